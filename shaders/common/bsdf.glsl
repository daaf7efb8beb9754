// The BSDF of a surface. It is a stack of lobes, each in a file of its own. All of them are defined about the shading
// normal and kept above the true surface. From top to bottom: a clear coat (coat.glsl, EFFECT_CLEARCOAT), microfacets
// (facets.glsl, EFFECT_GLOSSY) and the diffuse part (diffuse.glsl). With EFFECT_GLASS a surface may instead be a clear
// boundary (glass.glsl), which is never coated.
//
// Let S be the directional albedo of the microfacets. The diffuse part gets the light that the microfacets leave, on the
// way in and on the way out:
//     ρ/π (1 − S(v)) (1 − S(l)) / (1 − S̄).
// This is reciprocal, and with ρ = 1 the stack returns all light (after Kulla and Conty 2017). For a rough diffuse part the
// same factor multiplies f in place of ρ/π. Such a part is not distributed like the light that the lobes above transmit, so
// that a white one returns between 98 and 101 % of the light.
//
// A shading normal that differs from the geometric normal puts part of a lobe below the surface. Dropping that part darkens
// edges; keeping it leaks light. Here it is folded back: a direction below the surface is mirrored at it. With ω' the
// mirror image of ω, a direction ω above the surface has f(ω) + f(ω') of a lobe f, and likewise of its density. No energy
// is lost or made, whatever the normal. For a clear boundary, reflected directions are folded to above the surface and
// transmitted ones to below.
#ifndef COMMON_BSDF_GLSL
#define COMMON_BSDF_GLSL

#include "common/coat.glsl"
#include "common/diffuse.glsl"
#include "common/facets.glsl"
#include "common/glass.glsl"
#include "common/surface.glsl"

// The BSDF for one view direction.
struct bsdf {
	vec3 normal;          // shading normal
	vec3 geometric;
	vec3 x;               // x and y axis of the frame about the shading normal
	vec3 y;
	vec3 view;            // in the frame; z > 0
	vec3 diffuse;         // albedo of the diffuse part, ρ
	float diffuse_roughness;   // with EFFECT_ROUGH_DIFFUSE
	// The members below are set only with EFFECT_GLOSSY.
	microfacets gloss;
	float share;          // probability that a direction is sampled from the microfacets, not from the diffuse part
	vec3 outward;         // (1 − S(v)) / (1 − S̄); under a coat (1 − S(v)) / T̄; set with EFFECT_CLEARCOAT too
	// Only with EFFECT_GLASS.
	bool clear;
	dielectric glass;     // if clear
	// Only with EFFECT_CLEARCOAT.
	clearcoat film;
};

float luminance(vec3 c)
{
	return dot(c, vec3(0.2126, 0.7152, 0.0722));
}

void make_glossy(inout bsdf b, surface s)
{
	vec2 ab = ggx_albedo(b.view.z, s.roughness);
	b.gloss = facets_make(s.f0, s.f90, s.roughness, ab);
	vec3 specular = facets_albedo(b.gloss, ab);
	vec3 left = 1.0 - specular;
	b.outward = left / max(1.0 - facets_albedo(b.gloss, ggx_average(b.gloss.roughness)), 1e-4);
	float facets = luminance(specular);
	float wide = luminance(b.diffuse * left);
	// The share is an estimate: the clamp keeps either way of sampling from starving.
	b.share = facets <= 0.0 ? 0.0 : wide <= 0.0 ? 1.0 : clamp(facets / (facets + wide), 0.1, 0.9);
}

// 1 − S of the microfacets at the cosine mu.
vec3 below_facets(bsdf b, float mu)
{
	return EFFECT_GLOSSY ? 1.0 - facets_albedo(b.gloss, ggx_albedo(mu, b.gloss.roughness)) : vec3(1.0);
}

