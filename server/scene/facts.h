// A scene's facts: what the plan asks of it. They are found once, by the loader, and travel in the blob's header.
#ifndef CANDIL_SCENE_FACTS_H
#define CANDIL_SCENE_FACTS_H

#include <stdint.h>

#include "server/scene/blob.h"

// The facts of a blob whose sections are all filled in (header.facts itself is not read). Any thread.
uint32_t facts_collect(const struct blob_header *blob);

// The same of a view, whose own facts are not read.
uint32_t facts_of_view(const struct blob_view *view);

// The name of one fact as `describe` prints it: "textures", "spot lights". NULL for anything but exactly one known bit.
const char *fact_name(enum fact fact);

#endif
