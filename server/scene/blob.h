// The scene blob: everything that a technique may ask about a scene, in one flat piece of memory without pointers. A loader
// writes it into a memfd and seals it. The front passes it on without reading it. A worker maps it, checks it once, and only
// reads it from then on.
//
//   struct blob_header | section | section | …     every section starts at a multiple of BLOB_ALIGN
//
// A section is an array of one struct, here or in shaders/shared/layout.h. Numbers are those of the machine: a blob never
// leaves it. Nothing in it depends on where it is mapped. All coordinates are float metres relative to `origin` (double,
// world space), so a scene far from the world's origin keeps the precision that it has about its own middle. Any thread may
// call the functions. A blob is its mapper's.
//
// Example: `blob` of `bytes` is mapped from a loader's memfd
//	struct error err;
//	assert(blob_check(blob, bytes, &err) == STATUS_OK);
//	struct blob_view view;
//	blob_view_init(&view, blob);
//	const struct triangle *triangles = view.sections[BLOB_TRIANGLES];
//	const struct vertex *vertices = view.sections[BLOB_VERTICES];
//	for (uint32_t i = 0; i < view.counts[BLOB_TRIANGLES]; i++) {
//		const float x = vertices[triangles[i].vertex[0]].position[0];
//		assert(x >= view.bounds_min[0] && x <= view.bounds_max[0]);
//		printf("triangle %u has a corner at x = %g m\n", i, blob->origin[0] + (double)x);
//	}
#ifndef CANDIL_SCENE_BLOB_H
#define CANDIL_SCENE_BLOB_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/scene/patch_format.h"
#include "server/scene/transform.h"
#include "shaders/shared/layout.h"

#define BLOB_MAGIC 0x4C444E43424F4C42ull
#define BLOB_FORMAT 12u // rises when the bytes of a blob change their meaning
#define BLOB_ALIGN 256u // bytes
#define BLOB_COLOR_MAX 1e3f // of a component of a vertex colour
#define BLOB_LEAF_MAX 15u // triangles in a leaf: a shader keeps their number in four bits beside the first

// The sections, in the order of blob_header.sections, and the struct of each.
enum blob_section {
	BLOB_NODES, // struct bvh_node; at least one
	BLOB_LEAF_TRIANGLES, // struct leaf_triangle
	BLOB_TRIANGLES, // struct triangle, by id; as many as leaf triangles
	BLOB_VERTICES, // struct vertex
	BLOB_MATERIALS, // struct material; at least one
	BLOB_TEXTURES, // struct texture_info
	BLOB_TEXELS, // uint
	BLOB_EMITTERS, // struct emitter; none if nothing emits
	BLOB_LIGHTS, // struct punctual_light
	BLOB_CAMERAS, // struct blob_camera
	BLOB_MATERIAL_NAMES, // struct blob_name, one for each material
	BLOB_UV1, // struct vertex_uv1: none, or one for each vertex; there if a texture has TEXTURE_UV1
	BLOB_COLORS, // struct vertex_color: none, or one for each vertex; there with FACT_VERTEX_COLORS
	BLOB_TANGENTS, // struct vertex_tangent: none, or one for each vertex; there if a material that is used has a normal
		       // map
	BLOB_SCENE_NODES, // struct scene_node, parents before their children
	BLOB_ANIMATIONS, // struct scene_animation
	BLOB_CHANNELS, // struct scene_channel, those of an animation side by side
	BLOB_CURVES, // float
	BLOB_ENVIRONMENT, // struct environment_texel: none, or environment_width · environment_height
	BLOB_ENVIRONMENT_ROWS, // struct environment_row, one for each texel
	BLOB_TEXTURE_RANGES, // struct texture_range, one for each texture
	BLOB_MATERIAL_USES, // struct material_use, one for each material
	BLOB_PATCH_ELEMENTS, // struct imported_element; there with FACT_PATCHES
	BLOB_FACTOR_ROWS, // struct imported_row, one for each element; there with FACT_FACTORS
	BLOB_FACTOR_ENTRIES, // struct imported_factor, those of a row side by side
	BLOB_SECTIONS
};

// Where a section is.
struct blob_range {
	uint64_t offset; // bytes from the blob's start
	uint64_t count; // elements
};

