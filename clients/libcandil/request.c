#include "clients/libcandil/request.h"

#include <stdlib.h>
#include <string.h>

#define SLOTS (2u * REQUEST_OPEN_MAX)

struct request *request_find(struct request_table *table, uint32_t id)
{
	for (size_t i = 0; id != 0 && i < SLOTS; i++) {
		if (table->slots[i].id == id)
			return &table->slots[i];
	}
	return NULL;
}

struct request *request_any(struct request_table *table)
{
	for (size_t i = 0; i < SLOTS; i++) {
		if (table->slots[i].id != 0)
			return &table->slots[i];
	}
	return NULL;
}

bool request_any_audible(const struct request_table *table)
{
	for (size_t i = 0; i < SLOTS; i++) {
		if (table->slots[i].id != 0 && !table->slots[i].silent)
			return true;
	}
	return false;
}

struct request *request_slot(struct request_table *table, bool silent)
{
	struct request *slot = NULL;
	uint32_t open = 0;
	for (size_t i = 0; i < SLOTS; i++) {
		struct request *r = &table->slots[i];
		if (r->id == 0)
			slot = slot ? slot : r;
		else if (r->silent == silent)
			open++;
	}
	return open < REQUEST_OPEN_MAX ? slot : NULL;
}

uint32_t request_new_id(struct request_table *table)
{
	do
		table->last_id++;
	while (table->last_id == 0 || request_find(table, table->last_id));
	return table->last_id;
}

void request_open(struct request *slot, uint32_t id, uint8_t type, bool silent)
{
	memset(slot, 0, sizeof(*slot));
	slot->id = id;
	slot->type = type;
	slot->silent = silent;
}

void request_close(struct request *request)
{
	free(request->image.data);
	memset(request, 0, sizeof(*request));
}

void request_close_all(struct request_table *table)
{
	for (size_t i = 0; i < SLOTS; i++)
		request_close(&table->slots[i]);
}
