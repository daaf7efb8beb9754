// Light that comes to a surface straight from its sources.
//
// Point, spot and directional lights are exact: one shadow ray each, up to DIRECT_LIGHTS of them. Of more, so many are taken
// at even steps of their summed power.
//
// With DIRECT_MAPS a light that has a shadow map (shadow_map.glsl) is looked up there instead.
//
// Emissive triangles, diffuse part. Where they are few and evenly bright, what they would send without shadows is known in
// closed form (lamps.glsl); DIRECT_POINTS points on them, evenly over their power, tell how much of it arrives, as the ratio
// of what the points' visible light adds up to, to what all of it does (Heitz, Hill and McGuire 2018, "Combining analytic
// direct illumination and stochastic shadows"). Neither unshadowed nor fully shadowed places show any noise then. Else the
// points alone estimate the light.
// The points of 4 × 4 pixels are one set together: the mean over any such block (soften.comp.glsl) has 16 times as many.
// Pictures of many samples have points enough in each pixel, and take neither form nor mean: shadows keep their edges.
//
// Microfacets: the same points, and one ray in a direction that the facets reflect, weighted by the power heuristic (Veach
// 1997, 9.2.4); a perfect mirror's is the one there is.
#ifndef DIRECT_LIGHTING_GLSL
#define DIRECT_LIGHTING_GLSL

#include "deferred/area.glsl"
#include "direct/lamps.glsl"
#include "trace/single.glsl"

// Options, macros of the program.
#ifndef DIRECT_POINTS
#define DIRECT_POINTS 2u        // on emissive triangles, 1…16
#define DIRECT_CLOSED false     // few emissive triangles, none textured
#define DIRECT_SHADOWS true
#define DIRECT_LAMPS true         // else emissive triangles send no light here
#define DIRECT_SOFT true        // lamps' light is kept for soften.comp.glsl
#define DIRECT_MAPS true        // defined: lights have shadow maps
#define DIRECT_MAPS_FOR_ALL false // each of them
#endif
#ifndef DIRECT_TURN
#define DIRECT_TURN turn.y        // which of the sets of points
#endif
#ifdef DIRECT_MAPS
#include "direct/shadow_map.glsl"
#else
#define DIRECT_MAPS_FOR_ALL false
#endif
#define DIRECT_LIGHTS 64u
#define DIRECT_BLOCK 16u        // pixels whose points are one set

// Who traces no shadow rays for want of something better says by DIRECT_OPEN what part of a light arrives: a function of the
// ray's origin, the surface's normal, the segment and t_max.
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

// Diffuse light, luminance: what arrived, and what would without shadows.
vec2 direct_share = vec2(0.0);

// Rays traced by this invocation.
uint direct_rays = 0u;

// What the emissive triangles send to a surface's diffuse part. Reflected radiance is scale × arrived / expected, channel by
// channel, 0 where nothing is expected. The material's colour is in scale alone, so that sums over neighbouring pixels may
// stand for the other two.
struct lamp_light {
	vec3 scale;
	vec3 arrived;
	vec3 expected;
	vec3 facets;     // radiance by the microfacets, but a perfect mirror's
};

vec3 lamp_radiance(lamp_light l)
{
	vec3 ratio = l.arrived / max(l.expected, 1e-30);
	// A ratio is at most a little above one, where light comes folded over a leaning normal.
	if (DIRECT_CLOSED)
		ratio = min(ratio, 2.0);
	return l.scale * vec3(l.expected.r > 0.0 ? ratio.r : 0.0, l.expected.g > 0.0 ? ratio.g : 0.0,
			      l.expected.b > 0.0 ? ratio.b : 0.0);
}

// A pixel's number in its 4 × 4 block, neighbours far apart. Over sixteen samples a pixel has them all.
uint direct_pattern(uvec2 pixel)
{
	uvec2 p = pixel & 3u;
	uint odd = (p.x ^ p.y) & 1u;
	uint far = (p.x ^ p.y) >> 1;
	return (odd << 3 | (p.y & 1u) << 2 | far << 1 | p.y >> 1) ^ (bitfieldReverse(turn.y) >> 28) ^ (9u * turn.x);
}

// Each half of the samples has its own shifts.
uint direct_shift()
{
	return hash_combine(hash_combine(hash(job.seed[0]), job.seed[1]), turn.x);
}

// 32 bits for the choice of a light, the i-th of `count` even steps; samples fill them up.
uint direct_step(uint i, uint count, uint shift)
{
	float part = float((bitfieldReverse(DIRECT_TURN) ^ shift) >> 8) * UNIT_24;
	return uint((float(i) + part) / float(count) * 16777216.0) << 8;
}

// Point k of a pattern's: which light (x, y: 32 bits each, as alias tables want) and where on it (z, w: 0…1).
void direct_point(uint pattern, uint k, out uvec2 pick, out vec2 where)
{
	const uint count = DIRECT_POINTS * DIRECT_BLOCK;
	uint i = k * DIRECT_BLOCK + pattern;
	uint h = direct_shift();
	// The first by even steps, the other two by Sobol's: Hammersley's set in three dimensions, shifted as a whole. The next
	// sample goes on with the two.
	uint row, low;
	uint at = direct_step(i, count, hash(h));
	umulExtended(at, job.emitter_count, row, low);
	pick = uvec2(at, low);
	uint j = DIRECT_TURN * count + i;
	uvec2 bits = bitfieldReverse(uvec2(j, sobol1_reversed(j))) ^ uvec2(hash(h + 1u), hash(h + 2u));
	where = vec2(bits >> 8) * UNIT_24;
}

