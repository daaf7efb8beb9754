#include "server/worker/technique/radiosity/factor_build.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/technique/radiosity/corners.h"
#include "server/worker/technique/radiosity/factor_moves.h"

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
	free(b->group_first);
	free(b->wanted);
	free(b->queue);
	free(b->vertices);
	free(b->triangles);
	free(b->followed);
	free(b->batch);
	free(b);
}

// Other jobs may want more of them at any time, but what is there is good.
static bool build_is_finished(const struct shelved *shelved)
{
	return factor_build_finished((const struct factor_build *)shelved);
}

static uint64_t build_bytes(const struct shelved *shelved)
{
	const struct factor_build *b = (const struct factor_build *)shelved;
	return factors_bytes(&b->factors) + b->buffers.faces.bytes + b->buffers.triangles.bytes + b->buffers.patches.bytes;
}

static const struct shelf_kind kind = {
    .kept = 2, .finished = build_is_finished, .bytes = build_bytes, .destroy = build_destroy};

// ---- groups -------------------------------------------------------------------------------------------------------------

// The triangles of a node are consecutive, and so are the faces that begin at them, and these faces' patches.
static enum status make_groups(struct factor_build *b, const struct resident_scene *scene, struct error *err)
{
	const struct scene_node *nodes = scene_section(scene, BLOB_SCENE_NODES);
	const struct patches *p = &b->elements.patches;
	b->node_count = scene_count(scene, BLOB_SCENE_NODES);
	b->group_first = calloc(b->node_count + 1, sizeof *b->group_first);
	b->wanted = calloc(2 * (size_t)b->node_count + 1, sizeof *b->wanted);
	b->queue = calloc(2 * (size_t)b->node_count + 1, sizeof *b->queue);
	b->followed = calloc(b->elements.count + 1, sizeof *b->followed);
	if (!b->group_first || !b->wanted || !b->queue || !b->followed)
		return error_set(err, STATUS_MEMORY, "out of memory");
	uint32_t face = 0, triangle = 0;
	for (uint32_t i = 0; i < b->node_count; i++) {
		// A node without triangles may have any first one.
		if (nodes[i].triangle_count > 0)
			triangle = nodes[i].first_triangle + nodes[i].triangle_count;
		b->group_first[i] = face < p->faces.count ? p->cuts[face].first : p->count;
		while (face < p->faces.count && p->faces.list[face].triangle[0] < triangle)
			face++;
	}
	b->group_first[b->node_count] = p->count;
	return STATUS_OK;
}

static uint32_t node_of(const struct factor_build *b, uint32_t patch)
{
	uint32_t low = 0, high = b->node_count; // the node is low, or between
	while (high - low > 1) {
		const uint32_t mid = low + (high - low) / 2;
		if (b->group_first[mid] <= patch)
			low = mid;
		else
			high = mid;
	}
	return low;
}

uint32_t factor_build_group(const struct factor_build *b, uint32_t element)
{
	const uint32_t patches = b->elements.patches.count;
	const bool back = element >= patches;
	return 2 * node_of(b, back ? element - patches : element) + back;
}

static uint32_t group_size(const struct factor_build *b, uint32_t group)
{
	return b->group_first[group / 2 + 1] - b->group_first[group / 2];
}

uint32_t factor_build_group_elements(const struct factor_build *b, uint32_t group, uint32_t *first)
{
	*first = b->group_first[group / 2] + (group % 2 ? b->elements.patches.count : 0);
	return group_size(b, group);
}

void factor_build_want(struct factor_build *b, uint32_t element)
{
	const uint32_t group = factor_build_group(b, element);
	if (b->wanted[group])
		return;
	b->wanted[group] = 1;
	b->queue[b->queued++] = group;
}

bool factor_build_has(const struct factor_build *b, uint32_t element)
{
	return b->factors.rows[element].block != NONE;
}

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
	enum status s = elements_init(&b->elements, &scene->view, &options->cut, err);
	if (s == STATUS_OK)
		s = own_mesh(b, scene, err);
	if (s == STATUS_OK)
		s = make_groups(b, scene, err);
	if (s == STATUS_OK)
		s = element_buffers_init(&b->buffers, &b->elements, device, err);
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
	// What was seen there may be seen here.
	memcpy(b->wanted, from->wanted, 2 * (size_t)b->node_count);
	memcpy(b->queue, from->queue, from->queued * sizeof *b->queue);
	b->queued = from->queued;
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

// ---- rows ---------------------------------------------------------------------------------------------------------------

// Want the groups of all columns of `count` rows that follow each other in a block, of which a gap of padding is between
// two.
static enum status want_columns(struct factor_build *b, const uint32_t *elements, uint32_t count, struct error *err)
{
	const struct factors_row *rows = b->factors.rows;
	const struct factors_row *begin = &rows[elements[0]], *last = &rows[elements[count - 1]];
	const uint64_t entries = last->first + last->count - begin->first, bytes = entries * sizeof(uint32_t);
	uint32_t *columns = malloc(bytes + 1);
	if (!columns)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status s = STATUS_OK;
	if (entries > 0)
		s = buffer_read(&b->factors.blocks[begin->block].columns, b->device, begin->first * sizeof(uint32_t), bytes,
				columns, err);
	for (uint32_t i = 0; s == STATUS_OK && i < count; i++) {
		for (uint32_t k = 0; k < rows[elements[i]].count; k++)
			factor_build_want(b, columns[rows[elements[i]].first - begin->first + k]);
		b->followed[elements[i]] = 1;
	}
	free(columns);
	return s;
}

