// How a surface scatters: a microfacet lobe over a diffuse one, both about the shading normal, kept above the true surface.
//
// Without EFFECT_GLOSSY it is Lambert, ρ/π. With it, the microfacets reflect
//     D G2 F / (4 v·n l·n) · k(v),   k = 1 + F0 (1 − E(v)) / E(v),
// where E = A + B of ggx.glsl is what single scattering leaves of white light and k gives back what was scattered between
// facets (Turquin 2019, "Practical multiple scattering compensation for microfacet models"). Their directional albedo is
// S = (F0 A + F90 B) k: 1 for F0 = F90 = 1, at every angle and roughness. k knows one of the two directions, so this part is
// not reciprocal, and does not claim to be. The diffuse part gets what is left of the light, on the way in and on the way out:
//     ρ/π (1 − S(v)) (1 − S(l)) / (1 − S̄),
// which is reciprocal, and with ρ = 1 returns all of it (after Kulla and Conty 2017).
//
// A shading normal that leans away from the triangle's puts part of a lobe below the surface. Dropping that part darkens
// edges, letting it through leaks light. Here it is folded back: a direction below is mirrored at the surface. What a direction
// ω above the surface then has, of a lobe f and of its density alike, is f(ω) + f(ω'), ω' being ω mirrored at the surface:
// no energy is lost or made, whatever the normal is.
//
// Or, with EFFECT_GLASS, it is a clear boundary, glass.glsl's: what is reflected is folded to above the surface, what comes
// through to below.
#ifndef COMMON_BSDF_GLSL
#define COMMON_BSDF_GLSL

#include "common/ggx.glsl"
#include "common/glass.glsl"
#include "common/surface.glsl"

// How directions of the diffuse part are sampled: as its cosine, or for comparison uniformly.
#ifndef HEMISPHERE_UNIFORM
#define HEMISPHERE_UNIFORM false
#endif

// A BSDF as seen from one direction.
struct bsdf {
	vec3 normal;          // shading
	vec3 geometric;
	vec3 x;               // frame
	vec3 y;
	vec3 view;            // in the frame; z > 0
	vec3 diffuse;         // ρ
	// The rest only with EFFECT_GLOSSY.
	vec3 f0;
	vec3 f90;
	float roughness;
	float alpha;
	bool mirror;          // α too small to evaluate
	float share;          // probability that a direction comes from the microfacets, not from the cosine
	vec3 boost;           // k(v)
	vec3 outward;         // (1 − S(v)) / (1 − S̄)
	// With EFFECT_GLASS.
	bool clear;
	dielectric glass;     // if clear
};

// A density that stands for a perfect mirror's: no other way of sampling competes with it.
const float PDF_MIRROR = 1e30;

float luminance(vec3 c)
{
	return dot(c, vec3(0.2126, 0.7152, 0.0722));
}

// k, from (A, B). A mirror's facets are one: nothing goes between them.
vec3 facet_boost(bsdf b, vec2 ab)
{
	float e = clamp(ab.x + ab.y, 0.05, 1.0);
	return b.mirror ? vec3(1.0) : 1.0 + b.f0 * ((1.0 - e) / e);
}

// S, from (A, B).
vec3 specular_albedo(bsdf b, vec2 ab)
{
	return min((b.f0 * ab.x + b.f90 * ab.y) * facet_boost(b, ab), 1.0);
}

void make_glossy(inout bsdf b, surface s)
{
	b.f0 = s.f0;
	b.f90 = s.f90;
	b.roughness = s.roughness;
	b.alpha = max(s.roughness * s.roughness, GGX_ALPHA_LEAST);
	b.mirror = s.roughness * s.roughness < GGX_ALPHA_LEAST;
	vec2 ab = ggx_albedo(b.view.z, b.roughness);
	b.boost = facet_boost(b, ab);
	vec3 specular = specular_albedo(b, ab);
	vec3 left = 1.0 - specular;
	b.outward = left / max(1.0 - specular_albedo(b, ggx_average(b.roughness)), 1e-4);
	float facets = luminance(specular);
	float wide = luminance(b.diffuse * left);
	// Neither way of sampling may starve where its share is but a guess.
	b.share = facets <= 0.0 ? 0.0 : wide <= 0.0 ? 1.0 : clamp(facets / (facets + wide), 0.1, 0.9);
}

// The BSDF of a surface seen along `direction`, which points at it.
bsdf bsdf_make(surface s, vec3 direction)
{
	bsdf b;
	vec3 v = -direction;
	b.normal = s.shading;
	float c = dot(b.normal, v);
	// Seen from behind its shading normal: lean the normal over until it just is not.
	if (c < 1e-3)
		b.normal = normalize(b.normal + (1e-3 - c) * v);
	b.geometric = s.geometric;
	frame_make(b.normal, b.x, b.y);
	b.view = vec3(dot(v, b.x), dot(v, b.y), max(dot(v, b.normal), 1e-4));
	b.diffuse = s.albedo;
	b.share = 0.0;
	b.mirror = false;
	b.clear = EFFECT_GLASS && s.clear;
	if (EFFECT_GLOSSY)
		make_glossy(b, s);
	if (EFFECT_GLASS && b.clear)
		b.glass = glass_make(b.view.z, s.roughness, s.eta, s.thin, s.base);
	return b;
}

