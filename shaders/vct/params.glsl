// The parameters of voxel cone tracing: struct vct_params as a uniform block.
#ifndef VCT_PARAMS_GLSL
#define VCT_PARAMS_GLSL

#include "shared/vct.h"

layout(std140, binding = UNIFORM_VCT_PARAMS) uniform VctParams {
	vec4 vct_low_cell;
	uvec4 vct_sides_top;
	vec4 vct_background_scale;
	vct_marching vct_march;
	uvec4 vct_cones_emission;     // x: number of cones; y: emission; z, w: bits of sky_turn and sky_scale
	uvec4 vct_rays;               // x: rays of each side of an entry
	vec4 vct_cone[VCT_CONES_MAX];
	vec4 vct_tangent[VCT_CONES_MAX];
	vec4 vct_gather[VCT_GATHER_CONES];
};

uint vct_cones()
{
	return vct_cones_emission.x;
}

// Side of a cell of a level, in metres.
float vct_cell(float level)
{
	return vct_low_cell.w * exp2(level);
}

#endif