// Facts about a scene, bits: by them a plan finds the effects that the scene calls for. What is there by name alone and
// cannot change a picture is no fact. Made by facts_collect (facts.h).
enum fact {
	FACT_TEXTURES = 1u << 0, // some texture, other than a normal map, changes what it multiplies
	FACT_EMITTERS = 1u << 1, // some triangle emits
	FACT_POINT_LIGHTS = 1u << 2,
	FACT_SPOT_LIGHTS = 1u << 3,
	FACT_DIRECTIONAL_LIGHTS = 1u << 4,
	FACT_REFLECTS = 1u << 5, // some lit surface has a lobe
	FACT_GLOSSY = 1u << 6, // some lit surface that is not all clear is metallic or has a dielectric specular lobe
	FACT_NORMAL_MAPS = 1u << 7, // some lit surface with a lobe has a normal map of a scale other than zero
	FACT_ALPHA_MASK = 1u << 8, // somewhere a mask's alpha is below its cutoff
	FACT_VERTEX_COLORS = 1u << 9, // some vertex colour changes what it multiplies
	FACT_UNLIT = 1u << 10,
	FACT_GLASS = 1u << 11, // some lit surface that is not all metal lets light through
	FACT_ALPHA_BLEND = 1u << 12, // somewhere a blended surface's alpha is below 1
	FACT_CLEARCOAT = 1u << 13, // some lit surface has a coat of a weight above zero
	FACT_ROUGH_DIFFUSE = 1u << 14, // some lit surface's diffuse part has a diffuse_roughness above zero
	FACT_SURROUNDINGS = 1u << 15, // it is an environment: a picture of all directions
	FACT_POLISHED = 1u << 16, // some lit surface reflects or transmits light nearly unspread: casters.h
	FACT_DARK_NORMAL_MAPS = 1u << 17, // some lit surface without a lobe has a normal map: AOVs show it, light does not
	FACT_VAST = 1u << 18, // some triangle is so far away, or so small beside that, that floats need care
	FACT_PATCHES = 1u << 19, // it is a file of patches: a radiosity solution of some scene
	FACT_FACTORS = 1u << 20, // it is a file of form factors of some scene
};
#define FACT_LIGHTS (FACT_POINT_LIGHTS | FACT_SPOT_LIGHTS | FACT_DIRECTIONAL_LIGHTS)

// The header, at the blob's start.
struct blob_header {
	uint64_t magic; // BLOB_MAGIC
	uint32_t format; // BLOB_FORMAT
	uint32_t header_bytes; // sizeof(struct blob_header)
	uint64_t total_bytes;
	struct blob_range sections[BLOB_SECTIONS];
	double origin[3]; // world position of the blob's zero, metres
	float bounds_min[3]; // relative to origin
	float bounds_max[3];
	uint32_t bvh_depth; // levels of nodes, ≤ LIMIT_BVH_DEPTH
	uint32_t facts; // enum fact
	float emitter_power; // of all emissive triangles, W: their pmf is their share of it; 0 if there are none
	float light_power; // of all punctual lights, W, as their alias table weighs them
	uint32_t environment_width, environment_height; // texels; 0: there is no environment
	// The environment's luminance integrated over all directions, W/m² if a texel's unit is W/(m² sr). It is the power
	// through a sphere of 1 m² cross-section.
	float environment_power;
	// How uneven the environment is: 4π ∫ p² dω of its alias table's density p. 1: even; at least 1 / (4 s) if half of
	// its light is in a share s of the sphere. 0: there is no environment.
	float environment_contrast;
	uint64_t hash[2]; // XXH3-128 of everything behind the header; also of the header with hash = 0
};

// A camera of the file, in world space: double, metres, `origin` not subtracted.
struct blob_camera {
	char name[LIMIT_NAME + 1];
	double eye[3];
	double forward[3]; // unit
	double up[3]; // unit, perpendicular to forward
	double vfov_degrees; // 0: orthographic
	double aspect; // width / height; 0: any
	double half_height; // orthographic: metres
};

