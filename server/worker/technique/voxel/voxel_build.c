// Each pass is done in pieces that fit a slice. The size of a piece comes from the speed of the pieces before.
#include "server/worker/technique/voxel/voxel_build.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/common/scene_traits.h"
#include "shaders/gl/voxel_count_comp.h"
#include "shaders/gl/voxel_finish_comp.h"
#include "shaders/gl/voxel_mark_comp.h"
#include "shaders/gl/voxel_merge_comp.h"
#include "shaders/gl/voxel_prefix_comp.h"
#include "shaders/gl/voxel_sum_comp.h"

#define FIRST_ITEMS 4096u // items of a piece before the speed is known
#define LEAST_ITEMS 256u
#define FIRST_WORDS 65536u
#define RETRY_BITS 6u // by so many bits sums are made coarser where they overflowed

static const struct gl_source sources[VOXEL_PROGRAMS] = {
    [VOXEL_PROGRAM_MARK] = {.name = "voxel_mark", .compute = source_voxel_mark_comp},
    [VOXEL_PROGRAM_COUNT] = {.name = "voxel_count", .compute = source_voxel_count_comp},
    [VOXEL_PROGRAM_PREFIX] = {.name = "voxel_prefix", .compute = source_voxel_prefix_comp},
    [VOXEL_PROGRAM_MERGE] = {.name = "voxel_merge", .compute = source_voxel_merge_comp},
    [VOXEL_PROGRAM_SUM] = {.name = "voxel_sum", .compute = source_voxel_sum_comp},
    [VOXEL_PROGRAM_FINISH] = {.name = "voxel_finish", .compute = source_voxel_finish_comp}};

static enum status refuse(const struct voxels *v, const struct blob_view *scene, uint64_t entries, struct error *err)
{
	const struct gl_device *d = v->device;
	const uint64_t held = *d->bytes - voxels_bytes(v), left = *d->budget > held ? *d->budget - held : 0;
	const uint64_t most = d->storage_bytes_max / 16 * 64;
	const uint32_t fits = voxel_resolution_that_fits(scene, &v->options, entries, left < most ? left : most);
	const uint64_t guess = entries ? entries : voxel_entries_guess(scene, &v->grid);
	const unsigned long long mib = (voxel_grid_bytes(&v->grid, guess) + (1u << 20) - 1) >> 20;
	if (fits == 0)
		return error_set(err, STATUS_MEMORY,
				 "voxels at resolution %u take %llu MiB, and none fit the %llu MiB left of the "
				 "memory budget: give the daemon more",
				 v->options.resolution, mib, (unsigned long long)(left >> 20));
	return error_set(err, STATUS_MEMORY,
			 "voxels at resolution %u take %llu MiB, the memory budget leaves %llu MiB: resolution %u would fit",
			 v->options.resolution, mib, (unsigned long long)(left >> 20), fits);
}

static double emission_max(const struct blob_view *scene)
{
	const struct material *m = scene->sections[BLOB_MATERIALS];
	float most = 0;
	for (uint32_t i = 0; i < scene->counts[BLOB_MATERIALS]; i++)
		for (int c = 0; c < 3; c++)
			most = fmaxf(most, m[i].emission[c]);
	return (double)most;
}

// Make the words, and the buffers that the passes need beside them.
static enum status voxel_build_make_buffers(struct voxels *v, const struct plan *plan, struct error *err)
{
	struct voxel_build *b = v->build;
	struct scene_params job;
	const uint64_t words = voxel_grid_words(&v->grid);
	scene_params_fill(plan, &b->scene->view, false, &job);
	enum status r = gl_buffer_init(&v->grid_block, v->device, sizeof v->grid, &v->grid, err);
	if (r == STATUS_OK)
		r = gl_buffer_init(&v->words, v->device, 8 * (words + 1), NULL, err);
	if (r == STATUS_OK)
		r = gl_buffer_init(&b->job, v->device, sizeof job, &job, err);
	if (r == STATUS_OK)
		r = gl_buffer_init(&b->items, v->device, (b->chunk + 1) * sizeof(struct voxel_item), b->host_items, err);
	return r;
}

// Make the next chunk of items on the host.
static void fill_chunk(struct voxel_build *b)
{
	const bool first = b->stream.done == 0 && b->stream.row == 0 && b->stream.tile == 0;
	b->chunk = voxel_items_next(&b->stream, b->host_items, VOXEL_ITEMS_CHUNK);
	b->chunk_at = 0;
	b->chunk_is_all = first && voxel_items_ended(&b->stream);
}

