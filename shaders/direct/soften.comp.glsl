// Computes the lamps' light with the points of 4 × 4 pixels instead of one pixel's: neighbours on the same surface share
// them. Every such window contains each part of the set exactly once, so no pattern remains.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "direct/lamp_image.glsl"
#include "deferred/visible.glsl"

layout(local_size_x = TILE_PIXELS) in;

// A neighbour is on another surface if the cosine between the normals is below SAME_NORMAL, or if it lies more than
// SAME_PLANE pixels off the surface's plane.
const float SAME_NORMAL = 0.9;
const float SAME_PLANE = 1.0;

void main()
{
	uvec2 pixel;
	if (!pixel_mine(pixel))
		return;
	ivec2 texel = pixel_texel(pixel);
	vec4 own = imageLoad(scale_image, texel);
	if (own.w == 0.0)
		return;
	visible_point v = visible_ray(pixel);
	vec3 place = v.origin + own.w * v.direction;
	vec3 normal = from_octahedron(vec2(imageLoad(arrived_image, texel).w, imageLoad(expected_image, texel).w));
	float distance = job.orthographic != 0.0 ? 1.0 : own.w;
	float tolerance = SAME_PLANE * 2.0 * length(to_vec3(job.up)) / float(job.height) * distance;
	lamp_light sum = lamp_light(own.rgb, vec3(0.0), vec3(0.0), vec3(0.0));
	float kin = 0.0;
	for (int i = 0; i < 16; i++) {
		ivec2 at = texel + ivec2(i & 3, i >> 2) - 1;
		if (at.x < 0 || at.y < 0 || at.x >= int(job.width) || at.y >= int(area.y))
			continue;
		vec4 arrived = imageLoad(arrived_image, at);
		vec4 expected = imageLoad(expected_image, at);
		float t = imageLoad(scale_image, at).w;
		visible_point n = visible_ray(uvec2(at) + uvec2(0u, area.x));
		float off = abs(dot(normal, n.origin + t * n.direction - place));
		bool same = t > 0.0 && off < tolerance && dot(normal, from_octahedron(vec2(arrived.w, expected.w))) > SAME_NORMAL;
		sum.arrived += same ? arrived.rgb : vec3(0.0);
		sum.expected += same ? expected.rgb : vec3(0.0);
		if (EFFECT_GLOSSY)
			sum.facets += same ? imageLoad(facets_image, at).rgb : vec3(0.0);
		kin += same ? 1.0 : 0.0;
	}
	pixel_add(pixel, lamp_radiance(sum) + sum.facets / max(kin, 1.0));
}
