#include "server/worker/technique/radiosity/factors.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/worker/technique/radiosity/factors_blocks.h"
#include "server/worker/vk/command.h"
#include "server/worker/vk/pipeline.h"

// Entries of the first block. Every further one is half as large as all before it, so that few blocks hold many entries and
// a small matrix takes little.
#define FIRST_ENTRIES 65536u

// What is left free of the largest buffer: such that buffer_init finds a size which all shaders have the same code for.
#define SPARE_BYTES 1024u

#define HOLES_LEAST (1u << 18) // fewer are never worth moving a matrix

static const struct factors_row no_row = {.block = NONE};

static uint64_t least(uint64_t a, uint64_t b)
{
	return a < b ? a : b;
}

static uint32_t capacity(const struct factors_block *b)
{
	return (uint32_t)(b->columns.bytes / sizeof(uint32_t));
}

enum status factors_init(struct factors *f, struct device *device, uint32_t side, struct error *err)
{
	const uint64_t texels = (uint64_t)device->limits.maxTexelBufferElements * PIPELINE_TEXEL_BYTES;
	const uint64_t bytes = least(least(FACTORS_BLOCK_BYTES, device->limits.maxStorageBufferRange), texels) - SPARE_BYTES;
	*f = (struct factors){.device = device, .side = side, .packs_on_host = device->info.software};
	f->block_entries = (uint32_t)(bytes / sizeof(uint32_t)) / FACTORS_ALIGN * FACTORS_ALIGN;
	f->rows = malloc((side ? side : 1) * sizeof *f->rows);
	if (!f->rows)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < side; i++)
		f->rows[i] = no_row;
	return STATUS_OK;
}

static void block_finish(struct factors_block *b, struct device *device)
{
	buffer_finish(&b->columns, device);
	buffer_finish(&b->values, device);
}

void factors_finish(struct factors *f)
{
	for (uint32_t i = 0; i < f->block_count; i++)
		block_finish(&f->blocks[i], f->device);
	free(f->blocks);
	free(f->rows);
	memset(f, 0, sizeof *f);
}

uint64_t factors_bytes_most(uint64_t entries, uint64_t rows)
{
	const uint64_t all = entries + rows * (FACTORS_ALIGN - 1),
		       spare = least(all / 2, FACTORS_BLOCK_BYTES / sizeof(uint32_t));
	return (all + (spare > FIRST_ENTRIES ? spare : FIRST_ENTRIES)) * (sizeof(uint32_t) + sizeof(float));
}

uint64_t factors_bytes(const struct factors *f)
{
	uint64_t bytes = 0;
	for (uint32_t i = 0; i < f->block_count; i++)
		bytes += f->blocks[i].columns.allocated + f->blocks[i].values.allocated;
	return bytes;
}

// ---- room
// -----------------------------------------------------------------------------------------------------------------

static enum status block_init(struct factors_block *b, struct device *device, uint32_t entries, struct error *err)
{
	const uint64_t bytes = (uint64_t)entries * sizeof(uint32_t);
	*b = (struct factors_block){0};
	enum status s = buffer_init(&b->columns, device, bytes, BUFFER_DEVICE, err);
	if (s == STATUS_OK)
		s = buffer_init(&b->values, device, bytes, BUFFER_DEVICE, err);
	if (s == STATUS_OK)
		s = buffer_clear(&b->columns, device, err);
	if (s == STATUS_OK)
		s = buffer_clear(&b->values, device, err);
	if (s != STATUS_OK)
		block_finish(b, device);
	return s;
}

// Add a block for `first` entries at least, and, if it can be, for `wanted`, or for half as many as there are already.
static enum status add_block(struct factors *f, uint32_t first, uint64_t wanted, struct error *err)
{
	uint64_t all = 0;
	if (first > f->block_entries)
		return error_set(err, STATUS_MEMORY, "a row of %u form factors is more than this device can bind at once",
				 first);
	for (uint32_t i = 0; i < f->block_count; i++)
		all += capacity(&f->blocks[i]);
	wanted = wanted > FACTORS_ALIGN ? wanted : FACTORS_ALIGN;
	all = wanted > all / 2 ? wanted : all / 2 / FACTORS_ALIGN * FACTORS_ALIGN;
	all = least(all > FIRST_ENTRIES ? all : FIRST_ENTRIES, f->block_entries);
	struct factors_block *blocks = realloc(f->blocks, (f->block_count + 1) * sizeof *blocks);
	if (!blocks)
		return error_set(err, STATUS_MEMORY, "out of memory");
	f->blocks = blocks;
	struct factors_block *b = &blocks[f->block_count];
	enum status s = block_init(b, f->device, (uint32_t)all, err);
	if (s == STATUS_MEMORY)
		s = block_init(b, f->device, (uint32_t)least(wanted, f->block_entries), err);
	if (s == STATUS_OK)
		f->block_count++;
	return s;
}

