// The start of light paths: at a lamp chosen by power, as in next-event estimation. The direction is either sampled by the
// lamp's emission or aimed at a point of a caster. The balance heuristic (Veach 1997, 9.2.2) weights the two once it is
// known where the first ray ends: only there is the density of aimed directions known.
#ifndef PATH_EMIT_GLSL
#define PATH_EMIT_GLSL

#include "pt/caustic.glsl"
#include "pt/sky.glsl"
#include "shared/pt.h"

layout(std430, set = 0, binding = BIND_CASTERS) readonly buffer Casters {
	emitter casters[];
};

struct launch {
	vec3 origin;
	vec3 direction;
	vec3 power;       // radiance × cosine, or intensity, or irradiance
	float pick;       // density of the choice of the lamp and of the point on it
	float spread;     // density of directions that are not aimed, 1/sr
	float pdf_area;   // density of the lamp's point, 1/m², for the weights; 0: the lamp has no area
	float cos_lamp;
	float inverse;    // without an area: `inverse` for lamp_density
	bool parallel;    // light from afar: `spread` is unused; aimed rays have a density over the area across them
	uint target;      // triangle that was aimed at, or NONE
	float range;      // of a point or spot light; 0: no bound
};

launch launch_none()
{
	return launch(vec3(0.0), vec3(0.0, 0.0, 1.0), vec3(0.0), 0.0, 0.0, 0.0, 1.0, 0.0, false, NONE, 0.0);
}

// The direction from a point to a target, or `otherwise` where the two are one.
vec3 direction_to(vec3 target, vec3 from, vec3 otherwise)
{
	vec3 way = target - from;
	return dot(way, way) > 0.0 ? normalize(way) : otherwise;
}

vec3 corner_mix(corners k, vec2 uv)
{
	return k.v0 + uv.x * (k.v1 - k.v0) + uv.y * (k.v2 - k.v0);
}

// Chooses a point of a caster.
vec3 aim_at(uvec2 pick, vec2 u, out uint target)
{
	emitter e = casters[alias_row(pick.x, job.caster_count)];
	bool keep = float(pick.y >> 8) * UNIT_24 < e.keep;
	target = keep ? e.triangle : casters[e.alias].triangle;
	return corner_mix(corners_of(triangles[target]), sample_triangle(u));
}

// A direction about `axis`, uniform within the angle of which 1 − cos is `extent`.
vec3 cone_direction(vec3 axis, float extent, vec2 u)
{
	vec3 x, y;
	frame_make(axis, x, y);
	float lower = u.x * extent;
	float r = sqrt(lower * (2.0 - lower));
	return r * cos(2.0 * PI * u.y) * x + r * sin(2.0 * PI * u.y) * y + (1.0 - lower) * axis;
}

// `share` of all light paths start at emissive triangles. camera_keeps assumes the share of next-event estimation instead.
launch launch_emitter(sampler_state rnd, bool aims, float share)
{
	launch l;
	lamp_pick lamp = pick_emitter(sample_bits(rnd, SET_PICK));
	triangle tri = triangles[lamp.number];
	material m = materials[tri.material];
	corners k = corners_of(tri);
	vec2 uv = place_on(lamp, EMITTER_CELLS ? sample_bits(rnd, SET_CELL) : uvec2(0u), sample_2d(rnd, SET_LIGHT));
	vec3 q = corner_mix(k, uv);
	vec2 u = sample_2d(rnd, SET_BSDF);
	bool both = (m.flags & MATERIAL_EMITS_BOTH_SIDES) != 0u;
	vec3 target = q;
	l.target = NONE;
	if (aims)
		target = aim_at(sample_bits(rnd, SET_CHANCE), u, l.target);
	// The side from which the path leaves: the side of the target, or any that emits.
	bool front = aims ? dot(target - q, k.normal) > 0.0 : !both || sample_2d(rnd, SET_LENS).x < 0.5;
	vec3 n = front ? k.normal : -k.normal;
	l.origin = q + n * start_offset(k, q);
	vec3 x, y;
	frame_make(n, x, y);
	vec3 local = cosine_hemisphere(u);
	l.direction = aims ? direction_to(target, l.origin, n) : local.x * x + local.y * y + local.z * n;
	l.cos_lamp = max(dot(l.direction, n), 0.0);
	l.power = front || both ? emitted_towards(m, tri, k.normal, uv, l.direction) * l.cos_lamp : vec3(0.0);
	l.pdf_area = lamp.density * job.emitter_share;
	l.pick = lamp.density * share;
	l.spread = l.cos_lamp / (both ? 2.0 * PI : PI);
	l.inverse = 0.0;
	l.parallel = false;
	l.range = 0.0;
	return l;
}