static uint32_t scene_bindings(const struct plan *plan)
{
	return scene_bindings_shade(plan) &
	       ~(1u << BIND_EMITTERS | 1u << BIND_LIGHTS | 1u << BIND_TANGENTS | 1u << BIND_GGX_TABLE);
}

enum status voxel_build_create(struct voxels *v, struct resident_scene *scene, const struct plan *plan, struct voxels *fixed,
			       struct error *err)
{
	struct voxel_build *b = v->build = calloc(1, sizeof *b);
	if (b)
		b->host_items = calloc(VOXEL_ITEMS_CHUNK + 1, sizeof *b->host_items);
	if (b)
		b->fixed = fixed;
	else
		voxels_release(fixed);
	if (!b || !b->host_items)
		return error_set(err, STATUS_MEMORY, "out of memory");
	b->scene = scene;
	b->phase = VOXEL_COMPILE;
	b->area_bits = VOXEL_AREA_BITS;
	b->emission_bits = VOXEL_EMISSION_BITS;
	b->emission_max = emission_max(&scene->view);
	const uint64_t items = VOXEL_ITEMS_CHUNK * sizeof *b->host_items;
	if (gl_reserve(v->device, voxel_grid_bytes(&v->grid, 0) + items, NULL) != STATUS_OK)
		return refuse(v, &scene->view, 0, err);
	const enum voxel_choice choice = fixed ? VOXELS_MOVED : v->fixed ? VOXELS_UNMOVED : VOXELS_ALL;
	enum status r = voxel_ranges_init(&b->ranges, scene, choice, err);
	if (r != STATUS_OK)
		return r;
	voxel_items_init(&b->stream, &scene->view, &b->ranges, &v->grid);
	fill_chunk(b);
	r = gl_scene_get(scene, v->device, scene_bindings(plan), &b->gl, err);
	if (r == STATUS_OK)
		r = voxel_build_make_buffers(v, plan, err);
	return r;
}

void voxel_build_destroy(struct voxel_build *b, struct gl_device *device)
{
	if (!b)
		return;
	voxels_release(b->fixed);
	for (unsigned i = 0; i < VOXEL_PROGRAMS; i++)
		gl_program_release(b->programs[i]);
	voxel_ranges_finish(&b->ranges);
	gl_buffer_finish(&b->job, device);
	gl_buffer_finish(&b->items, device);
	free(b->host_items);
	free(b);
}

static void voxel_build_use(const struct voxels *v, const struct gl_program *program)
{
	gl_scene_bind(v->build->gl, 0);
	gl_buffer_bind(&v->build->job, BIND_JOB);
	gl_buffer_bind(&v->build->items, BIND_VOXEL_ITEMS);
	voxels_bind(v);
	gl_program_use(v->device, program);
}

