#include "clients/libcandil/text.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

// How many bytes the UTF-8 character at `s` has. `s` ends with a zero. 0: there is no valid character, or a control
// character.
static size_t character_bytes(const unsigned char *s)
{
	uint32_t code;
	size_t bytes;
	if (s[0] < 0x80)
		return s[0] >= 0x20 && s[0] != 0x7F ? 1 : 0;
	if (s[0] >= 0xC2 && s[0] <= 0xDF) {
		bytes = 2;
		code = s[0] & 0x1Fu;
	} else if (s[0] >= 0xE0 && s[0] <= 0xEF) {
		bytes = 3;
		code = s[0] & 0x0Fu;
	} else if (s[0] >= 0xF0 && s[0] <= 0xF4) {
		bytes = 4;
		code = s[0] & 0x07u;
	} else {
		return 0;
	}
	for (size_t i = 1; i < bytes; i++) {
		if ((s[i] & 0xC0) != 0x80)
			return 0;
		code = code << 6 | (s[i] & 0x3Fu);
	}
	static const uint32_t least[5] = {0, 0, 0xA0, 0x800, 0x10000}; // below 0xA0: C1 control characters
	bool good = code >= least[bytes] && code <= 0x10FFFF && !(code >= 0xD800 && code <= 0xDFFF);
	return good ? bytes : 0;
}

void text_copy(char *out, size_t capacity, const char *in)
{
	size_t used = 0;
	while (*in && used + 1 < capacity) {
		size_t bytes = character_bytes((const unsigned char *)in);
		if (bytes == 0) {
			out[used++] = *in == '\n' || *in == '\t' ? ' ' : '?';
			in++;
			continue;
		}
		if (used + bytes + 1 > capacity)
			break;
		memcpy(out + used, in, bytes);
		used += bytes;
		in += bytes;
	}
	out[used] = '\0';
}
