#include "server/worker/technique/common/scene_params.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/scene/lights.h"

uint32_t scene_bindings_shade(const struct plan *plan)
{
	uint32_t bits = 1u << BIND_TRIANGLES | 1u << BIND_VERTICES | 1u << BIND_MATERIALS;
	if (plan_has(plan, candil_Effect_EFFECT_EMITTERS))
		bits |= 1u << BIND_EMITTERS;
	if (plan_has(plan, candil_Effect_EFFECT_LIGHTS))
		bits |= 1u << BIND_LIGHTS;
	if (plan_has(plan, candil_Effect_EFFECT_TEXTURES) || plan_has(plan, candil_Effect_EFFECT_NORMAL_MAPS))
		bits |= 1u << BIND_TEXTURES | 1u << BIND_TEXELS | 1u << BIND_SRGB_TABLE | 1u << BIND_UV1;
	if (plan_has(plan, candil_Effect_EFFECT_NORMAL_MAPS))
		bits |= 1u << BIND_TANGENTS;
	if (plan_has(plan, candil_Effect_EFFECT_VERTEX_COLORS))
		bits |= 1u << BIND_COLORS;
	if (plan_has(plan, candil_Effect_EFFECT_GLOSSY) || plan_has(plan, candil_Effect_EFFECT_GLASS) ||
	    plan_has(plan, candil_Effect_EFFECT_CLEARCOAT))
		bits |= 1u << BIND_GGX_TABLE;
	return bits;
}

float scene_share(double of, double others)
{
	if (!(of > 0))
		return 0;
	const double share = of / (of + others);
	return (float)(!(others > 0) ? 1 : share < 0.1 ? 0.1 : share > 0.9 ? 0.9 : share);
}

double scene_sky_power(const struct plan *plan, const struct blob_view *scene)
{
	const double radius = lights_bounding_radius(scene->bounds_min, scene->bounds_max);
	return PI * radius * radius * plan->environment.power;
}

float scene_power_inverse(float power)
{
	return power >= FLT_MIN ? 1.0f / power : 0.0f;
}

double scene_emitter_power(const struct plan *plan, const struct blob_view *scene)
{
	return plan_has(plan, candil_Effect_EFFECT_EMITTERS) ? (double)scene->emitter_power : 0;
}

double scene_light_power(const struct plan *plan, const struct blob_view *scene)
{
	return plan_has(plan, candil_Effect_EFFECT_LIGHTS) ? (double)scene->light_power : 0;
}

static void fill_shares(const struct plan *p, const struct blob_view *scene, bool sky, struct scene_params *out)
{
	const double e = scene_emitter_power(p, scene), l = scene_light_power(p, scene);
	const float emitters = scene_share(e, l);
	out->sky_share = sky ? scene_share(scene_sky_power(p, scene), e + l) : 0;
	out->emitter_share = emitters * (1.0f - out->sky_share);
	out->light_share = (1.0f - emitters) * (1.0f - out->sky_share);
	out->sky_width = p->environment.width;
	out->sky_height = p->environment.height;
	out->sky_turn = (float)p->environment.turn;
	out->sky_scale = (float)p->environment.scale;
}

// Scale an axis of the image to the length of the lens's radius.
static void fill_lens(const struct plan_camera *c, const double axis[3], float out[3])
{
	const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
	for (int i = 0; i < 3; i++)
		out[i] = length > 0 ? (float)(axis[i] / length * c->lens_radius) : 0;
}

// Bits of the number of samples that each half of a pixel gets in a sequence that pixels share: it is a power of two, the
// least that is enough.
static uint32_t run_bits(uint32_t samples)
{
	uint32_t bits = 0;
	while (bits < 31 && (1u << bits) < samples / 2 + samples % 2)
		bits++;
	return bits;
}

void scene_params_fill(const struct plan *p, const struct blob_view *scene, bool sky_is_lamp, struct scene_params *out)
{
	memset(out, 0, sizeof *out);
	out->width = p->width;
	out->height = p->height;
	out->tiles_x = tiles_over(p->width);
	out->depth = p->depth;
	out->seed[0] = (uint32_t)p->seed;
	out->seed[1] = (uint32_t)(p->seed >> 32);
	out->emitter_count = scene->counts[BLOB_EMITTERS];
	out->light_count = scene->counts[BLOB_LIGHTS];
	fill_shares(p, scene, sky_is_lamp, out);
	out->emitter_power_inv = scene_power_inverse(scene->emitter_power);
	out->has_uv1 = scene->counts[BLOB_UV1] > 0;
	out->has_colors = scene->counts[BLOB_COLORS] > 0;
	out->orthographic = p->camera.orthographic ? 1.0f : 0.0f;
	for (int i = 0; i < 3; i++) {
		out->eye[i] = (float)(p->camera.eye[i] - scene->blob->origin[i]);
		out->forward[i] = (float)p->camera.forward[i];
		out->right[i] = (float)p->camera.right[i];
		out->up[i] = (float)p->camera.up[i];
		out->background[i] = p->background[i];
	}
	out->focus = (float)p->camera.focus;
	out->run_bits = run_bits(p->first_sample + p->samples);
	fill_lens(&p->camera, p->camera.right, out->lens_right);
	fill_lens(&p->camera, p->camera.up, out->lens_up);
}

void technique_note(candil_Accepted *accepted, const char *format, ...)
{
	va_list args;
	if (accepted->notes_count == sizeof accepted->notes / sizeof accepted->notes[0])
		return;
	va_start(args, format);
	vsnprintf(accepted->notes[accepted->notes_count++], sizeof accepted->notes[0], format, args);
	va_end(args);
}

bool scene_has_discs(const struct resident_scene *scene)
{
	const struct punctual_light *lights = scene_section(scene, BLOB_LIGHTS);
	for (uint32_t i = 0; i < scene_count(scene, BLOB_LIGHTS); i++)
		if (lights[i].spread > 0)
			return true;
	return false;
}