float diffuse_pdf(float cosine)
{
	return HEMISPHERE_UNIFORM ? 0.5 / PI : cosine * (1.0 / PI);
}

// Of a direction in the frame, without folding: the diffuse part's BSDF × cosine, 1/sr.
vec3 diffuse_lobe(bsdf b, vec3 l)
{
	float cosine = max(l.z, 0.0) * (1.0 / PI);
	if (!EFFECT_GLOSSY)
		return b.diffuse * cosine;
	vec3 inward = 1.0 - specular_albedo(b, ggx_albedo(l.z, b.roughness));
	return b.diffuse * b.outward * inward * cosine;
}

// The microfacets' (xyz), and the density of their own sampling (w). A perfect mirror's are zero.
vec4 facet_lobe(bsdf b, vec3 l)
{
	if (!EFFECT_GLOSSY || b.mirror || !(b.share > 0.0) || l.z <= 0.0)
		return vec4(0.0);
	return vec4(ggx_eval(b.view, l, b.alpha, b.f0, b.f90) * b.boost, ggx_pdf(b.view, l, b.alpha));
}

// Of a direction in the frame: BSDF × cosine (xyz) and density (w), 1/sr, without folding.
vec4 lobes(bsdf b, vec3 l)
{
	if (l.z <= 0.0)
		return vec4(0.0);
	float cosine = l.z * (1.0 / PI);
	if (!EFFECT_GLOSSY)
		return vec4(b.diffuse * cosine, diffuse_pdf(l.z));
	vec4 facets = facet_lobe(b, l);
	return vec4(diffuse_lobe(b, l) + facets.xyz, (1.0 - b.share) * diffuse_pdf(l.z) + b.share * facets.w);
}

vec3 into_frame(bsdf b, vec3 w)
{
	return vec3(dot(w, b.x), dot(w, b.y), dot(w, b.normal));
}

// Of a direction in the world: BSDF × cosine (xyz) and the density with which bsdf_sample takes it (w), 1/sr. Zero below
// the surface, unless that is clear. A perfect mirror's part is in neither, nor a polished boundary's.
vec4 bsdf_eval(bsdf b, vec3 w)
{
	float above = dot(b.geometric, w);
	if (EFFECT_GLASS && b.clear) {
		bool through = above < 0.0;
		return glass_lobe(b.glass, b.view, into_frame(b, w), through) +
		       glass_lobe(b.glass, b.view, into_frame(b, w - 2.0 * above * b.geometric), through);
	}
	if (above <= 0.0)
		return vec4(0.0);
	vec3 folded = w - 2.0 * above * b.geometric;
	return lobes(b, into_frame(b, w)) + lobes(b, into_frame(b, folded));
}

// bsdf_sample of a clear boundary.
vec3 clear_sample(bsdf b, float lobe, vec2 u, out vec3 weight, out float pdf)
{
	bool through;
	vec3 l = glass_sample(b.glass, b.view, lobe, u, through);
	vec3 w = l.x * b.x + l.y * b.y + l.z * b.normal;
	float above = dot(b.geometric, w);
	w = through != (above < 0.0) ? w - 2.0 * above * b.geometric : w;
	vec4 f = bsdf_eval(b, w);
	bool whole = through == (l.z < 0.0) && f.w > 0.0;
	weight = b.glass.polished ? glass_weight(b.glass, through) : whole ? f.xyz / f.w : vec3(0.0);
	pdf = b.glass.polished ? PDF_MIRROR : f.w;
	return w;
}

// A direction above the surface, or through it where it is clear, the weight BSDF × cosine / density and the density. `lobe` and u are uniform in [0, 1).
// A weight of zero means that there is none.
vec3 bsdf_sample(bsdf b, float lobe, vec2 u, out vec3 weight, out float pdf)
{
	if (EFFECT_GLASS && b.clear)
		return clear_sample(b, lobe, u, weight, pdf);
	vec3 l = HEMISPHERE_UNIFORM ? uniform_hemisphere(u) : cosine_hemisphere(u);
	bool facets = EFFECT_GLOSSY && lobe < b.share;
	if (EFFECT_GLOSSY && facets) {
		vec3 h = b.mirror ? vec3(0.0, 0.0, 1.0) : ggx_sample_half(b.view, b.alpha, u);
		l = 2.0 * dot(b.view, h) * h - b.view;
	}
	vec3 w = l.x * b.x + l.y * b.y + l.z * b.normal;
	float above = dot(b.geometric, w);
	w = above < 0.0 ? w - 2.0 * above * b.geometric : w;
	if (!EFFECT_GLOSSY && !HEMISPHERE_UNIFORM) {
		weight = b.diffuse;
		pdf = bsdf_eval(b, w).w;
	} else if (facets && b.mirror) {
		weight = schlick(b.f0, b.f90, b.view.z) / b.share;
		pdf = PDF_MIRROR;
	} else {
		vec4 f = bsdf_eval(b, w);
		weight = l.z > 0.0 && f.w > 0.0 ? f.xyz / f.w : vec3(0.0);
		pdf = f.w;
	}
	return w;
}

#endif
