// The light of the lamps on each pixel's diffuse part, kept between two passes, with the distance and normal by which
// neighbours on the same surface are recognised.
#ifndef DIRECT_LAMP_IMAGE_GLSL
#define DIRECT_LAMP_IMAGE_GLSL

#include "direct/lighting.glsl"
#include "deferred/radiance.glsl"

layout(binding = DIRECT_SCALE_UNIT, rgba32f) uniform image2D scale_image;         // w: metres from the eye; 0: no lamp light
layout(binding = DIRECT_ARRIVED_UNIT, rgba32f) uniform image2D arrived_image;     // w, with expected_image's: the normal
layout(binding = DIRECT_FACETS_UNIT, rgba32f) uniform image2D facets_image;
layout(binding = DIRECT_EXPECTED_UNIT, rgba32f) uniform image2D expected_image;

// Maps a unit vector to the unfolded octahedron: Cigolle et al. 2014 (JCGT 3-2).
vec2 octahedron(vec3 n)
{
	vec2 p = n.xy / max(abs(n.x) + abs(n.y) + abs(n.z), 1e-30);
	vec2 folded = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
	return n.z < 0.0 ? folded : p;
}

vec3 from_octahedron(vec2 p)
{
	vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
	vec2 folded = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
	n.xy = n.z < 0.0 ? folded : n.xy;
	return normalize(n);
}

void keep_lamps(ivec2 texel, lamp_light l, bsdf b, float t, vec3 normal)
{
	vec2 n = octahedron(normal);
	bool any = max(l.scale.r, max(l.scale.g, l.scale.b)) > 0.0 || (EFFECT_GLOSSY && b.share > 0.0 && !b.gloss.mirror);
	if (EFFECT_GLOSSY)
		imageStore(facets_image, texel, vec4(l.facets, 0.0));
	imageStore(scale_image, texel, vec4(l.scale, any ? t : 0.0));
	imageStore(arrived_image, texel, vec4(l.arrived, n.x));
	imageStore(expected_image, texel, vec4(l.expected, n.y));
}

#endif
