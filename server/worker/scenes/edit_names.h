// Names in a request: which node or material of its scene is meant. Host only, any thread.
#ifndef CANDIL_WORKER_EDIT_NAMES_H
#define CANDIL_WORKER_EDIT_NAMES_H

#include "server/scene/blob.h"

// The names of a section's elements. Each element starts with its name. A value that points into the view.
struct name_list {
	const char *first;
	size_t stride; // bytes from name to name
	uint32_t count;
	const char *kind; // "node", for a sentence
};

// The names of a section of a view. `kind` is static: what messages call an element.
struct name_list names_of(const struct blob_view *view, enum blob_section section, const char *kind);

// Whether `name` means element `i`: it is the element's name, or '#' and its number.
bool name_matches(const struct name_list *list, uint32_t i, const char *name);

// Find the one element that `name` means. STATUS_BAD_ARGUMENT if there is none or more than one.
enum status name_find(const struct name_list *list, const char *name, uint32_t *index, struct error *err);

// Say that no element has the name: fills `err` and returns STATUS_BAD_ARGUMENT.
enum status name_unknown(const struct name_list *list, const char *name, struct error *err);

#endif
