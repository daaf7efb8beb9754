// A picture of all directions (equirectangular, layout.h says which way it looks), from its file to a scene that is nothing
// else: texels, and the table by which pt chooses directions in it.
#ifndef CANDIL_LOADER_ENVIRONMENT_H
#define CANDIL_LOADER_ENVIRONMENT_H

#include "server/loader/import.h"

// Read exr, hdr, tiff, png or jpeg. What cannot be a radiance is mended, and import_warn says so: NaN and what is below zero
// becomes 0, an infinity the largest finite value of the picture, and nothing stays above LIMIT_RADIANCE.
// STATUS_SCENE_UNSUPPORTED, STATUS_SCENE_INVALID, STATUS_SCENE_LIMIT (a side, all texels), STATUS_MEMORY.
enum status environment_import(struct import *import, const char *file, const struct file_bytes *bytes, struct error *err);

// Fill in `texels`, `rows` and `power` of import->environment_width × environment_height values, which are finite and not
// below zero. A texel is chosen by its luminance times its solid angle, its luminance being the mean over its area of what
// is bilinear between the middles of the texels: no direction with light is left out. STATUS_MEMORY.
enum status environment_build(struct import *import, const float *rgb, struct error *err);

#endif
