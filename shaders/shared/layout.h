// Structures that C and GLSL share: the sections of a scene blob are what shaders read. They consist of 4-byte scalars and
// arrays of them, so that C's layout and std430's agree. The asserts below check C's; std430 leaves GLSL no choice.
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

// A corner. `normal` is of unit length, or zero if the file gives none: then the triangle's geometric normal holds.
struct vertex {
	float position[3];
	float normal[3];
	float uv[2];
};
LAYOUT_ASSERT(vertex, 32)

// Indexed by triangle id, in the order of the file.
struct triangle {
	uint vertex[3];
	uint material;
};
LAYOUT_ASSERT(triangle, 16)

// An inner node of a binary BVH: the boxes of both children and references to them. Node 0 is the root. In a scene of a
// single leaf the root still exists, and its second child is a point at infinity (min = max = +inf), which every ray
// misses. count[i] == 0: child[i] is a node. Otherwise the child is the leaf of triangles child[i] … child[i] + count[i] -
// 1.
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

// A triangle in leaf order, ready for intersection. Its corners equal those of `vertex` bit for bit, so that neighbours
// share exactly the same edge.
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

#define MATERIAL_EMITS_BOTH_SIDES 1u // both sides emit (glTF doubleSided); otherwise only the front (counter-clockwise)
#define MATERIAL_ALPHA_MASK 2u // absent where alpha is below alpha_cutoff
#define MATERIAL_UNLIT 4u // shows its base colour as radiance; neither receives nor casts light
#define MATERIAL_ALPHA_BLEND 8u // present with probability alpha
#define MATERIAL_THIN 16u // with transmission: a sheet without an interior, which does not bend light
#define MATERIAL_PRIORITY_SHIFT 8u // a clear body's priority, 0…LIMIT_PRIORITY; where bodies overlap, the highest wins

#define GGX_ALPHA_LEAST 1e-4 // microfacets with an α below it are a perfect mirror

