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

void scene_define(struct gl_defines *defines, const struct resident_scene *scene, uint32_t effects)
{
	gl_define_effects(defines, effects);
	if (has_deep_textures(scene, effects))
		gl_define(defines, "DEEP_TEXTURES", "true");
}

void scene_set_constants(struct constants *constants, const struct resident_scene *scene, uint32_t effects)
{
	constants_set_effects(constants, effects);
	constants_set(constants, SPEC_DEEP_TEXTURES, has_deep_textures(scene, effects));
}
