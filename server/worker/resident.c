#include "server/worker/resident.h"

#include <math.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "ggx_table.h"
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
    // Tables of our own, of no scene.
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

static void destroy(struct resident_scenes *scenes, struct resident_scene *scene)
{
	struct resident_scene **at = &scenes->first;
	while (*at != scene)
		at = &(*at)->next;
	*at = scene->next;
	leave_device(scene, scenes->device);
	if (scene->blob)
		munmap((void *)(uintptr_t)scene->blob, scene->bytes);
	close(scene->fd);
	free(scene);
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

bool resident_evict(struct resident_scenes *scenes)
{
	struct resident_scene *oldest = NULL;
	for (struct resident_scene *s = scenes->first; s; s = s->next)
		if (s->jobs == 0 && is_on_device(s) && (!oldest || s->used < oldest->used))
			oldest = s;
	if (!oldest)
		return false;
	log_line(LOG_INFO, "scene %llu makes room", (unsigned long long)oldest->id);
	leave_device(oldest, scenes->device);
	return true;
}

static struct resident_scene *find(const struct resident_scenes *scenes, uint64_t id)
{
	struct resident_scene *s = scenes->first;
	while (s && s->id != id)
		s = s->next;
	return s;
}

void resident_forget(struct resident_scenes *scenes, uint64_t id)
{
	struct resident_scene *s = find(scenes, id);
	if (!s)
		return;
	s->forgotten = true;
	if (s->jobs == 0)
		destroy(scenes, s);
}

enum status resident_acquire(struct resident_scenes *scenes, uint64_t id, struct resident_scene **scene, struct error *err)
{
	struct resident_scene *s = find(scenes, id);
	if (!s)
		return error_set(err, STATUS_INTERNAL, "the worker does not know this scene");
	if (!s->blob) {
		const void *map;
		size_t bytes;
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
	}
	s->jobs++;
	s->used = ++scenes->turn;
	*scene = s;
	return STATUS_OK;
}

void resident_release(struct resident_scenes *scenes, struct resident_scene *scene)
{
	if (--scene->jobs == 0 && scene->forgotten)
		destroy(scenes, scene);
}

// sRGB's curve for the 256 bytes, IEC 61966-2-1.
static const float *srgb_table(void)
{
	static float table[256];
	for (int i = 0; table[255] == 0.0f && i < 256; i++) {
		const double c = i / 255.0;
		table[i] = (float)(c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
	}
	return table;
}

const void *resident_data(const struct resident_scene *s, uint32_t binding, uint64_t *bytes)
{
	if (binding == BIND_SRGB_TABLE) {
		*bytes = 256 * sizeof(float);
		return srgb_table();
	}
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

// Whose buffer a binding is: what an edit left alone is shared with the scene as loaded.
static bool is_shared(const struct resident_scene *s, uint32_t binding)
{
	const enum blob_section section = section_of[binding];
	return s->base && (section == BLOB_SECTIONS || s->view.sections[section] == s->base->view.sections[section]);
}

const struct buffer *resident_buffer(const struct resident_scene *s, uint32_t binding)
{
	return is_shared(s, binding) ? &s->base->buffers[binding] : &s->buffers[binding];
}

enum status resident_upload(struct resident_scene *s, struct device *device, uint32_t bindings, struct error *err)
{
	enum status r = STATUS_OK;
	for (uint32_t i = 0; r == STATUS_OK && i < BIND_SCENE_COUNT; i++) {
		struct buffer *buffer = is_shared(s, i) ? &s->base->buffers[i] : &s->buffers[i];
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
		destroy(scenes, scenes->first);
}
