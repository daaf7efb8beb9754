// The microfacet lobe: GGX normals with height-correlated Smith masking (Walter et al. 2007; Heitz 2014, JCGT 3-2), sampled
// by visible normals (Dupuy and Benyoub 2023). Directions are in a frame whose Z is the shading normal; v and l point away
// from the surface.
//
// α = roughness². A lobe whose α is below GGX_ALPHA_LEAST is a perfect mirror: it is sampled but never evaluated.
#ifndef COMMON_GGX_GLSL
#define COMMON_GGX_GLSL

#include "common/sampling.glsl"
#include "common/scene.glsl"

// Smith's Λ for a direction w in the frame.
float ggx_lambda(vec3 w, float alpha)
{
	float t2 = dot(w.xy, w.xy) / max(w.z * w.z, 1e-20);
	return 0.5 * (sqrt(1.0 + alpha * alpha * t2) - 1.0);
}

// D(h), 1/sr. Computed from components, so that nothing cancels where the lobe is narrow.
float ggx_distribution(vec3 h, float alpha)
{
	vec2 s = h.xy / alpha;
	float k = dot(s, s) + h.z * h.z;
	return 1.0 / (PI * alpha * alpha * k * k);
}

vec3 schlick(vec3 f0, vec3 f90, float cosine)
{
	float c = clamp(1.0 - cosine, 0.0, 1.0);
	float c2 = c * c;
	return f0 + (f90 - f0) * (c2 * c2 * c);
}

// Samples a half vector from the normals visible to v. The density of the reflected direction is ggx_pdf.
vec3 ggx_sample_half(vec3 v, float alpha, vec2 u)
{
	vec3 s = normalize(vec3(v.xy * alpha, v.z));
	float z = (1.0 - u.y) * (1.0 + s.z) - s.z;
	float r = sqrt(clamp(1.0 - z * z, 0.0, 1.0));
	float phi = 2.0 * PI * u.x;
	vec3 h = vec3(r * cos(phi), r * sin(phi), z) + s;
	return normalize(vec3(h.xy * alpha, max(h.z, 1e-7)));
}

// Density of l when it is sampled by ggx_sample_half and reflection, 1/sr: D G1 / (4 v.z).
float ggx_pdf(vec3 v, vec3 l, float alpha)
{
	vec3 h = normalize(v + l);
	return ggx_distribution(h, alpha) / (4.0 * max(v.z, 1e-7) * (1.0 + ggx_lambda(v, alpha)));
}

// BSDF × cosine of l, 1/sr: D G2 F / (4 v.z).
vec3 ggx_eval(vec3 v, vec3 l, float alpha, vec3 f0, vec3 f90)
{
	vec3 h = normalize(v + l);
	float masking = 1.0 + ggx_lambda(v, alpha) + ggx_lambda(l, alpha);
	return schlick(f0, f90, dot(v, h)) * (ggx_distribution(h, alpha) / (4.0 * max(v.z, 1e-7) * masking));
}

// Directional albedo of the lobe as (A, B), the albedo being F0 · A + F90 · B. Interpolation is bilinear in √mu and
// √roughness.
vec2 ggx_albedo(float mu, float roughness)
{
	vec2 at = sqrt(clamp(vec2(mu, roughness), 0.0, 1.0)) * vec2(GGX_COSINES - 1, GGX_ROUGHNESSES - 1);
	uvec2 i = min(uvec2(at), uvec2(GGX_COSINES - 2, GGX_ROUGHNESSES - 2));
	vec2 f = at - vec2(i);
	uint row = i.y * GGX_COSINES + i.x;
	vec2 low = mix(ggx_table[row], ggx_table[row + 1u], f.x);
	vec2 high = mix(ggx_table[row + GGX_COSINES], ggx_table[row + GGX_COSINES + 1u], f.x);
	return mix(low, high, f.y);
}

// The hemispherical mean of ggx_albedo, 2 ∫ μ (A, B) dμ.
vec2 ggx_average(float roughness)
{
	float at = sqrt(clamp(roughness, 0.0, 1.0)) * float(GGX_ROUGHNESSES - 1);
	uint i = min(uint(at), GGX_ROUGHNESSES - 2);
	uint row = GGX_ROUGHNESSES * GGX_COSINES + i;
	return mix(ggx_table[row], ggx_table[row + 1u], at - float(i));
}

#endif
