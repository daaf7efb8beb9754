// A clear coat over everything else: KHR_materials_clearcoat, a film of index 1.5 whose upper side reflects with the lobe of
// facets.glsl, F0 = 0.04 c and F90 = c for a coat of which a share c is there. It has a normal of its own: a normal map beneath it does
// not bend it. What is below sees the light that is left, and what it emits is dimmed by as much: coat_lets.
//
// With C the coat's directional albedo, what is below sends 1 − C(v) of its light to v. Of the diffuse part the way in counts
// too, as in bsdf.glsl, so that a white surface returns all of it:
//     f = f_coat + (1 − C(v)) f_facets + ρ/π T(v) T(l) / T̄,   T = (1 − C) (1 − S),   T̄ = 2 ∫ T(μ) μ dμ.
// T̄ has no table, for C and S are two surfaces': it is Gauss and Jacobi's sum for the weight μ, of four points.
#ifndef COMMON_COAT_GLSL
#define COMMON_COAT_GLSL

#include "common/facets.glsl"

const vec4 COAT_COSINES = vec4(0.1397598643, 0.4164095676, 0.7231569864, 0.9428958039);
const vec4 COAT_WEIGHTS = vec4(0.0623619420, 0.2596950952, 0.4069291360, 0.2710138268);

struct clearcoat {
	microfacets film;
	vec3 normal;          // in the frame of what is below, and its own frame's axes
	vec3 x;
	vec3 y;
	vec3 view;            // in its own frame
	float share;          // probability that a direction comes from the coat; 0: there is none
	float passed;         // 1 − C(v)
};

vec3 coat_frame(clearcoat c, vec3 w)
{
	return vec3(dot(w, c.x), dot(w, c.y), dot(w, c.normal));
}

// 1 − C at a cosine to the coat's normal.
float coat_passed(clearcoat c, float mu)
{
	return 1.0 - facets_albedo(c.film, ggx_albedo(mu, c.film.roughness)).x;
}

// `view` and `normal` in the frame of what is below, `amount` and `roughness` as the extension has them; `below` is what that
// reflects, roughly.
clearcoat coat_make(vec3 view, vec3 normal, float amount, float roughness, float below)
{
	clearcoat c;
	c.normal = normal;
	float mu = dot(normal, view);
	if (mu < 1e-3)
		c.normal = normalize(normal + (1e-3 - mu) * view);
	frame_make(c.normal, c.x, c.y);
	c.view = coat_frame(c, view);
	c.view.z = max(c.view.z, 1e-4);
	vec2 ab = ggx_albedo(c.view.z, roughness);
	c.film = facets_make(vec3(0.04 * amount), vec3(amount), roughness, ab);
	float reflected = facets_albedo(c.film, ab).x;
	c.passed = 1.0 - reflected;
	// Neither may starve where its share is but a guess.
	float rest = c.passed * below;
	c.share = !(amount > 0.0) ? 0.0 : rest <= 0.0 ? 1.0 : clamp(reflected / (reflected + rest), 0.1, 0.9);
	return c;
}

// What of the light from below, emitted there, comes through it to w: `normal` is on w's side.
float coat_lets(vec3 normal, vec3 w, float amount, float roughness)
{
	vec2 ab = ggx_albedo(clamp(dot(normal, w), 1e-3, 1.0), roughness);
	return 1.0 - facets_albedo(facets_make(vec3(0.04 * amount), vec3(amount), roughness, ab), ab).x;
}

// facets_eval of the coat for a direction in the frame of what is below.
vec4 coat_eval(clearcoat c, vec3 l)
{
	return facets_eval(c.film, c.view, coat_frame(c, l));
}

// A direction in the frame of what is below. `above`: it left on the coat's upper side.
vec3 coat_sample(clearcoat c, vec2 u, out bool above)
{
	vec3 l = facets_sample(c.film, c.view, u);
	above = l.z > 0.0;
	return l.x * c.x + l.y * c.y + l.z * c.normal;
}

#endif
