// Options of a request, such as "pt.depth" = "8". A technique that takes options has a table of rules, by which their values
// are read into a struct of the technique's own. Host only, any thread.
#ifndef CANDIL_WORKER_PLAN_OPTION_H
#define CANDIL_WORKER_PLAN_OPTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "candil.pb.h"
#include "server/base/error.h"

// An option is a whole or a real number from `least` to `most`. Where there are `words` it is one of those, and its value is
// the word's place in them, or the number at that place in `numbers`.
struct option_rule {
	const char *name; // with its technique: "pt.depth"
	double least, most; // ignored where there are words
	const char *const *words; // ended by NULL; NULL: the option is a number
	const uint32_t *numbers; // NULL: a word's value is its place
	bool real; // the value is a float in the struct, else a uint32_t
	size_t offset; // of the value in the struct
};

// The rules of one struct. A technique has an array of tables, ended by one without rules: its own table, and those of the
// modules that it builds on.
struct option_table {
	const struct option_rule *rules;
	size_t count; // of the rules
	size_t offset; // of the struct that they fill in, within the technique's settings
};

// Initializers of a rule: for a whole number, a real number, a word, and a word that stands for a number. `field` is a
// member of `type`.
#define OPTION_WHOLE(name, least, most, type, field) \
	{ \
		name, least, most, NULL, NULL, false, offsetof(type, field) \
	}
#define OPTION_REAL(name, least, most, type, field) \
	{ \
		name, least, most, NULL, NULL, true, offsetof(type, field) \
	}
#define OPTION_WORD(name, words, type, field) \
	{ \
		name, 0, 0, words, NULL, false, offsetof(type, field) \
	}
#define OPTION_NUMBER(name, words, numbers, type, field) \
	{ \
		name, 0, 0, words, numbers, false, offsetof(type, field) \
	}

// Whether one of the tables has an option of this name.
bool option_known(const struct option_table *tables, const char *name);

// Read an option's value into `settings`, the technique's settings that `tables` fill in. One of the tables must have the
// option. STATUS_BAD_ARGUMENT for a value that its rule does not allow; STATUS_LIMIT for a whole number above `most`.
enum status option_set(const struct option_table *tables, const candil_Option *option, void *settings, struct error *err);

// Append to the string `out` a list, "depth, segment", of the options whose first `skip` bytes are those of `prefix`,
// without these bytes. Cut to fit `capacity` bytes.
void option_list(const struct option_table *tables, const char *prefix, size_t skip, char *out, size_t capacity);

#endif
