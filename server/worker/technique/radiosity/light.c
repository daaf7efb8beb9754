#include "server/worker/technique/radiosity/light.h"

#include <stdlib.h>

#include "server/base/clock.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/common/scene_traits.h"
#include "server/worker/technique/common/sky_texels.h"
#include "server/worker/trace/trace.h"
#include "shaders/patch_light_comp.h"

// Rays of an invocation in one dispatch. Software drivers end an invocation's loops after some 65,000 rounds in all: so many
// leave each ray 4,000.
#define RAYS_SOFTWARE 16u
#define RAYS_DEVICE 128u

#define EVEN_CONTRAST 2.0 // of a picture: from here on its table is worth a ray

static const struct shader light_shader = {.name = "patch_light",
					   .code = shader_patch_light_comp,
					   .bytes = sizeof shader_patch_light_comp,
					   .bindings = BIND_RADIOSITY_COUNT,
					   .texels = TRACE_TEXELS,
					   .push_bytes = sizeof(struct patch_push)};

// A kind of dispatch: its points are taken `points` at a time, over all patches, before the next begins.
struct light {
	struct patch_pass pass;
	struct light_options options;
	struct buffer irradiance;
	uint32_t lights; // that are simulated
	uint32_t sky; // PATCH_SKY_…
	bool lamps; // emissive surfaces are simulated
	// The cursor.
	uint32_t turn; // the lights, then the two sides for the sky, then for lamps
	uint32_t point; // its first
	uint32_t next; // patch
	uint64_t done; // patches times points
};

static bool has_lights(const struct plan *plan, const struct resident_scene *scene)
{
	return plan_has(plan, candil_Effect_EFFECT_LIGHTS) && scene_count(scene, BLOB_LIGHTS) > 0;
}

static bool has_lamps(const struct plan *plan, const struct resident_scene *scene)
{
	return plan_has(plan, candil_Effect_EFFECT_EMITTERS) && scene_count(scene, BLOB_EMITTERS) > 0;
}

bool light_wanted(const struct plan *plan, const struct resident_scene *scene, bool lamps)
{
	return has_lights(plan, scene) || plan_has_sky(plan) || (lamps && has_lamps(plan, scene));
}

static bool usable(uint32_t points)
{
	return points > 0 && points <= LIGHT_POINTS_MOST && (points & (points - 1)) == 0;
}

// Those of the plan's effects that the pass can know.
static uint32_t effects_of(const struct plan *plan, bool lamps)
{
	const uint32_t emitters = lamps ? plan->effects & 1u << candil_Effect_EFFECT_EMITTERS : 0;
	return emitters |
	       (plan->effects & (1u << candil_Effect_EFFECT_TEXTURES | 1u << candil_Effect_EFFECT_LIGHTS |
				 1u << candil_Effect_EFFECT_ENVIRONMENT | 1u << candil_Effect_EFFECT_ALPHA_MASK |
				 1u << candil_Effect_EFFECT_ALPHA_BLEND | 1u << candil_Effect_EFFECT_VERTEX_COLORS));
}

// By the cosine alone an even picture has no error at all; one with a sun has all of it.
static uint32_t sky_way(const struct plan *plan)
{
	if (!plan_has_sky(plan))
		return PATCH_SKY_NONE;
	return plan->environment.contrast < EVEN_CONTRAST ? PATCH_SKY_COSINE : PATCH_SKY_BOTH;
}

static enum status light_init(struct light *l, const struct patch_scene *of, struct error *err)
{
	const uint32_t effects = effects_of(of->plan, l->lamps);
	const struct sky_texels *sky = NULL;
	struct device *d = l->pass.device;
	struct constants c = {0};
	enum status s = resident_upload(of->scene, d, TRACE_BINDINGS, err);
	if (s == STATUS_OK)
		s = patch_pass_init(&l->pass, of, effects, l->sky != PATCH_SKY_NONE, err);
	if (s == STATUS_OK && l->sky)
		s = sky_texels_get(of->plan->environment.scene, d, &sky, err);
	if (s == STATUS_OK && of->elements->count > 0)
		s = buffer_init(&l->irradiance, d, of->elements->count * 3ull * sizeof(float), BUFFER_DEVICE, err);
	if (s == STATUS_OK && of->elements->count > 0)
		s = buffer_clear(&l->irradiance, d, err);
	if (s != STATUS_OK)
		return s;
	const struct trace trace = trace_choose(d, of->scene, TRACE_AUTO);
	scene_set_constants(&c, of->scene, effects);
	trace_set_constants(&trace, &c);
	constants_set(&c, SPEC_PATCH_COUNT, of->elements->patches.count);
	constants_set(&c, SPEC_PATCH_SKY, l->sky);
	constants_set(&c, SPEC_PATCH_DISCS, l->lights > 0 && scene_has_discs(of->scene));
	constants_set(&c, SPEC_PATCH_BOUNCES, l->sky || l->lamps ? l->options.bounces : 0);
	constants_set(&c, SPEC_PATCH_LAMPS, l->lamps);
	const struct buffer *const own[3] = {&l->irradiance, sky ? &sky->texels : NULL, sky ? &sky->rows : NULL};
	return patch_pass_bind(&l->pass, of, &light_shader, &c, own, err);
}

