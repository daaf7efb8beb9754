// Watertight ray-triangle intersection: Woop, Benthin and Wald 2013 (JCGT 2-1). For two triangles that share an edge, the
// edge functions are the same products in the same order, so rounding cannot open a gap between them. `precise` keeps
// compilers from fusing one and not the other. A zero edge function counts as inside for both neighbours.
#ifndef TRACE_TRIANGLE_GLSL
#define TRACE_TRIANGLE_GLSL

#include "common/scene.glsl"

// A ray with the shear that makes it run along +z from the origin.
struct sheared_ray {
	vec3 origin;
	vec3 shear;      // x, y: shear; z: scale
	uint axis;       // the world axis that became z
};

vec3 rotate_axes(vec3 v, uint axis)
{
	return axis == 0u ? v.yzx : axis == 1u ? v.zxy : v;
}

sheared_ray shear_ray(vec3 origin, vec3 direction)
{
	vec3 a = abs(direction);
	sheared_ray r;
	r.origin = origin;
	r.axis = a.x > a.y ? (a.x > a.z ? 0u : 2u) : (a.y > a.z ? 1u : 2u);
	vec3 d = rotate_axes(direction, r.axis);
	r.shear = vec3(d.x, d.y, 1.0) / d.z;
	return r;
}

// The distance of a hit by the triangle's plane, where that has a lower bound of its error than `t`, the mean of the corners'
// distances: a corner 10⁷ metres away makes a mean uncertain by a metre, but not the height of a level floor. The first bound
// is the rounding of the normal's products with the corner's place, Σ (|e1| × |e2|)ᵢ |aᵢ|, over the normal's part along the
// ray; a level plane has no other products than that of the height. The second is the farthest corner's distance. `a` is the
// first corner, rotated and relative to the origin; e1 and e2 are the edges from it.
float plane_distance(sheared_ray r, vec3 a, vec3 e1, vec3 e2, float farthest, float t)
{
	vec3 m = max(abs(e1), abs(e2));
	float k = 1.0 / max(max(m.x, max(m.y, m.z)), 1e-30);
	e1 = rotate_axes(e1 * k, r.axis);
	e2 = rotate_axes(e2 * k, r.axis);
	vec3 n = cross(e1, e2);
	vec3 products = abs(e1.yzx * e2.zxy) + abs(e1.zxy * e2.yzx);
	float along = n.x * r.shear.x + n.y * r.shear.y + n.z;
	return dot(products, abs(a)) < abs(along) * farthest ? dot(n, a) * r.shear.z / along : t;
}

// Intersects a triangle. t is in units of the direction's length; uv are the barycentrics of corners 1 and 2. False if the
// ray misses, or if the hit is not at t > 0.
bool hit_triangle(sheared_ray r, vec3 v0, vec3 v1, vec3 v2, out float t, out vec2 uv)
{
	vec3 a = rotate_axes(v0 - r.origin, r.axis);
	vec3 b = rotate_axes(v1 - r.origin, r.axis);
	vec3 c = rotate_axes(v2 - r.origin, r.axis);
	precise float ax = a.x - r.shear.x * a.z;
	precise float ay = a.y - r.shear.y * a.z;
	precise float bx = b.x - r.shear.x * b.z;
	precise float by = b.y - r.shear.y * b.z;
	precise float cx = c.x - r.shear.x * c.z;
	precise float cy = c.y - r.shear.y * c.z;
	precise float u = cx * by - cy * bx;
	precise float v = ax * cy - ay * cx;
	precise float w = bx * ay - by * ax;
	precise float det = u + v + w;
	precise float scaled = u * (r.shear.z * a.z) + v * (r.shear.z * b.z) + w * (r.shear.z * c.z);
	float least = min(u, min(v, w));
	float most = max(u, max(v, w));
	bool inside = !(least < 0.0 && most > 0.0) && det != 0.0;
	float inv = 1.0 / det;
	t = scaled * inv;
	if (VAST_SCENE)
		t = plane_distance(r, a, v1 - v0, v2 - v0, max(abs(a.z), max(abs(b.z), abs(c.z))), t);
	uv = vec2(v, w) * inv;
	return inside && t > 0.0;
}

#endif
