// What both ways of walking the BVH share.
#ifndef TRACE_WALK_GLSL
#define TRACE_WALK_GLSL

#include "common/scene.glsl"

#define TRAVERSE_STACK 48u          // LIMIT_BVH_DEPTH, which blob_check enforces
#define TRAVERSE_DONE 0xFFFFFFFFu
#define LEAF_COUNT_SHIFT 28         // a reference is either 0 and a node's index, or a leaf's count and its first triangle
#define LEAF_INDEX_MASK 0x0FFFFFFFu

struct ray_hit {
	float t;
	uint id;         // triangle id; NONE: nothing hit
	vec2 uv;         // barycentrics of corners 1 and 2
	uint material;
};

// Becomes true if the driver ended a loop before its condition did. Some drivers end all loops of an invocation after
// 65,535 rounds; the walk would then miss geometry silently.
bool trace_cut = false;

// Loop rounds of this invocation so far. The host keeps dispatches well below such a driver's limit.
uint trace_rounds = 0u;

// 1 / d with no component of d zero, so that no product is 0 × infinity. The least value, 1e-30, turns a ray by less than a
// float can represent. So does the value that keeps origin × inverse finite far from the origin.
vec3 safe_inverse(vec3 origin, vec3 d)
{
	vec3 sign_d = vec3(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0, d.z < 0.0 ? -1.0 : 1.0);
	return sign_d / max(abs(d), max(abs(origin) * 1e-37, 1e-30));
}

// A ray prepared for the intersection with boxes. The distance of an axis' plane at p is p · inverse − origin · inverse.
// Near planes are taken slightly too close and far planes slightly too distant, by more than the combined rounding of the
// product, of the inverse and of the origin (each half a unit in the last place; Ize 2013 has the argument). So rounding
// never makes a ray miss a box.
struct slab_ray {
	vec3 inverse;
	vec3 near_bias;
	vec3 far_bias;
};

slab_ray slab_make(vec3 origin, vec3 direction)
{
	slab_ray r;
	r.inverse = safe_inverse(origin, direction);
	vec3 at = origin * r.inverse;
	vec3 slack = abs(at) * 4.76837158203125e-07;   // 2⁻²¹
	r.near_bias = -at - slack;
	r.far_bias = slack - at;
	return r;
}

// Entry distance of a box, or infinity if it is missed. An empty child is always missed: its box is a point at infinity.
// For each axis, `near` and `far` are the planes that the ray meets first and last.
// t_max is enlarged by the possible error of a hit's distance, which comes from a longer computation; otherwise, of two
// coincident surfaces, the tree's order would choose. Maxima and minima are taken of the bits, as integers. Where one
// operand is not negative, they order floats correctly, and a negative exit is a miss whatever its value.
float hit_slabs(vec3 near, vec3 far, slab_ray r, float t_max)
{
	ivec3 a = floatBitsToInt(fma(near, r.inverse, r.near_bias));
	ivec3 b = floatBitsToInt(fma(far, r.inverse, r.far_bias));
	float enter = intBitsToFloat(max(max(a.x, 0), max(a.y, a.z))) * 0.99999;
	float leave = intBitsToFloat(min(min(b.x, b.y), min(b.z, floatBitsToInt(t_max))));
	return enter <= leave ? enter : INFINITY;
}

#endif