// Base colour, metallic and roughness as in glTF 2.0 (appendix B), with KHR_materials_specular for the dielectric part.
// Colours are linear Rec.709, 0…1. A texture is an index or NONE, and multiplies the factor beside it.
struct material {
	float albedo[3]; // base colour: diffuse albedo, or reflectance of a metal at normal incidence
	uint albedo_texture; // its alpha is used by MATERIAL_ALPHA_MASK and _BLEND
	float emission[3]; // radiance, W/(m² sr)
	uint emission_texture;
	float specular[3]; // reflectance of the dielectric part at normal incidence
	uint specular_texture; // colour
	float specular_weight; // its reflectance at grazing incidence; 0 with specular 0: pure Lambert, no specular lobe
	uint specular_weight_texture; // alpha; multiplies `specular` too
	float metallic;
	float roughness; // perceptual: the microfacets' α is its square; 0: a perfect mirror
	uint surface_texture; // green: roughness, blue: metallic
	uint normal_texture; // tangent space, +Z out
	float normal_scale; // scale of the map's X and Y
	float alpha_cutoff; // cutoff divided by the base colour's alpha factor
	uint flags; // MATERIAL_…
	float power_density; // π · mean luminance of the emission · emitting sides, W/m²: weight in the choice of emitters
	float alpha; // alpha factor of the base colour, with MATERIAL_ALPHA_BLEND
	// The share `transmission` of the non-metallic part is a clear dielectric boundary in place of the opaque surface:
	// it reflects by Fresnel's equations and transmits the rest times the base colour.
	float transmission; // 0…1
	uint transmission_texture; // red
	float ior; // index of refraction behind the surface, or of a thin sheet
	float absorption[3]; // of the interior, 1/m: transmittance is exp(-absorption · distance)
	float diffuse_roughness; // Oren and Nayar's roughness of the diffuse part, 0…1: common/diffuse.glsl; 0: Lambert
	// A clear coat over all lobes except clear boundaries: common/coat.glsl.
	float coat; // its weight, 0…1
	float coat_roughness; // perceptual
	uint coat_texture; // red
	uint coat_roughness_texture; // green
	uint coat_normal_texture; // as normal_texture; NONE: the mesh's own normal
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
#define TEXTURE_UV1 (1u << 6) // uses the second set of texture coordinates
#define TEXTURE_DEEP (1u << 7) // texels have 16 bits a channel

// RGBA texels, row by row from the top, starting at texels[offset]. A texel is one uint of 8 bits a channel, R in the low
// byte; of a deep texture two, R in the low half of the first and B in that of the second. Textures that differ only in
// sampler, coordinate set or transform share texels.
struct texture_info {
	uint offset;
	uint width;
	uint height;
	uint flags;
	float row_u[3]; // KHR_texture_transform: the texture is read at u' = row_u · (u, v, 1), v' = row_v · (u, v, 1)
	float row_v[3];
};
LAYOUT_ASSERT(texture_info, 40)

// The following three have one element a vertex if the scene uses them; otherwise their sections are empty.
struct vertex_uv1 {
	float uv[2];
};
LAYOUT_ASSERT(vertex_uv1, 8)

// COLOR_0, linear. It multiplies the base colour and its alpha. (1, 1, 1, 1) for vertices without a colour.
struct vertex_color {
	float rgba[4];
};
LAYOUT_ASSERT(vertex_color, 16)

// World-space tangent, unit, and the bitangent's sign (-1 or 1): bitangent = sign · cross(normal, tangent). All zero: no
// tangent.
struct vertex_tangent {
	float xyzw[4];
};
LAYOUT_ASSERT(vertex_tangent, 16)

// ---- lights -----------------------------------------------------------------------------------------------------------

// A row of an alias table (Walker 1977, Vose 1991): pick row i uniformly, keep it with probability `keep`, otherwise take
// row `alias`. `pmf` is the total probability of this entry.
struct emitter {
	uint triangle; // triangle id
	float keep;
	uint alias;
	float pmf; // proportional to area · power_density
};
LAYOUT_ASSERT(emitter, 16)

// The cells of an emitter: server/scene/emitter_cells.h.
struct emitter_grid {
	uint first; // of its cells
	uint level; // it has 4^level
	float share; // mean of their densities: its light per area over its material's mean
};
LAYOUT_ASSERT(emitter_grid, 12)

// A row of the alias table over a triangle's cells, as in `emitter`.
struct emitter_cell {
	float keep;
	uint alias; // relative to the grid's first
	float density; // of a place in it, over that of a place chosen by the material's mean emission; its mean is `share`
};
LAYOUT_ASSERT(emitter_cell, 12)

// A node of the light tree: server/scene/light_tree.h. Its children are `child` and `child` + 1. In a leaf, `child` is
// LIGHT_LEAF plus the lamp's number: in the job, emitters come first, then lights.
struct light_node {
	float min[3]; // metres; above `max`: the node holds directional lights
	float power; // π times the maximum that all lamps of the node emit together, W/sr; of directional lights W/m²
	float max[3];
	float cos_spread; // cosine of the angle about `axis` that contains all normals, or directions of light, of the node
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
	float direction[3]; // unit, direction in which the light travels; unused if point
	float outer; // spot: 1 − cos of the angle outside which is no light, 0 … 1
	float intensity[3]; // W/sr; directional: irradiance on a plane facing it, W/m²
	float inner; // spot: 1 − cos of the angle inside which is full light, 0 … 1
	float keep; // alias table over the punctual lights, as in `emitter`
	uint alias;
	float pmf;
	float spread; // directional: 1 − cos of the half aperture of its disc, 0 … 1; 0: a single direction
	float range; // point and spot: metres; no light reaches further; 0: no bound
};
LAYOUT_ASSERT(punctual_light, 68)

// ---- surroundings -----------------------------------------------------------------------------------------------------

// An equirectangular environment map: longitude grows from left to right, latitude falls from top to bottom. Its middle is
// in the direction -Z, the middle of its right half +X, its top row +Y. Rows run from the top.
struct environment_texel {
	float radiance[3]; // at the texel's middle, in the file's unit; interpolated bilinearly
	float pdf; // density of each direction in it when the table below chooses it, 1/sr
};
LAYOUT_ASSERT(environment_texel, 16)

// The alias table over the texels, as in `emitter`. Within a texel, directions are uniform by solid angle.
struct environment_row {
	float keep;
	uint alias;
};
LAYOUT_ASSERT(environment_row, 8)

#endif
