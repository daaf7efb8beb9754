// The part of blob_check that is about the hierarchy and its animations.
#ifndef CANDIL_SCENE_BLOB_CHECK_NODES_H
#define CANDIL_SCENE_BLOB_CHECK_NODES_H

#include "server/scene/blob.h"

// After the sections were checked to lie inside the blob. STATUS_SCENE_INVALID with the first thing that is wrong.
enum status blob_check_nodes(const struct blob_header *blob, struct error *err);

#endif
