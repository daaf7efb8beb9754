#include "server/worker/scenes/resident.h"

#include <math.h>
#include <pb_encode.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <xxhash.h>

#include "ggx_table.h"
#include "protocol/limits.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/memfd.h"

static const enum blob_section section_of[BIND_SCENE_COUNT] = {
    [BIND_NODES] = BLOB_NODES,
    [BIND_LEAF_TRIANGLES] = BLOB_LEAF_TRIANGLES,
    [BIND_TRIANGLES] = BLOB_TRIANGLES,
    [BIND_VERTICES] = BLOB_VERTICES,
    [BIND_MATERIALS] = BLOB_MATERIALS,
    [BIND_TEXTURES] = BLOB_TEXTURES,
    [BIND_TEXELS] = BLOB_TEXELS,
    [BIND_EMITTERS] = BLOB_EMITTERS,
    [BIND_LIGHTS] = BLOB_LIGHTS,
    [BIND_UV1] = BLOB_UV1,
    [BIND_COLORS] = BLOB_COLORS,
    [BIND_TANGENTS] = BLOB_TANGENTS,
    // Tables of the worker's own: no section.
    [BIND_SRGB_TABLE] = BLOB_SECTIONS,
    [BIND_GGX_TABLE] = BLOB_SECTIONS,
};

enum status resident_add(struct resident_scenes *scenes, uint64_t id, int fd, struct error *err)
{
	struct resident_scene *s = calloc(1, sizeof *s);
	if (!s) {
		close(fd);
		return error_set(err, STATUS_MEMORY, "out of memory");
	}
	s->id = id;
	s->fd = fd;
	s->next = scenes->first;
	scenes->first = s;
	return STATUS_OK;
}

static void leave_device(struct resident_scene *scene, struct device *device)
{
	while (scene->derived) {
		struct derived *d = scene->derived;
		scene->derived = d->next;
		d->destroy(d);
	}
	for (unsigned i = 0; i < BIND_SCENE_COUNT; i++)
		buffer_finish(&scene->buffers[i], device);
}

static void unlink_scene(struct resident_scenes *scenes, const struct resident_scene *scene)
{
	struct resident_scene **at = &scenes->first;
	while (*at != scene)
		at = &(*at)->next;
	*at = scene->next;
}

static void destroy_one(struct resident_scenes *scenes, struct resident_scene *scene)
{
	unlink_scene(scenes, scene);
	leave_device(scene, scenes->device);
	edited_finish(&scene->edited);
	free(scene->edits);
	if (!scene->base && scene->blob)
		munmap((void *)(uintptr_t)scene->blob, scene->bytes);
	if (!scene->base)
		close(scene->fd);
	free(scene);
}

static struct resident_scene *first_variant(const struct resident_scenes *scenes, const struct resident_scene *base)
{
	struct resident_scene *s = scenes->first;
	while (s && s->base != base)
		s = s->next;
	return s;
}

// Destroy a scene and its variants. It has no jobs, so neither have they.
static void scene_destroy(struct resident_scenes *scenes, struct resident_scene *scene)
{
	struct resident_scene *variant;
	while (!scene->base && (variant = first_variant(scenes, scene)))
		destroy_one(scenes, variant);
	destroy_one(scenes, scene);
}

static bool is_on_device(const struct resident_scene *scene)
{
	if (scene->derived)
		return true;
	for (unsigned i = 0; i < BIND_SCENE_COUNT; i++)
		if (scene->buffers[i].handle)
			return true;
	return false;
}

static bool trim_derived(const struct resident_scenes *scenes)
{
	bool any = false;
	for (const struct resident_scene *s = scenes->first; s; s = s->next)
		for (struct derived *d = s->derived; d; d = d->next)
			any |= d->trim && d->trim(d);
	return any;
}

bool resident_evict(struct resident_scenes *scenes)
{
	struct resident_scene *oldest = NULL;
	for (struct resident_scene *s = scenes->first; s; s = s->next)
		if (s->jobs == 0 && is_on_device(s) && (!oldest || s->used < oldest->used))
			oldest = s;
	if (!oldest)
		return trim_derived(scenes);
	log_line(LOG_INFO, "scene %llu%s makes room", (unsigned long long)oldest->id, oldest->base ? ", edited," : "");
	if (oldest->base) {
		scene_destroy(scenes, oldest);
		return true;
	}
	leave_device(oldest, scenes->device);
	return true;
}

uint64_t resident_idle_bytes(const struct resident_scenes *scenes)
{
	uint64_t bytes = 0;
	for (const struct resident_scene *s = scenes->first; s; s = s->next) {
		for (const struct derived *d = s->derived; d; d = d->next)
			bytes += d->bytes && (s->jobs == 0 || d->trim) ? d->bytes(d) : 0;
		for (unsigned i = 0; s->jobs == 0 && i < BIND_SCENE_COUNT; i++)
			bytes += s->buffers[i].allocated;
	}
	return bytes;
}

