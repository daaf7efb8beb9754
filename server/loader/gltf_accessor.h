// Accessors of a glTF file, every byte of them checked to lie inside its buffer.
#ifndef CANDIL_LOADER_GLTF_ACCESSOR_H
#define CANDIL_LOADER_GLTF_ACCESSOR_H

#include "server/loader/gltf_parts.h"

// Components as doubles, as many each as the type has. Indices are exact in a double too.
struct gltf_elements {
	std::vector<double> values;
	size_t count = 0;
};

// Read accessor `number`, which must have the TINYGLTF_TYPE_… `type` and at most `limit` elements. STATUS_SCENE_INVALID if
// it is not there, of another type, or not inside its buffer; STATUS_SCENE_LIMIT. May throw std::bad_alloc.
enum status gltf_read_accessor(const tinygltf::Model &model, int number, int type, size_t limit, gltf_elements *out,
			       struct error *err);

#endif
