// The text of an OBJ or MTL file, read in place: statements, which may go on over several lines, and their words. One
// thread.
#ifndef CANDIL_LOADER_OBJ_TEXT_H
#define CANDIL_LOADER_OBJ_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "server/base/error.h"
#include "server/loader/files.h"

struct obj_text {
	const char *at, *end; // what is not read yet; a zero byte lies at `end`
	size_t line; // the number of the line that `at` is in
	size_t next_line;
};

// A word of the text, not ended by a zero byte.
struct obj_word {
	const char *at;
	size_t size;
};

// Start at the head of a text, after a byte order mark. STATUS_SCENE_INVALID: it is UTF-16, or holds zero bytes.
enum status obj_text_start(struct obj_text *text, const struct file_bytes *bytes, struct error *err);

// Go to the next statement and read its keyword. text->line is the number of its line. False at the end. What remains of the
// statement before is skipped, and so are blank lines and comments: a # where a word could begin, up to the line's end.
// A backslash at the end of a line continues the statement, but not a comment.
bool obj_text_statement(struct obj_text *text, struct obj_word *keyword);

// Read the statement's next word. False if there is none. A # ends it, but in "1.#INF".
bool obj_text_word(struct obj_text *text, struct obj_word *word);
// Likewise, a word of a name: a # within it, or before a digit, is part of it.
bool obj_text_name_word(struct obj_text *text, struct obj_word *word);

// Whether the word is `text`, whatever its case.
bool obj_word_is(const struct obj_word *word, const char *text);

// Read the whole word as a number, which may be infinite or NaN. False: it is none.
bool obj_word_number(const struct obj_word *word, double *number);

// Read up to `most` numbers. *count becomes how many there are. False if a word is in the way that is no number.
bool obj_text_numbers(struct obj_text *text, int most, double *numbers, int *count);

// Read what remains of the statement as one name, with the blanks in it, but without those around it and without quotes. A #
// before a digit begins no comment here, as in "Material #25". The caller frees the name. It is empty if nothing remains,
// and NULL if there is no memory.
char *obj_text_rest(struct obj_text *text);

// Copy the bytes from `from` to `to` as such a name.
char *obj_text_name(const char *from, const char *to);

#endif
