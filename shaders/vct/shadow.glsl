// Visibility of a light, by marching towards it through the pyramid: with a ray that is blocked or not (hard), or a cone
// that is partly blocked (soft); or from the shares of light that the voxels have stored. For direct/lighting.glsl.
#ifndef VCT_SHADOW_GLSL
#define VCT_SHADOW_GLSL

#include "vct/cone.glsl"

#ifndef VCT_SHADOW_HARD
#define VCT_SHADOW_HARD false
#endif

#define DIRECT_OPEN volume_open

#ifdef VCT_SHADOW_VOLUME
layout(binding = VCT_SHARES_UNIT) uniform sampler3D vct_shares;

// Visibility, the same for all lights: the mean of the voxels that face like the surface.
float volume_open(vec3 origin, vec3 normal, vec3 segment, float t_max)
{
	vec3 sides = vec3(vct_sides_top.xyz);
	vec3 at = (origin - vct_low_cell.xyz) / vct_low_cell.w;
	float x = clamp(at.x, 0.5, sides.x - 0.5) / sides.x;
	// The surface is seen against its normal.
	vec3 way = vec3(0.0, 2.0, 4.0) + mix(vec3(0.0), vec3(1.0), greaterThan(normal, vec3(0.0)));
	vec2 sum = vec2(0.0);
	for (uint i = 0u; i < 3u; i++) {
		vec4 c = textureLod(vct_shares, vec3((way[i] + x) * (1.0 / 6.0), at.yz / sides.yz), 0.0);
		sum += normal[i] * normal[i] * c.ra;
	}
	return sum.y > 0.0 ? clamp(sum.x / sum.y, 0.0, 1.0) : 1.0;
}
#else
float volume_open(vec3 origin, vec3 normal, vec3 segment, float t_max)
{
	float l = length(segment);
	float tangent = VCT_SHADOW_HARD ? 0.0 : vct_march.shadow_tangent;
	// The voxels of the lamp itself and of its holder must not block the light: the last footprint ends before them.
	float end = t_max * l / vct_low_cell.w / (1.0 + 1.5 * tangent) - 1.5;
	cone_origin o = cone_from(origin, normal, 0.0);
	vec4 c = cone_march_to(o, segment / l, tangent, end);
	return VCT_SHADOW_HARD ? (c.a < 0.5 ? 1.0 : 0.0) : max(1.0 - c.a, 0.0);
}
#endif

#endif
