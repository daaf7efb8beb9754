#include "server/worker/technique/radiosity/factor_build.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/technique/radiosity/corners.h"
#include "server/worker/technique/radiosity/factor_moves.h"

#define PATCHES_AT_ONCE 4096u // between two looks at the clock

static void end_moves(struct factor_build *b, bool scene_goes)
{
	if (!b->moves)
		return;
	if (!scene_goes)
		shelf_release(&((struct factor_build *)b->moves->from)->shelved);
	factor_moves_finish(b->moves);
	free(b->moves);
	b->moves = NULL;
}

static void build_destroy(struct shelved *shelved, bool scene_goes)
{
	struct factor_build *b = (struct factor_build *)shelved;
	end_moves(b, scene_goes);
	corners_destroy(b->corners);
	factors_finish(&b->factors);
	element_buffers_finish(&b->buffers, b->device);
	elements_finish(&b->elements);
	element_groups_finish(&b->groups);
	free(b->vertices);
	free(b->triangles);
	free(b->batch);
	free(b);
}

// Other jobs may want more of them at any time, but what is there is good.
static bool build_is_finished(const struct shelved *shelved)
{
	const struct factor_build *b = (const struct factor_build *)shelved;
	return !b->partial && b->batch_count == 0 && !b->moves;
}

static uint64_t build_bytes(const struct shelved *shelved)
{
	const struct factor_build *b = (const struct factor_build *)shelved;
	return factors_bytes(&b->factors) + b->buffers.faces.bytes + b->buffers.triangles.bytes + b->buffers.patches.bytes;
}

static const struct shelf_kind kind = {
    .kept = 2, .finished = build_is_finished, .bytes = build_bytes, .destroy = build_destroy};

// ---- the shelf ----------------------------------------------------------------------------------------------------------

static void *copy_of(const struct resident_scene *scene, enum blob_section section, size_t stride)
{
	const size_t bytes = stride * scene_count(scene, section);
	void *copy = malloc(bytes + 1);
	if (copy && bytes > 0)
		memcpy(copy, scene_section(scene, section), bytes);
	return copy;
}

// What is made of a variant stays on the shelf of its base, and may outlive it.
static enum status own_mesh(struct factor_build *b, const struct resident_scene *scene, struct error *err)
{
	if (!scene->base)
		return STATUS_OK;
	b->vertices = copy_of(scene, BLOB_VERTICES, sizeof(struct vertex));
	b->triangles = copy_of(scene, BLOB_TRIANGLES, sizeof(struct triangle));
	if (!b->vertices || !b->triangles)
		return error_set(err, STATUS_MEMORY, "out of memory");
	b->elements.patches.vertices = b->vertices;
	b->elements.patches.triangles = b->triangles;
	return STATUS_OK;
}

static enum status build_create(struct resident_scene *scene, struct device *device, const struct factor_options *options,
				struct factor_build **out, struct error *err)
{
	struct factor_build *b = calloc(1, sizeof *b);
	if (!b)
		return error_set(err, STATUS_MEMORY, "out of memory");
	b->options = *options;
	b->keys = scene->keys;
	b->device = device;
	enum status s = elements_begin(&b->elements, &scene->view, &options->cut, err);
	if (s == STATUS_OK)
		s = own_mesh(b, scene, err);
	if (s == STATUS_OK)
		s = element_groups_init(&b->groups, &scene->view, &b->elements, err);
	if (s == STATUS_OK)
		s = element_buffers_init(&b->buffers, &b->elements, false, device, err);
	if (s == STATUS_OK)
		s = factors_init(&b->factors, device, b->elements.count, err);
	if (s == STATUS_OK)
		s = corners_create(&b->elements, &b->corners, err);
	if (s == STATUS_OK)
		*out = b;
	else
		build_destroy(&b->shelved, false);
	return s;
}

// Whether factors of the scene `keys` serve those of `scene`: places are the same, and materials where they matter.
static bool serves(const struct factor_build *b, const struct resident_scene *scene, const struct factor_options *options)
{
	const bool by_material = options->rows.mirrors || options->effects;
	return !memcmp(&b->options, options, sizeof *options) && b->keys.geometry == scene->keys.geometry &&
	       (!by_material || b->keys.materials == scene->keys.materials);
}

// Begin to take rows over from those of the scene as loaded, if they are there.
static void begin_moves(struct factor_build *b, const struct resident_scene *scene, struct shelf *shelf)
{
	struct factor_build *from = NULL;
	// Rows of a file are what it says, wherever nodes are.
	if (b->options.rows.way == ROWS_IMPORTED)
		return;
	for (struct shelved *at = scene->base ? shelf->first : NULL; at && !from; at = at->next)
		if (build_is_finished(at) && serves((struct factor_build *)at, scene->base, &b->options))
			from = (struct factor_build *)at;
	if (!from || !(b->moves = calloc(1, sizeof *b->moves)))
		return;
	if (!factor_moves_init(b->moves, from, b, scene)) {
		free(b->moves);
		b->moves = NULL;
		return;
	}
	shelf_hold(&from->shelved);
}

