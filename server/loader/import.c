#include "server/loader/import.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/text.h"
#include "server/base/checked.h"
#include "server/loader/import_parts.h"

void import_init(struct import *im, struct files *files, candil_SceneInfo *info)
{
	*im = (struct import){.files = files, .info = info, .unit = 1.0};
	key_table_init(&im->image_keys, IMPORT_IMAGE_WORDS);
	key_table_init(&im->texture_keys, IMPORT_TEXTURE_WORDS);
	key_table_init(&im->sought, KEY_TEXT_WORDS);
}

void import_finish(struct import *im)
{
	for (size_t i = 0; i < im->image_count; i++)
		free(im->images[i].key);
	free(im->vertices);
	free(im->extras);
	free(im->triangles);
	free(im->materials);
	free(im->names);
	free(im->textures);
	free(im->texels);
	free(im->lights);
	free(im->cameras);
	free(im->images);
	free(im->nodes);
	free(im->animations);
	free(im->channels);
	free(im->curves);
	free(im->environment);
	free(im->environment_rows);
	free(im->elements);
	free(im->rows);
	free(im->factors);
	key_table_finish(&im->image_keys);
	key_table_finish(&im->texture_keys);
	key_table_finish(&im->sought);
	for (size_t i = 0; i < im->found_count; i++)
		free(im->found[i]);
	free(im->found);
	*im = (struct import){0};
}

void *import_grown(void *items, size_t count, size_t more, size_t *room, size_t stride, size_t limit, const char *what,
		   struct error *err)
{
	size_t bytes;
	if (more > limit || count > limit - more) {
		error_set(err, STATUS_SCENE_LIMIT, "the scene has more than %zu %s; split it or simplify it", limit, what);
		return NULL;
	}
	if (count + more <= *room)
		return items;
	size_t wanted = *room + *room / 2 + 16;
	if (wanted < count + more)
		wanted = count + more;
	void *bigger = checked_mul(wanted, stride, &bytes) ? realloc(items, bytes) : NULL;
	if (!bigger) {
		error_set(err, STATUS_MEMORY, "no memory for %zu %s", wanted, what);
		return NULL;
	}
	*room = wanted;
	return bigger;
}

enum status import_add_vertex(struct import *im, const struct import_vertex *vertex, struct error *err)
{
	void *items = import_grown(im->vertices, im->vertex_count, 1, &im->vertex_room, sizeof *vertex, LIMIT_VERTICES,
				   "vertices", err);
	if (!items)
		return err->code;
	im->vertices = items;
	im->vertices[im->vertex_count++] = *vertex;
	return STATUS_OK;
}

enum status import_set_extra(struct import *im, const struct import_extra *extra, struct error *err)
{
	const struct import_extra none = {.color = {1, 1, 1, 1}};
	void *items = import_grown(im->extras, im->extra_count, im->vertex_count - im->extra_count, &im->extra_room,
				   sizeof *extra, LIMIT_VERTICES, "vertices", err);
	if (!items)
		return err->code;
	im->extras = items;
	while (im->extra_count + 1 < im->vertex_count)
		im->extras[im->extra_count++] = none;
	im->extras[im->vertex_count - 1] = *extra;
	im->extra_count = im->vertex_count;
	return STATUS_OK;
}

enum status import_add_triangle(struct import *im, const struct triangle *triangle, struct error *err)
{
	void *items = import_grown(im->triangles, im->triangle_count, 1, &im->triangle_room, sizeof *triangle,
				   LIMIT_TRIANGLES, "triangles", err);
	if (!items)
		return err->code;
	im->triangles = items;
	im->triangles[im->triangle_count++] = *triangle;
	if (im->node_count > 0)
		im->nodes[im->node_count - 1].triangle_end = im->triangle_count;
	return STATUS_OK;
}

// Name an element; one without a name in the file is called by its kind and number.
static void name_it(char out[LIMIT_NAME + 1], const char *name, const char *kind, size_t number)
{
	text_copy(out, LIMIT_NAME + 1, name);
	if (!out[0])
		snprintf(out, LIMIT_NAME + 1, "%s %zu", kind, number);
}

