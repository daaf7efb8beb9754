#include "server/loader/key_table.h"

#include <stdlib.h>
#include <string.h>
#include <sys/auxv.h>
#include <xxhash.h>

#include "shaders/shared/layout.h"

void key_table_init(struct key_table *t, size_t words)
{
	*t = (struct key_table){.words = words};
	const void *random = (const void *)getauxval(AT_RANDOM); // sixteen bytes that the kernel leaves every process
	if (random)
		memcpy(&t->seed, random, sizeof t->seed);
}

void key_table_finish(struct key_table *t)
{
	free(t->slots);
	free(t->keys);
	*t = (struct key_table){0};
}

// The slot of the key, or the empty slot where it belongs.
static uint32_t *find_slot(const struct key_table *t, const uint32_t *key)
{
	const size_t bytes = t->words * sizeof *key;
	size_t at = (size_t)XXH3_64bits_withSeed(key, bytes, t->seed) & (t->slot_count - 1);
	while (t->slots[at] != NONE && memcmp(t->keys + t->slots[at] * t->words, key, bytes) != 0)
		at = (at + 1) & (t->slot_count - 1);
	return &t->slots[at];
}

// Make room for one more key. At least half of the slots stay empty.
static enum status make_room(struct key_table *t, struct error *err)
{
	if (t->count < t->room)
		return STATUS_OK;
	const size_t room = t->room ? t->room * 2 : 1024;
	uint32_t *keys = realloc(t->keys, room * t->words * sizeof *keys);
	if (keys)
		t->keys = keys;
	uint32_t *slots = keys ? malloc(room * 2 * sizeof *slots) : NULL;
	if (!slots)
		return error_set(err, STATUS_MEMORY, "no memory for %zu distinct corners", room);
	free(t->slots);
	t->slots = slots;
	t->slot_count = room * 2;
	t->room = room;
	memset(slots, 0xFF, room * 2 * sizeof *slots);
	for (uint32_t i = 0; i < t->count; i++)
		*find_slot(t, t->keys + i * t->words) = i;
	return STATUS_OK;
}

enum status key_table_number(struct key_table *t, const uint32_t *key, uint32_t *number, struct error *err)
{
	if (make_room(t, err) != STATUS_OK)
		return err->code;
	uint32_t *slot = find_slot(t, key);
	if (*slot == NONE) {
		memcpy(t->keys + t->count * t->words, key, t->words * sizeof *key);
		*slot = t->count++;
	}
	*number = *slot;
	return STATUS_OK;
}

uint32_t key_table_find(const struct key_table *t, const uint32_t *key)
{
	return t->count > 0 ? *find_slot(t, key) : NONE;
}

void key_of_text(const char *text, uint32_t key[KEY_TEXT_WORDS])
{
	const XXH128_hash_t hash = XXH3_128bits(text, strlen(text));
	memcpy(key, &hash, sizeof hash);
}
