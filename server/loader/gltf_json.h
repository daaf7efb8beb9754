// What a glTF file must get right before a parser that trusts it may see it: the GLB container, the JSON, the types and
// ranges of the properties that we read, and the extensions it cannot do without.
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
	bool binary; // a GLB container around it
	const char *json; // within the file
	size_t json_bytes;
	uint64_t bin_bytes; // GLB: of the BIN chunk, 0 without one
};

// The names of the extensions that are read, NULL behind the last.
extern const char *const gltf_extensions_read[];

// Find the JSON in the file's bytes. STATUS_SCENE_INVALID if the container is broken.
enum status gltf_find_json(const struct file_bytes *bytes, struct gltf_text *text, struct error *err);

// The byteLength of each buffer with a URI that is not a data URI, in the file's order: a reader takes as many bytes of it.
struct gltf_externals {
	uint64_t *lengths; // free() it
	size_t count;
};

// Check the JSON. STATUS_SCENE_INVALID or STATUS_SCENE_UNSUPPORTED.
enum status gltf_check_json(const struct gltf_text *text, struct gltf_externals *externals, struct error *err);

#ifdef __cplusplus
}
#endif

#endif
