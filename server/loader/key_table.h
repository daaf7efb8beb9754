// A set of distinct keys, numbered in the order of their first appearance. One thread.
#ifndef CANDIL_LOADER_KEY_TABLE_H
#define CANDIL_LOADER_KEY_TABLE_H

#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

struct key_table {
	uint32_t *slots; // numbers of keys, NONE if empty
	uint32_t *keys; // `words` words each
	size_t words;
	size_t slot_count; // a power of two
	size_t room;
	uint32_t count;
	uint64_t seed;
};

// Start an empty table for keys of `words` words, which are compared bit by bit. key_table_finish frees it. Its slots are
// drawn anew in each process, so that no file can be made whose keys all want the same.
void key_table_init(struct key_table *table, size_t words);
void key_table_finish(struct key_table *table);

// The key's number. If the key is new, it is copied, and table->count grows by one. STATUS_MEMORY.
enum status key_table_number(struct key_table *table, const uint32_t *key, uint32_t *number, struct error *err);

// The same of a key that may not be there: NONE.
uint32_t key_table_find(const struct key_table *table, const uint32_t *key);

// Keys for texts are 128 bits of hash, which tell them apart.
#define KEY_TEXT_WORDS 4
void key_of_text(const char *text, uint32_t key[KEY_TEXT_WORDS]);

#endif
