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

// No component zero, so that no product is 0 × infinity. 1e-30 turns a ray by nothing that a float can tell; nor does what
// keeps origin × inverse finite, far out.
vec3 safe_inverse(vec3 origin, vec3 d)
{
	vec3 sign_d = vec3(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0, d.z < 0.0 ? -1.0 : 1.0);
	return sign_d / max(abs(d), max(abs(origin) * 1e-37, 1e-30));
}

// A ray as boxes see it. The distance of an axis' plane at p is p · inverse − origin · inverse; the near planes' are taken a
// little too small and the far ones' too large, by more than what the roundings of the product, of the inverse and of the
// origin itself can do (each half a unit in the last place; Ize 2013 has the argument): a box is never missed for rounding.
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

// Entry distance of a box, or infinity if missed (as an empty child's always is: its box is a point at infinity). `near` and
// `far` are the planes that the ray meets first and last of each axis.
// t_max is taken larger by what the distance of a hit, which comes out of a longer computation, may be off: of two surfaces at
// one place the tree's order would else choose. Maxima and minima are of bits, as integers: where one side is not negative
// they order floats rightly, and a negative exit is a miss whichever it is.
float hit_slabs(vec3 near, vec3 far, slab_ray r, float t_max)
{
	ivec3 a = floatBitsToInt(fma(near, r.inverse, r.near_bias));
	ivec3 b = floatBitsToInt(fma(far, r.inverse, r.far_bias));
	float enter = intBitsToFloat(max(max(a.x, 0), max(a.y, a.z))) * 0.99999;
	float leave = intBitsToFloat(min(min(b.x, b.y), min(b.z, floatBitsToInt(t_max))));
	return enter <= leave ? enter : INFINITY;
}

#endif
