// Textures on the OpenGL device, counted against the memory budget. Device's thread only. A texture is its holder's, who
// finishes it before the device goes.
#ifndef CANDIL_WORKER_GL_TEXTURE_H
#define CANDIL_WORKER_GL_TEXTURE_H

#include "server/worker/gl/device.h"

// The shape of a texture, in texels.
struct gl_texture_desc {
	unsigned target; // GL_TEXTURE_2D, GL_TEXTURE_2D_ARRAY, GL_TEXTURE_3D, GL_TEXTURE_CUBE_MAP_ARRAY (6 layers a cube)
	unsigned format; // a sized internal format that texel_bytes (texture.c) knows
	uint32_t width, height, depth; // depth: layers of an array, 1 for 2D
	uint32_t levels; // of the mip pyramid; 0: all, down to one texel
};

// A texture; zeroed: none. May be moved by copying the struct.
struct gl_texture {
	unsigned name; // 0: none
	struct gl_device *device; // that it is on
	struct gl_texture_desc desc; // with the number of levels filled in
	uint64_t bytes;
};

// Bytes that a texture takes, its levels included; 0 for a format that is not known here. No device is asked.
uint64_t gl_texture_bytes(const struct gl_texture_desc *desc);

// Make a texture of zeros, with nearest filtering, clamped to its edge. STATUS_MEMORY if the budget, the device or its
// largest side is too small; STATUS_INTERNAL for an unknown format; STATUS_DEVICE. On failure *texture is zeroed.
enum status gl_texture_init(struct gl_texture *texture, struct gl_device *device, const struct gl_texture_desc *desc,
			    struct error *err);

// Free the texture and zero it. A zeroed one is fine.
void gl_texture_finish(struct gl_texture *texture, struct gl_device *device);

// Set all levels to zero, in the order of the commands.
void gl_texture_clear(const struct gl_texture *texture);

// From now on filter linearly between texels and, if `mips`, between levels.
void gl_texture_linear(const struct gl_texture *texture, bool mips);

// Bind for the sampler of texture unit `unit`; or one level, with all its layers, for the image of image unit `unit`, where
// `access` is GL_READ_ONLY, GL_WRITE_ONLY or GL_READ_WRITE.
void gl_texture_bind(const struct gl_texture *texture, unsigned unit);
void gl_texture_bind_image(const struct gl_texture *texture, unsigned unit, uint32_t level, unsigned access);

#endif
