// Light from all of the half space above a place, by rays in the triangles (Reichert 1992's final gather): they take what the
// voxels know where they land, and where they do not, the background. Directions are by the cosine. Of an environment's
// picture, half as many rays again go where its table sends them, and both kinds are weighted by the balance heuristic (Veach
// 1997, 9.2.2): with n rays by the density p and m by q, each that escapes counts f L / (n p + m q).
//
// Clear surfaces are not in the voxels. A ray goes straight on through them, and takes their colour.
#ifndef VCT_RAYS_GLSL
#define VCT_RAYS_GLSL

#include "trace/single.glsl"
#include "vct/landed.glsl"

#ifdef VCT_SKY
#include "common/sky_map.glsl"
layout(binding = VCT_SKY_ROWS_UNIT) uniform usamplerBuffer sky_words;
#define SKY_TEXEL(x, y) texelFetch(sky_picture, ivec2(x, y), 0)
#define SKY_ROW(i) environment_row(uintBitsToFloat(texelFetch(sky_words, 2 * int(i)).x), texelFetch(sky_words, 2 * int(i) + 1).x)
#include "common/sky_sample.glsl"
#define RAYS_SKY true
#else
#define RAYS_SKY false
#endif
#ifndef VCT_AMBIENT
#define VCT_AMBIENT false
#endif

#define RAYS_FACES (EFFECT_GLASS ? 8u : 0u)   // clear faces that a ray passes
#define RAYS_CLEAR 0.5                        // transmission from which a face is clear
#define LEAST_LENGTH 1e-20                    // metres, of a ray: 1 / this is finite

uint rays_traced = 0u;

// Where rays start, and how far they may go.
struct rays_origin {
	vec3 position;    // off the surface
	vec3 geometric;   // unit; rays go to this side of the true surface
	vec3 shading;     // unit; the cosine is about it
};

// What one ray has met.
struct ray_end {
	vec3 radiance;    // from surfaces, W/(m² sr)
	vec3 open;        // share of the background that it sees
	float nearness;   // 1 / its length, 1/m, through clear surfaces; 0 where it sees the background
};

ray_end ray_follow(vec3 origin, vec3 direction, vec2 chance)
{
	ray_end r = ray_end(vec3(0.0), vec3(0.0), 0.0);
	vec3 through = vec3(1.0);
	float travelled = 0.0;
	for (uint face = 0u; face <= RAYS_FACES; face++) {
		ray_hit hit;
		rays_traced++;
		if (!walk_single(origin, direction, vct_march.reach - travelled, false, hit)) {
			r.open = through;
			return r;
		}
		travelled += hit.t;
		if (EFFECT_GLASS) {
			surface s = surface_at(hit.id, hit.uv, origin, direction, hit.t);
			if (s.transmission >= RAYS_CLEAR) {
				through *= s.transmission * s.base;
				origin = s.position - s.offset * s.geometric;
				continue;
			}
		}
		r.nearness = 1.0 / max(travelled, LEAST_LENGTH);
		r.radiance = through * landed_radiance(hit.id, origin + hit.t * direction, direction, chance);
		return r;
	}
	return r;
}

// Of the rays before ray i by the cosine, or among so many: those that go to the environment's picture.
uint rays_to_sky(uint i)
{
	return RAYS_SKY ? (i + 1u) / 2u : 0u;
}

// The direction on the true surface's upper side that stands for one below it.
vec3 rays_folded(rays_origin o, vec3 w)
{
	float above = dot(w, o.geometric);
	return above < 0.0 ? w - 2.0 * above * o.geometric : w;
}

// Density of a direction by the cosine, and of the one that is folded to it, 1/sr.
float rays_density(rays_origin o, vec3 w)
{
	vec3 below = w - 2.0 * dot(w, o.geometric) * o.geometric;
	return (max(dot(w, o.shading), 0.0) + max(dot(below, o.shading), 0.0)) * (1.0 / PI);
}

// The background's radiance along w, weighted: `all` are the rays by the cosine in all.
vec3 rays_background(rays_origin o, vec3 w, uint all)
{
#ifdef VCT_SKY
	sky_view v = sky_at(w);
	float density = float(all) * rays_density(o, w);
	return v.radiance * (density / max(density + float(rays_to_sky(all)) * v.pdf, 1e-30));
#else
	return vct_background_scale.rgb;
#endif
}

// The share of irradiance / π, W/(m² sr), that the rays from `first` to `end` bring of `all`. The place is part `part` of
// those that share a set. `nearness` grows by that of the rays by the cosine, 1/m.
vec3 rays_irradiance(rays_origin o, sampler_state random, uint part, uint first, uint end, uint all, inout float nearness)
{
	vec3 x, y;
	frame_make(o.shading, x, y);
	uint by_cosine = end - first;
	uint by_sky = rays_to_sky(end) - rays_to_sky(first);
	vec3 sum = vec3(0.0);
	for (uint i = 0u; i < by_cosine + by_sky; i++) {
		bool sky = i >= by_cosine;
		random.index = sky ? part * rays_to_sky(all) + rays_to_sky(first) + i - by_cosine : part * all + first + i;
		vec3 l = cosine_hemisphere(sample_2d(random, SET_BSDF));
		vec3 w = rays_folded(o, l.x * x + l.y * y + l.z * o.shading);
#ifdef VCT_SKY
		if (sky)
			w = sky_direction(sky_pick(sample_bits(random, SET_PICK)), sample_2d(random, SET_LIGHT));
#endif
		if (sky && dot(w, o.geometric) <= 0.0)
			continue;
		ray_end r = ray_follow(o.position, w, sample_2d(random, SET_CHANCE));
		sum += r.open * rays_background(o, w, all);
		if (sky)
			continue;
		sum += r.radiance;
		nearness += r.nearness;
		// As 1 − 1 / (1 + fall-off · length), which is 1 where nothing is met, whatever the fall-off.
		if (VCT_AMBIENT)
			sum += vct_march.ambient * (r.nearness > 0.0 ? vct_march.falloff / (vct_march.falloff + r.nearness) : 1.0);
	}
	return sum / float(all);
}

#endif