void make_coat(inout bsdf b, surface s)
{
	vec3 normal = vec3(dot(s.coat_normal, b.x), dot(s.coat_normal, b.y), dot(s.coat_normal, b.normal));
	vec3 left = below_facets(b, b.view.z);
	float below = luminance(b.diffuse * left + (1.0 - left));
	b.film = coat_make(b.view, normal, b.clear ? 0.0 : s.coat, s.coat_roughness, below);
	if (!(b.film.share > 0.0)) {
		b.outward = EFFECT_GLOSSY ? b.outward : vec3(1.0);
		return;
	}
	vec3 mean = vec3(0.0);
	for (int i = 0; i < 4; i++) {
		float mu = COAT_COSINES[i];
		mean += COAT_WEIGHTS[i] * coat_passed(b.film, mu) * below_facets(b, mu);
	}
	b.outward = left / max(mean, 1e-4);
}

// The BSDF of a surface seen along `direction`, which points at it.
bsdf bsdf_make(surface s, vec3 direction)
{
	bsdf b;
	vec3 v = -direction;
	b.normal = normal_in_front(s.shading, v);
	b.geometric = s.geometric;
	frame_make(b.normal, b.x, b.y);
	b.view = vec3(dot(v, b.x), dot(v, b.y), max(dot(v, b.normal), 1e-4));
	b.diffuse = s.albedo;
	b.diffuse_roughness = EFFECT_ROUGH_DIFFUSE ? s.diffuse_roughness : 0.0;
	b.share = 0.0;
	b.gloss.mirror = false;
	b.clear = EFFECT_GLASS && s.clear;
	if (EFFECT_GLOSSY)
		make_glossy(b, s);
	if (EFFECT_CLEARCOAT)
		make_coat(b, s);
	if (EFFECT_GLASS && b.clear)
		b.glass = glass_make(b.view.z, s.roughness, s.eta, s.thin, s.base);
	return b;
}

// The diffuse part for a direction in the frame, without folding: BSDF × cosine, 1/sr. It lacks the coat's factor 1 − C(v).
vec3 diffuse_lobe(bsdf b, vec3 l)
{
	float cosine = max(l.z, 0.0) * (1.0 / PI);
	vec3 reflected = diffuse_value(b.diffuse, b.diffuse_roughness, b.view, l);
	if (!EFFECT_GLOSSY && !EFFECT_CLEARCOAT)
		return reflected * cosine;
	vec3 inward = below_facets(b, l.z);
	if (EFFECT_CLEARCOAT && b.film.share > 0.0)
		inward *= coat_passed(b.film, max(dot(l, b.film.normal), 0.0));
	return reflected * b.outward * inward * cosine;
}

// The microfacets' BSDF × cosine (xyz) and the density of their own sampling (w), 1/sr. Both are zero for a perfect mirror.
vec4 facet_lobe(bsdf b, vec3 l)
{
	return EFFECT_GLOSSY && b.share > 0.0 ? facets_eval(b.gloss, b.view, l) : vec4(0.0);
}

// All lobes but the coat for a direction in the frame, without folding: BSDF × cosine (xyz) and density (w), 1/sr.
vec4 lobes(bsdf b, vec3 l)
{
	if (l.z <= 0.0)
		return vec4(0.0);
	vec3 diffuse = diffuse_lobe(b, l);
	if (!EFFECT_GLOSSY)
		return vec4(diffuse, diffuse_pdf(l.z));
	vec4 facets = facet_lobe(b, l);
	return vec4(diffuse + facets.xyz, (1.0 - b.share) * diffuse_pdf(l.z) + b.share * facets.w);
}

// As `lobes`, with the coat.
vec4 coated_lobes(bsdf b, vec3 l)
{
	vec4 f = lobes(b, l);
	if (!EFFECT_CLEARCOAT || !(b.film.share > 0.0))
		return f;
	vec4 c = coat_eval(b.film, l);
	return vec4(c.xyz + b.film.passed * f.xyz, mix(f.w, c.w, b.film.share));
}

vec3 into_frame(bsdf b, vec3 w)
{
	return vec3(dot(w, b.x), dot(w, b.y), dot(w, b.normal));
}

