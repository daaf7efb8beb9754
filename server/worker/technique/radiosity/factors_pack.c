// factors_put_dense: on the host where the device's memory is the host's, else by a shader.
#include <stdlib.h>
#include <string.h>

#include "server/worker/technique/radiosity/factors_blocks.h"
#include "server/worker/vk/command.h"
#include "server/worker/vk/pipeline.h"
#include "shaders/factors_pack_comp.h"
#include "shaders/shared/factors.h"

#define WORDS_AT_ONCE 8u // that the host looks at
#define ROWS_PER_DISPATCH 32768u // every device takes so many groups

static const struct shader pack_shader = {.name = "factors_pack",
					  .code = shader_factors_pack_comp,
					  .bytes = sizeof shader_factors_pack_comp,
					  .bindings = BIND_FACTORS_COUNT,
					  .push_bytes = sizeof(struct factors_push)};

// A call of factors_put_dense.
struct batch {
	struct factors *factors;
	const struct buffer *dense;
	const struct factors_put *rows;
	uint32_t count;
	float scale;
	uint32_t *counts; // by row
	struct factors_place *places; // by row
	struct buffer lanes; // by row and lane: entries; then where they go. With no shader: none
};

// ---- on the host
// ----------------------------------------------------------------------------------------------------------

// 0 if none of them has a bit.
static uint64_t any_of(const uint32_t words[WORDS_AT_ONCE])
{
	uint64_t pairs[WORDS_AT_ONCE / 2];
	memcpy(pairs, words, sizeof pairs);
	return (pairs[0] | pairs[1]) | (pairs[2] | pairs[3]);
}

static uint32_t count_words(const uint32_t *words, uint32_t count)
{
	uint32_t n = 0, i = 0;
	for (; i + WORDS_AT_ONCE <= count; i += WORDS_AT_ONCE)
		if (any_of(words + i))
			for (uint32_t k = 0; k < WORDS_AT_ONCE; k++)
				n += words[i + k] != 0;
	for (; i < count; i++)
		n += words[i] != 0;
	return n;
}

// `entries` of the words are not zero. A processor foresees few of them, so as long as there are enough entries to come,
// which overwrite what was written in vain, no branch asks.
static void pack_words(const uint32_t *words, uint32_t entries, float scale, uint32_t *columns, float *values)
{
	uint32_t n = 0, i = 0;
	while (n + WORDS_AT_ONCE <= entries) {
		const uint32_t group = any_of(words + i) ? WORDS_AT_ONCE : 0;
		for (uint32_t k = 0; k < group; k++) {
			columns[n] = i + k;
			values[n] = (float)words[i + k] * scale;
			n += words[i + k] != 0;
		}
		i += WORDS_AT_ONCE;
	}
	for (; n < entries; i++)
		if (words[i] != 0) {
			columns[n] = i;
			values[n++] = (float)words[i] * scale;
		}
}

static void host_count(struct batch *b)
{
	const uint32_t side = b->factors->side, *words = b->dense->map;
	for (uint32_t k = 0; k < b->count; k++)
		b->counts[k] = count_words(words + (size_t)k * side, side);
}

static void host_write(const struct batch *b)
{
	const uint32_t side = b->factors->side;
	for (uint32_t k = 0; k < b->count; k++) {
		const struct factors_block *to = &b->factors->blocks[b->places[k].block];
		uint32_t *words = (uint32_t *)b->dense->map + (size_t)k * side;
		pack_words(words, b->counts[k], b->scale, (uint32_t *)to->columns.map + b->places[k].first,
			   (float *)to->values.map + b->places[k].first);
		memset(words, 0, side * sizeof *words);
	}
}

// ---- by the shader
// --------------------------------------------------------------------------------------------------------