enum status light_create(const struct patch_scene *of, const struct light_options *options, struct device *device,
			 struct light **out, struct error *err)
{
	*out = NULL;
	if (!usable(options->points) || !usable(options->sky_points))
		return error_set(err, STATUS_BAD_ARGUMENT, "points of a patch must be a power of two of at most %u",
				 LIGHT_POINTS_MOST);
	struct light *l = calloc(1, sizeof *l);
	if (!l)
		return error_set(err, STATUS_MEMORY, "out of memory");
	l->pass.device = device;
	l->options = *options;
	l->lights = has_lights(of->plan, of->scene) ? scene_count(of->scene, BLOB_LIGHTS) : 0;
	l->sky = sky_way(of->plan);
	l->lamps = options->lamps && has_lamps(of->plan, of->scene);
	const enum status s = light_init(l, of, err);
	if (s != STATUS_OK) {
		light_destroy(l);
		return s;
	}
	*out = l;
	return STATUS_OK;
}

void light_destroy(struct light *l)
{
	if (!l)
		return;
	patch_pass_finish(&l->pass);
	buffer_finish(&l->irradiance, l->pass.device);
	free(l);
}

bool light_compiled(const struct light *l)
{
	return patch_pass_compiled(&l->pass);
}

enum status light_compile(struct light *l, struct error *err)
{
	return patch_pass_compile(&l->pass, err);
}

static uint32_t turns_of(const struct light *l)
{
	return l->lights + (l->sky ? 2 : 0) + (l->lamps ? 2 : 0);
}

static uint32_t points_of(const struct light *l)
{
	return l->turn < l->lights ? l->options.points : l->options.sky_points;
}

// How many points of a turn a dispatch takes. It depends on nothing but the device and the options, since the order of a sum
// is in its bits.
static uint32_t points_at_once(const struct light *l)
{
	const uint32_t rays = l->pass.device->info.software ? RAYS_SOFTWARE : RAYS_DEVICE;
	const uint32_t each = l->turn < l->lights ? 1 : 2 + l->options.bounces, most = rays / each > 0 ? rays / each : 1;
	const uint32_t left = points_of(l) - l->point;
	return most < left ? most : left;
}

static void advance(struct light *l, uint32_t patches, uint32_t points)
{
	const bool was_light = l->turn < l->lights;
	l->done += (uint64_t)patches * points;
	l->next += patches;
	if (l->next < l->pass.patches)
		return;
	l->next = 0;
	l->point += points;
	if (l->point < points_of(l))
		return;
	l->point = 0;
	l->turn++;
	// Rays to the sky and to lamps are others, and more.
	if (was_light && l->turn >= l->lights)
		l->pass.item_us = 0;
}

enum status light_step(struct light *l, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = STATUS_OK;
	while (s == STATUS_OK && !light_finished(l)) {
		const uint64_t spent = clock_us() - start;
		const uint32_t left = spent < budget_us ? budget_us - (uint32_t)spent : 0, points = points_at_once(l);
		const bool lamp = l->turn < l->lights, sky = l->sky && l->turn < l->lights + 2;
		const struct patch_push push = {.first = l->next,
						.count = patch_pass_fit(&l->pass, l->pass.patches - l->next, left),
						.light = lamp  ? l->turn
							 : sky ? NONE
							       : PATCH_LAMPS,
						.point = l->point,
						.points = points,
						.all = points_of(l),
						.back = lamp ? 0 : (l->turn - l->lights) % 2};
		s = patch_pass_run(&l->pass, &push, err);
		advance(l, push.count, points);
		if (clock_us() - start >= budget_us)
			break;
	}
	return s == STATUS_OK ? patch_pass_check(&l->pass, err) : s;
}

bool light_finished(const struct light *l)
{
	return l->pass.patches == 0 || l->turn >= turns_of(l);
}

static uint64_t whole(const struct light *l)
{
	return (uint64_t)l->pass.patches *
	       ((uint64_t)l->lights * l->options.points + (turns_of(l) - l->lights) * (uint64_t)l->options.sky_points);
}

float light_progress(const struct light *l)
{
	return light_finished(l) ? 1.0f : (float)((double)l->done / (double)whole(l));
}

double light_rays_wanted(const struct plan *plan, const struct resident_scene *scene, const struct light_options *options,
			 uint32_t patches)
{
	const double lights = has_lights(plan, scene) ? scene_count(scene, BLOB_LIGHTS) : 0;
	const double sides = (plan_has_sky(plan) ? 2 : 0) + (options->lamps && has_lamps(plan, scene) ? 2 : 0);
	return patches * (lights * options->points + sides * options->sky_points * (2.0 + options->bounces));
}

uint64_t light_rays(const struct light *l)
{
	const uint64_t of_lights = (uint64_t)l->pass.patches * l->lights * l->options.points;
	return l->done <= of_lights ? l->done : of_lights + (l->done - of_lights) * (2 + l->options.bounces);
}

enum status light_read(const struct light *l, float *irradiance, struct error *err)
{
	return l->irradiance.handle
		   ? buffer_read(&l->irradiance, l->pass.device, 0, l->pass.patches * 6ull * sizeof(float), irradiance, err)
		   : STATUS_OK;
}

uint64_t light_bytes(const struct plan *plan, uint32_t faces, uint32_t patches)
{
	uint64_t bytes = sizeof(struct scene_params) + sizeof(struct pass_counters) + faces * 2ull * sizeof(uint32_t) +
			 patches * 6ull * sizeof(float);
	if (plan_has_sky(plan))
		bytes += (uint64_t)plan->environment.width * plan->environment.height *
			 (sizeof(struct environment_texel) + sizeof(struct environment_row));
	return bytes;
}
