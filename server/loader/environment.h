// Reads an environment map (equirectangular; layout.h describes its orientation) as a scene of its own: the texels, and the
// table by which pt samples directions. One thread.
#ifndef CANDIL_LOADER_ENVIRONMENT_H
#define CANDIL_LOADER_ENVIRONMENT_H

#include "server/loader/import.h"

// Read an exr, hdr, tiff, png or jpeg file; `file` is its name for messages. Values that cannot be a radiance are repaired,
// with a warning: NaN and negative values become 0, an infinity becomes the largest finite value of the picture, and values
// above LIMIT_RADIANCE become that. STATUS_SCENE_UNSUPPORTED, STATUS_SCENE_INVALID, STATUS_SCENE_LIMIT (a side, or all
// texels), STATUS_MEMORY.
enum status environment_import(struct import *import, const char *file, const struct file_bytes *bytes, struct error *err);

// Fill in the import's `environment`, `environment_rows`, power and contrast from environment_width × environment_height
// RGB values, which must be finite and not negative. A texel is chosen in proportion to luminance times solid angle. Its
// luminance is the mean over its area of the bilinear interpolation between texel middles, so every direction with light
// can be chosen. STATUS_MEMORY.
enum status environment_build(struct import *import, const float *rgb, struct error *err);

#endif
