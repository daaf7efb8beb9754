// Renders a shadow map. Depth is the rasteriser's own; what alpha masks is discarded.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "shared/deferred.h"
#include "trace/alpha.glsl"

layout(location = DEFERRED_TRIANGLE) uniform uint first_triangle;
layout(location = 0) in vec2 barycentric;

void main()
{
	uint id = first_triangle + uint(gl_PrimitiveID);
	if (!is_there(id, triangles[id].material, clamp(barycentric, 0.0, 1.0)))
		discard;
}
