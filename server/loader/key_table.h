// Distinct keys, numbered in the order in which they came. One thread.
#ifndef CANDIL_LOADER_KEY_TABLE_H
#define CANDIL_LOADER_KEY_TABLE_H

#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

struct key_table {
	uint32_t *slots; // numbers, NONE where empty
	uint32_t *keys; // `words` each
	size_t words;
	size_t slot_count; // a power of two
	size_t room;
	uint32_t count;
};

// Keys of `words` words, compared bit by bit.
void key_table_init(struct key_table *table, size_t words);
void key_table_finish(struct key_table *table);

// The key's number; table->count grows by one where it is new. STATUS_MEMORY.
enum status key_table_number(struct key_table *table, const uint32_t *key, uint32_t *number, struct error *err);

#endif