static void voxel_build_run(uint32_t invocations, uint32_t group)
{
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
	glDispatchCompute((invocations + group - 1) / group, 1, 1);
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

// Make one more program and run it over nothing, which is when drivers compile.
static enum status compile_piece(struct voxels *v, struct error *err)
{
	struct voxel_build *b = v->build;
	const uint32_t i = b->compiled;
	struct gl_defines defines = {0};
	if (i == VOXEL_PROGRAMS) {
		b->phase = b->fixed ? VOXEL_FIXED : VOXEL_MARK;
		return STATUS_OK;
	}
	const uint64_t start = clock_us();
	if (i == VOXEL_PROGRAM_SUM)
		scene_define(&defines, b->scene, v->effects);
	struct gl_program *program;
	bool warm;
	enum status r = gl_program_get(v->device, &sources[i], &defines, &program, err);
	if (r != STATUS_OK)
		return r;
	voxel_build_use(v, program);
	r = gl_program_ask(v->device, program, &warm, err);
	if (r != STATUS_OK)
		return r;
	gl_program_hold(program);
	b->programs[i] = program;
	b->compiled++;
	if (warm)
		return STATUS_OK;
	if (i == VOXEL_PROGRAM_MARK || i == VOXEL_PROGRAM_SUM)
		glUniform2ui(0, 0, 0);
	else
		glUniform1ui(0, 0);
	voxel_build_run(1, 1);
	r = gl_wait(v->device, "compiling", err);
	if (r == STATUS_OK)
		gl_program_has_run(v->device, program);
	b->compile_us += clock_us() - start;
	return r;
}

// How much of `left` to do in this piece, by the speed measured so far.
static uint32_t portion(double speed, uint32_t budget_us, uint32_t first, uint32_t least, uint32_t left)
{
	const double n = speed > 0 ? speed * budget_us : first;
	const uint32_t want = n > left ? left : n < least ? least : (uint32_t)n;
	return want < left ? want : left;
}

// Run the program over items of the chunk, as many as should fit the budget.
static enum status items_piece(struct voxels *v, const struct gl_program *program, uint32_t budget_us, struct error *err)
{
	struct voxel_build *b = v->build;
	const uint32_t n = portion(b->items_a_us, budget_us, FIRST_ITEMS, LEAST_ITEMS, b->chunk - b->chunk_at);
	const uint64_t start = clock_us();
	voxel_build_use(v, program);
	glProgramUniform2ui(program->name, 0, b->chunk_at, n);
	if (b->phase == VOXEL_SUM) {
		const double units = ldexp(1, (int)b->area_bits);
		const double emission = ldexp(1, (int)b->emission_bits) / fmax(b->emission_max, 1e-20);
		glProgramUniform2f(program->name, 1, (float)units, (float)emission);
		glProgramUniform1ui(program->name, 2, voxel_grid_words(&v->grid));
	}
	voxel_build_run(n, VOXEL_GROUP);
	const enum status r = gl_wait(v->device, "voxelising", err);
	b->items_a_us = (double)n / (double)(clock_us() - start + 1);
	b->chunk_at += n;
	return r;
}

// Begin the stream of items again, for the next pass over it.
static void rewind_items(struct voxel_build *b)
{
	b->chunk_at = 0;
	b->items_a_us = 0;
	if (b->chunk_is_all)
		return;
	voxel_items_init(&b->stream, &b->scene->view, &b->ranges, &b->stream.grid);
	b->chunk = 0;
}

static enum status stream_piece(struct voxels *v, const struct gl_program *program, uint32_t budget_us, struct error *err)
{
	struct voxel_build *b = v->build;
	if (b->chunk_at < b->chunk)
		return items_piece(v, program, budget_us, err);
	if (!voxel_items_ended(&b->stream)) {
		fill_chunk(b);
		gl_buffer_write(&b->items, 0, b->chunk * sizeof(struct voxel_item), b->host_items);
		return STATUS_OK;
	}
	b->phase++;
	if (b->phase == VOXEL_COUNT)
		rewind_items(b);
	return STATUS_OK;
}

// Make cleared room for the entries. What certainly does not fit is refused before anything is allocated.
static enum status make_parts(struct voxels *v, struct error *err)
{
	const uint64_t entries = v->grid.entries, each = 16 * entries;
	const uint64_t most = each + 16 * ((entries + VOXEL_BACK_BITS - 1) / VOXEL_BACK_BITS);
	if (entries == 0)
		return STATUS_OK;
	if (most > v->device->storage_bytes_max || gl_reserve(v->device, VOXEL_PARTS * most, NULL) != STATUS_OK)
		return refuse(v, &v->build->scene->view, entries, err);
	enum status r = STATUS_OK;
	for (unsigned i = 0; r == STATUS_OK && i < VOXEL_PARTS; i++)
		r = gl_buffer_init(&v->parts[i], v->device, BIND_VOXEL_PLACE + i == BIND_VOXEL_EMISSION ? most : each, NULL,
				   err);
	// Keep all or none: the call is repeated once others have made room.
	for (unsigned i = 0; r != STATUS_OK && i < VOXEL_PARTS; i++)
		gl_buffer_finish(&v->parts[i], v->device);
	return r;
}

// Turn the blocks' counts of entries into the numbers of entries before each block, and make room for all.
static enum status sum_blocks(struct voxels *v, uint32_t *blocks, uint32_t count, struct error *err)
{
	uint64_t total = 0;
	for (uint32_t i = 0; i < count; i++) {
		const uint32_t n = blocks[i];
		blocks[i] = (uint32_t)total;
		total += n;
	}
	v->grid.entries = (uint32_t)total; // at most 2 · 512³
	gl_buffer_write(&v->grid_block, 0, sizeof v->grid, &v->grid);
	return make_parts(v, err);
}

static enum status count_piece(struct voxels *v, struct error *err)
{
	const struct voxel_build *b = v->build;
	const uint32_t words = voxel_grid_words(&v->grid), count = (words + VOXEL_BLOCK_WORDS - 1) / VOXEL_BLOCK_WORDS;
	struct gl_buffer blocks = {0};
	uint32_t *host = malloc(count * sizeof *host);
	enum status r = host ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	if (r == STATUS_OK)
		r = gl_buffer_init(&blocks, v->device, count * sizeof *host, NULL, err);
	if (r != STATUS_OK)
		goto out;
	voxel_build_use(v, b->programs[VOXEL_PROGRAM_COUNT]);
	gl_buffer_bind(&blocks, BIND_VOXEL_BLOCKS);
	glProgramUniform1ui(b->programs[VOXEL_PROGRAM_COUNT]->name, 0, words);
	voxel_build_run(count, VOXEL_WORD_GROUP);
	r = gl_buffer_read(&blocks, v->device, 0, count * sizeof *host, host, err);
	if (r == STATUS_OK)
		r = sum_blocks(v, host, count, err);
	if (r != STATUS_OK)
		goto out;
	gl_buffer_write(&blocks, 0, count * sizeof *host, host);
	voxel_build_use(v, b->programs[VOXEL_PROGRAM_PREFIX]);
	gl_buffer_bind(&blocks, BIND_VOXEL_BLOCKS);
	glProgramUniform1ui(b->programs[VOXEL_PROGRAM_PREFIX]->name, 0, words);
	voxel_build_run(count, VOXEL_WORD_GROUP);
	v->build->phase = v->grid.entries == 0 ? VOXEL_DONE : b->fixed ? VOXEL_MERGE : VOXEL_SUM;
out:
	gl_buffer_finish(&blocks, v->device);
	free(host);
	return r;
}

// The triangles in place and those that moved do not fit together into sums of those units: voxelise everything.
static enum status give_up_fixed(struct voxels *v, struct error *err)
{
	struct voxel_build *b = v->build;
	struct voxel_ranges all;
	struct gl_buffer items;
	enum status r = voxel_ranges_init(&all, b->scene, VOXELS_ALL, err);
	if (r == STATUS_OK)
		r = gl_buffer_init(&items, v->device, VOXEL_ITEMS_CHUNK * sizeof(struct voxel_item), NULL, err);
	if (r != STATUS_OK) {
		voxel_ranges_finish(&all);
		return r;
	}
	voxels_release(b->fixed);
	b->fixed = NULL;
	voxel_ranges_finish(&b->ranges);
	b->ranges = all;
	gl_buffer_finish(&b->items, v->device);
	b->items = items;
	for (unsigned i = 0; i < VOXEL_PARTS; i++)
		gl_buffer_finish(&v->parts[i], v->device);
	gl_buffer_clear(&v->words);
	b->area_bits = VOXEL_AREA_BITS;
	b->emission_bits = VOXEL_EMISSION_BITS;
	b->word = 0;
	b->phase = VOXEL_MARK;
	b->chunk_is_all = false;
	rewind_items(b);
	return STATUS_OK;
}

// Check whether sums have overflowed; if so, make them again with coarser units.
static enum status check_piece(struct voxels *v, struct error *err)
{
	struct voxel_build *b = v->build;
	const uint64_t at = 8ull * voxel_grid_words(&v->grid);
	uint32_t full = 0;
	const enum status r = gl_buffer_read(&v->words, v->device, at, sizeof full, &full, err);
	if (r != STATUS_OK)
		return r;
	v->area_bits = b->area_bits;
	v->emission_bits = b->emission_bits;
	if (!full) {
		b->phase = v->fixed ? VOXEL_DONE : VOXEL_FINISH;
		return STATUS_OK;
	}
	if (b->fixed)
		return give_up_fixed(v, err);
	if (full & VOXEL_FULL_AREA)
		b->area_bits -= b->area_bits > RETRY_BITS ? RETRY_BITS : b->area_bits;
	b->emission_bits -= b->emission_bits > RETRY_BITS ? RETRY_BITS : b->emission_bits;
	log_line(LOG_INFO, "voxels hold much surface: summing again with %u bits of area, %u of emission", b->area_bits,
		 b->emission_bits);
	full = 0;
	gl_buffer_write(&v->words, at, sizeof full, &full);
	for (unsigned i = 0; i < VOXEL_PARTS; i++)
		gl_buffer_clear(&v->parts[i]);
	rewind_items(b);
	b->phase = VOXEL_SUM;
	return STATUS_OK;
}

// Run the program in use over words. After the last word comes the phase `next`.
static enum status words_piece(struct voxels *v, const struct gl_program *p, uint32_t budget_us, enum voxel_phase next,
			       struct error *err)
{
	struct voxel_build *b = v->build;
	const uint32_t words = voxel_grid_words(&v->grid);
	const uint32_t n = portion(b->words_a_us, budget_us, FIRST_WORDS, VOXEL_WORD_GROUP, words - b->word);
	const uint64_t start = clock_us();
	glProgramUniform1ui(p->name, 0, b->word + n);
	glProgramUniform1ui(p->name, 2, b->word);
	voxel_build_run(n, VOXEL_WORD_GROUP);
	const enum status r = gl_wait(v->device, "voxelising", err);
	b->words_a_us = (double)n / (double)(clock_us() - start + 1);
	b->word += n;
	if (b->word == words) {
		b->word = 0;
		b->words_a_us = 0;
		b->phase = next;
	}
	return r;
}

static enum status finish_piece(struct voxels *v, uint32_t budget_us, struct error *err)
{
	const struct voxel_build *b = v->build;
	const struct gl_program *p = b->programs[VOXEL_PROGRAM_FINISH];
	voxel_build_use(v, p);
	glProgramUniform2f(p->name, 1, (float)ldexp(1, -(int)b->area_bits),
			   (float)(b->emission_max * ldexp(1, -(int)b->emission_bits)));
	return words_piece(v, p, budget_us, VOXEL_DONE, err);
}

static enum status merge_piece(struct voxels *v, uint32_t budget_us, struct error *err)
{
	const struct voxel_build *b = v->build;
	if (b->fixed->grid.entries == 0) {
		v->build->phase = VOXEL_SUM;
		return STATUS_OK;
	}
	voxel_build_use(v, b->programs[VOXEL_PROGRAM_MERGE]);
	glProgramUniform2ui(b->programs[VOXEL_PROGRAM_MERGE]->name, 1, b->fixed->grid.entries, v->grid.entries);
	gl_buffer_bind(&b->fixed->words, BIND_VOXEL_FIXED_WORDS);
	for (unsigned i = 0; i < VOXEL_PARTS; i++)
		gl_buffer_bind(&b->fixed->parts[i], BIND_VOXEL_FIXED_PARTS + i);
	return words_piece(v, b->programs[VOXEL_PROGRAM_MERGE], budget_us, VOXEL_SUM, err);
}

// Go on with the build of what stays in place. Once it is done, ours begins with a copy of its bits.
static enum status fixed_piece(struct voxels *v, uint32_t budget_us, struct error *err)
{
	struct voxel_build *b = v->build;
	if (!voxels_finished(b->fixed))
		return voxels_step(b->fixed, NULL, budget_us, err);
	b->area_bits = b->fixed->area_bits;
	b->emission_bits = b->fixed->emission_bits;
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	glCopyNamedBufferSubData(b->fixed->words.name, v->words.name, 0, 0, (GLsizeiptr)v->words.bytes);
	b->phase = VOXEL_MARK;
	return gl_check(v->device, "voxelising", err);
}

enum status voxel_build_piece(struct voxels *v, uint32_t budget_us, struct error *err)
{
	switch (v->build->phase) {
	case VOXEL_COMPILE:
		return compile_piece(v, err);
	case VOXEL_FIXED:
		return fixed_piece(v, budget_us, err);
	case VOXEL_MARK:
		return stream_piece(v, v->build->programs[VOXEL_PROGRAM_MARK], budget_us, err);
	case VOXEL_COUNT:
		return count_piece(v, err);
	case VOXEL_MERGE:
		return merge_piece(v, budget_us, err);
	case VOXEL_SUM:
		return stream_piece(v, v->build->programs[VOXEL_PROGRAM_SUM], budget_us, err);
	case VOXEL_CHECK:
		return check_piece(v, err);
	case VOXEL_FINISH:
		return finish_piece(v, budget_us, err);
	case VOXEL_DONE:
		break;
	}
	return STATUS_OK;
}