static void record_pack(const struct batch *b, const struct binding_set *set, uint32_t first, uint32_t end, bool writes)
{
	VkCommandBuffer c = b->factors->device->commands;
	struct factors_push push = {.side = b->factors->side, .writes = writes, .scale = b->scale};
	vkCmdBindPipeline(c, VK_PIPELINE_BIND_POINT_COMPUTE, set->pipeline->handle);
	vkCmdBindDescriptorSets(c, VK_PIPELINE_BIND_POINT_COMPUTE, set->pipeline->layout, 0, 1, &set->set, 0, NULL);
	while (first < end) {
		const uint32_t rows = end - first < ROWS_PER_DISPATCH ? end - first : ROWS_PER_DISPATCH;
		push.first_row = first;
		vkCmdPushConstants(c, set->pipeline->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
		vkCmdDispatch(c, rows, 1, 1);
		first += rows;
	}
}

// Run the shader over rows [first, end), which all go to `block` (NULL: they are counted).
static enum status run_pack(struct batch *b, const struct factors_block *block, uint32_t first, uint32_t end,
			    struct error *err)
{
	struct device *d = b->factors->device;
	struct pipeline *pipeline;
	struct binding_set set;
	const struct buffer *buffers[BIND_MOST] = {NULL};
	buffers[BIND_FACTORS_DENSE] = b->dense;
	buffers[BIND_FACTORS_COUNTS] = &b->lanes;
	buffers[BIND_FACTORS_COLUMNS] = block ? &block->columns : NULL;
	buffers[BIND_FACTORS_VALUES] = block ? &block->values : NULL;
	enum status s = pipeline_get(d, &pack_shader, NULL, &pipeline, err);
	if (s == STATUS_OK)
		s = binding_set_init(&set, d, pipeline, buffers, &b->lanes, err);
	if (s != STATUS_OK)
		return s;
	s = command_begin(d, err);
	if (s == STATUS_OK) {
		record_pack(b, &set, first, end, block != NULL);
		command_barrier(d);
		s = command_finish(d, err);
	}
	if (s == STATUS_OK && !pipeline->warm)
		pipeline_has_run(d, pipeline);
	binding_set_finish(&set, d);
	return s;
}

static enum status shader_count(struct batch *b, struct error *err)
{
	const uint64_t bytes = (uint64_t)b->count * FACTORS_LANES * sizeof(uint32_t);
	enum status s = buffer_init(&b->lanes, b->factors->device, bytes, BUFFER_READBACK, err);
	if (s == STATUS_OK)
		s = run_pack(b, NULL, 0, b->count, err);
	if (s != STATUS_OK)
		return s;
	const uint32_t *lanes = b->lanes.map;
	for (uint32_t k = 0; k < b->count; k++) {
		b->counts[k] = 0;
		for (uint32_t lane = 0; lane < FACTORS_LANES; lane++)
			b->counts[k] += lanes[k * FACTORS_LANES + lane];
	}
	return STATUS_OK;
}

static enum status clear_dense(const struct batch *b, struct error *err)
{
	struct device *d = b->factors->device;
	enum status s = command_begin(d, err);
	if (s != STATUS_OK)
		return s;
	vkCmdFillBuffer(d->commands, b->dense->handle, 0, (uint64_t)b->count * b->factors->side * sizeof(uint32_t), 0);
	command_barrier(d);
	return command_finish(d, err);
}

static enum status shader_write(struct batch *b, struct error *err)
{
	uint32_t *lanes = b->lanes.map;
	for (uint32_t k = 0; k < b->count; k++) {
		uint32_t at = b->places[k].first;
		for (uint32_t lane = k * FACTORS_LANES; lane < (k + 1) * FACTORS_LANES; lane++) {
			const uint32_t entries = lanes[lane];
			lanes[lane] = at;
			at += entries;
		}
	}
	enum status s = STATUS_OK;
	for (uint32_t first = 0, end; s == STATUS_OK && first < b->count; first = end) {
		end = first + 1;
		while (end < b->count && b->places[end].block == b->places[first].block)
			end++;
		s = run_pack(b, &b->factors->blocks[b->places[first].block], first, end, err);
	}
	return s == STATUS_OK ? clear_dense(b, err) : s;
}

// ---- both
// -----------------------------------------------------------------------------------------------------------------

static enum status check_batch(const struct batch *b, struct error *err)
{
	const struct factors *f = b->factors;
	if ((uint64_t)b->count * f->side * sizeof(uint32_t) > b->dense->bytes)
		return error_set(err, STATUS_INTERNAL, "%u rows of form factors are more than their buffer holds", b->count);
	for (uint32_t k = 0; k < b->count; k++)
		if (b->rows[k].element >= f->side || f->rows[b->rows[k].element].block != NONE)
			return error_set(err, STATUS_INTERNAL, "row %u of the form factors is none that is empty",
					 b->rows[k].element);
	return STATUS_OK;
}

static void take_rows(const struct batch *b)
{
	struct factors *f = b->factors;
	for (uint32_t k = 0; k < b->count; k++) {
		f->rows[b->rows[k].element] = (struct factors_row){.block = b->places[k].block,
								   .first = b->places[k].first,
								   .count = b->counts[k],
								   .escaped = b->rows[k].escaped,
								   .cut = b->rows[k].cut};
		f->entries += b->counts[k];
	}
}

enum status factors_put_dense(struct factors *f, const struct buffer *dense, double unit, const struct factors_put *rows,
			      uint32_t count, struct error *err)
{
	struct batch b = {.factors = f, .dense = dense, .rows = rows, .count = count, .scale = (float)(1.0 / unit)};
	struct factors_mark before;
	enum status s = check_batch(&b, err);
	if (s != STATUS_OK || count == 0)
		return s;
	const bool on_host = f->packs_on_host && dense->map;
	factors_tidy(f);
	b.counts = malloc(count * sizeof *b.counts);
	b.places = malloc(count * sizeof *b.places);
	if (!b.counts || !b.places)
		s = error_set(err, STATUS_MEMORY, "out of memory");
	else if (on_host)
		host_count(&b);
	else
		s = shader_count(&b, err);
	if (s == STATUS_OK)
		s = factors_find(f, b.counts, count, b.places, &before, err);
	if (s == STATUS_OK && on_host) {
		host_write(&b);
	} else if (s == STATUS_OK) {
		s = shader_write(&b, err);
		if (s != STATUS_OK)
			factors_undo(f, &before);
	}
	if (s == STATUS_OK)
		take_rows(&b);
	buffer_finish(&b.lanes, f->device);
	free(b.counts);
	free(b.places);
	return s;
}
