// Textures on the OpenGL device, counted against the memory budget.
#ifndef CANDIL_WORKER_GL_TEXTURE_H
#define CANDIL_WORKER_GL_TEXTURE_H

#include "server/worker/gl/device.h"

struct gl_texture_desc {
	unsigned target; // GL_TEXTURE_2D, GL_TEXTURE_2D_ARRAY, GL_TEXTURE_3D, GL_TEXTURE_CUBE_MAP_ARRAY (6 layers a cube)
	unsigned format; // sized, of those that texel_bytes knows
	uint32_t width, height, depth; // depth: layers of an array, 1 for 2D
	uint32_t levels; // 0: all down to one texel
};

struct gl_texture {
	unsigned name; // 0: none
	struct gl_texture_desc desc; // levels counted
	uint64_t bytes;
};

// Bytes that a texture takes, its levels included; 0 for a format that is not known here.
uint64_t gl_texture_bytes(const struct gl_texture_desc *desc);

// A texture of zeros, nearest filtering, clamped to its edge. STATUS_MEMORY if the budget, the device or its largest side is
// too small; nothing is left behind then.
enum status gl_texture_init(struct gl_texture *texture, struct gl_device *device, const struct gl_texture_desc *desc,
			    struct error *err);
void gl_texture_finish(struct gl_texture *texture, struct gl_device *device); // a zeroed one is fine

// All levels to zero, in the order of the commands.
void gl_texture_clear(const struct gl_texture *texture);

// Filtering between texels and, if `mips`, between levels.
void gl_texture_linear(const struct gl_texture *texture, bool mips);

// For a sampler at `unit`; for an image at `unit`, one level, all layers; `access` GL_READ_ONLY….
void gl_texture_bind(const struct gl_texture *texture, unsigned unit);
void gl_texture_bind_image(const struct gl_texture *texture, unsigned unit, uint32_t level, unsigned access);

#endif
