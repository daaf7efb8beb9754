// What part of a light arrives, by marching towards it through the pyramid: by a ray that is stopped or not (hard), or by a cone
// that is stopped more or less (soft). For direct/lighting.glsl.
#ifndef VCT_SHADOW_GLSL
#define VCT_SHADOW_GLSL

#include "vct/cone.glsl"

#ifndef VCT_SHADOW_HARD
#define VCT_SHADOW_HARD false
#define VCT_SHADOW_TANGENT 0.0875   // of the half aperture
#endif

#define DIRECT_OPEN volume_open

float volume_open(vec3 origin, vec3 normal, vec3 segment, float t_max)
{
	float l = length(segment);
	float tangent = VCT_SHADOW_HARD ? 0.0 : VCT_SHADOW_TANGENT;
	// The lamp's own voxels, and those of what it hangs from, are no obstacle: the last footprint ends before them.
	float end = t_max * l / vct_low_cell.w / (1.0 + 1.5 * tangent) - 1.5;
	cone_origin o = cone_from(origin, normal, 0.0);
	vec4 c = cone_march_to(o, segment / l, tangent, end);
	return VCT_SHADOW_HARD ? (c.a < 0.5 ? 1.0 : 0.0) : max(1.0 - c.a, 0.0);
}

#endif
