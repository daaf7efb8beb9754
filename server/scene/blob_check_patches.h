// Part of blob_check: elements of radiosity and rows of form factors. Any thread.
#ifndef CANDIL_SCENE_BLOB_CHECK_PATCHES_H
#define CANDIL_SCENE_BLOB_CHECK_PATCHES_H

#include "server/scene/blob.h"

// Check that both are as patch_format.h has them. The bounds of all sections are checked already. STATUS_SCENE_INVALID.
enum status blob_check_patches(const struct blob_header *blob, struct error *err);

#endif
