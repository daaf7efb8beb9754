// Direct light on a surface.
//
// Point, spot and directional lights are exact: one shadow ray each, for at most DIRECT_LIGHTS lights. If there are more,
// that many are chosen at even steps of their cumulative power. With DIRECT_MAPS, a light that has a shadow map
// (shadow_map.glsl) uses it instead of a ray.
//
// Emissive triangles on the diffuse part: where they are few, the unshadowed irradiance is known in closed form (lamps.glsl),
// as if they had no textures. DIRECT_POINTS points on them, evenly distributed over their power, then estimate the
// visibility: it is the ratio of the visible points' light to the light of all points (Heitz, Hill and McGuire 2018,
// "Combining analytic direct illumination and stochastic shadows"), here without their textures. So neither unshadowed nor
// fully shadowed places show noise. Otherwise the points alone estimate the light. The points of 4 × 4 pixels form one set:
// the mean over any such block (soften.comp.glsl) uses 16 times as many. Pictures of many samples have enough points in each pixel and do without
// the mean, so that shadows keep their edges. Such a ratio of few points is biased, and its mean over samples as much. So
// they take the closed form and the points' differences instead (DIRECT_SHARP, lamp_points.glsl).
//
// Emissive triangles on microfacets: the same points, and one ray in a direction sampled from the facets, combined by the
// power heuristic (Veach 1997, 9.2.4). A perfect mirror has only its one direction.
//
// An even sky (DIRECT_DOME) takes the place of the emissive triangles. Its points are directions by the cosine, which the
// same block of pixels shares; microfacets have their own direction alone.
#ifndef DIRECT_LIGHTING_GLSL
#define DIRECT_LIGHTING_GLSL

#include "deferred/area.glsl"
#include "direct/lamp_points.glsl"
#include "trace/single.glsl"

// Options; macros that the program defines.
#ifndef DIRECT_POINTS
#define DIRECT_POINTS 2u        // points on emissive triangles, 1…16; with DIRECT_SHARP at least 2
#define DIRECT_CLOSED false     // closed form: few emissive triangles
#define DIRECT_SHARP false      // with DIRECT_CLOSED: each pixel has its own points
#define DIRECT_SHADOWS true
#define DIRECT_DOME false       // nothing gives light but an even sky, the job's background
#define DIRECT_LAMPS true         // emissive triangles send light
#define DIRECT_SOFT true        // keep the lamps' light for soften.comp.glsl
#define DIRECT_MAPS true        // if defined: lights have shadow maps
#define DIRECT_MAPS_FOR_ALL false // every light has one
#endif
#ifndef DIRECT_OWN
#define DIRECT_OWN false          // each pixel has a set of points of its own: noise in the place of a pattern
#endif
#ifndef DIRECT_RAYS_BESIDE
#define DIRECT_RAYS_BESIDE 0.0    // rays by the cosine that find emissive triangles in another pass, beside the points
#endif
#ifndef DIRECT_TURN
#define DIRECT_TURN turn.y        // which set of points
#endif
#ifdef DIRECT_MAPS
#include "direct/shadow_map.glsl"
#else
#define DIRECT_MAPS_FOR_ALL false
#endif
#define DIRECT_LIGHTS 64u
#define DIRECT_BLOCK 16u        // number of pixels whose points form one set
#define DIRECT_AREAS (EFFECT_EMITTERS || DIRECT_DOME) // whether light comes from places that must be sampled

// A program without shadow rays defines DIRECT_OPEN as a function that returns a light's visibility, 0…1. Its arguments are
// the ray's origin, the surface's normal, the segment and t_max.
#ifdef DIRECT_OPEN
#define DIRECT_RAYS false
float direct_open(bool met, vec3 origin, vec3 normal, vec3 segment, float t_max)
{
	return DIRECT_OPEN(origin, normal, segment, t_max);
}
#else
#define DIRECT_RAYS (DIRECT_SHADOWS && !(DIRECT_MAPS_FOR_ALL && !(EFFECT_EMITTERS && DIRECT_LAMPS)))
float direct_open(bool met, vec3 origin, vec3 normal, vec3 segment, float t_max)
{
	return met ? 0.0 : 1.0;
}
#endif

// Luminance of the diffuse reflection: with shadows (x) and without (y).
vec2 direct_share = vec2(0.0);

// With DIRECT_SHARP or DIRECT_OWN, a number that the pixel shares with none.
uint direct_place = 0u;

// Number of rays that this invocation traced.
uint direct_rays = 0u;

