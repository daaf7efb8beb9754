// What the parts of import.h share; importers do not call it. One thread.
#ifndef CANDIL_LOADER_IMPORT_PARTS_H
#define CANDIL_LOADER_IMPORT_PARTS_H

#include <stddef.h>

#include "server/base/error.h"

// Make room in the array `items` of `count` elements, `stride` bytes each, for `more` elements. *room is its capacity in
// elements. Returns the array, which realloc may have moved. On failure returns NULL, and `items` is unchanged:
// STATUS_SCENE_LIMIT if there would be more than `limit` elements, which the message calls `what`; STATUS_MEMORY.
void *import_grown(void *items, size_t count, size_t more, size_t *room, size_t stride, size_t limit, const char *what,
		   struct error *err);

// The words of the keys in image_keys and texture_keys.
#define IMPORT_IMAGE_WORDS 5
#define IMPORT_TEXTURE_WORDS 8

#endif
