// How a surface scatters: a microfacet lobe over a diffuse one, both about the shading normal, kept above the true surface.
//
// Without EFFECT_GLOSSY it is Lambert, ρ/π. With it, what the microfacets reflect is
//     single scattering   D G2 F / (4 v·n l·n), and
//     scattering between facets, which single scattering loses: Kulla and Conty 2017, with E = A + B of ggx.glsl,
//         Fms (1 − E(v)) (1 − E(l)) / (π (1 − Ē)),   Fms = F̄² Ē / (1 − F̄ (1 − Ē))   (Fdez-Agüera 2019, JCGT 8-1),
// and the diffuse part gets what is left of the light, once on the way in and once on the way out:
//         ρ/π (1 − S(v)) (1 − S(l)) / (1 − S̄),   S the directional albedo of all that the microfacets reflect.
// Both are reciprocal, and with ρ = 1 or F0 = F90 = 1 the whole returns all light.
//
// A shading normal that leans away from the triangle's puts part of a lobe below the surface. Dropping that part darkens
// edges, letting it through leaks light. Here it is folded back: a direction below is mirrored at the surface. What a direction
// ω above the surface then has, of a lobe f and of its density alike, is f(ω) + f(ω'), ω' being ω mirrored at the surface:
// no energy is lost or made, whatever the normal is.
#ifndef COMMON_BSDF_GLSL
#define COMMON_BSDF_GLSL

#include "common/ggx.glsl"
#include "common/surface.glsl"

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
	vec3 fms;
	float lost;           // 1 − E(v)
	float lost_inverse;   // 1 / (1 − Ē), or 0 where nothing is lost
	vec3 outward;         // (1 − S(v)) / (1 − S̄)
};

// A density that stands for a perfect mirror's: no other way of sampling competes with it.
const float PDF_MIRROR = 1e30;

float luminance(vec3 c)
{
	return dot(c, vec3(0.2126, 0.7152, 0.0722));
}

// S(μ): what the microfacets reflect in all. `lost` is what single scattering alone would lose of white light.
vec3 specular_albedo(bsdf b, float mu, out float lost)
{
	vec2 ab = ggx_albedo(mu, b.roughness);
	lost = max(1.0 - ab.x - ab.y, 0.0);
	return b.f0 * ab.x + b.f90 * ab.y + b.fms * lost;
}

void make_glossy(inout bsdf b, surface s)
{
	b.f0 = s.f0;
	b.f90 = s.f90;
	b.roughness = s.roughness;
	b.alpha = max(s.roughness * s.roughness, GGX_ALPHA_LEAST);
	b.mirror = s.roughness * s.roughness < GGX_ALPHA_LEAST;
	vec2 mean = ggx_average(b.roughness);
	float mean_lost = max(1.0 - mean.x - mean.y, 0.0);
	// The facets' mean reflectance over all angles: Schlick's averages to F0 + (F90 − F0) / 21.
	vec3 f_mean = b.f0 + (b.f90 - b.f0) / 21.0;
	b.fms = f_mean * f_mean * (1.0 - mean_lost) / max(1.0 - f_mean * mean_lost, 1e-4);
	b.lost_inverse = mean_lost > 1e-5 ? 1.0 / mean_lost : 0.0;
	vec3 specular = specular_albedo(b, b.view.z, b.lost);
	vec3 mean_specular = b.f0 * mean.x + b.f90 * mean.y + b.fms * mean_lost;
	b.outward = max(1.0 - specular, 0.0) / max(1.0 - mean_specular, 1e-4);
	float single = luminance(specular - b.fms * b.lost);
	float wide = luminance(b.diffuse * max(1.0 - specular, 0.0) + b.fms * b.lost);
	// Neither way of sampling may starve where its share is but a guess.
	float share = clamp(single / max(single + wide, 1e-20), 0.1, 0.9);
	b.share = single <= 0.0 ? 0.0 : wide <= 0.0 ? 1.0 : share;
}

// The BSDF of a surface seen along `direction`, which points at it.
bsdf bsdf_make(surface s, vec3 direction)
{
	bsdf b;
	vec3 v = -direction;
	b.normal = s.shading;
	float c = dot(b.normal, v);
	// Seen from behind its shading normal: lean the normal over until it just is not.
	if (c < 0.02)
		b.normal = normalize(b.normal + (0.02 - c) * v);
	b.geometric = s.geometric;
	frame_make(b.normal, b.x, b.y);
	b.view = vec3(dot(v, b.x), dot(v, b.y), max(dot(v, b.normal), 1e-4));
	b.diffuse = s.albedo;
	b.share = 0.0;
	b.mirror = false;
	if (EFFECT_GLOSSY)
		make_glossy(b, s);
	return b;
}

// Of a direction in the frame: BSDF × cosine (xyz) and density (w), 1/sr, without folding.
vec4 lobes(bsdf b, vec3 l)
{
	if (l.z <= 0.0)
		return vec4(0.0);
	float cosine = l.z * (1.0 / PI);
	if (!EFFECT_GLOSSY)
		return vec4(b.diffuse * cosine, cosine);
	float lost;
	vec3 inward = max(1.0 - specular_albedo(b, l.z, lost), 0.0);
	vec3 wide = b.diffuse * b.outward * inward + b.fms * (b.lost * lost * b.lost_inverse);
	vec4 r = vec4(wide * cosine, (1.0 - b.share) * cosine);
	if (!b.mirror && b.share > 0.0) {
		r.xyz += ggx_eval(b.view, l, b.alpha, b.f0, b.f90);
		r.w += b.share * ggx_pdf(b.view, l, b.alpha);
	}
	return r;
}

vec3 into_frame(bsdf b, vec3 w)
{
	return vec3(dot(w, b.x), dot(w, b.y), dot(w, b.normal));
}

// Of a direction in the world: BSDF × cosine (xyz) and the density with which bsdf_sample takes it (w), 1/sr. Zero below
// the surface. A perfect mirror's part is in neither.
vec4 bsdf_eval(bsdf b, vec3 w)
{
	float above = dot(b.geometric, w);
	if (above <= 0.0)
		return vec4(0.0);
	vec3 folded = w - 2.0 * above * b.geometric;
	return lobes(b, into_frame(b, w)) + lobes(b, into_frame(b, folded));
}

// A direction above the surface, the weight BSDF × cosine / density and the density. `lobe` and u are uniform in [0, 1).
// A weight of zero means that there is none.
vec3 bsdf_sample(bsdf b, float lobe, vec2 u, out vec3 weight, out float pdf)
{
	vec3 l = cosine_hemisphere(u);
	bool facets = EFFECT_GLOSSY && lobe < b.share;
	if (EFFECT_GLOSSY && facets) {
		vec3 h = b.mirror ? vec3(0.0, 0.0, 1.0) : ggx_sample_half(b.view, b.alpha, u);
		l = 2.0 * dot(b.view, h) * h - b.view;
	}
	vec3 w = l.x * b.x + l.y * b.y + l.z * b.normal;
	float above = dot(b.geometric, w);
	w = above < 0.0 ? w - 2.0 * above * b.geometric : w;
	if (!EFFECT_GLOSSY) {
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
