#include "server/worker/technique/radiosity/prospect_try.h"

#include <math.h>
#include <stdlib.h>

#include "server/base/clock.h"
#include "server/worker/devices.h"
#include "server/worker/technique/radiosity/corners.h"
#include "server/worker/technique/radiosity/surfaces.h"
#include "server/worker/technique/radiosity/union_find.h"

#define SLICE_US 20000u // of a batch of rows, as in a job
#define LIGHT_SHARE 4u // one part of the budget in so many is for light, and likewise for corners
#define FIRST_SHARE 4u // one part of what rows have in so many finds out which groups see each other
#define FIRST_MOST 256u // rows for that
#define ROWS_LEAST 16u // against the clock, for which the budget is overrun where rows are slow
#define ROWS_ROOM 3u // by so many times
#define DOUBT_LEAST 0.1 // of the rows that are wanted
#define DOUBT_ROWS 1.0 // over the root of the rows that have told which groups see each other

struct trial {
	const struct prospect_try *of;
	struct device *device;
	struct gl_device *gl;
	struct elements elements;
	struct element_buffers buffers;
	struct surfaces *surfaces;
	bool covered; // what is covered of patches is known
	struct light *light; // NULL: the scene has none that is no element
	struct row_maker *maker;
	struct factors factors;
	struct radiosity_surface *made_of; // by element
	float *direct; // irradiance as far as it is known, 3 an element
	uint32_t *node; // by face
	uint32_t *same; // groups that see each other (union_find.h): 2 · node + side
	uint32_t groups;
	uint8_t *lit; // by the first group of a set: light reaches it
	uint32_t *list; // elements of a batch
	uint32_t step, next; // the next element is next · step modulo their number
	uint32_t tried; // rows that told which groups see each other
	struct prospect_found *found;
};

static void trial_finish(struct trial *t)
{
	row_maker_destroy(t->maker);
	factors_finish(&t->factors);
	light_destroy(t->light);
	surfaces_destroy(t->surfaces);
	element_buffers_finish(&t->buffers, t->device);
	elements_finish(&t->elements);
	free(t->made_of);
	free(t->direct);
	free(t->node);
	free(t->same);
	free(t->lit);
	free(t->list);
}

// ---- elements and light -------------------------------------------------------------------------------------------------

// By face the node that its first triangle is of. The triangles of a node are consecutive.
static void fill_nodes(struct trial *t)
{
	const struct resident_scene *scene = t->of->scene;
	const struct scene_node *nodes = scene_section(scene, BLOB_SCENE_NODES);
	const struct patch_faces *faces = &t->elements.patches.faces;
	const uint32_t count = scene_count(scene, BLOB_SCENE_NODES);
	uint32_t face = 0;
	for (uint32_t i = 0; i < count; i++) {
		const uint32_t end = nodes[i].first_triangle + nodes[i].triangle_count;
		while (nodes[i].triangle_count > 0 && face < faces->count && faces->list[face].triangle[0] < end)
			t->node[face++] = i;
	}
}

static uint32_t group_of(const struct trial *t, uint32_t element)
{
	const uint32_t patches = t->elements.patches.count;
	return 2 * t->node[t->elements.shapes[element % patches].face] + (element >= patches);
}

static uint32_t greatest_divisor(uint32_t a, uint32_t b)
{
	while (b > 0) {
		const uint32_t rest = a % b;
		a = b;
		b = rest;
	}
	return a;
}

static enum status make_arrays(struct trial *t, struct error *err)
{
	const uint32_t count = t->elements.count, nodes = scene_count(t->of->scene, BLOB_SCENE_NODES);
	t->groups = 2 * (nodes > 0 ? nodes : 1);
	t->made_of = calloc(count, sizeof *t->made_of);
	t->direct = calloc(3 * (size_t)count, sizeof *t->direct);
	t->node = calloc(t->elements.patches.faces.count, sizeof *t->node);
	t->same = calloc(t->groups, sizeof *t->same);
	t->lit = calloc(t->groups, sizeof *t->lit);
	t->list = calloc(count, sizeof *t->list);
	if (!t->made_of || !t->direct || !t->node || !t->same || !t->lit || !t->list)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < t->groups; i++)
		t->same[i] = i;
	fill_nodes(t);
	// Multiples of the golden ratio lie evenly on a circle however many there are.
	for (t->step = (uint32_t)(0.6180339887 * count) | 1u; greatest_divisor(t->step, count) != 1; t->step++)
		;
	return STATUS_OK;
}

