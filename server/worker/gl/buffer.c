#include "server/worker/gl/buffer.h"

#include <epoxy/gl.h>

enum status gl_buffer_init(struct gl_buffer *b, struct gl_device *d, uint64_t bytes, const void *data, struct error *err)
{
	*b = (struct gl_buffer){0};
	enum status s = gl_reserve(d, bytes, err);
	if (s != STATUS_OK)
		return s;
	if (bytes > d->storage_bytes_max)
		return error_set(err, STATUS_MEMORY, "the OpenGL device binds %llu MiB at once, %llu are needed",
				 (unsigned long long)(d->storage_bytes_max >> 20),
				 (unsigned long long)((bytes + (1u << 20) - 1) >> 20));
	glCreateBuffers(1, &b->name);
	glNamedBufferStorage(b->name, (GLsizeiptr)bytes, data, GL_DYNAMIC_STORAGE_BIT);
	b->bytes = bytes;
	*d->bytes += bytes;
	if (!data)
		gl_buffer_clear(b);
	s = gl_check(d, "making a buffer", err);
	if (s != STATUS_OK)
		gl_buffer_finish(b, d);
	return s;
}

void gl_buffer_finish(struct gl_buffer *b, struct gl_device *d)
{
	if (b->name) {
		glDeleteBuffers(1, &b->name);
		*d->bytes -= b->bytes;
	}
	*b = (struct gl_buffer){0};
}

void gl_buffer_clear(const struct gl_buffer *b)
{
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	glClearNamedBufferData(b->name, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
}

void gl_buffer_write(const struct gl_buffer *b, uint64_t offset, uint64_t bytes, const void *data)
{
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	glNamedBufferSubData(b->name, (GLintptr)offset, (GLsizeiptr)bytes, data);
}

enum status gl_buffer_read(const struct gl_buffer *b, struct gl_device *d, uint64_t offset, uint64_t bytes, void *out,
			   struct error *err)
{
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	glGetNamedBufferSubData(b->name, (GLintptr)offset, (GLsizeiptr)bytes, out);
	return gl_check(d, "reading a buffer", err);
}

void gl_buffer_bind(const struct gl_buffer *b, unsigned binding)
{
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, b->name);
}
