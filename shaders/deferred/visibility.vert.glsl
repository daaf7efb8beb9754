// Projects every corner of every triangle, fetched from the scene's buffers, to the image plane. x and y are taken relative
// to the eye before anything is rounded. The fragment shader computes depth.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "common/scene.glsl"
#include "deferred/area.glsl"

void main()
{
	uint corner = uint(gl_VertexID);
	vec3 p = to_vec3(vertices[triangles[corner / 3u].vertex[corner % 3u]].position) - to_vec3(job.eye);
	vec3 right = to_vec3(job.right);
	vec3 up = to_vec3(job.up);
	vec2 at = vec2(dot(p, right) / dot(right, right), dot(p, up) / dot(up, up));
	float w = job.orthographic != 0.0 ? 1.0 : dot(p, to_vec3(job.forward));
	// Rows count downwards. The shift makes the ray at `jitter` fall on the pixel's middle.
	vec2 shift = (1.0 - 2.0 * jitter) / vec2(job.width, job.height);
	gl_Position = vec4(vec2(at.x, -at.y) + shift * w, job.orthographic != 0.0 ? 0.5 : VISIBLE_NEAR, w);
}
