#include "server/worker/technique/pt/pt_light.h"

#include <math.h>
#include <stdlib.h>

#include "server/scene/casters.h"
#include "server/scene/lights.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/vk/command.h"
#include "shaders/light_comp.h"

// A film's unit as a share of the power per area that the lamps would give, spread over the scene. 2⁶⁴ units have room for a
// million samples of a million times that brightness each.
#define FILM_FINE 0x1p-24

static const struct shader light_shader = {.name = "light",
					   .code = shader_light_comp,
					   .bytes = sizeof shader_light_comp,
					   .bindings = BIND_LIGHT_COUNT,
					   .texels = TRACE_TEXELS | 1u << BIND_LIGHT_NODES,
					   .push_bytes = sizeof(struct path_push)};

static bool wanted(const struct plan *plan)
{
	return plan_has(plan, candil_Effect_EFFECT_CAUSTICS);
}

uint64_t pt_light_bytes(const struct blob_view *scene, const struct plan *plan)
{
	if (!wanted(plan))
		return 0;
	return (uint64_t)plan->width * plan->height * sizeof(struct film_pixel) +
	       (uint64_t)casters_count(scene) * sizeof(struct emitter) + scene->counts[BLOB_MATERIALS] * sizeof(float);
}

static enum status make_casters(struct technique_job *j, struct scene_params *params, struct error *err)
{
	const struct blob_view *scene = &j->scene->view;
	const uint32_t materials = scene->counts[BLOB_MATERIALS];
	struct emitter *rows = NULL;
	float *density = calloc(materials, sizeof *density);
	if (!density)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status s = casters_make_table(scene, &rows, &params->caster_count, density, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&j->casters, j->device, rows, params->caster_count * sizeof *rows, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&j->caster_density, j->device, density, materials * sizeof *density, err);
	free(density);
	free(rows);
	return s;
}

enum status pt_light_init(struct technique_job *j, struct scene_params *params, struct error *err)
{
	const struct blob_view *scene = &j->scene->view;
	if (!wanted(&j->plan))
		return STATUS_OK;
	const double radius = lights_bounding_radius(scene->bounds_min, scene->bounds_max);
	const double sky = plan_sky_casts(&j->plan) ? scene_sky_power(&j->plan, scene) : 0;
	const double lamps = scene_emitter_power(&j->plan, scene) + scene_light_power(&j->plan, scene);
	const double power = lamps + sky;
	j->film_unit = fmin(fmax(power / (radius * radius) * FILM_FINE, 1e-30), 1e30);
	params->reach = (float)(2.1 * radius);
	params->film_unit = (float)j->film_unit;
	params->sky_paths = scene_share(sky, lamps);
	enum status s = make_casters(j, params, err);
	if (params->caster_count == 0)
		params->sky_paths = 0; // there is no polished surface to aim at
	for (uint32_t i = 0; s == STATUS_OK && i < j->band_count; i++) {
		const uint64_t pixels = (uint64_t)j->bands[i].rows * j->plan.width;
		s = buffer_init(&j->bands[i].film, j->device, pixels * sizeof(struct film_pixel), BUFFER_DEVICE, err);
	}
	return s;
}

enum status pt_light_make_pass(struct technique_job *j, bool *compiles, struct error *err)
{
	if (!wanted(&j->plan))
		return STATUS_OK;
	enum status s = pt_job_make_pipeline(j, &light_shader, j->plan.effects, &j->light, err);
	for (uint32_t i = 0; s == STATUS_OK && i < j->band_count; i++) {
		binding_set_finish(&j->bands[i].light_bindings, j->device);
		s = pt_job_bind(j, j->light, &j->bands[i].film, &j->bands[i].light_bindings, err);
	}
	if (s != STATUS_OK)
		return s;
	*compiles = *compiles || !j->light->warm;
	return pt_job_warm_up(j, j->light, &j->bands[0].light_bindings, err);
}

enum status pt_light_pipeline(struct technique_job *j, uint32_t effects, struct pipeline **pipeline, struct binding_set *set,
			      struct error *err)
{
	enum status s = pt_job_make_pipeline(j, &light_shader, effects, pipeline, err);
	if (s == STATUS_OK)
		s = pt_job_bind(j, *pipeline, &j->bands[0].film, set, err);
	return s == STATUS_OK ? pt_job_warm_up(j, *pipeline, set, err) : s;
}

void pt_light_finish(struct technique_job *j)
{
	for (uint32_t i = 0; j->bands && i < j->band_count; i++) {
		binding_set_finish(&j->bands[i].light_bindings, j->device);
		buffer_finish(&j->bands[i].film, j->device);
	}
	buffer_finish(&j->casters, j->device);
	buffer_finish(&j->caster_density, j->device);
}

void pt_light_record(const struct technique_job *j, const struct pipeline *pipeline, const struct binding_set *set,
		     const struct pt_band *band, uint32_t first_tile, uint32_t tiles)
{
	const uint32_t from = pt_light_tiles(first_tile - band->first_tile);
	const uint32_t to = pt_light_tiles(first_tile - band->first_tile + tiles);
	if (from == to)
		return;
	struct path_push push = pt_job_push(j, band);
	push.first_tile = band->first_tile + from;
	push.tile_count = to - from;
	pt_job_record(j, pipeline, set, push, j->segments);
}

// How many numbers below n have the last bit `half`.
static double of_half(uint64_t n, uint32_t half)
{
	return (double)((n + 1 - half) / 2);
}

void pt_light_units(const struct technique_job *j, const struct pt_band *band, double units[2])
{
	const uint32_t before = j->tile > band->first_tile ? j->tile - band->first_tile : 0;
	const uint32_t ahead = pt_light_tiles(before < band->tiles ? before : band->tiles);
	const uint32_t whole = pt_light_tiles(band->tiles);
	const uint64_t first = j->plan.first_sample, last = first + j->sample;
	for (uint32_t half = 0; half < 2; half++) {
		const double all = of_half(last, half) - of_half(first, half);
		const double more = of_half(last + j->batch, half) - of_half(last, half);
		const double tiles = all * whole + (j->tile > 0 ? more * ahead : 0);
		units[half] = tiles > 0 ? j->film_unit * whole / tiles : 0;
	}
}

enum status pt_light_read(const struct technique_job *j, const struct pt_band *band, uint32_t **film, struct error *err)
{
	*film = NULL;
	if (!band->film.handle)
		return STATUS_OK;
	*film = malloc((size_t)band->film.bytes);
	if (!*film)
		return error_set(err, STATUS_MEMORY, "out of memory");
	return buffer_read(&band->film, j->device, 0, band->film.bytes, *film, err);
}
