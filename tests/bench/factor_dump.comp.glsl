// The rays of rows of form factors, written to a list in place of being traced: factor_rays.comp.glsl's, one for one.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "common/scene.glsl"
#include "shared/cast.h"
#include "shared/factor_rays.h"

layout(local_size_x = FACTOR_LANES) in;

layout(push_constant) uniform Push {
	factor_push push;
};
layout(std430, set = 0, binding = BIND_RADIOSITY_PATCHES) readonly buffer Patches {
	radiosity_patch radiosity_patches[];
};
layout(std430, set = 0, binding = BIND_FACTOR_TABLE) readonly buffer Table {
	uvec4 factor_table[];
};
layout(std430, set = 0, binding = BIND_FACTOR_ROWS) readonly buffer Rows {
	uint factor_rows[];
};
layout(std430, set = 0, binding = BIND_FACTOR_SECONDS) readonly buffer Seconds {
	uint factor_seconds[];
};
layout(std430, set = 0, binding = BIND_FACTOR_DENSE) writeonly buffer Rays {
	cast_ray rays[];
};

#include "radiosity/factor_source.glsl"

void main()
{
	uint row = gl_WorkGroupID.y;
	uint i = gl_WorkGroupID.x * FACTOR_LANES + gl_LocalInvocationIndex;
	if (i >= push.rays)
		return;
	vec3 o, d;
	source_ray(source_make(factor_rows[row], push.patches), i, o, d);
	rays[row * push.rays + i] =
	    cast_ray(float[3](o.x, o.y, o.z), INFINITY, float[3](d.x, d.y, d.z), 0u);
}
