#include "protocol/text.h"

#include <ctype.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/limits.h"

// Bytes of the character at `text`, 0 if it is a control character or none at all: overlong forms, surrogates and
// code points past U+10FFFF are none.
static size_t text_character(const uint8_t *text)
{
	static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
	uint8_t first = text[0];
	if (first < 0x80)
		return first >= 0x20 && first != 0x7F ? 1 : 0;
	size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
	if (first < 0xC2 || first > 0xF4)
		return 0;
	uint32_t code = first & (0x7Fu >> bytes);
	for (size_t i = 1; i < bytes; i++) {
		if ((text[i] & 0xC0) != 0x80)
			return 0;
		code = code << 6 | (text[i] & 0x3Fu);
	}
	bool surrogate = code >= 0xD800 && code <= 0xDFFF;
	bool control = code >= 0x80 && code < 0xA0;
	return code >= least[bytes] && code <= 0x10FFFF && !surrogate && !control ? bytes : 0;
}

bool text_is_clean(const char *text)
{
	const uint8_t *at = (const uint8_t *)text;
	while (*at) {
		size_t bytes = text_character(at);
		if (!bytes)
			return false;
		at += bytes;
	}
	return true;
}

bool text_is_name(const char *text)
{
	size_t length = strlen(text);
	return length > 0 && length <= LIMIT_NAME && !strchr(text, '/') && text_is_clean(text);
}

void text_clean(char *text, size_t capacity)
{
	text[capacity - 1] = 0;
	for (uint8_t *at = (uint8_t *)text; *at;) {
		size_t bytes = text_character(at);
		if (!bytes) {
			*at = '?';
			bytes = 1;
		}
		at += bytes;
	}
}

bool text_is_plain_path(const char *path)
{
	if (!*path || !text_is_clean(path))
		return false;
	for (const char *at = path;;) {
		size_t length = strcspn(at, "/");
		if (length == 0 || (length == 1 && at[0] == '.') || (length == 2 && at[0] == '.' && at[1] == '.'))
			return false;
		if (!at[length])
			return true;
		at += length + 1;
	}
}

void text_copy(char *out, size_t capacity, const char *text)
{
	size_t used = 0;
	while (*text) {
		const size_t bytes = text_character((const uint8_t *)text);
		const size_t step = bytes > 0 ? bytes : 1;
		if (used + step >= capacity)
			break;
		if (bytes > 0)
			memcpy(out + used, text, bytes);
		else
			out[used] = *text == '\n' || *text == '\t' ? ' ' : '?';
		used += step;
		text += step;
	}
	memset(out + used, 0, capacity - used);
}

// Where a number with its sign ends that begins at `at`, or `at`. `before`: the character before it.
static const char *skip_number(const char *at, char before)
{
	char *end;
	const char *digit = at + (*at == '+' || *at == '-');
	if (!isdigit((unsigned char)*digit) || isalnum((unsigned char)before) || before == '_')
		return at;
	strtod(at, &end);
	return end;
}

bool text_alike(const char *a, const char *b)
{
	for (char before = ' ';; before = *a++, b++) {
		const char *const a_end = skip_number(a, before), *const b_end = skip_number(b, before);
		// A number is like another one, not like none.
		if ((a_end == a) != (b_end == b))
			return false;
		a = a_end;
		b = b_end;
		if (*a != *b)
			return false;
		if (!*a)
			return true;
	}
}
