// Options of a request, "pt.depth" = "8": read by a table that whoever takes them owns, into a struct of his own. Host only,
// any thread.
#ifndef CANDIL_WORKER_PLAN_OPTION_H
#define CANDIL_WORKER_PLAN_OPTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "candil.pb.h"
#include "server/base/error.h"

// An option is a whole number or a real one from least to most, or, where `words` are given, one of them: its place is the
// value, or `numbers` at its place.
struct option_rule {
	const char *name; // with its technique: "pt.depth"
	double least, most;
	const char *const *words; // ended by NULL; NULL: a number
	const uint32_t *numbers;
	bool real; // a float in the struct, else a uint32_t
	size_t offset; // in the struct
};

// Rules of one struct. A technique has an array of them, ended by one without rules: its own, and those of what it stands
// on.
struct option_table {
	const struct option_rule *rules;
	size_t count;
	size_t offset; // of the struct that they fill in, within the technique's settings
};

// A rule for a whole number, a real one, a word, and a word for a number.
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

// Read the option's value into `settings`, the struct that `tables` are for. One of them has it. STATUS_BAD_ARGUMENT for
// what is no such value, STATUS_LIMIT for a whole number above the most.
enum status option_set(const struct option_table *tables, const candil_Option *option, void *settings, struct error *err);

// Append the names, without their first `skip` bytes, of the options that begin as `prefix` does for so many bytes: "depth,
// segment". Cut where `capacity` bytes are too few.
void option_list(const struct option_table *tables, const char *prefix, size_t skip, char *out, size_t capacity);

#endif