static enum status make_passes(struct trial *t, struct error *err)
{
	const struct prospect_try *of = t->of;
	const struct patch_scene on = {of->plan, of->scene, &t->elements, &t->buffers};
	bool *const covered = surfaces_cover(of->factors->rows.way) ? &t->covered : NULL;
	enum status s = surfaces_create(&on, covered, t->device, &t->surfaces, err);
	if (s == STATUS_OK)
		s = surfaces_compile(t->surfaces, err);
	if (s == STATUS_OK && light_wanted(of->plan, of->scene, of->light->lamps))
		s = light_create(&on, of->light, t->device, &t->light, err);
	if (s == STATUS_OK && t->light)
		s = light_compile(t->light, err);
	if (s == STATUS_OK && of->rows)
		s = factors_init(&t->factors, t->device, t->elements.count, err);
	if (s == STATUS_OK && of->rows)
		s = row_maker_create(&on, &of->factors->rows, t->made_of, t->device, t->gl, &t->maker, err);
	if (s == STATUS_OK && of->rows)
		s = row_maker_compile(t->maker, err);
	return s;
}

// Cut the scene and make ready.
static enum status trial_init(struct trial *t, struct error *err)
{
	enum status s = devices_gl(t->of->devices, &t->gl, err);
	t->device = t->of->devices->vk;
	if (s == STATUS_OK)
		s = elements_init(&t->elements, &t->of->scene->view, &t->of->factors->cut, err);
	if (s != STATUS_OK || t->elements.count == 0)
		return s;
	s = element_buffers_init(&t->buffers, &t->elements, true, t->device, err);
	if (s == STATUS_OK)
		s = make_arrays(t, err);
	if (s == STATUS_OK)
		s = make_passes(t, err);
	return s;
}

// What surfaces are made of, which is quick and all the rest wants to know, and as much of what is covered as fits. *us:
// what all of it takes.
static enum status try_surfaces(struct trial *t, uint32_t budget_us, double *us, struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = STATUS_OK;
	while (s == STATUS_OK && !surfaces_made(t->surfaces))
		s = surfaces_step(t->surfaces, SLICE_US, err);
	const uint64_t made = clock_us();
	const double before = (double)surfaces_progress(t->surfaces);
	while (s == STATUS_OK && !surfaces_finished(t->surfaces)) {
		s = surfaces_step(t->surfaces, SLICE_US, err);
		if (clock_us() - start >= budget_us)
			break;
	}
	const double share = before < 1 ? ((double)surfaces_progress(t->surfaces) - before) / (1 - before) : 1;
	*us = (double)(made - start) + (double)(clock_us() - made) / fmax(share, 1e-6);
	if (s == STATUS_OK)
		s = buffer_read(&t->buffers.surfaces, t->device, 0, t->elements.count * sizeof *t->made_of, t->made_of, err);
	return s;
}

// Surfaces, and as many of the corners as fit.
static enum status try_cut(struct trial *t, uint32_t budget_us, struct error *err)
{
	struct corners *corners;
	double surfaces_us;
	enum status s = try_surfaces(t, budget_us / 2, &surfaces_us, err);
	if (s == STATUS_OK)
		s = corners_create(&t->elements, &corners, err);
	if (s != STATUS_OK)
		return s;
	const uint64_t start = clock_us();
	do
		s = corners_step(corners, SLICE_US, err);
	while (s == STATUS_OK && !corners_finished(corners) && clock_us() - start < budget_us / 2);
	const double done = fmax(corners_progress(corners), 0.01);
	t->found->cut = t->elements.count;
	t->found->cut_us = surfaces_us + (double)(clock_us() - start) / done;
	corners_destroy(corners);
	return s;
}

static enum status try_light(struct trial *t, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = STATUS_OK;
	if (!t->light)
		return STATUS_OK;
	while (s == STATUS_OK && !light_finished(t->light) && clock_us() - start < budget_us)
		s = light_step(t->light, SLICE_US, err);
	t->found->light_us = (double)(clock_us() - start);
	t->found->rays = (double)light_rays(t->light);
	return s == STATUS_OK ? light_read(t->light, t->direct, err) : s;
}

// ---- rows ---------------------------------------------------------------------------------------------------------------

static bool is_lit(const struct trial *t, uint32_t element)
{
	bool lit = t->of->background;
	for (unsigned c = 0; c < 3; c++)
		lit = lit || t->made_of[element].emission[c] > 0 || t->direct[3 * (size_t)element + c] > 0;
	return lit;
}

static bool is_wanted(const struct trial *t, uint32_t element)
{
	return t->lit[union_find(t->same, group_of(t, element))];
}

