// Points on the lamps for pictures of many samples. Each point is chosen for the surface that it lights: a lamp by the light
// that it would send without shadows, then a direction towards it, uniform by solid angle. So no point counts much more than
// another, however near the lamp is. A point's own light is an estimate of all lamps' light, independent of the other points'.
#ifndef DIRECT_LAMP_POINTS_GLSL
#define DIRECT_LAMP_POINTS_GLSL

#include "direct/lamps.glsl"

#define LAMPS_MOST 32u          // CLOSED_EMITTERS_MAX of server/worker/technique/direct/lighting.c
#define LAMP_POINT_TRIES 12u    // of a lamp that is half below the horizon, all fail once in 4096 times
#define LAMP_WIDE 1e-3          // sr: smaller lamps are sampled by area, because their angles cancel

// Sum of the channels of the irradiance from the lamps up to each, without shadows.
float lamp_reach[LAMPS_MOST];

// lamps_irradiance, which also fills lamp_reach.
vec3 lamps_survey(vec3 position, vec3 n)
{
	vec3 x, y;
	frame_make(n, x, y);
	vec3 sum = vec3(0.0);
	for (uint i = 0u; i < min(job.emitter_count, LAMPS_MOST); i++) {
		sum += triangle_irradiance(triangles[emitters[i].triangle], position, x, y, n);
		lamp_reach[i] = sum.r + sum.g + sum.b;
	}
	return sum;
}

// Chooses an emitter by u, and leaves in u a number for the place on it: one even set of numbers is even over all lamps
// together. For microfacets, which may see most of a lamp that lights the rest little, half of the choices are by power. Some
// lamp must send light here.
uint lamp_choose(inout float u, out float chance)
{
	uint last = min(job.emitter_count, LAMPS_MOST) - 1u;
	float whole = lamp_reach[last];
	float reached = 0.0;
	float begun = 0.0;
	float below = 0.0;
	uint chosen = last;
	bool found = false;
	chance = 0.0;
	// The loop has one end for all lanes.
	for (uint i = 0u; i <= last; i++) {
		float own = max(lamp_reach[i] - reached, 0.0) / whole;
		float share = EFFECT_GLOSSY ? 0.5 * (own + emitters[i].pmf) : own;
		bool here = !found && (u < below + share || i == last);
		chosen = here ? i : chosen;
		chance = here ? share : chance;
		begun = here ? below : begun;
		found = found || here;
		reached = lamp_reach[i];
		below += share;
	}
	u = clamp((u - begun) / max(chance, 1e-20), 0.0, 0.99999994);
	return chosen;
}

// A unit vector from the part of c that is perpendicular to a; both are unit.
vec3 beside(vec3 c, vec3 a)
{
	vec3 d = c - dot(c, a) * a;
	return d / max(length(d), 1e-20);
}

// A direction in the spherical triangle of three unit vectors, uniform by solid angle: Arvo 1995, "Stratified sampling of
// spherical triangles". `area` is its solid angle.
vec3 sample_spherical(vec3 a, vec3 b, vec3 c, float area, vec2 u)
{
	// The angle at a, by its sine and cosine times a factor. Neither cancels.
	vec2 alpha = vec2(abs(dot(a, cross(b, c))), dot(b, c) - dot(a, b) * dot(a, c));
	alpha /= max(length(alpha), 1e-20);
	float turn = u.x * area - atan(alpha.x, alpha.y);
	float s = sin(turn);
	float t = cos(turn);
	float p = t - alpha.y;
	float v = s + alpha.x * dot(a, b);
	float below = (v * s + p * t) * alpha.x;
	float q = abs(below) > 1e-20 ? clamp(((v * t - p * s) * alpha.y - v) / below, -1.0, 1.0) : 1.0;
	vec3 top = q * a + sqrt(max(1.0 - q * q, 0.0)) * beside(c, a);
	float z = 1.0 - u.y * (1.0 - dot(top, b));
	return z * b + sqrt(max(1.0 - z * z, 0.0)) * beside(top, b);
}

// Barycentrics of corners 1 and 2 of a point in a triangle's plane, held to the triangle.
vec2 barycentrics_in(corners k, vec3 p)
{
	vec3 e1 = k.v1 - k.v0;
	vec3 e2 = k.v2 - k.v0;
	vec3 n = cross(e1, e2);
	vec3 d = p - k.v0;
	float whole = max(dot(n, n), 1e-37);
	vec2 uv = clamp(vec2(dot(cross(d, e2), n), dot(cross(e1, d), n)) / whole, 0.0, 1.0);
	return uv / max(uv.x + uv.y, 1.0);
}

