// Data URIs (RFC 2397): bytes within a file's text. tinygltf reads seven of their forms, and of these no percent encoding;
// this reads them all. One thread.
#ifndef CANDIL_LOADER_DATA_URI_H
#define CANDIL_LOADER_DATA_URI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/loader/files.h"

#ifdef __cplusplus
extern "C" {
#endif

// Whether the URI's scheme is "data", in any case.
bool data_uri_is(const char *uri);

// Write the scheme of the data URIs of a glTF file's text as "Data:", so that tinygltf takes them for names of files. One
// that is spelled by escapes of JSON stays.
void data_uri_hide(uint8_t *json, size_t size);

// Whether tinygltf takes it for one. What it does not, it takes for a file's name.
bool data_uri_is_plain(const char *uri);

// Decode the bytes: any media type or none, base64 or percent-encoded. Base64 may lack its padding, and may have blanks, or
// - and _ for + and /. STATUS_SCENE_INVALID, STATUS_MEMORY.
enum status data_uri_read(const char *uri, struct file_bytes *out, struct error *err);

#ifdef __cplusplus
}
#endif

#endif
