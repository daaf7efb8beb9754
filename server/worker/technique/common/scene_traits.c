#include "server/worker/technique/common/scene_traits.h"

static bool has(uint32_t effects, candil_Effect effect)
{
	return effects >> effect & 1u;
}

static bool has_deep_textures(const struct resident_scene *scene, uint32_t effects)
{
	return (has(effects, candil_Effect_EFFECT_TEXTURES) || has(effects, candil_Effect_EFFECT_NORMAL_MAPS)) &&
	       resident_has_deep_textures(scene);
}

static bool has_ranges(const struct resident_scene *scene, uint32_t effects)
{
	const struct punctual_light *lights = scene_section(scene, BLOB_LIGHTS);
	for (uint32_t i = 0; has(effects, candil_Effect_EFFECT_LIGHTS) && i < scene_count(scene, BLOB_LIGHTS); i++)
		if (lights[i].range > 0)
			return true;
	return false;
}

void scene_define(struct gl_defines *defines, const struct resident_scene *scene, uint32_t effects)
{
	gl_define_effects(defines, effects);
	if (has_deep_textures(scene, effects))
		gl_define(defines, "DEEP_TEXTURES", "true");
	if (has_ranges(scene, effects))
		gl_define(defines, "RANGED_LIGHTS", "true");
	if (scene->view.facts & FACT_VAST)
		gl_define(defines, "VAST_SCENE", "true");
}

void scene_set_constants(struct constants *constants, const struct resident_scene *scene, uint32_t effects)
{
	constants_set_effects(constants, effects);
	constants_set(constants, SPEC_DEEP_TEXTURES, has_deep_textures(scene, effects));
	constants_set(constants, SPEC_RANGED_LIGHTS, has_ranges(scene, effects));
	constants_set(constants, SPEC_VAST_SCENE, (scene->view.facts & FACT_VAST) != 0);
}