// For a direction in world space: BSDF × cosine (xyz) and the density with which bsdf_sample returns it (w), 1/sr. Zero
// below the surface, unless it is a clear boundary. Perfect mirrors and polished boundaries are delta functions and
// contribute to neither.
vec4 bsdf_eval(bsdf b, vec3 w)
{
	float above = dot(b.geometric, w);
	bool clear = EFFECT_GLASS && b.clear;
	if (!clear && above <= 0.0)
		return vec4(0.0);
	// The sum over the direction and the one that folds to it. One loop, so that the code exists once.
	vec4 f = vec4(0.0);
	for (uint i = 0u; i < 2u; i++) {
		vec3 l = into_frame(b, i == 0u ? w : w - 2.0 * above * b.geometric);
		f += clear ? glass_lobe(b.glass, b.view, l, above < 0.0) : coated_lobes(b, l);
	}
	return f;
}

// A direction that a lobe sampled, in the frame.
struct lobe_sample {
	vec3 l;
	bool whole;           // the direction is on the lobe's own side
	bool through;         // the direction was meant for the other side of a clear boundary
	bool mirror;          // a perfect mirror's direction, whose weight is `weight`
	vec3 weight;
};

// Chooses a lobe by `lobe` and samples a direction of it.
lobe_sample lobes_sample(bsdf b, float lobe, vec2 u)
{
	lobe_sample r = lobe_sample(diffuse_sample(u), true, false, false, vec3(0.0));
	float passed = 1.0;
	bool coated = EFFECT_CLEARCOAT && lobe < b.film.share;
	if (EFFECT_CLEARCOAT && !coated && b.film.share > 0.0) {
		passed = b.film.passed / max(1.0 - b.film.share, 1e-6);
		lobe = (lobe - b.film.share) / max(1.0 - b.film.share, 1e-6);
	}
	bool facets = EFFECT_GLOSSY && !coated && lobe < b.share;
	if (EFFECT_GLOSSY && facets) {
		r.l = facets_sample(b.gloss, b.view, u);
		r.mirror = b.gloss.mirror;
		r.weight = facets_mirrored(b.gloss, b.view.z) / b.share;
		if (EFFECT_CLEARCOAT)
			r.weight *= passed;
	}
	r.whole = r.l.z > 0.0;
	if (EFFECT_CLEARCOAT && coated) {
		r.l = coat_sample(b.film, u, r.whole);
		r.mirror = b.film.film.mirror;
		r.weight = facets_mirrored(b.film.film, b.film.view.z) / b.film.share;
	}
	return r;
}

// As lobes_sample, for a clear boundary.
lobe_sample clear_sample(bsdf b, float lobe, vec2 u)
{
	lobe_sample r;
	r.l = glass_sample(b.glass, b.view, lobe, u, r.through);
	r.whole = r.through == (r.l.z < 0.0);
	r.mirror = b.glass.polished;
	r.weight = glass_weight(b.glass, r.through);
	return r;
}

// Samples a direction above the surface, or through it if it is clear. Also returns the weight BSDF × cosine / density and
// the density, 1/sr. `lobe` and u are uniform in [0, 1). A weight of zero means that the sample failed.
vec3 bsdf_sample(bsdf b, float lobe, vec2 u, out vec3 weight, out float pdf)
{
	bool clear = EFFECT_GLASS && b.clear;
	lobe_sample r;
	if (EFFECT_GLASS && clear)
		r = clear_sample(b, lobe, u);
	else
		r = lobes_sample(b, lobe, u);
	vec3 w = r.l.x * b.x + r.l.y * b.y + r.l.z * b.normal;
	float above = dot(b.geometric, w);
	w = r.through != (above < 0.0) ? w - 2.0 * above * b.geometric : w;
	vec4 f = bsdf_eval(b, w);
	weight = r.whole && f.w > 0.0 ? f.xyz / f.w : vec3(0.0);
	pdf = f.w;
	if (!EFFECT_GLOSSY && !EFFECT_CLEARCOAT && !EFFECT_ROUGH_DIFFUSE && !HEMISPHERE_UNIFORM && !clear)
		weight = b.diffuse;
	if (r.mirror) {
		weight = r.weight;
		pdf = PDF_MIRROR;
	}
	return w;
}

#endif
