// The camera ray through a pixel, and its hit on a triangle. The rasteriser determines the triangle. The point on it is
// computed as in the path tracer, from the same ray by the same arithmetic.
#ifndef DIRECT_VISIBLE_GLSL
#define DIRECT_VISIBLE_GLSL

#include "common/camera.glsl"
#include "deferred/area.glsl"
#include "trace/triangle.glsl"

struct visible_point {
	vec3 origin;       // origin of the camera ray
	vec3 direction;    // unit
	uint id;           // triangle
	float t;           // metres along the ray
	vec2 uv;           // barycentrics of corners 1 and 2
};

// The ray of a pixel, counted from the image's top left; no hit yet.
visible_point visible_ray(uvec2 pixel)
{
	visible_point v;
	camera_ray(vec2(pixel) + jitter, v.origin, v.direction);
	v.id = NONE;
	v.t = INFINITY;
	v.uv = vec2(0.0);
	return v;
}

// Intersects the ray with triangle `id`, whose corners are given. The rasteriser rounds corners to a fraction of a pixel, so the
// ray may miss the triangle by as much. Then the nearest barycentrics are used, and for a triangle seen exactly edge-on its
// middle. False if it is behind the eye.
bool visible_on(inout visible_point v, uint id, vec3 v0, vec3 v1, vec3 v2)
{
	v.id = id;
	if (hit_triangle(shear_ray(v.origin, v.direction), v0, v1, v2, v.t, v.uv))
		return true;
	// Written as comparisons that a NaN fails.
	vec3 b = vec3(1.0 - v.uv.x - v.uv.y, v.uv);
	b = vec3(b.x > 0.0 ? min(b.x, 1.0) : 0.0, b.y > 0.0 ? min(b.y, 1.0) : 0.0, b.z > 0.0 ? min(b.z, 1.0) : 0.0);
	float sum = b.x + b.y + b.z;
	b = sum > 0.0 ? b / sum : vec3(1.0 / 3.0);
	v.uv = b.yz;
	v.t = dot(b.x * (v0 - v.origin) + b.y * (v1 - v.origin) + b.z * (v2 - v.origin), v.direction);
	return v.t > 0.0;
}

bool visible_at(inout visible_point v, uint id)
{
	triangle tri = triangles[id];
	return visible_on(v, id, to_vec3(vertices[tri.vertex[0]].position), to_vec3(vertices[tri.vertex[1]].position),
			  to_vec3(vertices[tri.vertex[2]].position));
}

#endif
