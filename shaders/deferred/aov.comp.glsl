// The AOVs of the ray through a pixel's middle: depth, normal, albedo, id, in the format of the path tracer's pass of that
// name.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "deferred/pixel.glsl"

layout(local_size_x = TILE_PIXELS) in;

layout(std430, binding = BIND_ACCUMULATOR) writeonly buffer Aov {
	uint aov[];
};

void main()
{
	uvec2 pixel;
	if (!pixel_mine(pixel))
		return;
	visible_point v;
	float depth = INFINITY;
	vec3 normal = vec3(0.0);
	vec3 albedo = vec3(0.0);
	uint id = 0u;
	if (pixel_visible(pixel, v)) {
		surface s = pixel_surface(v);
		depth = v.t * dot(v.direction, to_vec3(job.forward));
		normal = s.shading;
		albedo = s.base;
		id = triangles[v.id].material + 1u;
	}
	ivec2 texel = pixel_texel(pixel);
	uint at = (uint(texel.y) * job.width + uint(texel.x)) * AOV_WORDS;
	aov[at] = floatBitsToUint(depth);
	for (uint i = 0u; i < 3u; i++) {
		aov[at + 1u + i] = floatBitsToUint(normal[i]);
		aov[at + 4u + i] = floatBitsToUint(albedo[i]);
	}
	aov[at + 7u] = id;
}
