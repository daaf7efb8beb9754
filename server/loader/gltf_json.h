// Checks that a glTF file must pass before a parser sees it that trusts its input: the GLB container, the JSON, the types
// and ranges of the properties that are read, and the required extensions. One thread.
#ifndef CANDIL_LOADER_GLTF_JSON_H
#define CANDIL_LOADER_GLTF_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/loader/files.h"

#ifdef __cplusplus
extern "C" {
#endif

struct gltf_text {
	bool binary; // the JSON is in a GLB container
	const char *json; // within the file's bytes
	size_t json_bytes;
	uint64_t bin_bytes; // GLB: size of the BIN chunk, 0 without one
};

// Whether the extension of a name is read.
bool gltf_extension_is_read(const char *name);

// The names of those that gltf_layers.cpp reads; NULL ends the list.
extern const char *const gltf_layer_extensions[];

// Find the JSON in the file's bytes. STATUS_SCENE_INVALID if the container is broken.
enum status gltf_find_json(const struct file_bytes *bytes, struct gltf_text *text, struct error *err);

// The byteLength of each buffer with a URI that tinygltf takes for a file's name, in the file's order. A reader takes this
// many bytes of its file, or of its content if that has data: it is a data URI of a form that tinygltf does not know.
struct gltf_externals {
	uint64_t *lengths;
	struct file_bytes *contents;
	size_t count;
	bool has_images; // not buffers, but as much to be read
};

// Free what gltf_check_json has filled in.
void gltf_externals_finish(struct gltf_externals *externals);

// Check the JSON. *externals is filled in on success. STATUS_SCENE_INVALID, STATUS_SCENE_UNSUPPORTED, STATUS_MEMORY.
enum status gltf_check_json(const struct gltf_text *text, struct gltf_externals *externals, struct error *err);

#ifdef __cplusplus
}
#endif

#endif