// A light and the reciprocal of its chance, for the i-th of so many shadow rays. `number`: its own.
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

// BSDF × cosine of the diffuse part as if it were white, and of the microfacets with their density, folded as bsdf_eval
// folds them.
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

// What one ray may bring.
struct direct_ray {
	vec3 segment;
	float t_max;        // -1: none
	vec3 diffuse;       // radiance by the diffuse part, if nothing is in the way; by a white one, of a lamp's light
	vec3 facets;        // by the microfacets
	vec3 expected;      // lamps: what the closed form knows
	uint map;           // of shadow_first, instead of a ray; NONE: a ray
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

void ray_to_lamp(bsdf b, vec3 origin, uint pattern, uint k, inout direct_ray r)
{
	uvec2 pick;
	vec2 where;
	emitter_view v;
	direct_point(pattern, k, pick, where);
	if (!view_emitter(origin, pick_emitter(pick), where, v))
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
	r.expected = light * (max(dot(w, b.normal), 0.0) * (1.0 / PI));
	if (max(r.diffuse * b.diffuse + r.facets, vec3(0.0)) == vec3(0.0))
		r.t_max = -1.0;
}

// A direction of the microfacets, its BSDF × cosine over its density in `facets`. Returns the density.
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

// What a ray off the facets met: emitted radiance, as far as the lamps' own points do not stand for it.
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

// Radiance that a surface sends back along the camera's ray, but for the emissive triangles' light on its diffuse part, which
// is in `lamps`. `origin`: where its rays begin. `pattern`: direct_pattern of its pixel.
vec3 direct_light_parts(surface s, bsdf b, vec3 origin, uint pattern, out lamp_light lamps)
{
	const bool has_lamps = EFFECT_EMITTERS && DIRECT_LAMPS && job.emitter_count > 0u;
	const uint light_count = EFFECT_LIGHTS ? min(job.light_count, DIRECT_LIGHTS) : 0u;
	const uint lamp_end = light_count + (has_lamps ? DIRECT_POINTS : 0u);
	const uint end = lamp_end + (has_lamps && EFFECT_GLOSSY ? 1u : 0u);
	vec3 radiance = vec3(0.0);
	lamps = lamp_light(b.diffuse, vec3(0.0), vec3(0.0), vec3(0.0));
	for (uint i = 0u; i < end; i++) {
		direct_ray r = direct_ray(vec3(0.0, 0.0, 1.0), -1.0, vec3(0.0), vec3(0.0), vec3(0.0), NONE);
		float pdf = 0.0;
		bool off_facets = EFFECT_GLOSSY && has_lamps && i >= lamp_end;
		bool to_lamp = EFFECT_EMITTERS && i >= light_count;
		if (EFFECT_LIGHTS && !to_lamp)
			ray_to_light(b, origin, i, r);
		if (EFFECT_EMITTERS && to_lamp && !off_facets)
			ray_to_lamp(b, origin, pattern, i - light_count, r);
		if (EFFECT_EMITTERS && EFFECT_GLOSSY && off_facets)
			pdf = ray_off_facets(b, pattern, r);
		bool sent = r.t_max > 0.0;
		bool mapped = r.map != NONE;
		direct_rays += sent && !mapped ? 1u : 0u;
		ray_hit hit;
		bool met = false;
		if (DIRECT_RAYS || (EFFECT_EMITTERS && EFFECT_GLOSSY))
			met = walk_single(origin, r.segment, (DIRECT_RAYS && !mapped) || off_facets ? r.t_max : -1.0, !off_facets, hit);
		float open = sent ? direct_open(met, origin, s.geometric, r.segment, r.t_max) : 0.0;
#ifdef DIRECT_MAPS
		if (sent && mapped)
			open = shadow_map_open(r.map, origin, s.geometric);
#endif
		direct_share += off_facets || !sent ? vec2(0.0) : luminance(r.diffuse) * vec2(open, 1.0);
		if (EFFECT_EMITTERS && EFFECT_GLOSSY && off_facets) {
			vec3 seen = met ? r.facets * lamp_met(hit, r.segment, pdf) : vec3(0.0);
			radiance += b.gloss.mirror ? seen : vec3(0.0);
			lamps.facets += b.gloss.mirror ? vec3(0.0) : seen;
		} else if (to_lamp) {
			lamps.facets += open * r.facets;
		} else {
			radiance += open * (r.facets + r.diffuse);
		}
		if (EFFECT_EMITTERS && to_lamp) {
			lamps.arrived += open * r.diffuse;
			lamps.expected += r.expected;
		}
	}
	if (EFFECT_EMITTERS && DIRECT_LAMPS && DIRECT_CLOSED)
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

// Irradiance of a plane in space, W/m², for what is no pixel: a voxel. `offset`: rays begin so far off it along the normal.
// `pattern`: any number; neighbours should differ in it.
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
	bsdf b = bsdf_make(s, -normal);
	lamp_light lamps;
	vec3 radiance = direct_light_parts(s, b, position + offset * normal, pattern & (DIRECT_BLOCK - 1u), lamps);
	return PI * (radiance + lamp_radiance(lamps));
}

#endif
