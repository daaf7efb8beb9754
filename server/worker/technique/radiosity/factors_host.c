#include "server/worker/technique/radiosity/factors_host.h"

#include <stdlib.h>

void host_free(struct host_block *blocks, uint32_t count)
{
	for (uint32_t i = 0; blocks && i < count; i++)
		if (blocks[i].owned) {
			free(blocks[i].columns);
			free(blocks[i].values);
		}
	free(blocks);
}

static enum status host_read(const struct factors *f, const struct factors_block *b, struct host_block *h, struct error *err)
{
	const uint64_t bytes = (uint64_t)b->entries * sizeof(uint32_t);
	if (b->columns.map && b->values.map) {
		*h = (struct host_block){.columns = b->columns.map, .values = b->values.map};
		return STATUS_OK;
	}
	*h = (struct host_block){.columns = malloc(bytes + 1), .values = malloc(bytes + 1), .owned = true};
	if (!h->columns || !h->values)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status s = STATUS_OK;
	if (bytes > 0)
		s = buffer_read(&b->columns, f->device, 0, bytes, h->columns, err);
	if (s == STATUS_OK && bytes > 0)
		s = buffer_read(&b->values, f->device, 0, bytes, h->values, err);
	return s;
}

enum status host_read_all(const struct factors *f, struct host_block **blocks, struct error *err)
{
	*blocks = calloc(f->block_count ? f->block_count : 1, sizeof **blocks);
	enum status s = *blocks ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; s == STATUS_OK && i < f->block_count; i++)
		s = host_read(f, &f->blocks[i], &(*blocks)[i], err);
	if (s != STATUS_OK) {
		host_free(*blocks, f->block_count);
		*blocks = NULL;
	}
	return s;
}

enum status factors_host_refresh(struct factors_host *h, const struct factors *f, bool *anew, struct error *err)
{
	*anew = !h->blocks || h->changes != f->changes;
	if (!*anew)
		return STATUS_OK;
	factors_host_finish(h);
	h->block_count = f->block_count;
	h->changes = f->changes;
	return host_read_all(f, &h->blocks, err);
}

void factors_host_finish(struct factors_host *h)
{
	host_free(h->blocks, h->block_count);
	*h = (struct factors_host){0};
}

struct row_view host_row(const struct factors *f, const struct host_block *blocks, uint32_t i)
{
	const struct factors_row *r = &f->rows[i];
	if (r->block == NONE)
		return (struct row_view){.count = 0};
	return (struct row_view){.columns = blocks[r->block].columns + r->first,
				 .values = blocks[r->block].values + r->first,
				 .count = r->count,
				 .there = true};
}

double host_sum(const struct row_view *row)
{
	double sum = 0;
	for (uint32_t k = 0; k < row->count; k++)
		sum += (double)row->values[k];
	return sum;
}