static enum status want_seen(struct factor_build *b, const uint32_t *elements, uint32_t count, struct error *err)
{
	const struct factors_row *rows = b->factors.rows;
	enum status s = STATUS_OK;
	for (uint32_t i = 0, n; s == STATUS_OK && i < count; i += n) {
		for (n = 1; i + n < count; n++) {
			const struct factors_row *next = &rows[elements[i + n]], *row = &rows[elements[i + n - 1]];
			const uint32_t end = row->first + row->count;
			if (next->block != row->block || next->first < end || next->first - end >= FACTORS_ALIGN)
				break;
		}
		s = want_columns(b, &elements[i], n, err);
	}
	return s;
}

// The next elements without a row, as many as fit `most`. Rows that are there, but that nobody has followed, are followed.
static enum status next_elements(struct factor_build *b, uint32_t *elements, uint32_t most, uint32_t *found,
				 struct error *err)
{
	uint32_t count = 0;
	enum status s = STATUS_OK;
	while (s == STATUS_OK && b->done < b->queued && count < most) {
		uint32_t first;
		const uint32_t size = factor_build_group_elements(b, b->queue[b->done], &first);
		for (; s == STATUS_OK && b->next < size && count < most; b->next += s == STATUS_OK) {
			const uint32_t element = first + b->next;
			if (!factor_build_has(b, element))
				elements[count++] = element;
			else if (!b->followed[element])
				s = want_seen(b, &element, 1, err);
		}
		if (b->next < size)
			break;
		b->done++;
		b->next = 0;
	}
	*found = s == STATUS_OK ? count : 0;
	return s;
}

// Begin a batch of rows, if none is begun.
static enum status begin_batch(struct factor_build *b, struct row_maker *maker, uint32_t budget_us, struct error *err)
{
	const uint32_t most = row_maker_batch(maker, budget_us);
	if (b->batch_count > 0)
		return STATUS_OK;
	b->batch_by = maker;
	free(b->batch);
	b->batch = malloc(most * sizeof *b->batch);
	if (!b->batch)
		return error_set(err, STATUS_MEMORY, "out of memory");
	b->batch_done = b->done;
	b->batch_next = b->next;
	const enum status s = next_elements(b, b->batch, most, &b->batch_count, err);
	if (s != STATUS_OK) {
		b->done = b->batch_done;
		b->next = b->batch_next;
		return s;
	}
	row_maker_begin(maker, b->batch, b->batch_count);
	return STATUS_OK;
}

void factor_build_pause(struct factor_build *b, const struct row_maker *maker)
{
	if (b->batch_count == 0 || b->batch_by != maker)
		return;
	b->done = b->batch_done;
	b->next = b->batch_next;
	b->batch_count = 0;
}

static enum status make_rows(struct factor_build *b, struct row_maker *maker, uint32_t budget_us, struct error *err)
{
	bool done = true;
	enum status s = begin_batch(b, maker, budget_us, err);
	// Another job may be in the midst of rows, which it will end.
	if (s != STATUS_OK || b->batch_count == 0 || b->batch_by != maker)
		return s;
	s = row_maker_step(maker, budget_us, &b->factors, &done, err);
	if (s == STATUS_OK && !done)
		return STATUS_OK;
	if (s == STATUS_OK) {
		b->rows += b->batch_count;
		s = want_seen(b, b->batch, b->batch_count, err);
	}
	if (s != STATUS_OK)
		factor_build_pause(b, maker);
	b->batch_count = 0;
	return s;
}

enum status factor_build_step(struct factor_build *b, struct row_maker *maker, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	uint64_t spent = 0;
	enum status s = STATUS_OK;
	while (s == STATUS_OK && b->moves && spent < budget_us) {
		bool done;
		s = factor_moves_step(b->moves, b, budget_us, &done, err);
		if (s == STATUS_OK && done)
			end_moves(b, false);
		spent = clock_us() - start;
	}
	while (s == STATUS_OK && !factor_build_finished(b) && (spent < budget_us || spent == 0)) {
		s = make_rows(b, maker, spent < budget_us ? budget_us - (uint32_t)spent : 1, err);
		spent = clock_us() - start;
		spent += spent == 0;
	}
	return s;
}

bool factor_build_finished(const struct factor_build *b)
{
	return b->done == b->queued && b->batch_count == 0 && !b->moves;
}

double factor_build_fraction(const struct factor_build *b)
{
	uint64_t all = 0;
	for (uint32_t i = 0; i < b->queued; i++)
		all += group_size(b, b->queue[i]);
	return factor_build_finished(b) || all == 0 ? 1 : fmin(1, ((double)b->rows + b->taken) / (double)all);
}
