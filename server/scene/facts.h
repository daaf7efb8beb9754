// A scene's facts: properties by which the plan decides which effects a render needs. The loader finds them once, and the
// blob's header carries them. Any thread; cannot fail.
#ifndef CANDIL_SCENE_FACTS_H
#define CANDIL_SCENE_FACTS_H

#include <stdint.h>

#include "server/scene/blob.h"

// The facts of a blob whose sections are complete. header.facts is not read.
uint32_t facts_collect(const struct blob_header *blob);

// The facts of a view. Its own `facts` are not read.
uint32_t facts_of_view(const struct blob_view *view);

// The name of a fact as `describe` prints it, such as "textures" or "spot lights". Static storage. NULL unless exactly one
// known bit is set.
const char *fact_name(enum fact fact);

#endif
