// What a picture's file says about itself: its candil/… texts, as verify.h finds them. Bounded: what is longer or more than
// candil writes is left out.
#ifndef CANDIL_CLI_METADATA_H
#define CANDIL_CLI_METADATA_H

#include "protocol/asked.h"

#define METADATA_PREFIX "candil/"
#define METADATA_KEY_BYTES 64u
#define METADATA_ENTRIES 96u

struct metadata {
	unsigned count;
	struct {
		char key[METADATA_KEY_BYTES]; // without the prefix
		char value[ASKED_TEXT_BYTES];
	} entries[METADATA_ENTRIES];
};

// Whether a text of this name and this many bytes, neither with a zero, has a place.
bool metadata_wants(const struct metadata *metadata, const char *name, size_t bytes);

// Keep one that metadata_wants.
void metadata_keep(struct metadata *metadata, const char *name, const char *value, size_t bytes);

// The text of a key, without the prefix; NULL: the file has none.
const char *metadata_find(const struct metadata *metadata, const char *key);

#endif