// The light of the emissive triangles on a surface's diffuse part. Reflected radiance is scale × arrived / expected,
// channel by channel, or 0 where nothing is expected. Only `scale` contains the material's colour, so that the other two
// may be replaced by sums over neighbouring pixels.
struct lamp_light {
	vec3 scale;
	vec3 arrived;
	vec3 expected;
	vec3 facets;     // radiance reflected by the microfacets, except a perfect mirror's
};

vec3 lamp_radiance(lamp_light l)
{
	vec3 ratio = l.arrived / max(l.expected, 1e-30);
	// The ratio slightly exceeds one where light is folded over a tilted normal.
	if (DIRECT_CLOSED && !DIRECT_SHARP)
		ratio = min(ratio, 2.0);
	return l.scale * vec3(l.expected.r > 0.0 ? ratio.r : 0.0, l.expected.g > 0.0 ? ratio.g : 0.0,
			      l.expected.b > 0.0 ? ratio.b : 0.0);
}

// A pixel's number in its 4 × 4 block; neighbouring pixels have distant numbers. Over sixteen samples, a pixel takes every
// number.
uint direct_pattern(uvec2 pixel)
{
	uvec2 p = pixel & 3u;
	uint odd = (p.x ^ p.y) & 1u;
	uint far = (p.x ^ p.y) >> 1;
	return (odd << 3 | (p.y & 1u) << 2 | far << 1 | p.y >> 1) ^ (bitfieldReverse(turn.y) >> 28) ^ (9u * turn.x);
}

// The shift of the point sets. The two halves of the samples have different ones.
uint direct_shift()
{
	uint shift = hash_combine(hash_combine(hash(job.seed[0]), job.seed[1]), turn.x);
	return DIRECT_OWN ? hash_combine(shift, direct_place) : shift;
}

// 32 bits that choose a light: step i of `count` even steps, whose position within the step depends on the sample.
uint direct_step(uint i, uint count, uint shift)
{
	float part = float((bitfieldReverse(DIRECT_TURN) ^ shift) >> 8) * UNIT_24;
	return uint((float(i) + part) / float(count) * 16777216.0) << 8;
}

// Point k of a pixel with this pattern: `pick` chooses the light (two times 32 bits for alias tables), `where` the place on
// it, 0…1.
void direct_point(uint pattern, uint k, out uvec2 pick, out vec2 where)
{
	const uint count = DIRECT_POINTS * DIRECT_BLOCK;
	uint i = k * DIRECT_BLOCK + pattern;
	uint h = direct_shift();
	// The first coordinate takes even steps, the other two are Sobol' points: Hammersley's set in three dimensions,
	// shifted as a whole. The next sample continues the latter two.
	uint row, low;
	uint at = direct_step(i, count, hash(h));
	umulExtended(at, job.emitter_count, row, low);
	pick = uvec2(at, low);
	uint j = DIRECT_TURN * count + i;
	uvec2 bits = bitfieldReverse(uvec2(j, sobol1_reversed(j))) ^ uvec2(hash(h + 1u), hash(h + 2u));
	where = vec2(bits >> 8) * UNIT_24;
}

// The light of shadow ray i, 1 / its probability in `weight`, and its own number.
punctual_light direct_punctual(uint i, out float weight, out uint number)
{
	weight = 1.0;
	number = i;
	if (job.light_count <= DIRECT_LIGHTS)
		return lights[i];
	uint at = direct_step(i, DIRECT_LIGHTS, hash(direct_shift() + 3u));
	uint row, low;
	umulExtended(at, job.light_count, row, low);
	lamp_pick lamp = pick_light(uvec2(at, low));
	number = lamp.number;
	weight = 1.0 / (float(DIRECT_LIGHTS) * lamp.density);
	return lights[number];
}

vec3 folded_below(bsdf b, vec3 w, float above)
{
	return into_frame(b, w - 2.0 * above * b.geometric);
}

// The diffuse part's BSDF × cosine for a white surface, and the microfacets' with their density, folded as in bsdf_eval.
void direct_eval(bsdf b, vec3 w, out vec3 diffuse, out vec4 facets)
{
	b.diffuse = vec3(1.0);
	float above = dot(b.geometric, w);
	vec3 l = into_frame(b, w);
	vec3 f = folded_below(b, w, above);
	bool lit = above > 0.0;
	diffuse = lit ? diffuse_lobe(b, l) + diffuse_lobe(b, f) : vec3(0.0);
	facets = lit ? facet_lobe(b, l) + facet_lobe(b, f) : vec4(0.0);
}

