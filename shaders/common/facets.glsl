// The microfacet lobe of a metal or a glossy surface, with compensation for multiple scattering between facets:
//     D G2 F / (4 v·n l·n) · k(v),   k = 1 + F0 (1 − E(v)) / E(v).
// E = A + B of ggx.glsl is the albedo of single scattering for white facets; k adds the light that was scattered more than
// once (Turquin 2019, "Practical multiple scattering compensation for microfacet models"). The directional albedo is S =
// (F0 A + F90 B) k, which is 1 for F0 = F90 = 1 at every angle and roughness. k depends on only one of the two directions,
// so the lobe is not reciprocal.
#ifndef COMMON_FACETS_GLSL
#define COMMON_FACETS_GLSL

#include "common/ggx.glsl"

struct microfacets {
	vec3 f0;
	vec3 f90;
	float roughness;
	float alpha;
	bool mirror;          // α is too small to evaluate the lobe
	vec3 boost;           // k(v)
};

// The density that stands for a perfect mirror. It is so large that no other way of sampling gets a weight.
const float PDF_MIRROR = 1e30;

// k, from (A, B). It is 1 for a mirror: a flat surface has no multiple scattering.
vec3 facets_boost(microfacets f, vec2 ab)
{
	float e = clamp(ab.x + ab.y, 0.05, 1.0);
	return f.mirror ? vec3(1.0) : 1.0 + f.f0 * ((1.0 - e) / e);
}

// S, the directional albedo, from (A, B).
vec3 facets_albedo(microfacets f, vec2 ab)
{
	return min((f.f0 * ab.x + f.f90 * ab.y) * facets_boost(f, ab), 1.0);
}

// `ab` is (A, B) of the view direction.
microfacets facets_make(vec3 f0, vec3 f90, float roughness, vec2 ab)
{
	microfacets f;
	f.f0 = f0;
	f.f90 = f90;
	f.roughness = roughness;
	f.alpha = max(roughness * roughness, GGX_ALPHA_LEAST);
	f.mirror = roughness * roughness < GGX_ALPHA_LEAST;
	f.boost = facets_boost(f, ab);
	return f;
}

// BSDF × cosine (xyz) and the density of facets_sample (w), 1/sr. Both are zero for a perfect mirror.
vec4 facets_eval(microfacets f, vec3 v, vec3 l)
{
	if (f.mirror || l.z <= 0.0)
		return vec4(0.0);
	return vec4(ggx_eval(v, l, f.alpha, f.f0, f.f90) * f.boost, ggx_pdf(v, l, f.alpha));
}

vec3 facets_sample(microfacets f, vec3 v, vec2 u)
{
	vec3 h = f.mirror ? vec3(0.0, 0.0, 1.0) : ggx_sample_half(v, f.alpha, u);
	return 2.0 * dot(v, h) * h - v;
}

// The reflectance of a perfect mirror at the cosine mu.
vec3 facets_mirrored(microfacets f, float mu)
{
	return schlick(f.f0, f.f90, mu);
}

#endif
