// Reads texels on the host, of either depth. Any thread; cannot fail.
#ifndef CANDIL_SCENE_TEXEL_H
#define CANDIL_SCENE_TEXEL_H

#include <stddef.h>
#include <stdint.h>

#include "shaders/shared/layout.h"

#define TEXEL_WHITE 65535u // the most that a channel can be

// Words that a texel of this texture takes.
static inline uint32_t texel_words(const struct texture_info *texture)
{
	return texture->flags & TEXTURE_DEEP ? 2 : 1;
}

// Channel 0 … 3 of the texture's texel `i`, counted row by row, as 0 … TEXEL_WHITE. `texels` is the whole section. It is as
// the file has it: not decoded from sRGB.
static inline uint32_t texel_channel(const struct texture_info *texture, const uint32_t *texels, size_t i, unsigned channel)
{
	if (texture->flags & TEXTURE_DEEP)
		return texels[texture->offset + 2 * i + channel / 2] >> 16 * (channel % 2) & 65535u;
	return (texels[texture->offset + i] >> 8 * channel & 255u) * 257u;
}

// Set a channel of a texel that was all zero. It is rounded to the texture's depth.
static inline void texel_put(const struct texture_info *texture, uint32_t *texels, size_t i, unsigned channel,
			     uint32_t value)
{
	if (texture->flags & TEXTURE_DEEP)
		texels[texture->offset + 2 * i + channel / 2] |= value << 16 * (channel % 2);
	else
		texels[texture->offset + i] |= (value + 128u) / 257u << 8 * channel;
}

#endif
