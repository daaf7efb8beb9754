// What a request names in its scene.
#ifndef CANDIL_WORKER_EDIT_NAMES_H
#define CANDIL_WORKER_EDIT_NAMES_H

#include "server/scene/blob.h"

// Where the names of a section's elements are: each element starts with one.
struct name_list {
	const char *first;
	size_t stride;
	uint32_t count;
	const char *kind; // "node", for a sentence
};

struct name_list names_of(const struct blob_view *view, enum blob_section section, const char *kind);

// Whether element `i` is meant by `name`: it has it, or `name` is '#' and its number.
bool name_matches(const struct name_list *list, uint32_t i, const char *name);

// The one element that is meant. STATUS_BAD_ARGUMENT if there is none or more than one.
enum status name_find(const struct name_list *list, const char *name, uint32_t *index, struct error *err);

// STATUS_BAD_ARGUMENT: there is none.
enum status name_unknown(const struct name_list *list, const char *name, struct error *err);

#endif