launch launch_punctual(sampler_state rnd, bool aims, float share)
{
	launch l;
	lamp_pick lamp = pick_light(sample_bits(rnd, SET_PICK));
	punctual_light light = lights[lamp.number];
	vec2 u = sample_2d(rnd, SET_BSDF);
	vec3 axis = to_vec3(light.direction);
	l.parallel = light.kind == LIGHT_DIRECTIONAL;
	// Light from afar can only be aimed.
	aims = job.caster_count > 0u && (aims || l.parallel);
	l.power = l.parallel && !aims ? vec3(0.0) : to_vec3(light.intensity);
	if (DISC_LIGHTS && light.spread > 0.0)
		axis = in_disc(light, axis, sample_2d(rnd, SET_LIGHT), l.power);
	float extent = punctual_extent(light);
	l.origin = to_vec3(light.position);
	l.direction = cone_direction(light.kind == LIGHT_SPOT ? axis : vec3(0.0, 0.0, 1.0), extent, u);
	l.target = NONE;
	if (aims) {
		vec3 target = aim_at(sample_bits(rnd, SET_CHANCE), u, l.target);
		l.origin = l.parallel ? target - axis * job.reach : l.origin;
		l.direction = l.parallel ? axis : direction_to(target, l.origin, l.direction);
	}
	if (light.kind == LIGHT_SPOT)
		l.power *= spot_attenuation(light, l.direction);
	bool inside = light.kind != LIGHT_SPOT || spread_between(l.direction, axis) <= extent;
	l.spread = inside ? punctual_spread(light) : 0.0;
	l.pick = lamp.density * share;
	l.pdf_area = 0.0;
	l.cos_lamp = 1.0;
	l.inverse = 0.0;
	l.range = l.parallel ? 0.0 : light.range;
	return l;
}

// Starts a light path at the environment map, by its alias table.
launch launch_sky(sampler_state rnd, float share)
{
	launch l;
	uint texel = sky_pick(sample_bits(rnd, SET_PICK));
	vec3 w = sky_direction(texel, sample_2d(rnd, SET_LIGHT));
	sky_view v = sky_at(w);
	l.power = v.radiance;
	l.pick = share * sky_texels[texel].w;
	l.direction = -w;
	l.origin = aim_at(sample_bits(rnd, SET_CHANCE), sample_2d(rnd, SET_BSDF), l.target) + w * job.reach;
	l.spread = 0.0;
	l.pdf_area = 0.0;
	l.cos_lamp = 1.0;
	l.inverse = path_inverse(v);
	l.parallel = true;
	l.range = 0.0;
	return l;
}

// The first ray of a light path. Its power may be zero; then there is no path.
launch launch_make(sampler_state rnd)
{
	vec2 ways = sample_2d(rnd, SET_PIXEL);
	// Of the paths that do not start at the environment map, each kind of lamp gets the same share as in next-event
	// estimation.
	float lamps = 1.0 - job.sky_paths;
	float share = lamps * job.emitter_share / max(job.emitter_share + job.light_share, 1e-30);
	bool afar = SKY && job.caster_count > 0u && ways.y >= lamps;
	bool emissive = EFFECT_EMITTERS && job.emitter_count > 0u && (!EFFECT_LIGHTS || ways.y < share);
	bool aims = ways.x < aimed_share(false);
	launch l = launch_none();
	if (SKY && afar)
		l = launch_sky(rnd, job.sky_paths);
	else if (emissive)
		l = launch_emitter(rnd, aims, share);
	else if (EFFECT_LIGHTS && job.light_count > 0u)
		l = launch_punctual(rnd, aims, lamps - share);
	return l;
}

// Power, W, of the first ray after it hit triangle `id` at distance t with this cosine. `density` is that of aimed points
// on this material, 1/m². Zero if the ray was aimed at another triangle, or where the lamp's range ends. Light that has reached
// a surface within the range goes on without a bound, as from any surface.
vec3 launch_power(launch l, uint id, float density, float cosine, float t)
{
	float reach = l.parallel ? 1.0 : t * t;
	float share = aimed_share(l.parallel);
	float pdf = l.pick * ((1.0 - share) * l.spread + min(share * density * reach / max(cosine, 1e-30), 1e30));
	vec3 power = RANGED_LIGHTS ? l.power * within_range(l.range, t * t) : l.power;
	return (l.target == NONE || l.target == id) && pdf > 0.0 ? power / pdf : vec3(0.0);
}

// lamp_density for the same ray. `pdf` is the density of the camera's sampling where the ray ended, 1/sr.
float launch_density(launch l, float density, float cosine, float t, float pdf)
{
	bool point = l.pdf_area > 0.0;
	float t2 = max(t * t, 1e-37);
	float spread = (point ? l.cos_lamp / PI : l.spread) / t2;
	float inverse = point ? min(l.cos_lamp / (t2 * l.pdf_area), 1e18) : l.inverse;
	return lamp_density(arriving(spread, density / max(cosine, 1e-30), l.parallel), pdf, inverse);
}

#endif
