// What an importer finds in a file, before it becomes a blob: growable arrays in world space, every element checked against
// its limit when it is added. glTF and OBJ importers fill it; build_blob.c reads it. One thread.
#ifndef CANDIL_LOADER_IMPORT_H
#define CANDIL_LOADER_IMPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "candil.pb.h"
#include "server/base/error.h"
#include "server/loader/files.h"
#include "server/scene/blob.h"

// A corner in world space. Positions stay double until the blob's origin is known. They may be anything here, NaN included;
// the builder drops the triangles that use such.
struct import_vertex {
	double position[3];
	float normal[3]; // any length; zero or not finite: the triangle's own
	float uv[2];
};

// What only some vertices have.
struct import_extra {
	float uv1[2]; // finite or not
	float color[4]; // 0 … BLOB_COLOR_MAX
	float tangent[4]; // world space, any length; the sign is -1 or 1, or 0 where there is no tangent
};

struct import_light {
	struct punctual_light light; // all but position and table
	double position[3];
};

// A node of the file's hierarchy: what it owns is what was added between it and the next one.
struct import_node {
	struct scene_node node; // all but world and triangles; `light` counts import_add_light
	size_t triangle_end; // triangles up to here are its own, those of the nodes before it apart
};

// One decoded image: where its texels are. Images are known by a key so that each is decoded once.
struct import_image {
	char *key;
	uint32_t offset;
	uint32_t width; // 0: it could not be read
	uint32_t height;
};

struct import {
	struct files *files;
	candil_SceneInfo *info; // counts, warnings and ignored features go here
	double unit; // metres per unit, OBJ only
	bool z_up; // OBJ only

	struct import_vertex *vertices;
	struct import_extra *extras; // of the first `extra_count` vertices; those behind have none
	struct triangle *triangles;
	struct material *materials; // power_density is the builder's
	struct blob_name *names; // one a material
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
	float environment_power; // as in struct blob_header
	float environment_contrast;
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

	double source_reach; // of the vertices least precise in the file: largest |coordinate| …
	double source_extent; // … and how far they span; 0: nothing noted
};

void import_init(struct import *import, struct files *files, candil_SceneInfo *info);
void import_finish(struct import *import);

// Each adds one element; STATUS_SCENE_LIMIT past the limit of its kind, STATUS_MEMORY. *index may be NULL.
enum status import_add_vertex(struct import *import, const struct import_vertex *vertex, struct error *err);
// The extra of the vertex added last. Vertices before it that were given none get a white colour and nothing else.
enum status import_set_extra(struct import *import, const struct import_extra *extra, struct error *err);

enum status import_add_triangle(struct import *import, const struct triangle *triangle, struct error *err);
enum status import_add_material(struct import *import, const struct material *material, const char *name, struct error *err);
// A Lambert surface of that albedo, without textures, emission or flags.
struct material import_plain_material(float albedo);

// The texture that a material's tangents are for, or NONE: its normal map, else its coat's.
uint32_t import_tangent_map(const struct material *material);

enum status import_add_light(struct import *import, const struct import_light *light, struct error *err);
enum status import_add_camera(struct import *import, const struct blob_camera *camera, struct error *err);

// Every triangle, light and camera belongs to the node that was added last: add one before them. Its name is cleaned here;
// one without is called "node" and its number. `parent` is an earlier node or NONE.
enum status import_add_node(struct import *import, const char *name, const struct transform *local,
			    const struct transform_parts *parts, uint32_t parent, struct error *err);

// The channels added from here on are this animation's.
enum status import_add_animation(struct import *import, const char *name, struct error *err);
// `values` holds, of each key, what struct scene_channel says; all finite, times ascending.
enum status import_add_channel(struct import *import, const struct scene_channel *channel, const float *times,
			       const float *values, struct error *err);

// How a texture is looked up: the wrap, filter and space flags of texture_info, and its transform.
struct import_sampling {
	uint32_t flags;
	float row_u[3], row_v[3];
};

// No transform.
struct import_sampling import_plain_sampling(uint32_t flags);

// A texture over an image already decoded under `key`, or over encoded bytes decoded now (png, jpeg, and with `any_format`
// tga, bmp, tiff too). *texture becomes its index, or NONE with a warning and a count where the image cannot be read;
// only a limit or memory fails. bytes NULL: the file is missing, `why` says so.
enum status import_texture(struct import *import, const char *key, const uint8_t *bytes, size_t size, bool any_format,
			   const struct import_sampling *sampling, uint32_t *texture, struct error *err);
// A texture over texels of the caller's, as an image of that key; width and height 1 … LIMIT_TEXTURE_SIDE.
enum status import_texture_of(struct import *import, const char *key, const uint32_t *texels, uint32_t width,
			      uint32_t height, const struct import_sampling *sampling, uint32_t *texture, struct error *err);

bool import_knows_image(const struct import *import, const char *key);
enum status import_missing_image(struct import *import, const char *key, const char *why, struct error *err);

// A sentence for `describe`, once. The 33rd and later are only counted.
void import_warn(struct import *import, const char *format, ...) __attribute__((format(printf, 2, 3)));

// A feature of the file that the renderer leaves out, by name, once.
void import_ignore(struct import *import, const char *feature);

// Note the bounds of positions as the file itself writes them, before any transform: far from zero they are coarse.
void import_note_source(struct import *import, const double min[3], const double max[3]);

// A colour component made fit: NaN and negatives become 0, values above `limit` become it. True if it was fit already.
bool import_fit(float *value, double given, double limit);

#endif
