#include "server/loader/data_uri.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

bool data_uri_is(const char *uri)
{
	return strncasecmp(uri, "data:", 5) == 0;
}

bool data_uri_is_plain(const char *uri)
{
	static const char *const types[] = {
	    "application/octet-stream", "image/jpeg", "image/png", "image/bmp", "image/gif", "text/plain",
	    "application/gltf-buffer"};
	if (strncmp(uri, "data:", 5) != 0)
		return false;
	for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
		const size_t size = strlen(types[i]);
		if (strncmp(uri + 5, types[i], size) == 0 && strncmp(uri + 5 + size, ";base64,", 8) == 0)
			return true;
	}
	return false;
}

static int hex(char c)
{
	return isdigit((unsigned char)c) ? c - '0' : isxdigit((unsigned char)c) ? tolower((unsigned char)c) - 'a' + 10 : -1;
}

static void decode_percents(const char *from, struct file_bytes *out)
{
	while (*from) {
		const int high = from[0] == '%' ? hex(from[1]) : -1, low = high >= 0 ? hex(from[2]) : -1;
		out->data[out->size++] = (uint8_t)(low >= 0 ? high * 16 + low : *from);
		from += low >= 0 ? 3 : 1;
	}
}

// The six bits of a letter, or -1.
static int sextet(uint8_t c)
{
	static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	const char *found = c == '-' ? letters + 62 : c == '_' ? letters + 63 : c ? strchr(letters, c) : NULL;
	return found ? (int)(found - letters) : -1;
}

// Decode base64 in place. False if there is anything else before the padding.
static bool decode_base64(struct file_bytes *b)
{
	size_t size = 0;
	uint32_t bits = 0;
	unsigned count = 0;
	for (size_t i = 0; i < b->size && b->data[i] != '='; i++) {
		if (isspace(b->data[i]))
			continue;
		const int six = sextet(b->data[i]);
		if (six < 0)
			return false;
		bits = (bits << 6 | (uint32_t)six) & 0xFFFFu;
		count += 6;
		if (count >= 8) {
			count -= 8;
			b->data[size++] = (uint8_t)(bits >> count);
		}
	}
	b->size = size;
	return true;
}

enum status data_uri_read(const char *uri, struct file_bytes *out, struct error *err)
{
	const char *comma = strchr(uri, ',');
	*out = (struct file_bytes){0};
	if (!comma)
		return error_set(err, STATUS_SCENE_INVALID, "its data URI has no comma before the data");
	out->data = malloc(strlen(comma));
	if (!out->data)
		return error_set(err, STATUS_MEMORY, "no memory for the bytes of a data URI");
	decode_percents(comma + 1, out);
	if (comma - uri >= 7 && strncasecmp(comma - 7, ";base64", 7) == 0 && !decode_base64(out)) {
		file_bytes_finish(out);
		return error_set(err, STATUS_SCENE_INVALID, "its data URI is not base64");
	}
	return STATUS_OK;
}
