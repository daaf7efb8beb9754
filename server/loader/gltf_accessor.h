// Reads accessors of a glTF file. Every byte is checked to lie inside its buffer. One thread.
#ifndef CANDIL_LOADER_GLTF_ACCESSOR_H
#define CANDIL_LOADER_GLTF_ACCESSOR_H

#include "server/loader/gltf_parts.h"

// Elements as doubles, as many for each as its type has components. Doubles represent indices exactly too.
struct gltf_elements {
	std::vector<double> values;
	size_t count = 0;
};

// Read accessor `number`, which must be of the type `type` (TINYGLTF_TYPE_…) and have at most `limit` elements.
// STATUS_SCENE_INVALID if it does not exist, has another type, or is not inside its buffer; STATUS_SCENE_LIMIT. May throw
// std::bad_alloc.
enum status gltf_read_accessor(const tinygltf::Model &model, int number, int type, size_t limit, gltf_elements *out,
			       struct error *err);

#endif
