// Texel buffers on the OpenGL device: arrays that shaders fetch as texels of one word or of four. Software drivers fetch
// them for all lanes at once, and they take none of the sixteen storage blocks of a stage. Counted against the memory
// budget. Device's thread only. A texel buffer is its holder's, who finishes it before the device goes.
#ifndef CANDIL_WORKER_GL_TEXELS_H
#define CANDIL_WORKER_GL_TEXELS_H

#include "server/worker/gl/buffer.h"

// A texel buffer; zeroed: none. May be moved by copying the struct.
struct gl_texels {
	struct gl_buffer buffer; // zeroed: that of somebody else is viewed
	struct gl_device *device; // that it is on
	unsigned texture; // OpenGL's
	uint64_t count; // texels
};

// Bytes that so many words take as texels of a format: GL_R32UI or GL_R32F, one word; GL_RGBA32UI or GL_RGBA32F, four.
uint64_t gl_texels_bytes(unsigned format, uint64_t words);

// Make one with a copy of so many words, a multiple of the format's. There may be none. STATUS_MEMORY if the budget or the
// device is too small; STATUS_DEVICE. On failure *texels is zeroed.
enum status gl_texels_init(struct gl_texels *texels, struct gl_device *device, unsigned format, uint64_t words,
			   const void *data, struct error *err);

// Make one of a buffer's own bytes, which must outlive it; of a zeroed buffer one without texels. Fails alike.
enum status gl_texels_view(struct gl_texels *texels, struct gl_device *device, unsigned format,
			   const struct gl_buffer *buffer, struct error *err);

// Free it and zero it. A zeroed one is fine.
void gl_texels_finish(struct gl_texels *texels);

// Bind to the sampler of texture unit `unit`, for the program in use.
void gl_texels_bind(const struct gl_texels *texels, unsigned unit);

#endif