static struct resident_scene *scene_find(const struct resident_scenes *scenes, uint64_t id)
{
	struct resident_scene *s = scenes->first;
	while (s && (s->base || s->id != id))
		s = s->next;
	return s;
}

void resident_forget(struct resident_scenes *scenes, uint64_t id)
{
	struct resident_scene *s = scene_find(scenes, id);
	if (!s)
		return;
	s->forgotten = true;
	if (s->jobs == 0)
		scene_destroy(scenes, s);
}

static enum status map_blob(struct resident_scene *s, struct error *err)
{
	const void *map;
	size_t bytes;
	if (s->blob)
		return STATUS_OK;
	enum status r = memfd_map_sealed(s->fd, &map, &bytes, err);
	if (r != STATUS_OK)
		return r;
	r = blob_check(map, bytes, err);
	if (r != STATUS_OK) {
		munmap((void *)(uintptr_t)map, bytes);
		return r;
	}
	s->blob = map;
	s->bytes = bytes;
	blob_view_init(&s->view, map);
	s->keys = edit_keys(&s->view);
	return STATUS_OK;
}

// ---- variants -----------------------------------------------------------------------------------------------------------

// Encode edits, so that equal ones are found by their bytes. *bytes NULL and *count 0: they change nothing.
static enum status encode(const candil_Edits *edits, uint8_t **bytes, size_t *count, struct error *err)
{
	*bytes = NULL;
	*count = 0;
	if (!edits || !pb_get_encoded_size(count, candil_Edits_fields, edits) || *count == 0)
		return STATUS_OK;
	*bytes = malloc(*count);
	if (!*bytes)
		return error_set(err, STATUS_MEMORY, "no memory for an edit");
	pb_ostream_t stream = pb_ostream_from_buffer(*bytes, *count);
	if (pb_encode(&stream, candil_Edits_fields, edits))
		return STATUS_OK;
	free(*bytes);
	*bytes = NULL;
	return error_set(err, STATUS_INTERNAL, "edits cannot be encoded: %s", PB_GET_ERROR(&stream));
}

static struct resident_scene *find_variant(const struct resident_scenes *scenes, const struct resident_scene *base,
					   const uint8_t *edits, size_t bytes)
{
	for (struct resident_scene *s = scenes->first; s; s = s->next)
		if (s->base == base && s->edit_bytes == bytes && memcmp(s->edits, edits, bytes) == 0)
			return s;
	return NULL;
}

// Make a variant. Takes `bytes`, on failure too.
static enum status add_variant(struct resident_scenes *scenes, struct resident_scene *base, const candil_Edits *edits,
			       uint8_t *bytes, size_t count, struct resident_scene **out, struct error *err)
{
	const uint64_t start = clock_us();
	struct resident_scene *s = calloc(1, sizeof *s);
	enum status r = s ? edit_apply(&base->view, edits, &s->edited, err) : error_set(err, STATUS_MEMORY, "out of memory");
	if (r != STATUS_OK) {
		free(bytes);
		free(s);
		return r;
	}
	s->id = base->id;
	s->fd = -1;
	s->blob = base->blob;
	s->bytes = base->bytes;
	s->base = base;
	s->view = s->edited.view;
	s->keys = s->edited.keys;
	s->edits = bytes;
	s->edit_bytes = count;
	s->edit_hash = XXH3_64bits(bytes, count);
	s->edit_us = clock_us() - start;
	s->next = scenes->first;
	scenes->first = s;
	log_line(LOG_DEBUG, "scene %llu: edited in %llu us, %u nodes moved%s%s", (unsigned long long)s->id,
		 (unsigned long long)s->edit_us, s->edited.move_count, s->edited.note[0] ? ": " : "", s->edited.note);
	*out = s;
	return STATUS_OK;
}

static enum status acquire_variant(struct resident_scenes *scenes, struct resident_scene *base, const candil_Edits *edits,
				   struct resident_scene **out, struct error *err)
{
	uint8_t *bytes;
	size_t count;
	*out = base;
	if (encode(edits, &bytes, &count, err) != STATUS_OK)
		return err->code;
	if (count == 0)
		return STATUS_OK;
	struct resident_scene *known = find_variant(scenes, base, bytes, count);
	if (!known)
		return add_variant(scenes, base, edits, bytes, count, out, err);
	free(bytes);
	*out = known;
	return STATUS_OK;
}

