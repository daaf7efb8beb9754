#include "server/worker/gl/texels.h"

#include <epoxy/gl.h>

#include "server/worker/gl/program.h"

#define WORD 4u

// The words with those that nobody reads: software drivers compile other code where their number is a power of two.
static uint64_t padded(uint64_t words)
{
	return words + ((words & (words - 1)) == 0 ? (words > 1 ? 1 : 3 - words) : 0);
}

uint64_t gl_texels_bytes(uint64_t words)
{
	return padded(words) * WORD;
}

static enum status view(struct gl_texels *t, unsigned format, uint64_t words, struct error *err)
{
	GLint most = 0;
	glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
	if (padded(words) > (uint64_t)most)
		return error_set(err, STATUS_MEMORY, "%llu words are more than the OpenGL device's %d texels",
				 (unsigned long long)words, most);
	glCreateTextures(GL_TEXTURE_BUFFER, 1, &t->texture);
	glTextureBuffer(t->texture, format, t->buffer.name);
	return gl_check(t->device, "viewing a buffer as texels", err);
}

enum status gl_texels_init(struct gl_texels *t, struct gl_device *device, unsigned format, uint64_t words, const void *data,
			   struct error *err)
{
	*t = (struct gl_texels){.device = device};
	enum status s = gl_buffer_init(&t->buffer, device, gl_texels_bytes(words), NULL, err);
	if (s == STATUS_OK && words > 0)
		gl_buffer_write(&t->buffer, 0, words * WORD, data);
	if (s == STATUS_OK)
		s = view(t, format, words, err);
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
	gl_shape(t->device, (uint64_t)unit << 1);
	glBindTextureUnit(unit, t->texture);
}
