#include "clients/cli/metadata.h"

#include <stdio.h>
#include <string.h>

#define PREFIX_BYTES (sizeof(METADATA_PREFIX) - 1)

bool metadata_wants(const struct metadata *metadata, const char *name, size_t bytes)
{
	return metadata->count < METADATA_ENTRIES && strncmp(name, METADATA_PREFIX, PREFIX_BYTES) == 0 &&
	       strlen(name) - PREFIX_BYTES < METADATA_KEY_BYTES && bytes < ASKED_TEXT_BYTES;
}

void metadata_keep(struct metadata *metadata, const char *name, const char *value, size_t bytes)
{
	const unsigned i = metadata->count++;
	snprintf(metadata->entries[i].key, METADATA_KEY_BYTES, "%s", name + PREFIX_BYTES);
	memcpy(metadata->entries[i].value, value, bytes);
	metadata->entries[i].value[bytes] = '\0';
}

const char *metadata_find(const struct metadata *metadata, const char *key)
{
	for (unsigned i = 0; i < metadata->count; i++)
		if (strcmp(metadata->entries[i].key, key) == 0)
			return metadata->entries[i].value;
	return NULL;
}