// The next elements, which is some number of all or of those that are wanted alone.
static uint32_t next_elements(struct trial *t, uint32_t most, bool wanted)
{
	const uint32_t count = t->elements.count;
	uint32_t n = 0;
	for (; n < most && t->next < count; t->next++) {
		const uint32_t element = (uint32_t)((uint64_t)t->next * t->step % count);
		if (!wanted || is_wanted(t, element))
			t->list[n++] = element;
	}
	return n;
}

static enum status make_rows(struct trial *t, uint32_t count, struct error *err)
{
	bool done = count == 0;
	enum status s = STATUS_OK;
	row_maker_begin(t->maker, t->list, count);
	while (s == STATUS_OK && !done)
		s = row_maker_step(t->maker, SLICE_US, &t->factors, &done, err);
	return s;
}

// The groups that a batch of rows sees.
static enum status join_seen(struct trial *t, uint32_t count, struct error *err)
{
	enum status s = STATUS_OK;
	for (uint32_t i = 0; i < count && s == STATUS_OK; i++) {
		uint32_t *columns;
		float *values;
		s = factors_read_row(&t->factors, t->list[i], &columns, &values, err);
		if (s != STATUS_OK)
			break;
		for (uint32_t k = 0; k < t->factors.rows[t->list[i]].count; k++)
			union_join(t->same, group_of(t, t->list[i]), group_of(t, columns[k]));
		free(columns);
		free(values);
	}
	t->tried += count;
	return s;
}

// Which groups see each other, and which are lit.
static enum status find_wanted(struct trial *t, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = STATUS_OK;
	uint32_t wanted = 0;
	const uint32_t some = t->elements.count / 2, most = some < FIRST_MOST ? some : FIRST_MOST;
	do {
		const uint32_t batch = row_maker_batch(t->maker, SLICE_US), left = most - t->tried;
		const uint32_t n = next_elements(t, batch < left ? batch : left, false);
		s = make_rows(t, n, err);
		if (s == STATUS_OK)
			s = join_seen(t, n, err);
	} while (s == STATUS_OK && clock_us() - start < budget_us && t->tried < most);
	for (uint32_t i = 0; i < t->elements.count; i++)
		if (is_lit(t, i))
			t->lit[union_find(t->same, group_of(t, i))] = 1;
	for (uint32_t i = 0; i < t->elements.count; i++)
		wanted += is_wanted(t, i);
	t->found->wanted = wanted;
	// More rows would at most find that all are wanted.
	const double more = wanted > 0 ? log((double)t->elements.count / wanted) / 1.645 : INFINITY;
	t->found->doubt = DOUBT_LEAST + fmin(DOUBT_ROWS / sqrt(1.0 + t->tried), more);
	return s;
}

// Against the clock, rows of those that are wanted.
static enum status time_rows(struct trial *t, uint32_t budget_us, struct error *err)
{
	const uint64_t begin = clock_us();
	const uint64_t before = t->factors.entries;
	uint64_t spent = 0;
	enum status s = STATUS_OK;
	do {
		const uint32_t n = next_elements(t, row_maker_batch(t->maker, SLICE_US), true);
		const uint64_t start = clock_us();
		if (n == 0)
			break;
		s = make_rows(t, n, err);
		if (s == STATUS_OK)
			s = join_seen(t, n, err); // as a job does
		t->found->rows += n;
		t->found->rows_us += (double)(clock_us() - start);
		spent = clock_us() - begin;
	} while (s == STATUS_OK && spent < (t->found->rows < ROWS_LEAST ? ROWS_ROOM * (uint64_t)budget_us : budget_us));
	t->found->entries = t->found->rows > 0 ? (double)(t->factors.entries - before) / t->found->rows : 0;
	return s;
}

enum status prospect_run(const struct prospect_try *of, uint32_t budget_us, struct prospect_found *found, struct error *err)
{
	struct trial t = {.of = of, .found = found};
	*found = (struct prospect_found){0};
	enum status s = trial_init(&t, err);
	found->elements = s == STATUS_OK ? t.elements.count : 0;
	const uint64_t start = clock_us();
	if (s == STATUS_OK && found->elements > 0)
		s = try_cut(&t, budget_us / LIGHT_SHARE, err);
	if (s == STATUS_OK && found->elements > 0)
		s = try_light(&t, budget_us / LIGHT_SHARE, err);
	const uint64_t spent = clock_us() - start;
	const uint32_t left = spent < budget_us ? budget_us - (uint32_t)spent : 0;
	if (s == STATUS_OK && t.maker)
		s = find_wanted(&t, left / FIRST_SHARE, err);
	if (s == STATUS_OK && t.maker)
		s = time_rows(&t, left - left / FIRST_SHARE, err);
	trial_finish(&t);
	return s;
}