void factors_undo(struct factors *f, const struct factors_mark *before)
{
	while (f->block_count > before->block_count)
		block_finish(&f->blocks[--f->block_count], f->device);
	if (f->block_count > 0)
		f->blocks[f->block_count - 1].entries = before->entries;
}

enum status factors_find(struct factors *f, const uint32_t *counts, uint32_t n, struct factors_place *places,
			 struct factors_mark *before, struct error *err)
{
	uint64_t wanted = 0;
	f->changes++;
	*before = (struct factors_mark){.block_count = f->block_count};
	if (f->block_count > 0)
		before->entries = f->blocks[f->block_count - 1].entries;
	for (uint32_t i = 0; i < n; i++)
		wanted += factors_padded(counts[i]);
	for (uint32_t i = 0; i < n; i++) {
		const uint32_t room = factors_padded(counts[i]);
		struct factors_block *last = f->block_count > 0 ? &f->blocks[f->block_count - 1] : NULL;
		if (!last || capacity(last) - last->entries < room) {
			enum status s = add_block(f, room, wanted, err);
			if (s != STATUS_OK) {
				factors_undo(f, before);
				return s;
			}
			last = &f->blocks[f->block_count - 1];
		}
		places[i] = (struct factors_place){.block = f->block_count - 1, .first = last->entries};
		last->entries += room;
		wanted -= room;
	}
	return STATUS_OK;
}

// ---- rows
// -----------------------------------------------------------------------------------------------------------------

static bool is_row(const uint32_t *columns, const float *values, uint32_t count, uint32_t side)
{
	for (uint32_t k = 0; k < count; k++)
		if (columns[k] >= side || (k > 0 && columns[k] <= columns[k - 1]) || !(values[k] >= 0) ||
		    !isfinite(values[k]))
			return false;
	return true;
}

// Write a row where the host does not see the block, in one go.
static enum status send_row(const struct factors *f, const struct factors_block *b, uint32_t first, const uint32_t *columns,
			    const float *values, uint32_t count, struct error *err)
{
	const uint64_t bytes = (uint64_t)count * sizeof(uint32_t);
	struct buffer staging;
	enum status s = buffer_init(&staging, f->device, 2 * bytes, BUFFER_STAGING, err);
	if (s != STATUS_OK)
		return s;
	memcpy(staging.map, columns, bytes);
	memcpy((char *)staging.map + bytes, values, bytes);
	s = command_begin(f->device, err);
	if (s == STATUS_OK) {
		VkBufferCopy region = {.dstOffset = (uint64_t)first * sizeof(uint32_t), .size = bytes};
		vkCmdCopyBuffer(f->device->commands, staging.handle, b->columns.handle, 1, &region);
		region.srcOffset = bytes;
		vkCmdCopyBuffer(f->device->commands, staging.handle, b->values.handle, 1, &region);
		command_barrier(f->device);
		s = command_finish(f->device, err);
	}
	buffer_finish(&staging, f->device);
	return s;
}

enum status factors_put_row(struct factors *f, const struct factors_put *row, const uint32_t *columns, const float *values,
			    uint32_t count, struct error *err)
{
	struct factors_place place;
	struct factors_mark before;
	if (row->element >= f->side || !is_row(columns, values, count, f->side))
		return error_set(err, STATUS_INTERNAL, "row %u of the form factors is none of this matrix", row->element);
	factors_tidy(f);
	enum status s = factors_find(f, &count, 1, &place, &before, err);
	if (s != STATUS_OK)
		return s;
	const struct factors_block *b = &f->blocks[place.block];
	if (count > 0 && b->columns.map && b->values.map) {
		memcpy((uint32_t *)b->columns.map + place.first, columns, count * sizeof *columns);
		memcpy((float *)b->values.map + place.first, values, count * sizeof *values);
	} else if (count > 0) {
		s = send_row(f, b, place.first, columns, values, count, err);
	}
	if (s != STATUS_OK) {
		factors_undo(f, &before);
		return s;
	}
	factors_remove_row(f, row->element);
	f->rows[row->element] = (struct factors_row){
	    .block = place.block, .first = place.first, .count = count, .escaped = row->escaped, .cut = row->cut};
	f->entries += count;
	return STATUS_OK;
}

