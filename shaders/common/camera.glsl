// Camera rays.
#ifndef COMMON_CAMERA_GLSL
#define COMMON_CAMERA_GLSL

#include "common/scene.glsl"

// The pixel of this invocation in a tile. Eight neighbours in number are a block of 4 × 2, so that the rays of a subgroup
// begin close together.
uvec2 tile_pixel(uint tile)
{
	uint i = gl_LocalInvocationIndex;
	uint block = i / 8u;
	uvec2 inside = uvec2(block % 2u * 4u + i % 4u, block / 2u * 2u + i / 4u % 2u);
	return uvec2(tile % job.tiles_x, tile / job.tiles_x) * TILE_SIDE + inside;
}

// `at` in pixels from the image's top left corner.
void camera_ray(vec2 at, out vec3 origin, out vec3 direction)
{
	vec2 ndc = vec2(2.0 * at.x / float(job.width) - 1.0, 1.0 - 2.0 * at.y / float(job.height));
	vec3 plane = ndc.x * to_vec3(job.right) + ndc.y * to_vec3(job.up);
	origin = to_vec3(job.eye) + job.orthographic * plane;
	direction = normalize(to_vec3(job.forward) + (1.0 - job.orthographic) * plane);
}

#endif