// A shadow ray and what it brings if nothing blocks it.
struct direct_ray {
	vec3 segment;
	float t_max;        // -1: no ray
	vec3 diffuse;       // radiance reflected by the diffuse part; for emissive triangles, by a white diffuse part
	vec3 facets;        // radiance reflected by the microfacets
	vec3 expected;      // for emissive triangles: the light that the closed form also contains
	uint map;           // shadow map to use instead of a ray, from shadow_first; NONE: a ray
};

void ray_to_light(bsdf b, vec3 origin, uint i, inout direct_ray r)
{
	float weight;
	vec3 w;
	uint number;
	punctual_light light = direct_punctual(i, weight, number);
#ifdef DIRECT_MAPS
	r.map = shadow_first[number];
#endif
	vec3 irradiance = punctual_irradiance(light, origin, w, r.segment, r.t_max) * weight;
	vec4 facets;
	direct_eval(b, w, r.diffuse, facets);
	r.diffuse *= irradiance * b.diffuse;
	r.facets = facets.xyz * irradiance;
	if (max(r.diffuse + r.facets, vec3(0.0)) == vec3(0.0))
		r.t_max = -1.0;
}

// The density, 1/sr, of a direction above the surface by the cosine, with that of the one that folds to it.
float cosine_pdf(bsdf b, vec3 w)
{
	return (max(dot(w, b.normal), 0.0) + max(folded_below(b, w, dot(b.geometric, w)).z, 0.0)) / PI;
}

void ray_to_lamp(bsdf b, vec3 origin, uint pattern, uint k, inout direct_ray r)
{
	uvec2 pick;
	vec2 where;
	emitter_view v;
	direct_point(pattern, k, pick, where);
	lamp_pick lamp = pick_emitter(pick);
	if (!view_emitter(origin, lamp, sample_triangle(where), v))
		return;
	vec3 w = normalize(v.segment);
	vec4 facets;
	vec3 diffuse;
	direct_eval(b, w, diffuse, facets);
	vec3 light = v.radiance * (v.inverse / float(DIRECT_POINTS));
	r.segment = v.segment;
	r.t_max = 1.0;
	r.diffuse = diffuse * light;
	if (EFFECT_GLOSSY)
		r.facets = facets.xyz * light * power_weight(min(facets.w * v.inverse / float(DIRECT_POINTS), 1e18));
	if (DIRECT_RAYS_BESIDE > 0.0)
		r.diffuse *= power_weight(min(DIRECT_RAYS_BESIDE * cosine_pdf(b, w) * v.inverse / float(DIRECT_POINTS), 1e18));
	// The closed form knows no texture: the ratio tells what both the texture and what is in the way leave.
	vec3 whole = EFFECT_TEXTURES ? to_vec3(materials[triangles[lamp.number].material].emission) : v.radiance;
	r.expected = whole * (v.inverse / float(DIRECT_POINTS)) * (max(dot(w, b.normal), 0.0) * (1.0 / PI));
	if (max(r.diffuse * b.diffuse + r.facets, vec3(0.0)) == vec3(0.0))
		r.t_max = -1.0;
}

// Point k of the even sky.
void ray_to_dome(bsdf b, uint pattern, uint k, inout direct_ray r)
{
	uvec2 pick;
	vec2 where;
	direct_point(pattern, k, pick, where);
	vec3 l = cosine_hemisphere(where);
	vec3 w = l.x * b.x + l.y * b.y + l.z * b.normal;
	float above = dot(b.geometric, w);
	w = above < 0.0 ? w - 2.0 * above * b.geometric : w;
	float density = cosine_pdf(b, w);
	vec4 facets;
	direct_eval(b, w, r.diffuse, facets);
	r.diffuse *= to_vec3(job.background) / (max(density, 1e-20) * float(DIRECT_POINTS));
	r.segment = w;
	r.t_max = max(r.diffuse * b.diffuse, vec3(0.0)) != vec3(0.0) ? INFINITY : -1.0;
}