enum status factors_read_row(const struct factors *f, uint32_t i, uint32_t **columns, float **values, struct error *err)
{
	const struct factors_row *r = &f->rows[i];
	const uint64_t offset = (uint64_t)r->first * sizeof(uint32_t), bytes = (uint64_t)r->count * sizeof(uint32_t);
	*columns = NULL;
	*values = NULL;
	if (r->block == NONE || r->count == 0)
		return STATUS_OK;
	*columns = malloc(bytes);
	*values = malloc(bytes);
	enum status s = *columns && *values ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	if (s == STATUS_OK)
		s = buffer_read(&f->blocks[r->block].columns, f->device, offset, bytes, *columns, err);
	if (s == STATUS_OK)
		s = buffer_read(&f->blocks[r->block].values, f->device, offset, bytes, *values, err);
	if (s != STATUS_OK) {
		free(*columns);
		free(*values);
		*columns = NULL;
		*values = NULL;
	}
	return s;
}

void factors_remove_row(struct factors *f, uint32_t i)
{
	struct factors_row *r = &f->rows[i];
	if (r->block == NONE)
		return;
	f->changes++;
	f->holes += factors_padded(r->count);
	f->entries -= r->count;
	*r = no_row;
}

// ---- rows that move
// -------------------------------------------------------------------------------------------------------

static void move(const struct factors *f, const struct buffer *from, uint32_t first, const struct buffer *to,
		 uint32_t to_first, uint32_t count)
{
	const VkBufferCopy region = {.srcOffset = (uint64_t)first * sizeof(uint32_t),
				     .dstOffset = (uint64_t)to_first * sizeof(uint32_t),
				     .size = (uint64_t)count * sizeof(uint32_t)};
	vkCmdCopyBuffer(f->device->commands, from->handle, to->handle, 1, &region);
}

// Record and run the copies of n rows to their places in a matrix, in one submission. `elements` NULL: all rows in order.
static enum status copy_rows(const struct factors *f, const struct factors *to, const uint32_t *elements, uint32_t n,
			     const struct factors_place *places, struct error *err)
{
	enum status s = command_begin(f->device, err);
	if (s != STATUS_OK)
		return s;
	for (uint32_t i = 0; i < n; i++) {
		const struct factors_row *r = &f->rows[elements ? elements[i] : i];
		if (r->block == NONE || r->count == 0)
			continue;
		const struct factors_block *a = &f->blocks[r->block], *b = &to->blocks[places[i].block];
		move(f, &a->columns, r->first, &b->columns, places[i].first, r->count);
		move(f, &a->values, r->first, &b->values, places[i].first, r->count);
	}
	command_barrier(f->device);
	return command_finish(f->device, err);
}

enum status factors_take(struct factors *f, const struct factors *from, const uint32_t *elements, uint32_t n,
			 struct error *err)
{
	struct factors_mark before;
	uint32_t *counts = malloc((n + 1) * sizeof *counts);
	struct factors_place *places = malloc((n + 1) * sizeof *places);
	enum status s = counts && places ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; s == STATUS_OK && i < n; i++)
		counts[i] = from->rows[elements[i]].count;
	if (s == STATUS_OK)
		s = factors_find(f, counts, n, places, &before, err);
	if (s == STATUS_OK) {
		s = copy_rows(from, f, elements, n, places, err);
		if (s != STATUS_OK)
			factors_undo(f, &before);
	}
	for (uint32_t i = 0; s == STATUS_OK && i < n; i++) {
		struct factors_row *row = &f->rows[elements[i]];
		*row = from->rows[elements[i]];
		row->block = places[i].block;
		row->first = places[i].first;
		f->entries += row->count;
	}
	free(counts);
	free(places);
	return s;
}

enum status factors_compact(struct factors *f, struct error *err)
{
	struct factors next = {.device = f->device, .block_entries = f->block_entries};
	struct factors_mark before;
	uint32_t *counts = calloc(f->side ? f->side : 1, sizeof *counts);
	struct factors_place *places = malloc((f->side ? f->side : 1) * sizeof *places);
	enum status s = counts && places ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; s == STATUS_OK && i < f->side; i++)
		counts[i] = f->rows[i].block == NONE ? 0 : f->rows[i].count;
	if (s == STATUS_OK)
		s = factors_find(&next, counts, f->side, places, &before, err);
	if (s == STATUS_OK)
		s = copy_rows(f, &next, NULL, f->side, places, err);
	if (s != STATUS_OK)
		goto done;
	for (uint32_t i = 0; i < f->side; i++)
		if (f->rows[i].block != NONE) {
			f->rows[i].block = places[i].block;
			f->rows[i].first = places[i].first;
		}
	const struct factors old = *f;
	f->blocks = next.blocks;
	f->block_count = next.block_count;
	f->holes = 0;
	f->changes++;
	next.blocks = old.blocks;
	next.block_count = old.block_count;
done:
	factors_finish(&next);
	free(counts);
	free(places);
	return s;
}

void factors_tidy(struct factors *f)
{
	// Without room for it the rows stay where they are.
	if (f->holes > f->entries && f->holes > HOLES_LEAST)
		(void)factors_compact(f, NULL);
}
