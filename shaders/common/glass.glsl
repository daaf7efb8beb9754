// The boundary of a clear dielectric, smooth or with GGX facets (Walter et al. 2007, "Microfacet models for refraction
// through rough surfaces"). Fresnel's equations are exact. Directions are in a frame whose Z is the shading normal on the
// viewer's side.
//
// η is the index of refraction on the far side divided by that on the viewer's side. The boundary of a solid refracts;
// radiance that is transmitted is scaled by 1/η², because the solid angle of a pencil of light changes (Veach 1997, 5.2). A
// thin wall is two boundaries side by side. It reflects R + T² R + T² R³ + … = 2 R / (1 + R), and transmitted light leaves
// as if it had been reflected and then mirrored to the other side. Reflection has the lobe of ggx.glsl. Refraction has
// Walter's equation 21 with separable masking. The energy that single scattering loses is given back to both: all is
// divided by E(v), the share that single scattering keeps, which is in ggx.glsl's table. E depends on one of the two
// directions. So a rough boundary is not reciprocal, because of that factor alone; a smooth one (E = 1) is, up to η².
//
// Facets reflect or refract some samples to the wrong side, and such a sample fails. But a path in a dense body has many
// events. If each failure ended the path and each success made it 1 / E brighter, few paths would carry all the light. So
// the boundary of a solid draws again, at most twice. With V(v) the share of samples on the right side, also in the table,
// the density of each direction grows by the factor 1 + (1 − V) + (1 − V)².
#ifndef COMMON_GLASS_GLSL
#define COMMON_GLASS_GLSL

#include "common/ggx.glsl"

struct dielectric {
	float eta;
	bool thin;
	bool polished;     // the lobe, reflected or refracted, is too narrow to evaluate
	float alpha;
	vec3 tint;         // colour of transmitted light
	float boost;       // 1 / E(v)
	float draws;       // factor of the density, because failed samples are drawn again
};

const uint GLASS_REDRAWS = 2u;

// Fresnel's reflectance of unpolarised light for a cosine above 0.
float fresnel_dielectric(float cosine, float eta)
{
	float c = min(cosine, 1.0);
	float sine2 = (1.0 - c * c) / (eta * eta);
	if (sine2 >= 1.0)
		return 1.0;
	float t = sqrt(1.0 - sine2);
	float across = (c - eta * t) / max(c + eta * t, 1e-30);
	float along = (eta * c - t) / max(eta * c + t, 1e-30);
	return 0.5 * (across * across + along * along);
}

float glass_reflectance(dielectric g, float cosine)
{
	float r = fresnel_dielectric(cosine, g.eta);
	return g.thin ? 2.0 * r / (1.0 + r) : r;
}

// (E, V) of the boundary of a solid. Interpolation is linear in √mu, √roughness and (η − 1) / (η + 1).
vec2 glass_albedo(float mu, float roughness, float eta)
{
	float ratio = clamp((eta - 1.0) / (eta + 1.0), -0.5, 0.5) + 0.5;
	vec3 at = vec3(sqrt(clamp(vec2(mu, roughness), 0.0, 1.0)), ratio) *
		  vec3(GLASS_COSINES - 1, GLASS_ROUGHNESSES - 1, GLASS_RATIOS - 1);
	uvec3 i = min(uvec3(at), uvec3(GLASS_COSINES - 2, GLASS_ROUGHNESSES - 2, GLASS_RATIOS - 2));
	vec3 f = at - vec3(i);
	uint row = GGX_TABLE_PAIRS + (i.z * GLASS_ROUGHNESSES + i.y) * GLASS_COSINES + i.x;
	vec2 share = vec2(0.0);
	for (uint k = 0u; k < 2u; k++, row += GLASS_TABLE_PAIRS) {
		vec2 low = mix(ggx_table[row], ggx_table[row + 1u], f.x);
		vec2 high = mix(ggx_table[row + GLASS_COSINES], ggx_table[row + GLASS_COSINES + 1u], f.x);
		vec2 e = mix(low, high, f.y);
		share[k] = mix(e.x, e.y, f.z);
	}
	return share;
}

dielectric glass_make(float mu, float roughness, float eta, bool thin, vec3 tint)
{
	dielectric g;
	g.eta = eta;
	g.thin = thin;
	g.alpha = max(roughness * roughness, GGX_ALPHA_LEAST);
	float bent = thin ? 1.0 : abs(eta - 1.0);
	g.polished = roughness * roughness * min(bent, 1.0) < GGX_ALPHA_LEAST;
	g.tint = tint;
	vec2 ab = ggx_albedo(mu, roughness);
	vec2 kept = thin ? vec2(ab.x + ab.y, 1.0) : glass_albedo(mu, roughness, eta);
	float lost = 1.0 - min(kept.y, 1.0);
	g.boost = g.polished ? 1.0 : 1.0 / clamp(kept.x, 0.05, 1.0);
	g.draws = g.polished ? 1.0 : 1.0 + lost + lost * lost;
	return g;
}

