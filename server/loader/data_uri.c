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

void data_uri_hide(uint8_t *json, size_t size)
{
	static const char key[] = "\"uri\"", scheme[] = "\"data:";
	uint8_t *end = json + size, *from = json;
	for (uint8_t *at; (at = memmem(from, (size_t)(end - from), scheme, sizeof scheme - 1)); from = at + 1) {
		const uint8_t *before = at;
		bool colon = false;
		for (; before > json && (isspace(before[-1]) || (!colon && before[-1] == ':')); before--)
			colon |= before[-1] == ':';
		if (colon && before - json >= (ptrdiff_t)sizeof key - 1 &&
		    memcmp(before - (sizeof key - 1), key, sizeof key - 1) == 0)
			at[1] = 'D';
	}
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

// Whether the media type says so at its end. Blanks may stand before and behind the word, as browsers have it.
static bool is_base64(const char *type, const char *end)
{
	while (end > type && end[-1] == ' ')
		end--;
	if (end - type < 7 || strncasecmp(end - 6, "base64", 6) != 0)
		return false;
	for (end -= 6; end > type && end[-1] == ' ';)
		end--;
	return end > type && end[-1] == ';';
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
	if (is_base64(uri + 5, comma) && !decode_base64(out)) {
		file_bytes_finish(out);
		return error_set(err, STATUS_SCENE_INVALID, "its data URI is not base64");
	}
	return STATUS_OK;
}