// A node of the file's hierarchy. Every triangle belongs to one node, and so do the vertices that it names: a node's
// triangles have consecutive ids, and no vertex is named by triangles of two nodes.
struct scene_node {
	char name[LIMIT_NAME + 1];
	struct transform local; // to the parent's space
	struct transform world; // parent's world · local, bit for bit as transform_compose has it
	struct transform_parts parts; // of `local`, which has a shear beside them if the file gives such a matrix
	uint32_t parent; // an earlier node, or NONE
	uint32_t first_triangle, triangle_count; // by id
	uint32_t light; // of BLOB_LIGHTS, or NONE; the light stands at the node's origin and shines along -Z
	uint32_t camera; // of BLOB_CAMERAS, or NONE; placed likewise
	uint32_t reserved;
};

// An animation of the file: a run of channels.
struct scene_animation {
	char name[LIMIT_NAME + 1];
	double duration_s; // the last key of any channel
	uint32_t first_channel, channel_count;
};

// The part of a node's transform that a channel sets.
enum channel_path { CHANNEL_TRANSLATION, CHANNEL_ROTATION, CHANNEL_SCALE };

// How a channel interpolates between its keys.
enum channel_curve { CURVE_STEP, CURVE_LINEAR, CURVE_CUBIC };

// What an animation does to one part of one node (glTF 2.0, appendix C). Its floats in BLOB_CURVES are `keys` ascending
// times in seconds, then as many values of three components, or of four for a rotation (a quaternion x y z w). With
// CURVE_CUBIC each value is three: the in-tangent, the value and the out-tangent.
struct scene_channel {
	uint32_t node;
	uint32_t path; // enum channel_path
	uint32_t curve; // enum channel_curve
	uint32_t keys; // at least one
	uint32_t first; // of its floats, in BLOB_CURVES
};

// A name, ended by a zero.
struct blob_name {
	char text[LIMIT_NAME + 1];
};

// The least and the greatest code of each channel among a texture's texels, red first.
struct texture_range {
	uint8_t low[4], high[4];
};

// How triangles use a material: their number, that of those with a tangent, without which a normal map does nothing, and the
// least and the greatest of their vertex colours, which are 1 where the scene has none.
struct material_use {
	uint32_t triangles;
	uint32_t tangents;
	float color_low[4], color_high[4];
};

// Bytes of one element of a section.
size_t blob_stride(enum blob_section section);

// Check a mapped blob of `bytes` completely: the magic and the bounds of sections; that every index is in its section; that
// the BVH is a tree of at most LIMIT_BVH_DEPTH levels, whose leaves have at most BLOB_LEAF_MAX triangles and name each
// triangle once; that textures are within the texels; that nodes are a forest whose transforms compose, and animations have
// nodes; that all floats are finite; that elements and rows of form factors are as patch_format.h has them; that the facts
// are those of its ranges and sections; and that the sections by vertex exist which textures, materials and facts need. That
// the ranges are those of the texels and colours is not checked: a wrong one costs a wrong picture, and nothing else. A blob
// that passes cannot lead a reader outside of it.
// STATUS_SCENE_INVALID names the first fault; STATUS_MEMORY.
enum status blob_check(const void *blob, size_t bytes, struct error *err);

// The elements of a section of a checked blob, in the blob's memory. BVH nodes are numbered depth first (a node, its first
// child's subtree, its second child's subtree), and leaf triangles in the order of their leaves. A child that does not
// exist, as in a scene of one triangle or of none, is a point at infinity (min = max = +inf) with child 0 and count 0.
const void *blob_section(const struct blob_header *blob, enum blob_section section);

// The number of those elements.
uint32_t blob_count(const struct blob_header *blob, enum blob_section section);

// A scene as a job sees it: the sections and sums of a checked blob, some of which a request's edits may have replaced.
// `blob` has what no edit changes: the origin, the BVH's depth, the hash. Fields are as in struct blob_header.
struct blob_view {
	const struct blob_header *blob;
	const void *sections[BLOB_SECTIONS];
	uint32_t counts[BLOB_SECTIONS];
	float bounds_min[3], bounds_max[3];
	uint32_t facts;
	float emitter_power, light_power;
};

// Make the view of a checked blob without edits. The blob stays the caller's and must outlive the view.
void blob_view_init(struct blob_view *view, const struct blob_header *blob);

#endif