// BSDF × cosine (xyz) and density (w), 1/sr, of reflection to l (z > 0).
vec4 glass_reflected(dielectric g, vec3 v, vec3 l)
{
	float r = glass_reflectance(g, dot(v, normalize(v + l)));
	return r * vec4(ggx_eval(v, l, g.alpha, vec3(1.0), vec3(1.0)) * g.boost, ggx_pdf(v, l, g.alpha) * g.draws);
}

// BSDF × cosine (xyz) and density (w), 1/sr, of refraction of light from l (z < 0).
vec4 glass_refracted(dielectric g, vec3 v, vec3 l)
{
	vec3 h = normalize(v + g.eta * l);
	h = h.z < 0.0 ? -h : h;
	float vh = dot(v, h);
	float lh = dot(l, h);
	if (vh <= 0.0 || lh >= 0.0)
		return vec4(0.0);
	float k = vh + g.eta * lh;
	float masking = 1.0 + ggx_lambda(v, g.alpha);
	float common_part = (1.0 - fresnel_dielectric(vh, g.eta)) * ggx_distribution(h, g.alpha) * vh * -lh /
			    (max(v.z, 1e-7) * max(k * k, 1e-20) * masking);
	float seen = common_part / (1.0 + ggx_lambda(l, g.alpha));
	return vec4(g.tint * (seen * g.boost), common_part * g.eta * g.eta * g.draws);
}

vec4 glass_transmitted(dielectric g, vec3 v, vec3 l)
{
	if (!g.thin)
		return glass_refracted(g, v, l);
	vec3 up = vec3(l.xy, -l.z);
	float r = glass_reflectance(g, dot(v, normalize(v + up)));
	return (1.0 - r) * vec4(g.tint * ggx_eval(v, up, g.alpha, vec3(1.0), vec3(1.0)) * g.boost, ggx_pdf(v, up, g.alpha));
}

// BSDF × cosine (xyz) and density (w), 1/sr, on the side of the shading normal that `through` names. Zero where l is on the
// other side.
vec4 glass_lobe(dielectric g, vec3 v, vec3 l, bool through)
{
	if (g.polished || l.z == 0.0 || through != (l.z < 0.0))
		return vec4(0.0);
	return through ? glass_transmitted(g, v, l) : glass_reflected(g, v, l);
}

// Samples a direction in the frame: a visible normal, then reflection or transmission by Fresnel's reflectance. `through`
// is which of the two was meant; a strongly tilted facet may send the direction to the wrong side.
vec3 glass_draw(dielectric g, vec3 v, float lobe, vec2 u, out bool through)
{
	vec3 h = g.polished ? vec3(0.0, 0.0, 1.0) : ggx_sample_half(v, g.alpha, u);
	float vh = dot(v, h);
	through = lobe >= glass_reflectance(g, max(vh, 0.0));
	vec3 l = 2.0 * vh * h - v;
	if (!through)
		return l;
	if (g.thin)
		return vec3(l.xy, -l.z);
	float t = sqrt(max(1.0 - (1.0 - vh * vh) / (g.eta * g.eta), 0.0));
	return (vh / g.eta - t) * h - v / g.eta;
}

// As glass_draw, drawn again while the direction is on the wrong side. If the last draw is still on the wrong side, the
// sample fails. `lobe` and u are uniform in [0, 1).
vec3 glass_sample(dielectric g, vec3 v, float lobe, vec2 u, out bool through)
{
	vec3 l = glass_draw(g, v, lobe, u, through);
	uint bits = hash_combine(floatBitsToUint(u.x), floatBitsToUint(u.y));
	uint more = g.thin || g.polished ? 0u : GLASS_REDRAWS;
	for (uint i = 0u; i < more && through != (l.z < 0.0); i++) {
		vec3 chance;
		for (uint k = 0u; k < 3u; k++) {
			bits = hash_combine(bits, k);
			chance[k] = float(bits >> 8) * UNIT_24;
		}
		l = glass_draw(g, v, chance.x, chance.yz, through);
	}
	return l;
}

// BSDF × cosine / density of a sample of a polished boundary.
vec3 glass_weight(dielectric g, bool through)
{
	return through ? g.tint * (g.thin ? 1.0 : 1.0 / (g.eta * g.eta)) : vec3(1.0);
}

#endif
