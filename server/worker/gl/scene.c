#include "server/worker/gl/scene.h"

#include <epoxy/gl.h>
#include <stdlib.h>

#include "server/worker/gl/program.h"

static const char kind; // its address is gl_scene's kind of struct derived

#define TEXEL_BYTES 16u

static void gl_scene_destroy(struct derived *derived)
{
	struct gl_scene *s = (struct gl_scene *)derived;
	glDeleteTextures(1, &s->node_texels);
	glDeleteTextures(1, &s->leaf_texels);
	glDeleteTextures(1, &s->triangle_texels);
	glDeleteTextures(1, &s->vertex_texels);
	for (unsigned i = 0; i < BIND_SCENE_COUNT; i++)
		gl_buffer_finish(&s->buffers[i], s->device);
	free(s);
}

static uint64_t bytes_of(const struct derived *derived)
{
	const struct gl_scene *s = (const struct gl_scene *)derived;
	uint64_t bytes = 0;
	for (unsigned i = 0; i < BIND_SCENE_COUNT; i++)
		bytes += s->buffers[i].bytes;
	return bytes;
}

// Make a texel buffer over one of the scene's buffers, unless it is made.
static enum status view_as_texels(struct gl_scene *s, uint32_t binding, unsigned *texture, struct error *err)
{
	const struct gl_buffer *buffer = &s->buffers[binding];
	GLint most = 0;
	if (!buffer->name || *texture)
		return STATUS_OK;
	glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
	if (buffer->bytes / TEXEL_BYTES > (uint64_t)most)
		return error_set(err, STATUS_MEMORY, "the scene has more texels than the OpenGL device's %d", most);
	glCreateTextures(GL_TEXTURE_BUFFER, 1, texture);
	glTextureBuffer(*texture, GL_RGBA32UI, buffer->name);
	return gl_check(s->device, "viewing a buffer as texels", err);
}

static enum status gl_scene_upload(struct gl_scene *s, const struct resident_scene *scene, uint32_t bindings,
				   struct error *err)
{
	enum status r = STATUS_OK;
	for (uint32_t i = 0; r == STATUS_OK && i < BIND_SCENE_COUNT; i++) {
		if (!(bindings & 1u << i) || s->buffers[i].name || resident_shares(scene, i))
			continue;
		uint64_t bytes;
		const void *data = resident_data(scene, i, &bytes);
		if (bytes > 0)
			r = gl_buffer_init(&s->buffers[i], s->device, bytes, data, err);
	}
	if (r == STATUS_OK)
		r = view_as_texels(s, BIND_NODES, &s->node_texels, err);
	if (r == STATUS_OK)
		r = view_as_texels(s, BIND_LEAF_TRIANGLES, &s->leaf_texels, err);
	if (r == STATUS_OK)
		r = view_as_texels(s, BIND_TRIANGLES, &s->triangle_texels, err);
	if (r == STATUS_OK)
		r = view_as_texels(s, BIND_VERTICES, &s->vertex_texels, err);
	return r;
}

enum status gl_scene_get(struct resident_scene *scene, struct gl_device *device, uint32_t bindings, struct gl_scene **out,
			 struct error *err)
{
	struct gl_scene *s = (struct gl_scene *)resident_derived(scene, &kind);
	if (!s) {
		s = calloc(1, sizeof *s);
		if (!s)
			return error_set(err, STATUS_MEMORY, "out of memory");
		s->device = device;
		s->derived = (struct derived){.kind = &kind, .destroy = gl_scene_destroy, .bytes = bytes_of};
		resident_derive(scene, &s->derived);
	}
	*out = s;
	if (scene->base) {
		struct gl_scene *base;
		uint32_t shared = 0;
		for (uint32_t i = 0; i < BIND_SCENE_COUNT; i++)
			shared |= resident_shares(scene, i) ? bindings & 1u << i : 0;
		if (gl_scene_get(scene->base, device, shared, &base, err) != STATUS_OK)
			return err->code;
		s->base = base;
	}
	return gl_scene_upload(s, scene, bindings, err);
}

const struct gl_buffer *gl_scene_buffer(const struct gl_scene *s, uint32_t binding)
{
	return s->buffers[binding].name || !s->base ? &s->buffers[binding] : gl_scene_buffer(s->base, binding);
}

static void bind_texels(const struct gl_scene *s, unsigned binding, unsigned unit, unsigned texture)
{
	const uint64_t texels = s->buffers[binding].bytes / TEXEL_BYTES;
	gl_shape(s->device, (uint64_t)unit << 1 | ((texels & (texels - 1)) == 0));
	glBindTextureUnit(unit, texture);
}

void gl_scene_bind(const struct gl_scene *s, uint32_t bindings)
{
	if (s->base)
		gl_scene_bind(s->base, bindings);
	for (unsigned i = BIND_LEAF_TRIANGLES + 1; i < BIND_SCENE_COUNT; i++)
		if (s->buffers[i].name)
			gl_buffer_bind(&s->buffers[i], i);
	if (s->node_texels && bindings >> BIND_NODES & 1u)
		bind_texels(s, BIND_NODES, UNIT_NODES, s->node_texels);
	if (s->leaf_texels && bindings >> BIND_LEAF_TRIANGLES & 1u)
		bind_texels(s, BIND_LEAF_TRIANGLES, UNIT_LEAF_TRIANGLES, s->leaf_texels);
}

void gl_scene_bind_corners(const struct gl_scene *s)
{
	if (s->base)
		gl_scene_bind_corners(s->base);
	if (s->triangle_texels)
		bind_texels(s, BIND_TRIANGLES, UNIT_TRIANGLES, s->triangle_texels);
	if (s->vertex_texels)
		bind_texels(s, BIND_VERTICES, UNIT_VERTICES, s->vertex_texels);
}
