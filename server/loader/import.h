// What an importer collects from a file before it becomes a blob: growable arrays in world space. Every element is checked
// against its limit when it is added. The importers of glTF and OBJ fill it in; build_blob.c reads it. One thread.
#ifndef CANDIL_LOADER_IMPORT_H
#define CANDIL_LOADER_IMPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "candil.pb.h"
#include "server/base/error.h"
#include "server/base/remarks.h"
#include "server/loader/files.h"
#include "server/loader/image_read.h"
#include "server/loader/key_table.h"
#include "server/scene/blob.h"

// A vertex in world space, metres. Positions are doubles until the blob's origin is known. They may have any value here,
// NaN included; the builder drops triangles with such vertices.
struct import_vertex {
	double position[3];
	float normal[3]; // any length; zero or not finite: use the triangle's normal
	float uv[2];
};

// Attributes that only some vertices have.
struct import_extra {
	float uv1[2]; // second set of texture coordinates, finite or not
	float color[4]; // 0 … BLOB_COLOR_MAX
	float tangent[4]; // world space, any length; the sign is -1 or 1, or 0 if there is no tangent
};

struct import_light {
	struct punctual_light light; // everything except position and alias table
	double position[3];
};

// A node of the file's hierarchy. It owns what is added between it and the next node.
struct import_node {
	struct scene_node node; // everything except world and triangles; `light` counts calls of import_add_light
	size_t triangle_end; // its triangles end here; they start where those of the previous node end
};

// A decoded image and the place of its texels. Each image has a key, so that it is decoded only once.
struct import_image {
	char *key;
	bool derived; // made of another image, whose key it has; not a file's own
	bool deep; // its texels are TEXTURE_DEEP
	uint32_t offset;
	uint32_t width; // 0: the image could not be read
	uint32_t height;
	int has_alpha; // whether an alpha is below 1: -1 no, 1 yes, 0 nobody has looked yet
	int has_normals; // whether it looks like a normal map; the same
};

struct import {
	struct files *files;
	candil_SceneInfo *info; // receives counts, warnings and ignored features
	struct scene_remarks remarks; // those of them that leave pictures as they are
	double unit; // metres per unit of length, OBJ only
	bool z_up; // OBJ only
	const struct image_decoder *decoder; // NULL: there is none
	bool wants_decoder; // it failed for that reason alone

	struct import_vertex *vertices;
	struct import_extra *extras; // for the first `extra_count` vertices; later ones have none
	struct triangle *triangles;
	struct material *materials; // the builder fills in power_density
	struct blob_name *names; // one for each material
	struct texture_info *textures;
	uint32_t *texels;
	struct import_light *lights;
	struct blob_camera *cameras;
	struct import_image *images;
	struct import_node *nodes;
	struct scene_animation *animations;
	struct scene_channel *channels;
	float *curves;
	struct environment_texel *environment; // environment_width · environment_height, or NULL
	struct environment_row *environment_rows; // as many
	uint32_t environment_width, environment_height;
	float environment_power; // this and the next as in struct blob_header
	float environment_contrast;
	struct imported_element *elements; // of a file of patches
	struct imported_row *rows; // of a file of form factors
	struct imported_factor *factors;
	size_t element_count, row_count, factor_count;
	size_t vertex_count, vertex_room;
	size_t extra_count, extra_room;
	size_t triangle_count, triangle_room;
	size_t material_count, material_room, name_room;
	size_t texture_count, texture_room;
	size_t texel_count, texel_room;
	size_t light_count, light_room;
	size_t camera_count, camera_room;
	size_t image_count, image_room;
	size_t node_count, node_room;
	size_t animation_count, animation_room;
	size_t channel_count, channel_room;
	size_t curve_count, curve_room;
	struct key_table image_keys; // of the images, by key and whether derived
	struct key_table texture_keys; // of the textures, by the number of their image and their sampling
	size_t encoded_bytes; // of the images that were decoded
	size_t wasted_texels; // of those whose pixels could not be read
	struct key_table sought; // files of maps, by their names where they were looked for
	char **found; // for each of them, the name by which it was found
	size_t found_count, found_room;

	double source_reach; // of the positions stored least precisely in the file: largest |coordinate|
	double source_extent; // and the extent that they span; 0: nothing noted
};

// Start an empty import. `files` and `info` remain the caller's and must outlive it. import_finish frees the rest.
void import_init(struct import *import, struct files *files, candil_SceneInfo *info);
void import_finish(struct import *import);

// The functions below add one element each, copying what they are given. STATUS_SCENE_LIMIT beyond the limit of its kind,
// STATUS_MEMORY.
enum status import_add_vertex(struct import *import, const struct import_vertex *vertex, struct error *err);
// Set the extra of the vertex added last. Earlier vertices without one get a white colour and nothing else.
enum status import_set_extra(struct import *import, const struct import_extra *extra, struct error *err);

