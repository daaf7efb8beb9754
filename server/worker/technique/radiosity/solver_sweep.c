// A product with the matrix, cut into pieces of about as long as the caller has.
#include "server/base/clock.h"
#include "server/worker/technique/radiosity/solver_parts.h"
#include "server/worker/vk/command.h"

#define FIRST_ENTRIES (1u << 18) // of the first piece, before it is known how long one takes
#define ROWS_MOST 1048576u // of a dispatch
#define GROUPS_MOST 32768u // of a dispatch: every device takes so many, and a group takes further rows

// Rows of the list from the cursor on, in its run, whose entries are about *entries, which they are taken from; at least
// one.
static uint32_t take_rows(const struct solver *s, uint64_t *entries)
{
	const uint32_t end = s->runs[s->run].end;
	uint32_t row = s->row;
	uint64_t taken = 0;
	do
		taken += s->list[row++].count;
	while (row < end && taken < *entries && row - s->row < ROWS_MOST);
	*entries = taken < *entries ? *entries - taken : 0;
	return row;
}

static void record_rows(const struct solver *s, bool pairs, uint32_t end)
{
	VkCommandBuffer c = s->device->commands;
	const struct pipeline *p = s->gather[pairs];
	const struct gather_push push = {.first_row = s->row, .end_row = end};
	const uint32_t width = s->device->info.subgroup;
	const uint32_t rows = width < SOLVE_LANES ? SOLVE_LANES / (width ? width : 1) : 1; // of a group
	const uint32_t groups = (end - s->row + rows - 1) / rows;
	vkCmdBindPipeline(c, VK_PIPELINE_BIND_POINT_COMPUTE, p->handle);
	vkCmdBindDescriptorSets(c, VK_PIPELINE_BIND_POINT_COMPUTE, p->layout, 0, 1,
				&s->gather_sets[pairs][s->runs[s->run].block].set, 0, NULL);
	vkCmdPushConstants(c, p->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
	vkCmdDispatch(c, groups < GROUPS_MOST ? groups : GROUPS_MOST, 1, 1);
}

// The elements of a part end before this one.
static uint32_t part_end(const struct solver *s, uint32_t part)
{
	// The first element whose part is a later one.
	return (uint32_t)(((uint64_t)(part + 1) * s->count + s->parts - 1) / s->parts);
}

static void relax_part(const struct solver *s, uint32_t part, const double scale[4])
{
	solver_record_step(s, STEP_RELAX, part > 0 ? part_end(s, part - 1) : 0, part_end(s, part), scale);
}

// Record what comes next, as much as `entries` allow.
static void record_piece(struct solver *s, bool pairs, bool relaxes, const double scale[4], uint64_t *entries)
{
	while (s->run<s->run_count && * entries> 0) {
		const struct solver_run *run = &s->runs[s->run];
		const uint32_t end = take_rows(s, entries);
		record_rows(s, pairs, end);
		s->row = end;
		if (end < run->end)
			continue;
		s->run++;
		const bool next = s->run < s->run_count;
		s->row = next ? s->runs[s->run].first : 0;
		if (next && s->runs[s->run].part == run->part)
			continue;
		command_barrier(s->device);
		if (relaxes)
			relax_part(s, run->part, scale);
	}
}

enum status solver_sweep(struct solver *s, bool pairs, uint32_t before, uint32_t after, const double scale[4],
			 uint32_t budget_us, bool *done, struct error *err)
{
	const double us = s->entry_us[pairs];
	const uint64_t wanted = us > 0 ? (uint64_t)((double)budget_us / us) + 1 : FIRST_ENTRIES, start = clock_us();
	uint64_t left = wanted;
	enum status status = command_begin(s->device, err);
	if (status != STATUS_OK)
		return status;
	if (!s->sweeping) {
		s->sweeping = true;
		s->run = 0;
		s->row = 0;
		solver_clear_maxima(s);
		if (before != STEP_COUNT)
			solver_record_step(s, before, 0, s->count, scale);
	}
	record_piece(s, pairs, after == STEP_RELAX, scale, &left);
	*done = s->run == s->run_count;
	if (*done && after != STEP_RELAX)
		solver_record_step(s, after, 0, s->count, scale);
	if (*done)
		solver_fetch_maxima(s);
	else
		command_barrier(s->device);
	status = command_finish(s->device, err);
	if (wanted > left) {
		const double measured = (double)(clock_us() - start) / (double)(wanted - left);
		s->entry_us[pairs] = us > 0 ? 0.5 * (us + measured) : measured;
	}
	s->sweeping = !*done;
	s->iterations += *done;
	return status;
}
