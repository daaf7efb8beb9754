#include "server/worker/gl/texels.h"

#include <epoxy/gl.h>

#include "server/worker/gl/program.h"

static uint32_t texel_bytes(unsigned format)
{
	return format == GL_R32UI || format == GL_R32F ? 4 : 16;
}

static bool is_power_of_two(uint64_t n)
{
	return (n & (n - 1)) == 0;
}

// With texels that nobody reads: software drivers compile other code where their number is a power of two.
static uint64_t padded(unsigned format, uint64_t words)
{
	const uint64_t n = words * 4 / texel_bytes(format);
	return n < 3 ? 3 : n + is_power_of_two(n);
}

uint64_t gl_texels_bytes(unsigned format, uint64_t words)
{
	return padded(format, words) * texel_bytes(format);
}

static enum status view(struct gl_texels *t, unsigned format, const struct gl_buffer *buffer, struct error *err)
{
	GLint most = 0;
	t->count = buffer->bytes / texel_bytes(format);
	glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
	if (t->count > (uint64_t)most)
		return error_set(err, STATUS_MEMORY, "%llu texels are more than the OpenGL device's %d",
				 (unsigned long long)t->count, most);
	glCreateTextures(GL_TEXTURE_BUFFER, 1, &t->texture);
	glTextureBuffer(t->texture, format, buffer->name);
	return gl_check(t->device, "viewing a buffer as texels", err);
}

enum status gl_texels_init(struct gl_texels *t, struct gl_device *device, unsigned format, uint64_t words, const void *data,
			   struct error *err)
{
	*t = (struct gl_texels){.device = device};
	enum status s = gl_buffer_init(&t->buffer, device, gl_texels_bytes(format, words), NULL, err);
	if (s == STATUS_OK && words > 0)
		gl_buffer_write(&t->buffer, 0, words * 4, data);
	if (s == STATUS_OK)
		s = view(t, format, &t->buffer, err);
	if (s != STATUS_OK)
		gl_texels_finish(t);
	return s;
}

enum status gl_texels_view(struct gl_texels *t, struct gl_device *device, unsigned format, const struct gl_buffer *buffer,
			   struct error *err)
{
	*t = (struct gl_texels){.device = device};
	const enum status s = buffer->name ? view(t, format, buffer, err) : STATUS_OK;
	if (s != STATUS_OK)
		gl_texels_finish(t);
	return s;
}

void gl_texels_finish(struct gl_texels *t)
{
	if (t->texture)
		glDeleteTextures(1, &t->texture);
	if (t->device)
		gl_buffer_finish(&t->buffer, t->device);
	*t = (struct gl_texels){0};
}

void gl_texels_bind(const struct gl_texels *t, unsigned unit)
{
	gl_shape(t->device, (uint64_t)unit << 1 | is_power_of_two(t->count));
	glBindTextureUnit(unit, t->texture);
}
