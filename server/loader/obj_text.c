#include "server/loader/obj_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum status obj_text_start(struct obj_text *t, const struct file_bytes *bytes, struct error *err)
{
	const uint8_t *b = bytes->data;
	if (bytes->size >= 2 && ((b[0] == 0xFE && b[1] == 0xFF) || (b[0] == 0xFF && b[1] == 0xFE)))
		return error_set(err, STATUS_SCENE_INVALID, "it is UTF-16 text; save it as UTF-8");
	if (memchr(b, 0, bytes->size))
		return error_set(err, STATUS_SCENE_INVALID, "it holds zero bytes, so it is no text");
	const size_t mark = bytes->size >= 3 && memcmp(b, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
	const char *text = (const char *)b;
	*t = (struct obj_text){.at = text + mark, .end = text + bytes->size, .line = 0, .next_line = 1};
	return STATUS_OK;
}

static bool is_blank(char c)
{
	return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

// The bytes of the line's end here, 0 if it does not end here. The zero byte after the text is not one of them.
static size_t line_end(const char *at)
{
	if (at[0] == '\r')
		return at[1] == '\n' ? 2 : 1;
	return at[0] == '\n' ? 1 : 0;
}

// The bytes of a backslash and the end of the line, or of the text, that it hides, else 0. Blanks may lie between them.
static size_t continuation(const char *at)
{
	if (at[0] != '\\')
		return 0;
	size_t bytes = 1;
	while (is_blank(at[bytes]))
		bytes++;
	const size_t end = line_end(at + bytes);
	return end > 0 || at[bytes] == 0 ? bytes + end : 0;
}

static bool ends_word(const char *at)
{
	return *at == 0 || is_blank(*at) || line_end(at) > 0 || continuation(at) > 0;
}

static void skip_blanks(struct obj_text *t)
{
	for (;;) {
		const size_t joint = continuation(t->at);
		if (joint > 0)
			t->next_line++;
		else if (!is_blank(*t->at))
			return;
		t->at += joint > 0 ? joint : 1;
	}
}

// Whether a number as Microsoft's runtime has written it goes on at the # here: "1.#INF", "-1.#IND00", "1.#QNAN".
static bool is_odd_tail(const char *at)
{
	return strncasecmp(at, "#INF", 4) == 0 || strncasecmp(at, "#IND", 4) == 0 || strncasecmp(at, "#QNAN", 5) == 0 ||
	       strncasecmp(at, "#SNAN", 5) == 0;
}

static bool next_word(struct obj_text *t, struct obj_word *word, bool of_name)
{
	skip_blanks(t);
	if (t->at == t->end || line_end(t->at) > 0)
		return false;
	if (*t->at == '#' && !(of_name && t->at[1] >= '0' && t->at[1] <= '9'))
		return false;
	word->at = t->at;
	while (!ends_word(t->at) && (of_name || *t->at != '#' || (t->at[-1] == '.' && is_odd_tail(t->at))))
		t->at++;
	word->size = (size_t)(t->at - word->at);
	return true;
}

bool obj_text_statement(struct obj_text *t, struct obj_word *keyword)
{
	struct obj_word rest;
	bool found = false;
	while (!found && t->at < t->end) {
		while (t->line > 0 && next_word(t, &rest, false))
			;
		if (*t->at == '#')
			while (t->at < t->end && line_end(t->at) == 0)
				t->at++;
		t->next_line += t->line > 0 && line_end(t->at) > 0;
		t->at += t->line > 0 ? line_end(t->at) : 0;
		t->line = t->next_line;
		found = next_word(t, keyword, false);
	}
	return found;
}

bool obj_text_word(struct obj_text *t, struct obj_word *word)
{
	return next_word(t, word, false);
}

bool obj_word_is(const struct obj_word *word, const char *text)
{
	return strncasecmp(word->at, text, word->size) == 0 && text[word->size] == 0;
}

// Infinite numbers and what is none, with such a tail.
static bool is_odd_number(const char *at, double *number)
{
	const bool minus = *at == '-';
	at += minus;
	if (strncmp(at, "1.", 2) != 0 || !is_odd_tail(at + 2))
		return false;
	*number = strncasecmp(at + 3, "INF", 3) != 0 ? NAN : minus ? -INFINITY : INFINITY;
	return true;
}

bool obj_word_number(const struct obj_word *word, double *number)
{
	char *end;
	*number = strtod(word->at, &end);
	return end == word->at + word->size || is_odd_number(word->at, number);
}

bool obj_text_numbers(struct obj_text *t, int most, double *numbers, int *count)
{
	struct obj_word word;
	for (*count = 0; *count < most; ++*count) {
		if (!next_word(t, &word, false))
			return true;
		if (!obj_word_number(&word, &numbers[*count]))
			return false;
	}
	return true;
}

bool obj_text_name_word(struct obj_text *t, struct obj_word *word)
{
	return next_word(t, word, true);
}

char *obj_text_name(const char *from, const char *to)
{
	if (to - from >= 2 && (*from == '"' || *from == '\'') && to[-1] == *from) {
		from++;
		to--;
	}
	char *name = malloc((size_t)(to - from) + 1);
	if (!name)
		return NULL;
	size_t size = 0;
	while (from < to) {
		const size_t joint = continuation(from);
		name[size++] = *from;
		if (joint > 0)
			name[size - 1] = ' ';
		from += joint > 0 ? joint : 1;
	}
	name[size] = 0;
	return name;
}

char *obj_text_rest(struct obj_text *t)
{
	struct obj_word word;
	const char *from = t->at, *to = t->at;
	for (bool first = true; next_word(t, &word, true); first = false) {
		from = first ? word.at : from;
		to = word.at + word.size;
	}
	return obj_text_name(from, to);
}