// With DIRECT_SHARP. Unlike ray_to_lamp's, each point's light is an estimate by itself. Only the microfacets' is divided by the
// number of points. False if the point is a later try.
bool ray_to_point(bsdf b, vec3 origin, uint k, inout direct_ray r)
{
	// Each of the two groups has a sequence of its own, which goes on from sample to sample.
	uint group = k & 1u;
	uint each = (DIRECT_POINTS + 1u - group) / 2u;
	uint scramble = hash_combine(hash_combine(direct_shift(), direct_place), group);
	sampler_state rnd = sampler_state(DIRECT_TURN * each + k / 2u, scramble);
	lamp_point p = lamp_point_make(rnd, origin, b.normal);
	if (!(p.cosine > 0.0))
		return false;
	vec4 facets;
	vec3 diffuse;
	direct_eval(b, p.w, diffuse, facets);
	vec3 light = p.radiance * p.inverse;
	r.segment = p.segment;
	r.t_max = 1.0;
	r.diffuse = diffuse * light;
	// Any weights that add up to one will do, so that they may be those of points that are chosen by power, as in lamp_met.
	if (EFFECT_GLOSSY && p.first)
		r.facets = facets.xyz * light * (power_weight(min(facets.w * p.by_power / float(DIRECT_POINTS), 1e18)) / float(DIRECT_POINTS));
	r.expected = p.whole * (p.inverse * p.cosine * (1.0 / PI));
	if (max(r.diffuse * b.diffuse + r.facets, vec3(0.0)) == vec3(0.0))
		r.t_max = -1.0;
	return p.first;
}

// Samples a direction from the microfacets; r.facets becomes BSDF × cosine / density. Returns the density, 1/sr.
float ray_off_facets(bsdf b, uint pattern, inout direct_ray r)
{
	uvec2 pick;
	vec2 u;
	direct_point(pattern, 0u, pick, u);
	vec3 l = facets_sample(b.gloss, b.view, u);
	vec3 w = l.x * b.x + l.y * b.y + l.z * b.normal;
	float above = dot(b.geometric, w);
	w = above < 0.0 ? w - 2.0 * above * b.geometric : w;
	vec3 diffuse;
	vec4 facets;
	direct_eval(b, w, diffuse, facets);
	r.segment = w;
	r.facets = b.gloss.mirror ? facets_mirrored(b.gloss, b.view.z) : l.z > 0.0 && facets.w > 0.0 ? facets.xyz / facets.w : vec3(0.0);
	r.t_max = b.share > 0.0 && max(r.facets, vec3(0.0)) != vec3(0.0) ? INFINITY : -1.0;
	return b.gloss.mirror ? PDF_MIRROR : facets.w;
}

// Radiance emitted by what a ray off the facets hit, weighted against the points on lamps.
vec3 lamp_met(ray_hit hit, vec3 w, float pdf)
{
	triangle tri = triangles[hit.id];
	material m = materials[hit.material];
	corners k = corners_of(tri);
	float c = dot(k.normal, w);
	vec4 at = EFFECT_TEXTURES ? coordinates_at(tri, vec3(1.0 - hit.uv.x - hit.uv.y, hit.uv)) : vec4(0.0);
	bool emits = c < 0.0 || (m.flags & MATERIAL_EMITS_BOTH_SIDES) != 0u;
	float pdf_area = m.power_density * job.emitter_power_inv * float(DIRECT_POINTS);
	float r = pdf_area * hit.t * hit.t / max(abs(c) * pdf, 1e-37);
	return emits ? emission_at(m, at) * power_weight(min(r, 1e18)) : vec3(0.0);
}

