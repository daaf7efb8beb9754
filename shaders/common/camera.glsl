// Camera rays.
#ifndef COMMON_CAMERA_GLSL
#define COMMON_CAMERA_GLSL

#include "common/scene.glsl"

// The ray through the point `at` of the image, in pixels from its top left corner.
void camera_ray(vec2 at, out vec3 origin, out vec3 direction)
{
	vec2 ndc = vec2(2.0 * at.x / float(job.width) - 1.0, 1.0 - 2.0 * at.y / float(job.height));
	vec3 plane = ndc.x * to_vec3(job.right) + ndc.y * to_vec3(job.up);
	origin = to_vec3(job.eye) + job.orthographic * plane;
	direction = normalize(to_vec3(job.forward) + (1.0 - job.orthographic) * plane);
}

#endif
