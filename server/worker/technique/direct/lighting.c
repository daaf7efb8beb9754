#include "server/worker/technique/direct/lighting.h"

#include <epoxy/gl.h>

#include "server/worker/technique/common/scene_params.h"
#include "shaders/gl/light_comp.h"
#include "shaders/gl/soften_comp.h"
#include "shaders/shared/deferred.h"

#define CLOSED_EMITTERS_MAX 32u
// Points on lamps that a pixel with its own has at least, over all samples: as good as the shared ones of fewer samples.
#define SHARP_POINTS 64u
#define SHARP_POINTS_MOST 16u // of them, in one sample
#define DOME_POINTS 4u // of a pixel on an even sky, at least: 64 for each block of pixels

static const struct gl_source light_source = {.name = "light", .compute = source_light_comp};
static const struct gl_source soften_source = {.name = "soften", .compute = source_soften_comp};

// Whether unshadowed light of the emissive triangles can be summed in closed form.
static bool lamps_are_few(const struct resident_scene *scene)
{
	return scene_count(scene, BLOB_EMITTERS) <= CLOSED_EMITTERS_MAX;
}

// Whether each pixel has points of its own.
static bool is_own(const struct plan *plan, const struct lighting_wish *wish)
{
	return wish->own || plan->samples >= DIRECT_SOFT_BELOW;
}

// Whether emissive triangles, or an even sky, light the scene by points that neighbouring pixels share.
static bool is_soft(const struct plan *plan, const struct resident_scene *scene, const struct lighting_wish *wish)
{
	const bool lamps =
	    plan_has(plan, candil_Effect_EFFECT_EMITTERS) && scene_count(scene, BLOB_EMITTERS) > 0 && wish->lamps;
	return (lamps || wish->dome) && !is_own(plan, wish);
}

static const char *word(bool value)
{
	return value ? "true" : "false";
}

struct lighting_wish lighting_wish_of(const struct direct_settings *s, bool maps, bool lamps)
{
	const bool shadows = s->shadows != DIRECT_SHADOWS_NONE;
	return (struct lighting_wish){.points = s->points,
				      .shadows = shadows,
				      .map_side = shadows && maps ? s->map : 0,
				      .lamps = lamps,
				      .rows = s->rows};
}

// Whether the closed form and a pixel's own points tell the light of emissive triangles.
static bool is_sharp(const struct plan *plan, const struct resident_scene *scene, const struct lighting_wish *wish)
{
	return !wish->dome && lamps_are_few(scene) && is_own(plan, wish);
}

// Points of a sample of a pixel.
static uint32_t points_of(const struct plan *plan, const struct resident_scene *scene, const struct lighting_wish *wish)
{
	const uint32_t enough = (SHARP_POINTS - 1) / plan->samples + 1;
	const uint32_t share = enough > SHARP_POINTS_MOST ? SHARP_POINTS_MOST : enough > 2 ? enough : 2;
	const uint32_t least = wish->dome ? DOME_POINTS : wish->own || is_sharp(plan, scene, wish) ? share : 1;
	return wish->points > least ? wish->points : least;
}

uint32_t lighting_rivals(const struct plan *plan, const struct resident_scene *scene, const struct lighting_wish *wish)
{
	const bool lamps = plan_has(plan, candil_Effect_EFFECT_EMITTERS) && wish->lamps && wish->shadows && !wish->dome;
	const bool lambert = !plan_has(plan, candil_Effect_EFFECT_ROUGH_DIFFUSE);
	return lamps && lambert && wish->rays > 0 && !lamps_are_few(scene) ? points_of(plan, scene, wish) : 0;
}

void lighting_define(struct gl_defines *defines, const struct plan *plan, const struct resident_scene *scene,
		     const struct lighting_wish *wish)
{
	const bool closed = !wish->dome && lamps_are_few(scene), sharp = is_sharp(plan, scene, wish);
	gl_define(defines, "DIRECT_POINTS", "%uu", points_of(plan, scene, wish));
	if (wish->own)
		gl_define(defines, "DIRECT_OWN", "true");
	if (lighting_rivals(plan, scene, wish) > 0)
		gl_define(defines, "DIRECT_RAYS_BESIDE", "%u.0", wish->rays);
	gl_define(defines, "DIRECT_CLOSED", "%s", word(closed));
	gl_define(defines, "DIRECT_SHARP", "%s", word(sharp));
	gl_define(defines, "DIRECT_DOME", "%s", word(wish->dome));
	gl_define(defines, "DIRECT_LAMPS", "%s", word(wish->lamps));
	gl_define(defines, "DIRECT_SHADOWS", "%s", word(wish->shadows));
	gl_define(defines, "DIRECT_SOFT", "%s", word(is_soft(plan, scene, wish)));
	if (plan_has_sky(plan))
		gl_define(defines, "DIRECT_SKY", "true");
	if (!shadow_maps_wanted(plan, scene, wish->map_side))
		return;
	gl_define(defines, "DIRECT_MAPS", "true");
	gl_define(defines, "DIRECT_MAPS_FOR_ALL", "%s", word(shadow_maps_for_all(scene)));
}

