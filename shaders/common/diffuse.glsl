// The diffuse lobe: Lambert's ρ/π. With EFFECT_ROUGH_DIFFUSE and a roughness r above 0 it is instead Oren and Nayar's model
// of matte facets, in Fujii's form, which conserves energy, with compensation for multiple scattering: "EON", Portsmouth,
// Kutz and Hill 2024, "EON: A practical energy-preserving rough diffuse BRDF". In a frame whose Z is the normal, with s =
// v·l − v.z l.z, t = max(v.z, l.z) where s > 0 and 1 elsewhere, A = 1 / (1 + (1/2 − 2/(3π)) r):
//     f = ρ/π A (1 + r s/t)  +  ρₘ/π (1 − E(v)) (1 − E(l)) / (1 − Ē),    ρₘ = ρ² Ē / (1 − ρ (1 − Ē)).
// E is the directional albedo of the first term at ρ = 1, which has a closed form, and Ē = A (1 + (2/3 − 28/(15π)) r) its
// mean. The lobe is reciprocal, equals Lambert's at r = 0, and with ρ = 1 returns exactly all light.
#ifndef COMMON_DIFFUSE_GLSL
#define COMMON_DIFFUSE_GLSL

#include "common/sampling.glsl"
#include "common/scene.glsl"

// How diffuse directions are sampled: proportional to the cosine or, for comparison, uniformly.
#ifndef HEMISPHERE_UNIFORM
#define HEMISPHERE_UNIFORM false
#endif

float rough_diffuse_scale(float r)
{
	return 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * r);
}

// E at a cosine c above 0. The quotient (1 − sin³) / c is rearranged so that nothing cancels.
float rough_diffuse_albedo(float r, float c)
{
	float s = sqrt(max(1.0 - c * c, 0.0));
	float g = s * (acos(clamp(c, 0.0, 1.0)) - s * c) + (2.0 / 3.0) * s * (c * (1.0 + s + s * s) / (1.0 + s) - 1.0);
	return rough_diffuse_scale(r) * (1.0 + r * g / PI);
}

// π f of the rough lobe for an albedo ρ.
vec3 rough_diffuse(vec3 albedo, float r, vec3 v, vec3 l)
{
	float a = rough_diffuse_scale(r);
	float s = dot(v, l) - v.z * l.z;
	float t = s > 0.0 ? max(max(v.z, l.z), 1e-7) : 1.0;
	float mean = a * (1.0 + (2.0 / 3.0 - 28.0 / (15.0 * PI)) * r);
	vec3 again = albedo * albedo * (mean / max(1.0 - albedo * (1.0 - mean), 1e-6));
	float missing = (1.0 - rough_diffuse_albedo(r, v.z)) * (1.0 - rough_diffuse_albedo(r, l.z)) / max(1.0 - mean, 1e-6);
	return albedo * (a * (1.0 + r * s / t)) + again * max(missing, 0.0);
}

// π f of the diffuse lobe for a direction above the surface.
vec3 diffuse_value(vec3 albedo, float roughness, vec3 v, vec3 l)
{
	if (!EFFECT_ROUGH_DIFFUSE || !(roughness > 0.0) || l.z <= 0.0)
		return albedo;
	return rough_diffuse(albedo, roughness, v, l);
}

float diffuse_pdf(float cosine)
{
	return HEMISPHERE_UNIFORM ? 0.5 / PI : cosine * (1.0 / PI);
}

vec3 diffuse_sample(vec2 u)
{
	return HEMISPHERE_UNIFORM ? uniform_hemisphere(u) : cosine_hemisphere(u);
}

#endif