// Radiance, W/(m² sr), that a surface reflects along the camera ray. The light of emissive triangles on its diffuse part is
// not included but returned in `lamps`. `origin` is where shadow rays start; `pattern` is the pixel's direct_pattern.
vec3 direct_light_parts(surface s, bsdf b, vec3 origin, uint pattern, out lamp_light lamps)
{
	const bool has_lamps = DIRECT_DOME || (EFFECT_EMITTERS && DIRECT_LAMPS && job.emitter_count > 0u);
	const uint light_count = EFFECT_LIGHTS ? min(job.light_count, DIRECT_LIGHTS) : 0u;
	const uint lamp_end = light_count + (has_lamps ? DIRECT_POINTS : 0u);
	const uint end = lamp_end + (has_lamps && EFFECT_GLOSSY ? 1u : 0u);
	vec3 radiance = vec3(0.0);
	lamps = lamp_light(b.diffuse, vec3(0.0), vec3(0.0), vec3(0.0));
	lamp_groups groups = lamp_groups_none();
	vec3 closed = vec3(0.0);
	if (EFFECT_EMITTERS && DIRECT_SHARP && has_lamps)
		closed = lamps_survey(origin, b.normal) * (1.0 / PI);
	bool some = closed != vec3(0.0);
	for (uint i = 0u; i < end; i++) {
		direct_ray r = direct_ray(vec3(0.0, 0.0, 1.0), -1.0, vec3(0.0), vec3(0.0), vec3(0.0), NONE);
		float pdf = 0.0;
		bool off_facets = EFFECT_GLOSSY && has_lamps && i >= lamp_end;
		bool to_lamp = DIRECT_AREAS && i >= light_count;
		if (EFFECT_LIGHTS && !to_lamp)
			ray_to_light(b, origin, i, r);
		bool first = true;
		if (EFFECT_EMITTERS && DIRECT_SHARP && some && to_lamp && !off_facets)
			first = ray_to_point(b, origin, i - light_count, r);
		if (EFFECT_EMITTERS && !DIRECT_DOME && !DIRECT_SHARP && to_lamp && !off_facets)
			ray_to_lamp(b, origin, pattern, i - light_count, r);
		if (DIRECT_DOME && to_lamp && !off_facets)
			ray_to_dome(b, pattern, i - light_count, r);
		if (DIRECT_AREAS && EFFECT_GLOSSY && off_facets)
			pdf = ray_off_facets(b, pattern, r);
		bool sent = r.t_max > 0.0;
		bool mapped = r.map != NONE;
		direct_rays += sent && !mapped ? 1u : 0u;
		ray_hit hit;
		bool met = false;
		if (DIRECT_RAYS || (DIRECT_AREAS && EFFECT_GLOSSY))
			met = walk_single(origin, r.segment, (DIRECT_RAYS && !mapped) || off_facets ? r.t_max : -1.0, !off_facets, hit);
		float open = sent ? direct_open(met, origin, s.geometric, r.segment, r.t_max) : 0.0;
#ifdef DIRECT_MAPS
		if (sent && mapped)
			open = shadow_map_open(r.map, origin, s.geometric);
#endif
		direct_share += off_facets || !sent ? vec2(0.0) : luminance(r.diffuse) * vec2(open, 1.0);
		if (DIRECT_AREAS && EFFECT_GLOSSY && off_facets) {
			vec3 seen = vec3(0.0);
			if (DIRECT_DOME)
				seen = met && DIRECT_SHADOWS ? seen : r.facets * to_vec3(job.background);
			else if (met)
				seen = r.facets * lamp_met(hit, r.segment, pdf);
			radiance += b.gloss.mirror ? seen : vec3(0.0);
			lamps.facets += b.gloss.mirror ? vec3(0.0) : seen;
		} else if (to_lamp) {
			lamps.facets += open * r.facets;
		} else {
			radiance += open * (r.facets + r.diffuse);
		}
		if (EFFECT_EMITTERS && DIRECT_SHARP && to_lamp && !off_facets)
			lamp_groups_take(groups, (i - light_count) & 1u, open * r.diffuse, r.expected, first);
		if (DIRECT_AREAS && !DIRECT_SHARP && to_lamp) {
			lamps.arrived += open * r.diffuse;
			lamps.expected += r.expected;
		}
	}
	if (EFFECT_EMITTERS && DIRECT_SHARP)
		lamps.arrived = lamp_groups_light(groups, closed, DIRECT_POINTS);
	if (EFFECT_EMITTERS && DIRECT_LAMPS && DIRECT_CLOSED && !DIRECT_SHARP)
		lamps.scale = b.diffuse * lamps_irradiance(s.position, b.normal) * (1.0 / PI);
	else
		lamps.expected = vec3(1.0);
	return radiance;
}

vec3 direct_light(surface s, bsdf b, vec3 origin, uvec2 pixel)
{
	lamp_light lamps;
	vec3 radiance = direct_light_parts(s, b, origin, direct_pattern(pixel), lamps);
	return radiance + lamps.facets + lamp_radiance(lamps);
}

// Irradiance, W/m², on a plane in space that belongs to no pixel, such as a voxel's. Shadow rays start `offset` metres off
// it along the normal. `pattern` is any number; neighbours should have different ones.
vec3 direct_irradiance(vec3 position, vec3 normal, float offset, uint pattern)
{
	surface s;
	s.position = position;
	s.geometric = normal;
	s.shading = normal;
	s.albedo = vec3(1.0);
	s.f0 = vec3(0.0);
	s.f90 = vec3(0.0);
	s.roughness = 1.0;
	s.diffuse_roughness = 0.0;
	s.coat = 0.0;
	s.coat_roughness = 0.0;
	s.coat_normal = normal;
	s.clear = false;
	bsdf b = bsdf_make(s, -normal);
	lamp_light lamps;
	vec3 radiance = direct_light_parts(s, b, position + offset * normal, pattern & (DIRECT_BLOCK - 1u), lamps);
	return PI * (radiance + lamp_radiance(lamps));
}

#endif
