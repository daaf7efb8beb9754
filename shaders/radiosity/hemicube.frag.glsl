// Which triangle a pixel of a hemicube sees. Within a mirror, only pixels that see the mirror are drawn.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "radiosity/hemicube.glsl"

layout(location = 0) out uint seen;
layout(location = 2) flat in uint id;
#ifdef HEMICUBE_CUT
#include "radiosity/hemicube_scene.glsl"
#include "trace/alpha.glsl"

layout(location = 0) in vec2 barycentric;
#endif
#ifdef HEMICUBE_MIRRORED
layout(binding = UNIT_HEMICUBE_PARENTS) uniform usampler2DArray parents;
layout(location = 1) flat in uint cell;
#endif

void main()
{
#ifdef HEMICUBE_MIRRORED
	hemicube_cell c = hemicube_cells[cell];
	uvec3 at = uvec3(gl_FragCoord.xy, uint(gl_Layer) % HEMICUBE_LAYERS);
	if (texelFetch(parents, hemicube_texel(c.parent, at), 0).x != c.plane)
		discard;
#endif
#ifdef HEMICUBE_CUT
	if (!is_there(id, triangles[id].material, clamp(barycentric, 0.0, 1.0)))
		discard;
#endif
	seen = id + 1u;
}
