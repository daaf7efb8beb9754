// What every walk through the BVH shares.
#ifndef TRACE_WALK_GLSL
#define TRACE_WALK_GLSL

#include "common/scene.glsl"

#define TRAVERSE_STACK 48u          // LIMIT_BVH_DEPTH, which blob_check enforces
#define TRAVERSE_DONE 0xFFFFFFFFu
#define LEAF_COUNT_SHIFT 28         // a reference: 0 and a node's index, or a leaf's count and its first triangle
#define LEAF_INDEX_MASK 0x0FFFFFFFu

struct ray_hit {
	float t;
	uint id;         // triangle id; NONE: nothing hit
	vec2 uv;         // barycentrics of corners 1 and 2
	uint material;
};

// Becomes true if the driver ended a loop before its condition did (some end all loops of an invocation after 65,535
// rounds): the walk would then have missed geometry without a word.
bool trace_cut = false;

// How often this invocation has gone round in loops, for such a driver's sake: who dispatches keeps well below that.
uint trace_rounds = 0u;

// Entry distance of a box, or infinity if missed (as an empty child's always is: its box is a point at infinity).
// The factors make up for rounding: a few units for the products (Ize 2013); more for the comparison with a hit's distance,
// which comes out of a longer computation. Of two surfaces at one place the tree's order would else choose.
float hit_box(vec3 low, vec3 high, vec3 origin, vec3 inverse, float t_max)
{
	vec3 a = (low - origin) * inverse;
	vec3 b = (high - origin) * inverse;
	vec3 near = min(a, b);
	vec3 far = max(a, b);
	float enter = max(max(near.x, near.y), max(near.z, 0.0)) * 0.99999;
	float leave = min(min(far.x, far.y), far.z) * 1.0000005;
	return enter <= min(leave, t_max) ? enter : INFINITY;
}

// No component zero, so that no product is 0 × infinity. 1e-30 turns a ray by nothing that a float can tell.
vec3 safe_inverse(vec3 d)
{
	vec3 sign_d = vec3(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0, d.z < 0.0 ? -1.0 : 1.0);
	return sign_d / max(abs(d), vec3(1e-30));
}

#endif
