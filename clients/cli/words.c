#include "clients/cli/words.h"

#include <stdlib.h>
#include <string.h>

#include "protocol/names.h"

#define COLUMNS 116u // of a help text

struct words {
	FILE *out;
	unsigned column, indent;
};

static void words_put(struct words *w, const char *text, size_t bytes)
{
	for (size_t i = 0; i < bytes; i++) {
		// Only the first byte of a UTF-8 character takes a column.
		w->column += ((unsigned char)text[i] & 0xC0) != 0x80;
		if (text[i] == '\n')
			w->column = 0;
	}
	fwrite(text, 1, bytes, w->out);
}

// `between` ends with a space.
static void words_put_names(struct words *w, const char *between, const char *const *names, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		const char *name = names[i];
		const char *before = i == 0 ? "" : i == count - 1 ? " or " : between;
		if (w->indent > 0 && w->column + strlen(before) + strlen(name) > COLUMNS) {
			// The line ends in place of the space at the end of `before`.
			words_put(w, before, before[0] ? strlen(before) - 1 : 0);
			fprintf(w->out, "\n%*s", (int)w->indent, "");
			w->column = w->indent;
		} else {
			words_put(w, before, strlen(before));
		}
		words_put(w, name, strlen(name));
	}
}

static void words_put_effects(struct words *w)
{
#define EFFECT_NAME(NAME, number, name, ...) name,
	static const char *const names[] = {CANDIL_EFFECT_LIST(EFFECT_NAME)};
	words_put_names(w, ", ", names, sizeof(names) / sizeof(names[0]));
}

static void words_put_shares(struct words *w)
{
#define SHARE_NAME(field, name) name,
	static const char *const names[] = {CANDIL_MATERIAL_SHARES(SHARE_NAME)};
	words_put_names(w, ", ", names, sizeof(names) / sizeof(names[0]));
}

static void words_put_lights(struct words *w)
{
#define LIGHT_FORM(NAME, number, name, traits, called, form) form,
	static const char *const forms[] = {CANDIL_LIGHT_KIND_LIST(LIGHT_FORM)};
	words_put_names(w, " or ", forms, sizeof(forms) / sizeof(forms[0]));
}

static void words_put_techniques(struct words *w, unsigned traits)
{
	char list[256];
	technique_list(traits, "or", list, sizeof(list));
	words_put(w, list, strlen(list));
}

static void words_put_auto(struct words *w)
{
	const char *name = technique_name(TECHNIQUE_OF_AUTO);
	words_put(w, name, strlen(name));
}

// Print what the mark at `text` stands for. Returns the length of the mark; 0: there is none.
static size_t words_put_mark(struct words *w, const char *text)
{
	static const struct {
		const char *mark;
		unsigned traits; // of the techniques that are listed, unless there is `put`
		void (*put)(struct words *w);
	} marks[] = {
	    {"{techniques}", TECHNIQUE_RENDERS, NULL},
	    {"{noise}", TECHNIQUE_NOISE, NULL},
	    {"{voxels}", TECHNIQUE_VOXELS, NULL},
	    {"{patches}", TECHNIQUE_PATCHES, NULL},
	    {"{auto}", 0, words_put_auto},
	    {"{effects}", 0, words_put_effects},
	    {"{shares}", 0, words_put_shares},
	    {"{lights}", 0, words_put_lights},
	};
	for (size_t i = 0; i < sizeof(marks) / sizeof(marks[0]); i++) {
		const size_t length = strlen(marks[i].mark);
		if (strncmp(text, marks[i].mark, length) != 0)
			continue;
		if (marks[i].put)
			marks[i].put(w);
		else
			words_put_techniques(w, marks[i].traits);
		return length;
	}
	return 0;
}

void words_print(FILE *out, const char *text, unsigned indent)
{
	struct words w = {.out = out, .indent = indent};
	while (*text) {
		const size_t plain = strcspn(text, "{");
		words_put(&w, text, plain);
		text += plain;
		const size_t mark = words_put_mark(&w, text);
		if (mark == 0 && *text)
			words_put(&w, text++, 1);
		text += mark;
	}
}

char *words_text(const char *text)
{
	char *filled = NULL;
	size_t bytes;
	FILE *out = open_memstream(&filled, &bytes);
	if (!out)
		return NULL;
	words_print(out, text, 0);
	if (fclose(out) != 0) {
		free(filled);
		return NULL;
	}
	return filled;
}
