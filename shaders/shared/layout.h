// Structures that C and GLSL share: what lies in a scene blob is what a shader reads. Only 4-byte scalars and arrays of
// them, so that C's layout and std430's are the same; the asserts below hold C to it, and GLSL has no other choice.
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
	uint id; // triangle id
	float v1[3];
	uint material;
	float v2[3];
	uint reserved;
};
LAYOUT_ASSERT(leaf_triangle, 48)

// ---- materials --------------------------------------------------------------------------------------------------------

#define MATERIAL_EMITS_BOTH_SIDES 1u // glTF doubleSided emitters; else the front (counter-clockwise) side alone emits
#define MATERIAL_ALPHA_MASK 2u // not there where alpha is below alpha_cutoff
#define MATERIAL_UNLIT 4u // shows its base colour as radiance, neither lit nor casting light
#define MATERIAL_ALPHA_BLEND 8u // there with the probability that its alpha says
#define MATERIAL_THIN 16u // of what lets light through: a sheet without an inside, that does not bend it
#define MATERIAL_PRIORITY_SHIFT 8u // above: a clear body's, 0…LIMIT_PRIORITY; where bodies overlap, the highest is there

#define GGX_ALPHA_LEAST 1e-4 // microfacets' α below it is a perfect mirror

// Base colour, metallic and roughness as glTF 2.0 has them (appendix B), with KHR_materials_specular for what is no metal.
// Colours are linear Rec.709, 0…1. A texture is an index or NONE and multiplies the factor beside it.
struct material {
	float albedo[3]; // base colour: diffuse albedo, or reflectance of a metal at normal incidence
	uint albedo_texture; // its alpha is for MATERIAL_ALPHA_MASK and _BLEND
	float emission[3]; // radiance, W/(m² sr)
	uint emission_texture;
	float specular[3]; // reflectance of the dielectric part at normal incidence
	uint specular_texture; // colour
	float specular_weight; // its reflectance at grazing incidence; 0 with specular 0: no specular lobe, pure Lambert
	uint specular_weight_texture; // alpha; of the colour too
	float metallic;
	float roughness; // perceptual: the microfacets' α is its square; 0: a perfect mirror
	uint surface_texture; // green: roughness, blue: metallic
	uint normal_texture; // tangent space, +Z out
	float normal_scale; // of its X and Y
	float alpha_cutoff; // with the base colour's alpha factor divided out
	uint flags; // MATERIAL_…
	float power_density; // π · mean luminance of the emission · sides, W/m²: emitters are chosen by it
	float alpha; // base colour's factor, with MATERIAL_ALPHA_BLEND
	// Of the light that is not the metal's, this share meets a clear dielectric in place of the opaque surface:
	// reflected by Fresnel's equations, the rest let through, times the base colour.
	float transmission; // 0…1
	uint transmission_texture; // red
	float ior; // index of refraction of what is behind the surface; that of a thin one's sheet
	float absorption[3]; // of what is behind it, 1/m: light falls by exp(-absorption · distance)
	float diffuse_roughness; // of Oren and Nayar's matte facets, 0…1: common/diffuse.glsl; 0: Lambert
	// A clear film over all the rest, but for what lets light through: common/coat.glsl.
	float coat; // how much of it is there, 0…1
	float coat_roughness; // perceptual
	uint coat_texture; // red
	uint coat_roughness_texture; // green
	uint coat_normal_texture; // as normal_texture; NONE: the mesh's own normals
	float coat_normal_scale;
};
LAYOUT_ASSERT(material, 144)

#define WRAP_REPEAT 0u
#define WRAP_CLAMP 1u
#define WRAP_MIRROR 2u
#define TEXTURE_WRAP_S_SHIFT 0u // two bits
#define TEXTURE_WRAP_T_SHIFT 2u // two bits
#define TEXTURE_NEAREST (1u << 4) // else bilinear, in linear light
#define TEXTURE_SRGB (1u << 5) // texels are sRGB-encoded
#define TEXTURE_UV1 (1u << 6) // looked up by the second set of coordinates

// RGBA8 texels, one uint each (R in the low byte), row by row from the top, at texels[offset].
// Textures that differ in sampler, coordinates or transform alone share texels.
struct texture_info {
	uint offset;
	uint width;
	uint height;
	uint flags;
	float row_u[3]; // looked up at u' = row_u · (u, v, 1), v' = row_v · (u, v, 1): KHR_texture_transform
	float row_v[3];
};
LAYOUT_ASSERT(texture_info, 40)

// Per vertex where the scene has them at all, else sections without elements.
struct vertex_uv1 {
	float uv[2];
};
LAYOUT_ASSERT(vertex_uv1, 8)

// COLOR_0, linear; multiplies the base colour and its alpha. (1, 1, 1, 1) for vertices without.
struct vertex_color {
	float rgba[4];
};
LAYOUT_ASSERT(vertex_color, 16)

// World-space tangent, unit, and the bitangent's sign (-1 or 1): bitangent = sign · cross(normal, tangent). All zero: none.
struct vertex_tangent {
	float xyzw[4];
};
LAYOUT_ASSERT(vertex_tangent, 16)

// ---- lights -----------------------------------------------------------------------------------------------------------

// A row of an alias table (Walker 1977, Vose 1991): pick row i uniformly, keep it with probability `keep`, else take row
// `alias`. `pmf` is the probability of this entry, all told.
struct emitter {
	uint triangle; // triangle id
	float keep;
	uint alias;
	float pmf; // ∝ area · power_density
};
LAYOUT_ASSERT(emitter, 16)

// A node of the tree over the lamps: server/scene/light_tree.h. `child` and `child` + 1 are below it; of a leaf, LIGHT_LEAF
// and the lamp's number, in the job emitters first, then lights.
struct light_node {
	float min[3]; // metres; above max: directional lights are below
	float power; // π times what all lamps below send at the most, W/sr; directional ones W/m²
	float max[3];
	float cos_spread; // every normal below, or way that light travels, is within the angle of this cosine of `axis`
	float axis[3]; // unit
	uint child;
};
LAYOUT_ASSERT(light_node, 48)
#define LIGHT_LEAF 0x80000000u

#define LIGHT_POINT 0u
#define LIGHT_SPOT 1u
#define LIGHT_DIRECTIONAL 2u

struct punctual_light {
	float position[3]; // metres; unused if directional
	uint kind; // LIGHT_…
	float direction[3]; // unit, the way the light travels; unused if point
	float cos_outer; // spot: no light beyond
	float intensity[3]; // W/sr; directional: irradiance, W/m², on a plane facing it
	float cos_inner; // spot: full light within
	float keep; // alias table over the punctual lights, as in `emitter`
	uint alias;
	float pmf;
	float spread; // directional: 1 − cos of the half aperture of the disc that it shines from, 0 … 1; 0: one direction
};
LAYOUT_ASSERT(punctual_light, 64)

// ---- surroundings -----------------------------------------------------------------------------------------------------

// A picture of all directions (equirectangular): longitude grows from left to right, latitude falls from top to bottom. Its
// middle is seen along -Z, its right quarter along +X, its top row along +Y. Rows from the top.
struct environment_texel {
	float radiance[3]; // at its middle, in the file's unit; bilinear in between
	float pdf; // of each of its directions where the table below chooses one, 1/sr
};
LAYOUT_ASSERT(environment_texel, 16)

// The alias table over the texels, as in `emitter`. A texel's directions are then equally likely by solid angle.
struct environment_row {
	float keep;
	uint alias;
};
LAYOUT_ASSERT(environment_row, 8)

#endif