// Chooses a point of a triangle as seen from `origin`. `inverse` is 1 / its density by solid angle.
vec2 sample_seen(corners k, vec3 origin, vec2 u, out float inverse)
{
	vec3 a = normalize(k.v0 - origin);
	vec3 b = normalize(k.v1 - origin);
	vec3 c = normalize(k.v2 - origin);
	float area = 2.0 * atan(abs(dot(a, cross(b, c))), 1.0 + dot(a, b) + dot(b, c) + dot(c, a));
	area = area < 0.0 ? area + 2.0 * PI : area;
	if (area > LAMP_WIDE) {
		vec3 w = sample_spherical(a, b, c, area, u);
		float across = dot(k.normal, w);
		inverse = area;
		return barycentrics_in(k, origin + w * (dot(k.normal, k.v0 - origin) / (abs(across) > 1e-7 ? across : 1e-7)));
	}
	vec2 uv = sample_triangle(u);
	vec3 way = k.v0 + uv.x * (k.v1 - k.v0) + uv.y * (k.v2 - k.v0) - origin;
	float d2 = max(dot(way, way), 1e-37);
	inverse = area_of(k) * abs(dot(k.normal, way)) / (d2 * sqrt(d2));
	return uv;
}

struct lamp_point {
	vec3 segment;     // from the receiver; at t = 1 it ends in front of the lamp itself
	vec3 w;           // its direction
	vec3 radiance;    // towards the receiver
	vec3 whole;       // the same, as the closed form has it: without textures, and where the lamp is not cut out
	float inverse;    // 1 / density, by solid angle, of the choice
	float by_power;   // the same, had it been chosen by power and area
	float cosine;     // to the surface's normal
	bool first;       // it is the first try
};

// Chooses a point above the surface with normal n. Later tries only tell whether the lamps are to be seen.
lamp_point lamp_point_make(sampler_state rnd, vec3 origin, vec3 n)
{
	lamp_point p;
	p.cosine = 0.0;
	for (uint i = 0u; i < LAMP_POINT_TRIES && !(p.cosine > 0.0); i++) {
		float chance;
		vec2 u = sample_2d(rnd, i);
		triangle tri = triangles[emitters[lamp_choose(u.x, chance)].triangle];
		material m = materials[tri.material];
		corners k = corners_of(tri);
		float inverse;
		vec2 uv = sample_seen(k, origin, u, inverse);
		vec3 q = k.v0 + uv.x * (k.v1 - k.v0) + uv.y * (k.v2 - k.v0);
		float away = dot(k.normal, origin - q);
		bool lit = away > 0.0 || (m.flags & MATERIAL_EMITS_BOTH_SIDES) != 0u;
		p.segment = q + (away < 0.0 ? -k.normal : k.normal) * segment_offset(k, origin) - origin;
		float d2 = max(dot(p.segment, p.segment), 1e-37);
		p.w = p.segment / sqrt(d2);
		p.inverse = inverse / max(chance, 1e-20);
		p.by_power = min(abs(dot(k.normal, p.w)) / (d2 * max(m.power_density * job.emitter_power_inv, 1e-37)), 1e18);
		p.whole = to_vec3(m.emission);
		p.radiance = emitted_towards(m, tri, k.normal, uv, -p.w);
		p.cosine = lit ? max(dot(p.w, n), 0.0) : 0.0;
		p.first = i == 0u;
	}
	return p;
}

// What the points of one surface tell, in two groups that are independent of each other.
struct lamp_groups {
	vec3 arrived[2];    // sums of light that is visible, reflected by a white diffuse part
	vec3 expected[2];   // sums of the light that the closed form has
	vec3 seen[2];       // as `arrived`, and later tries too
	vec3 tried[2];      // as `expected`, and later tries too
};

lamp_groups lamp_groups_none()
{
	vec3[2] none = vec3[2](vec3(0.0), vec3(0.0));
	return lamp_groups(none, none, none, none);
}

void lamp_groups_take(inout lamp_groups g, uint group, vec3 arrived, vec3 expected, bool first)
{
	g.seen[group] += arrived;
	g.tried[group] += expected;
	g.arrived[group] += first ? arrived : vec3(0.0);
	g.expected[group] += first ? expected : vec3(0.0);
}

// The light that arrives. `closed` is all that would without shadows, in closed form; `count` is the number of points. With
// A and E a group's means of visible and of all light, and v any number that does not depend on them, the estimate
//     A + v (closed − E)
// is unbiased. v is the share that the other group sees: where that is all or nothing, the estimate is exact.
vec3 lamp_groups_light(lamp_groups g, vec3 closed, uint count)
{
	vec3 by_even = min(g.seen[0] / max(g.tried[0], 1e-30), 1.0);
	vec3 by_odd = min(g.seen[1] / max(g.tried[1], 1e-30), 1.0);
	// A group whose every try failed has no opinion.
	bvec3 even_knows = greaterThan(g.tried[0], vec3(0.0));
	bvec3 odd_knows = greaterThan(g.tried[1], vec3(0.0));
	vec3 v_even = mix(by_odd, by_even, even_knows);
	vec3 v_odd = mix(by_even, by_odd, odd_knows);
	vec2 size = vec2((count + 1u) / 2u, count / 2u);
	vec3 even = g.arrived[0] / size.x + v_odd * (closed - g.expected[0] / size.x);
	vec3 odd = g.arrived[1] / size.y + v_even * (closed - g.expected[1] / size.y);
	return 0.5 * (even + odd);
}

#endif