// Destroy the least recently used of the idle variants that are beyond LIMIT_VARIANTS.
static void trim_variants(struct resident_scenes *scenes)
{
	for (;;) {
		struct resident_scene *oldest = NULL;
		unsigned idle = 0;
		for (struct resident_scene *s = scenes->first; s; s = s->next) {
			if (!s->base || s->jobs > 0)
				continue;
			idle++;
			if (!oldest || s->used < oldest->used)
				oldest = s;
		}
		if (idle <= LIMIT_VARIANTS)
			return;
		scene_destroy(scenes, oldest);
	}
}

enum status resident_acquire(struct resident_scenes *scenes, uint64_t id, const candil_Edits *edits,
			     struct resident_scene **scene, struct error *err)
{
	struct resident_scene *base = scene_find(scenes, id), *s;
	if (!base)
		return error_set(err, STATUS_INTERNAL, "the worker does not know this scene");
	if (map_blob(base, err) != STATUS_OK || acquire_variant(scenes, base, edits, &s, err) != STATUS_OK)
		return err->code;
	base->used = ++scenes->turn;
	base->jobs++;
	if (s != base) {
		s->used = scenes->turn;
		s->jobs++;
	}
	*scene = s;
	return STATUS_OK;
}

void resident_release(struct resident_scenes *scenes, struct resident_scene *scene)
{
	struct resident_scene *base = scene->base ? scene->base : scene;
	if (scene != base)
		scene->jobs--;
	if (--base->jobs == 0 && base->forgotten)
		scene_destroy(scenes, base);
	else
		trim_variants(scenes);
}

bool resident_has_deep_textures(const struct resident_scene *s)
{
	const struct texture_info *textures = scene_section(s, BLOB_TEXTURES);
	for (uint32_t i = 0; i < scene_count(s, BLOB_TEXTURES); i++)
		if (textures[i].flags & TEXTURE_DEEP)
			return true;
	return false;
}

// The linear value of each of a code's `most` + 1 values: IEC 61966-2-1. A table that is filled in is left as it is.
static void fill_srgb(float *table, uint32_t most)
{
	for (uint32_t i = 0; i <= most && table[most] == 0.0f; i++) {
		const double c = (double)i / most;
		table[i] = (float)(c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
	}
}

// As shared/bindings.h has it.
static const float *srgb_table(bool deep, uint64_t *bytes)
{
	static float table[256 + 65536];
	fill_srgb(table, 255);
	if (deep)
		fill_srgb(table + 256, 65535);
	*bytes = deep ? sizeof table : 256 * sizeof *table;
	return table;
}

const void *resident_data(const struct resident_scene *s, uint32_t binding, uint64_t *bytes)
{
	if (binding == BIND_SRGB_TABLE)
		return srgb_table(resident_has_deep_textures(s), bytes);
	if (binding == BIND_GGX_TABLE) {
		*bytes = sizeof ggx_table;
		return ggx_table;
	}
	*bytes = (uint64_t)scene_count(s, section_of[binding]) * blob_stride(section_of[binding]);
	return scene_section(s, section_of[binding]);
}

struct derived *resident_derived(const struct resident_scene *s, const void *kind)
{
	struct derived *d = s->derived;
	while (d && d->kind != kind)
		d = d->next;
	return d;
}

void resident_derive(struct resident_scene *s, struct derived *derived)
{
	derived->next = s->derived;
	s->derived = derived;
}

// ---- on the device ------------------------------------------------------------------------------------------------------

// The worker's own tables are no sections: all variants use their base's buffers of them.
bool resident_shares(const struct resident_scene *s, uint32_t binding)
{
	const enum blob_section section = section_of[binding];
	return s->base && (section == BLOB_SECTIONS || s->view.sections[section] == s->base->view.sections[section]);
}

const struct buffer *resident_buffer(const struct resident_scene *s, uint32_t binding)
{
	return resident_shares(s, binding) ? &s->base->buffers[binding] : &s->buffers[binding];
}

enum status resident_upload(struct resident_scene *s, struct device *device, uint32_t bindings, struct error *err)
{
	enum status r = STATUS_OK;
	for (uint32_t i = 0; r == STATUS_OK && i < BIND_SCENE_COUNT; i++) {
		struct buffer *buffer = resident_shares(s, i) ? &s->base->buffers[i] : &s->buffers[i];
		if (!(bindings & 1u << i) || buffer->handle)
			continue;
		uint64_t bytes;
		const void *data = resident_data(s, i, &bytes);
		r = buffer_init_with(buffer, device, data, bytes, err);
	}
	return r;
}

void resident_finish(struct resident_scenes *scenes)
{
	while (scenes->first)
		scene_destroy(scenes, scenes->first->base ? scenes->first->base : scenes->first);
}