enum status import_add_material(struct import *im, const struct material *material, const char *name, struct error *err)
{
	void *items = import_grown(im->materials, im->material_count, 1, &im->material_room, sizeof *material,
				   LIMIT_MATERIALS, "materials", err);
	if (!items)
		return err->code;
	im->materials = items;
	items = import_grown(im->names, im->material_count, 1, &im->name_room, sizeof *im->names, LIMIT_MATERIALS,
			     "materials", err);
	if (!items)
		return err->code;
	im->names = items;
	memset(&im->names[im->material_count], 0, sizeof *im->names);
	name_it(im->names[im->material_count].text, name, "material", im->material_count);
	im->materials[im->material_count++] = *material;
	return STATUS_OK;
}

struct material import_plain_material(float albedo)
{
	return (struct material){.albedo = {albedo, albedo, albedo},
				 .albedo_texture = NONE,
				 .emission_texture = NONE,
				 .specular_texture = NONE,
				 .roughness = 1.0f,
				 .surface_texture = NONE,
				 .normal_texture = NONE,
				 .normal_scale = 1.0f,
				 .alpha = 1.0f,
				 .transmission_texture = NONE,
				 .specular_weight_texture = NONE,
				 .ior = 1.5f,
				 .coat_texture = NONE,
				 .coat_roughness_texture = NONE,
				 .coat_normal_texture = NONE,
				 .coat_normal_scale = 1.0f};
}

uint32_t import_tangent_map(const struct material *m)
{
	return m->normal_texture != NONE ? m->normal_texture : m->coat_normal_texture;
}

enum status import_add_light(struct import *im, const struct import_light *light, struct error *err)
{
	void *items = import_grown(im->lights, im->light_count, 1, &im->light_room, sizeof *light, LIMIT_PUNCTUAL_LIGHTS,
				   "lights", err);
	if (!items)
		return err->code;
	im->lights = items;
	if (im->node_count > 0)
		im->nodes[im->node_count - 1].node.light = (uint32_t)im->light_count;
	im->lights[im->light_count++] = *light;
	return STATUS_OK;
}

enum status import_add_camera(struct import *im, const struct blob_camera *camera, struct error *err)
{
	void *items =
	    import_grown(im->cameras, im->camera_count, 1, &im->camera_room, sizeof *camera, LIMIT_CAMERAS, "cameras", err);
	if (!items)
		return err->code;
	im->cameras = items;
	if (im->node_count > 0)
		im->nodes[im->node_count - 1].node.camera = (uint32_t)im->camera_count;
	im->cameras[im->camera_count++] = *camera;
	return STATUS_OK;
}

enum status import_add_node(struct import *im, const char *name, const struct transform *local,
			    const struct transform_parts *parts, uint32_t parent, struct error *err)
{
	void *items =
	    import_grown(im->nodes, im->node_count, 1, &im->node_room, sizeof *im->nodes, LIMIT_NODES, "nodes", err);
	if (!items)
		return err->code;
	im->nodes = items;
	struct import_node *n = &im->nodes[im->node_count];
	memset(n, 0, sizeof *n);
	name_it(n->node.name, name, "node", im->node_count);
	n->node.local = *local;
	n->node.parts = *parts;
	n->node.parent = parent;
	n->node.light = n->node.camera = NONE;
	n->triangle_end = im->triangle_count;
	im->node_count++;
	return STATUS_OK;
}

enum status import_add_animation(struct import *im, const char *name, struct error *err)
{
	void *items = import_grown(im->animations, im->animation_count, 1, &im->animation_room, sizeof *im->animations,
				   LIMIT_ANIMATIONS, "animations", err);
	if (!items)
		return err->code;
	im->animations = items;
	struct scene_animation *a = &im->animations[im->animation_count];
	memset(a, 0, sizeof *a);
	name_it(a->name, name, "animation", im->animation_count);
	a->first_channel = (uint32_t)im->channel_count;
	im->animation_count++;
	return STATUS_OK;
}

