// A clear coat over everything else (KHR_materials_clearcoat): a film of index 1.5 whose upper side reflects with the lobe
// of facets.glsl. A coat of weight c has F0 = 0.04 c and F90 = c. It has a normal of its own, which the normal map of the
// base does not bend. The base receives the light that the coat does not reflect. Its emission is dimmed likewise:
// coat_lets.
//
// With C the coat's directional albedo, the base sends 1 − C(v) of its light to v. For the diffuse part the way in counts
// too, as in bsdf.glsl, so that a white surface returns all light:
//     f = f_coat + (1 − C(v)) f_facets + ρ/π T(v) T(l) / T̄,   T = (1 − C) (1 − S),   T̄ = 2 ∫ T(μ) μ dμ.
// T̄ cannot come from a table, because C and S belong to two different surfaces. It is a four-point Gauss-Jacobi quadrature
// with the weight μ.
#ifndef COMMON_COAT_GLSL
#define COMMON_COAT_GLSL

#include "common/facets.glsl"

const vec4 COAT_COSINES = vec4(0.1397598643, 0.4164095676, 0.7231569864, 0.9428958039);
const vec4 COAT_WEIGHTS = vec4(0.0623619420, 0.2596950952, 0.4069291360, 0.2710138268);

struct clearcoat {
	microfacets film;
	vec3 normal;          // in the base's frame, as are the two axes of the coat's own frame
	vec3 x;
	vec3 y;
	vec3 view;            // in the coat's frame
	float share;          // probability that a direction is sampled from the coat; 0: no coat
	float passed;         // 1 − C(v)
};

vec3 coat_frame(clearcoat c, vec3 w)
{
	return vec3(dot(w, c.x), dot(w, c.y), dot(w, c.normal));
}

// 1 − C at the cosine mu to the coat's normal.
float coat_passed(clearcoat c, float mu)
{
	return 1.0 - facets_albedo(c.film, ggx_albedo(mu, c.film.roughness)).x;
}

// `view` and `normal` are in the base's frame. `amount` and `roughness` are the extension's parameters. `below` is an
// estimate of the base's albedo.
clearcoat coat_make(vec3 view, vec3 normal, float amount, float roughness, float below)
{
	clearcoat c;
	c.normal = normal_in_front(normal, view);
	frame_make(c.normal, c.x, c.y);
	c.view = coat_frame(c, view);
	c.view.z = max(c.view.z, 1e-4);
	vec2 ab = ggx_albedo(c.view.z, roughness);
	c.film = facets_make(vec3(0.04 * amount), vec3(amount), roughness, ab);
	float reflected = facets_albedo(c.film, ab).x;
	c.passed = 1.0 - reflected;
	// The share is an estimate: the clamp keeps either way of sampling from starving.
	float rest = c.passed * below;
	c.share = !(amount > 0.0) ? 0.0 : rest <= 0.0 ? 1.0 : clamp(reflected / (reflected + rest), 0.1, 0.9);
	return c;
}

// The share of the base's emission that passes the coat towards w. `normal` is the coat's, on w's side.
float coat_lets(vec3 normal, vec3 w, float amount, float roughness)
{
	vec2 ab = ggx_albedo(clamp(dot(normal, w), 1e-3, 1.0), roughness);
	return 1.0 - facets_albedo(facets_make(vec3(0.04 * amount), vec3(amount), roughness, ab), ab).x;
}

// facets_eval of the coat for a direction l in the base's frame.
vec4 coat_eval(clearcoat c, vec3 l)
{
	return facets_eval(c.film, c.view, coat_frame(c, l));
}

// Samples a direction, in the base's frame. `above` says whether it is on the coat's upper side.
vec3 coat_sample(clearcoat c, vec2 u, out bool above)
{
	vec3 l = facets_sample(c.film, c.view, u);
	above = l.z > 0.0;
	return l.x * c.x + l.y * c.y + l.z * c.normal;
}

#endif
