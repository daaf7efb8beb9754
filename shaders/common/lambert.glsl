// The Lambert BSDF, ρ/π, about a shading normal, kept above the true surface.
//
// A shading normal that leans away from the triangle's puts part of the cosine lobe below the surface. Dropping that part
// darkens edges, letting it through leaks light. Here it is folded back: a direction below is mirrored at the surface. The
// lobe over the upper hemisphere is then
//     p(ω) = [max(0, ns·ω) + max(0, ns·ω')] / π,   ω' = ω mirrored at the surface,
// which integrates to one whatever ns is, and is plain cosine where ns is the true normal.
#ifndef COMMON_LAMBERT_GLSL
#define COMMON_LAMBERT_GLSL

#include "common/sampling.glsl"
#include "common/surface.glsl"

// p(ω), 1/sr; BSDF × cosine is albedo × this. Zero below the surface.
float lambert_pdf(surface s, vec3 w)
{
	float above = dot(s.geometric, w);
	vec3 mirrored = w - 2.0 * above * s.geometric;
	float lobe = max(0.0, dot(s.shading, w)) + max(0.0, dot(s.shading, mirrored));
	return above > 0.0 ? lobe * (1.0 / PI) : 0.0;
}

// A direction with density p(ω); the sample's weight BSDF × cosine / p is the albedo.
vec3 lambert_sample(surface s, vec2 u)
{
	vec3 x, y;
	frame_make(s.shading, x, y);
	vec3 local = cosine_hemisphere(u);
	vec3 w = local.x * x + local.y * y + local.z * s.shading;
	float above = dot(s.geometric, w);
	return above < 0.0 ? w - 2.0 * above * s.geometric : w;
}

#endif