// ---- the passes ---------------------------------------------------------------------------------------------------------

static struct gl_texture_desc lamp_desc(const struct gl_device *device, const struct plan *plan, uint32_t rows)
{
	return (struct gl_texture_desc){.target = GL_TEXTURE_2D,
					.format = GL_RGBA32F,
					.width = plan->width,
					.height = deferred_band_rows(device, plan, rows),
					.depth = 1,
					.levels = 1};
}

uint64_t lighting_bytes(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan,
			const struct lighting_wish *wish)
{
	const struct gl_texture_desc desc = lamp_desc(devices->gl, plan, wish->rows);
	const uint64_t maps = shadow_maps_bytes(plan, scene, wish->map_side);
	const uint32_t images = !is_soft(plan, scene, wish) ? 0 : plan_has(plan, candil_Effect_EFFECT_GLOSSY) ? 4 : 3;
	return maps + images * gl_texture_bytes(&desc);
}

static void bind_lamps(void *user, const struct deferred_area *area)
{
	const struct lighting *l = user;
	(void)area;
	if (l->maps)
		shadow_maps_bind(l->maps);
	if (l->sky)
		sky_map_bind(l->sky);
	if (!l->scale.name)
		return;
	gl_texture_bind_image(&l->scale, DIRECT_SCALE_UNIT, 0, GL_READ_WRITE);
	gl_texture_bind_image(&l->arrived, DIRECT_ARRIVED_UNIT, 0, GL_READ_WRITE);
	gl_texture_bind_image(&l->expected, DIRECT_EXPECTED_UNIT, 0, GL_READ_WRITE);
	if (l->facets.name)
		gl_texture_bind_image(&l->facets, DIRECT_FACETS_UNIT, 0, GL_READ_WRITE);
}

static void add_pass(struct lighting *l, const struct gl_source *source, const struct plan *plan,
		     const struct resident_scene *scene, const struct lighting_wish *wish)
{
	struct deferred_pass *pass = &l->passes[l->pass_count++];
	*pass = (struct deferred_pass){.source = source, .stage = source->name, .bind = bind_lamps, .user = l};
	lighting_define(&pass->defines, plan, scene, wish);
}

static enum status make_images(struct lighting *l, const struct plan *plan, uint32_t rows, struct error *err)
{
	const struct gl_texture_desc desc = lamp_desc(l->device, plan, rows);
	enum status s = gl_texture_init(&l->scale, l->device, &desc, err);
	if (s == STATUS_OK)
		s = gl_texture_init(&l->arrived, l->device, &desc, err);
	if (s == STATUS_OK)
		s = gl_texture_init(&l->expected, l->device, &desc, err);
	if (s == STATUS_OK && plan_has(plan, candil_Effect_EFFECT_GLOSSY))
		s = gl_texture_init(&l->facets, l->device, &desc, err);
	return s;
}

enum status lighting_init(struct lighting *l, struct devices *devices, struct resident_scene *scene, const struct plan *plan,
			  const struct lighting_wish *wish, struct error *err)
{
	*l = (struct lighting){0};
	enum status s = devices_gl(devices, &l->device, err);
	if (s == STATUS_OK && plan_has_sky(plan))
		s = sky_map_get(plan->environment.scene, l->device, &l->sky, err);
	if (s == STATUS_OK && shadow_maps_wanted(plan, scene, wish->map_side))
		s = shadow_maps_acquire(scene, l->device, plan, wish->map_side, &l->compile_us, &l->maps, err);
	if (s != STATUS_OK)
		return s;
	add_pass(l, &light_source, plan, scene, wish);
	if (!is_soft(plan, scene, wish))
		return STATUS_OK;
	add_pass(l, &soften_source, plan, scene, wish);
	s = make_images(l, plan, wish->rows, err);
	if (s != STATUS_OK)
		lighting_finish(l);
	return s;
}

void lighting_finish(struct lighting *l)
{
	if (!l->device)
		return;
	gl_texture_finish(&l->scale, l->device);
	gl_texture_finish(&l->arrived, l->device);
	gl_texture_finish(&l->expected, l->device);
	gl_texture_finish(&l->facets, l->device);
	shadow_maps_release(l->maps);
	l->maps = NULL;
}

enum status lighting_step(struct lighting *l, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	return l->maps ? shadow_maps_step(l->maps, timer, budget_us, err) : STATUS_OK;
}

bool lighting_ready(const struct lighting *l)
{
	return !l->maps || shadow_maps_finished(l->maps);
}