static struct factor_build *find(const struct shelf *shelf, const struct resident_scene *scene,
				 const struct factor_options *options)
{
	struct shelved *at = shelf ? shelf->first : NULL;
	while (at && !serves((struct factor_build *)at, scene, options))
		at = at->next;
	return (struct factor_build *)at;
}

const struct factor_build *factor_build_find(struct resident_scene *scene, const struct factor_options *options)
{
	return find(shelf_of(scene, &kind), scene, options);
}

enum status factor_build_acquire(struct resident_scene *scene, struct device *device, const struct factor_options *options,
				 struct factor_build **build, struct error *err)
{
	struct shelf *shelf = shelf_of(scene, &kind);
	struct factor_build *b = find(shelf, scene, options);
	if (!shelf)
		return error_set(err, STATUS_MEMORY, "out of memory");
	if (!b) {
		enum status s;
		while (shelf_drop_idle(shelf, kind.kept - 1))
			;
		do
			s = build_create(scene, device, options, &b, err);
		while (s == STATUS_MEMORY && shelf_drop_idle(shelf, 0));
		if (s != STATUS_OK)
			return s;
		begin_moves(b, scene, shelf);
		shelf_put(shelf, &b->shelved);
	}
	shelf_hold(&b->shelved);
	*build = b;
	return STATUS_OK;
}

void factor_build_release(struct factor_build *b)
{
	if (b)
		shelf_release(&b->shelved);
}

// ---- patches ------------------------------------------------------------------------------------------------------------

bool factor_build_ready(const struct factor_build *b)
{
	return b->sent == b->elements.patches.count;
}

enum status factor_build_prepare(struct factor_build *b, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = STATUS_OK;
	do {
		elements_make(&b->elements, PATCHES_AT_ONCE);
		s = element_buffers_send(&b->buffers, &b->elements, b->sent, b->device, err);
		b->sent = s == STATUS_OK ? b->elements.made : b->sent;
	} while (s == STATUS_OK && !factor_build_ready(b) && clock_us() - start < budget_us);
	return s;
}

// ---- rows ---------------------------------------------------------------------------------------------------------------

// Begin a batch of rows, if none is begun.
static enum status begin_batch(struct factor_build *b, const struct reach *reach, struct row_maker *maker,
			       uint32_t budget_us, struct error *err)
{
	const uint32_t most = row_maker_batch(maker, budget_us);
	if (b->batch_count > 0)
		return STATUS_OK;
	free(b->batch);
	b->batch = malloc(most * sizeof *b->batch);
	if (!b->batch)
		return error_set(err, STATUS_MEMORY, "out of memory");
	b->batch_count = reach_missing(reach, &b->factors, b->batch, most);
	b->batch_by = maker;
	b->partial = true;
	row_maker_begin(maker, b->batch, b->batch_count);
	return STATUS_OK;
}

void factor_build_pause(struct factor_build *b, const struct row_maker *maker)
{
	if (b->batch_by == maker)
		b->batch_count = 0;
}

// What another job has begun this one goes on with: rows are the same whoever makes them.
static enum status make_rows(struct factor_build *b, const struct reach *reach, struct row_maker *maker, uint32_t budget_us,
			     struct error *err)
{
	bool done = true;
	enum status s = begin_batch(b, reach, maker, budget_us, err);
	if (s == STATUS_OK)
		s = row_maker_step(b->batch_by, budget_us, &b->factors, &done, err);
	if (s == STATUS_OK && !done)
		return STATUS_OK;
	if (s == STATUS_OK)
		b->rows += b->batch_count;
	b->batch_count = 0;
	return s;
}

static enum status do_piece(struct factor_build *b, struct reach *reach, struct row_maker *maker, uint32_t budget_us,
			    struct error *err)
{
	if (b->moves) {
		bool done;
		const enum status s = factor_moves_step(b->moves, b, budget_us, &done, err);
		if (s == STATUS_OK && done)
			end_moves(b, false);
		return s;
	}
	return reach_waits(reach, &b->factors) ? make_rows(b, reach, maker, budget_us, err)
					       : reach_follow(reach, &b->factors, budget_us, err);
}

enum status factor_build_step(struct factor_build *b, struct reach *reach, struct row_maker *maker, uint32_t budget_us,
			      struct error *err)
{
	const uint64_t start = clock_us();
	uint64_t spent = 0;
	enum status s;
	do {
		s = do_piece(b, reach, maker, budget_us > spent ? budget_us - (uint32_t)spent : 1, err);
		spent = clock_us() - start;
	} while (s == STATUS_OK && !reach_ended(reach) && spent < budget_us);
	if (s == STATUS_OK && reach_ended(reach))
		b->partial = false;
	return s;
}

bool factor_build_finished(const struct factor_build *b)
{
	return build_is_finished(&b->shelved) && b->rows + b->taken > 0;
}
