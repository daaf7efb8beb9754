// The boundary of a clear dielectric: Fresnel's equations without approximation, smooth or with GGX facets (Walter et al. 2007,
// "Microfacet models for refraction through rough surfaces"), in a frame whose Z is the shading normal on the viewer's side.
//
// η is the index on the far side over that on the viewer's. A solid's boundary refracts; radiance that comes through it is
// 1/η² of what it was, for a pencil of light changes its width (Veach 1997, 5.2). A thin wall is two boundaries side by side:
// it reflects R + T² R + T² R³ + … = 2 R / (1 + R), and what it lets through leaves as if it had been reflected and turned to
// the other side. Reflection has the lobe of ggx.glsl; refraction has Walter's equation 21 with separable masking.
// What single scattering loses is given back to both: E(v), the share that it keeps, is in ggx.glsl's table, and all is
// divided by it. E knows one of the two directions: a rough boundary is not reciprocal but for that factor's sake, a smooth
// one (E = 1) is, up to η².
//
// Facets send some directions to the wrong side. Such a sample is none; but a path in a dense body has many events, and if each of
// them ended it by chance, and made what is left 1 / E brighter, few paths would carry all light. So a solid's boundary draws
// again, twice at most: with V(v) the share of good directions, in the table too, each is 1 + (1 − V) + (1 − V)² times as dense.
#ifndef COMMON_GLASS_GLSL
#define COMMON_GLASS_GLSL

#include "common/ggx.glsl"

struct dielectric {
	float eta;
	bool thin;
	bool polished;     // facets, or what they bend, too narrow to evaluate
	float alpha;
	vec3 tint;         // of what comes through
	float boost;       // 1 / E(v)
	float draws;       // how many times as dense directions are, for others are drawn again
};

const uint GLASS_REDRAWS = 2u;

// The reflectance of unpolarised light for a cosine above 0.
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

// (E, V) of a solid's boundary: linear in the square roots of cosine and roughness and in (η − 1) / (η + 1).
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

// BSDF × cosine (xyz) and density (w), 1/sr, of what is reflected to l (z > 0) …
vec4 glass_reflected(dielectric g, vec3 v, vec3 l)
{
	float r = glass_reflectance(g, dot(v, normalize(v + l)));
	return r * vec4(ggx_eval(v, l, g.alpha, vec3(1.0), vec3(1.0)) * g.boost, ggx_pdf(v, l, g.alpha) * g.draws);
}

// … and of what comes through from l (z < 0).
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

// On one side of the shading normal: zero where l is on the other.
vec4 glass_lobe(dielectric g, vec3 v, vec3 l, bool through)
{
	if (g.polished || l.z == 0.0 || through != (l.z < 0.0))
		return vec4(0.0);
	return through ? glass_transmitted(g, v, l) : glass_reflected(g, v, l);
}

// A direction in the frame by the visible normals and Fresnel's share; `through` is what it was meant to be: a facet that leans
// far may send it to the wrong side.
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

// The same, drawn again where it is on the wrong side; it may be there in the end, and is none then. `lobe` and u are uniform in
// [0, 1).
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

// Of a polished boundary, per sample.
vec3 glass_weight(dielectric g, bool through)
{
	return through ? g.tint * (g.thin ? 1.0 : 1.0 / (g.eta * g.eta)) : vec3(1.0);
}

#endif