enum status import_add_triangle(struct import *import, const struct triangle *triangle, struct error *err);
enum status import_add_material(struct import *import, const struct material *material, const char *name, struct error *err);
// A Lambertian surface of this albedo, without textures, emission or flags.
struct material import_plain_material(float albedo);

// The texture for which a material needs tangents: its normal map, else its coat's, else NONE.
uint32_t import_tangent_map(const struct material *material);

enum status import_add_light(struct import *import, const struct import_light *light, struct error *err);
enum status import_add_camera(struct import *import, const struct blob_camera *camera, struct error *err);

// Add a node. Every triangle, light and camera belongs to the node added last, so add a node before them. The name is
// cleaned; a node without one is called "node" and its number. `parent` is an earlier node or NONE.
enum status import_add_node(struct import *import, const char *name, const struct transform *local,
			    const struct transform_parts *parts, uint32_t parent, struct error *err);

// Add an animation. Channels added from now on belong to it.
enum status import_add_animation(struct import *import, const char *name, struct error *err);
// Add a channel. `times`, in seconds and ascending, has channel->keys elements. `values` has for each key what struct
// scene_channel describes. All must be finite.
enum status import_add_channel(struct import *import, const struct scene_channel *channel, const float *times,
			       const float *values, struct error *err);

// Textures keep 16 bits a channel where they have them and LIMIT_TEXELS leaves room; a warning tells where it does not.
// Making a texture may therefore round others and move their texels, but not their numbers.

// How a texture is sampled: wrap, filter and colour space as flags of texture_info, and its transform.
struct import_sampling {
	uint32_t flags;
	float row_u[3], row_v[3];
};

// A sampling without a transform.
struct import_sampling import_plain_sampling(uint32_t flags);

// Make a texture of the image `key`. If no image has this key yet, decode one from the encoded bytes (png, jpeg, and with
// `any_format` tga, bmp, tiff too). *texture becomes its index. If the image cannot be read, *texture is NONE, and there is
// a warning and a count. Fails only as import_expect_images does, and with STATUS_SCENE_LIMIT and STATUS_MEMORY.
enum status import_texture(struct import *import, const char *key, const uint8_t *bytes, size_t size, bool any_format,
			   const struct import_sampling *sampling, uint32_t *texture, struct error *err);
// Make a texture of what was derived from the image `key`, such as the normals of a bump map. If nothing was derived from it
// yet, take the caller's texels, 1 … LIMIT_TEXTURE_SIDE a side, of two words each if `deep`; else they may be NULL.
// STATUS_SCENE_LIMIT, STATUS_MEMORY.
enum status import_derived_texture(struct import *import, const char *key, const uint32_t *texels, uint32_t width,
				   uint32_t height, bool deep, const struct import_sampling *sampling, uint32_t *texture,
				   struct error *err);

// Tell that images are to be read. As early as that is known, for without a decoder it fails: STATUS_SCENE_UNSUPPORTED, and
// wants_decoder is set.
enum status import_expect_images(struct import *import, struct error *err);

// Whether an image with this key exists, readable or not.
bool import_knows_image(const struct import *import, const char *key);
// Whether something was derived from the image with this key.
bool import_knows_derived(const struct import *import, const char *key);
// The image that a texture shows.
struct import_image *import_image_of(struct import *import, uint32_t texture);
// Note, with a warning, that the image `key` cannot be read because of `why`. STATUS_SCENE_LIMIT, STATUS_MEMORY.
enum status import_missing_image(struct import *import, const char *key, const char *why, struct error *err);

// Add a sentence for `describe`, unless it is already there. Beyond LIMIT_WARNINGS, sentences are only counted.
void import_warn(struct import *import, const char *format, ...) __attribute__((format(printf, 2, 3)));

// The same of what leaves pictures as they are, which replies to renders pass over.
void import_remark(struct import *import, const char *format, ...) __attribute__((format(printf, 2, 3)));

// Note by name a feature of the file that the renderer ignores, unless it is already noted.
void import_ignore(struct import *import, const char *feature);

// The same of a feature that no picture of this kind would show.
void import_pass_over(struct import *import, const char *feature);

// Note the bounds of positions as the file itself stores them, before any transform: far from zero, the file's floats are
// coarse.
void import_note_source(struct import *import, const double min[3], const double max[3]);

// Clamp a colour component: NaN and negative values become 0, values above `limit` become `limit`. True if nothing had to
// be clamped.
bool import_fit(float *value, double given, double limit);

#endif
