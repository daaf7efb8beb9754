// The part of blob_check that covers the node hierarchy and its animations. Any thread.
#ifndef CANDIL_SCENE_BLOB_CHECK_NODES_H
#define CANDIL_SCENE_BLOB_CHECK_NODES_H

#include "server/scene/blob.h"

// The sections must already be known to lie inside the blob. STATUS_SCENE_INVALID names the first thing that is wrong.
enum status blob_check_nodes(const struct blob_header *blob, struct error *err);

#endif
