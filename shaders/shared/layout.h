// Structures that C and GLSL share: what lies in a scene blob is what a shader reads. Only 4-byte scalars and arrays of them,
// so that C's layout and std430's are the same; the asserts below hold C to it, and GLSL has no other choice.
#ifndef CANDIL_SHARED_LAYOUT_H
#define CANDIL_SHARED_LAYOUT_H

#ifdef GL_core_profile
#define LAYOUT_ASSERT(type, bytes)
#else
#include <stdint.h>
typedef uint32_t uint;
#define LAYOUT_ASSERT(type, bytes) _Static_assert(sizeof(struct type) == (bytes), #type " has the size that shaders expect");
#ifdef __cplusplus
#undef LAYOUT_ASSERT
#define LAYOUT_ASSERT(type, bytes) static_assert(sizeof(struct type) == (bytes), #type);
#endif
#endif

#define NONE 0xFFFFFFFFu

// ---- geometry: metres, world space relative to the blob's origin -----------------------------------------------------

// A corner. `normal` is unit length, or zero where the file gives none: the triangle's own normal then holds.
struct vertex {
	float position[3];
	float normal[3];
	float uv[2];
};
LAYOUT_ASSERT(vertex, 32)

// By triangle id, in the order of the file.
struct triangle {
	uint vertex[3];
	uint material;
};
LAYOUT_ASSERT(triangle, 16)

// A binary BVH's inner node: both children's boxes and where they are. Node 0 is the root; a scene of one leaf still has it,
// its second child then a point at infinity (min = max = +inf),
// which every ray misses.
// count[i] == 0: child[i] is a node; else leaf triangles child[i] … child[i] + count[i] - 1.
struct bvh_node {
	float min0[3];
	uint child0;
	float max0[3];
	uint count0;
	float min1[3];
	uint child1;
	float max1[3];
	uint count1;
};
LAYOUT_ASSERT(bvh_node, 64)

// A triangle in leaf order, ready to be hit. Corners are bit for bit those of `vertex`, so that shared edges are.
struct leaf_triangle {
	float v0[3];
	uint id;         // triangle id
	float v1[3];
	uint material;
	float v2[3];
	uint reserved;
};
LAYOUT_ASSERT(leaf_triangle, 48)

// ---- materials --------------------------------------------------------------------------------------------------------

#define MATERIAL_EMITS_BOTH_SIDES 1u  // glTF doubleSided emitters; else the front (counter-clockwise) side alone emits

struct material {
	float albedo[3];          // base-colour factor or Kd, linear Rec.709, each 0…1
	uint albedo_texture;      // multiplies it; NONE
	float emission[3];        // radiance, W/(m² sr)
	uint emission_texture;    // multiplies it; NONE
	uint flags;               // MATERIAL_…
	float power_density;      // π · mean luminance of the emission · sides, W/m²: emitters are chosen by it
	float reserved[2];
};
LAYOUT_ASSERT(material, 48)

#define WRAP_REPEAT 0u
#define WRAP_CLAMP 1u
#define WRAP_MIRROR 2u
#define TEXTURE_WRAP_S_SHIFT 0u   // two bits
#define TEXTURE_WRAP_T_SHIFT 2u   // two bits
#define TEXTURE_NEAREST (1u << 4) // else bilinear, in linear light
#define TEXTURE_SRGB (1u << 5)    // texels are sRGB-encoded

// RGBA8 texels, one uint each (R in the low byte), row by row from the top, at texels[offset].
// Two textures that differ in sampler alone share texels.
struct texture_info {
	uint offset;
	uint width;
	uint height;
	uint flags;
};
LAYOUT_ASSERT(texture_info, 16)

// ---- lights -----------------------------------------------------------------------------------------------------------

// A row of an alias table (Walker 1977, Vose 1991): pick row i uniformly, keep it with probability `keep`, else take row
// `alias`. `pmf` is the probability of this entry, all told.
struct emitter {
	uint triangle;   // triangle id
	float keep;
	uint alias;
	float pmf;       // ∝ area · power_density
};
LAYOUT_ASSERT(emitter, 16)

#define LIGHT_POINT 0u
#define LIGHT_SPOT 1u
#define LIGHT_DIRECTIONAL 2u

struct punctual_light {
	float position[3];    // metres; unused if directional
	uint kind;            // LIGHT_…
	float direction[3];   // unit, the way the light travels; unused if point
	float cos_outer;      // spot: no light beyond
	float intensity[3];   // W/sr; directional: irradiance, W/m², on a plane facing it
	float cos_inner;      // spot: full light within
	float keep;           // alias table over the punctual lights, as in `emitter`
	uint alias;
	float pmf;
	float reserved;
};
LAYOUT_ASSERT(punctual_light, 64)

#endif