enum status import_add_channel(struct import *im, const struct scene_channel *channel, const float *times,
			       const float *values, struct error *err)
{
	const size_t width = channel->path == CHANNEL_ROTATION ? 4 : 3, per_key = channel->curve == CURVE_CUBIC ? 3 : 1;
	const size_t count = channel->keys * width * per_key; // below 2^36
	void *items = import_grown(im->channels, im->channel_count, 1, &im->channel_room, sizeof *channel, LIMIT_CHANNELS,
				   "channels of animations", err);
	if (!items)
		return err->code;
	im->channels = items;
	items = import_grown(im->curves, im->curve_count, channel->keys + count, &im->curve_room, sizeof *im->curves,
			     LIMIT_CURVE_FLOATS, "numbers in its animations", err);
	if (!items)
		return err->code;
	im->curves = items;
	im->channels[im->channel_count] = *channel;
	im->channels[im->channel_count++].first = (uint32_t)im->curve_count;
	memcpy(im->curves + im->curve_count, times, channel->keys * sizeof *times);
	memcpy(im->curves + im->curve_count + channel->keys, values, count * sizeof *values);
	im->curve_count += channel->keys + count;
	struct scene_animation *a = &im->animations[im->animation_count - 1];
	a->channel_count++;
	a->duration_s = fmax(a->duration_s, (double)times[channel->keys - 1]);
	return STATUS_OK;
}

_Static_assert(LIMIT_WARNINGS <= 32 &&
		   sizeof((candil_SceneInfo){0}.ignored) / sizeof((candil_SceneInfo){0}.ignored[0]) <= 32,
	       "each has a bit of struct scene_remarks");

// Add a sentence unless it is there. Returns its place, or LIMIT_WARNINGS.
__attribute__((format(printf, 2, 0))) static pb_size_t add_warning(struct import *im, const char *format, va_list args)
{
	char text[sizeof im->info->warnings[0] * 2];
	vsnprintf(text, sizeof text, format, args);
	char clean[sizeof im->info->warnings[0]];
	text_copy(clean, sizeof clean, text);
	for (pb_size_t i = 0; i < im->info->warnings_count; i++)
		if (strcmp(im->info->warnings[i], clean) == 0)
			return i;
	if (im->info->warnings_count == LIMIT_WARNINGS) {
		im->info->warnings_more++;
		return LIMIT_WARNINGS;
	}
	memcpy(im->info->warnings[im->info->warnings_count], clean, sizeof clean);
	return im->info->warnings_count++;
}

void import_warn(struct import *im, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	add_warning(im, format, args);
	va_end(args);
}

void import_remark(struct import *im, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	const pb_size_t at = add_warning(im, format, args);
	va_end(args);
	if (at < LIMIT_WARNINGS)
		im->remarks.warnings |= 1u << at;
}

// Add a feature unless it is there. Returns its place, or the number of places.
static pb_size_t add_ignored(struct import *im, const char *feature)
{
	char text[sizeof im->info->ignored[0]];
	const pb_size_t room = sizeof im->info->ignored / sizeof im->info->ignored[0];
	text_copy(text, sizeof text, feature);
	for (pb_size_t i = 0; i < im->info->ignored_count; i++)
		if (strcmp(im->info->ignored[i], text) == 0)
			return i;
	if (im->info->ignored_count == room)
		return room;
	memcpy(im->info->ignored[im->info->ignored_count], text, sizeof text);
	return im->info->ignored_count++;
}

void import_ignore(struct import *im, const char *feature)
{
	add_ignored(im, feature);
}

void import_pass_over(struct import *im, const char *feature)
{
	const pb_size_t at = add_ignored(im, feature);
	if (at < sizeof im->info->ignored / sizeof im->info->ignored[0])
		im->remarks.ignored |= 1u << at;
}

void import_note_source(struct import *im, const double min[3], const double max[3])
{
	double reach = 0, extent = 0;
	for (int i = 0; i < 3; i++) {
		reach = fmax(reach, fmax(fabs(min[i]), fabs(max[i])));
		extent = fmax(extent, max[i] - min[i]);
	}
	if (!isfinite(reach) || !(extent > 0))
		return;
	if (im->source_extent == 0 || reach / extent > im->source_reach / im->source_extent) {
		im->source_reach = reach;
		im->source_extent = extent;
	}
}

bool import_fit(float *value, double given, double limit)
{
	*value = given > 0 ? (float)fmin(given, limit) : 0.0f;
	return given >= 0 && given <= limit;
}
