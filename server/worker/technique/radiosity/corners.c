#include "server/worker/technique/radiosity/corners.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/base/clock.h"
#include "server/base/vec3.h"
#include "server/worker/technique/radiosity/corners_parts.h"

#define PIECE 1024u // of places, sides, edges or patches
#define MOVES 16384u // of what is sorted
#define LOOKS 1024u // points that may be looked at for each place and side, in the mean

uint64_t corners_bytes(uint32_t patches)
{
	const uint64_t corners = 4 * (uint64_t)patches;
	return sizeof(struct corners) + corner_places_bytes(patches) + corner_links_bytes(patches) +
	       corners * (sizeof(float) + 2 * (4 * sizeof(uint32_t) + 6 * sizeof(float) + 1)) + patches * 3 * sizeof(float) +
	       64;
}

enum status corners_create(const struct elements *elements, struct corners **out, struct error *err)
{
	const uint32_t count = corners_of(elements);
	struct corners *c = calloc(1, sizeof *c);
	*out = c;
	if (!c)
		return error_set(err, STATUS_MEMORY, "out of memory");
	c->elements = elements;
	c->angle = malloc(count / 2 * sizeof *c->angle + 1);
	c->middle = malloc(elements->patches.count * sizeof *c->middle + 1);
	c->group = malloc(count * sizeof *c->group + 1);
	c->members = malloc(count * sizeof *c->members + 1);
	if (c->angle && c->middle && c->group && c->members)
		return STATUS_OK;
	corners_destroy(c);
	*out = NULL;
	return error_set(err, STATUS_MEMORY, "out of memory");
}

void corners_destroy(struct corners *c)
{
	if (!c)
		return;
	corner_links_finish(&c->links);
	corner_places_finish(&c->places);
	free(c->angle);
	free(c->middle);
	free(c->group);
	free(c->first);
	free(c->members);
	free(c->at);
	free(c->hangs);
	free(c);
}

// ---- groups -----------------------------------------------------------------------------------------------------------

// The angle of a polygon at a corner.
static double angle_at(const struct form_polygon *s, uint32_t k)
{
	const double *at = s->at[k], *next = s->at[(k + 1) % s->corners], *last = s->at[(k + s->corners - 1) % s->corners];
	double u[3], v[3], cross[3];
	for (int c = 0; c < 3; c++) {
		u[c] = next[c] - at[c];
		v[c] = last[c] - at[c];
	}
	vec3_cross(u, v, cross);
	return atan2(sqrt(vec3_dot(cross, cross)), vec3_dot(u, v));
}

// Angles and middles of more patches, and where the groups of their corners are.
static void measure(struct corners *c, uint32_t count)
{
	const uint32_t left = c->elements->patches.count - c->measured, end = c->measured + (count < left ? count : left);
	for (uint32_t i = c->measured; i < end; i++) {
		const struct radiosity_patch *shape = &c->elements->shapes[i];
		struct patch patch;
		patches_get(&c->elements->patches, i, &patch);
		for (uint32_t k = 0; k < 4; k++) {
			c->angle[4 * i + k] = k < patch.shape.corners ? (float)angle_at(&patch.shape, k) : 0;
			for (uint32_t side = 0; k < patch.shape.corners && side < 2; side++)
				memcpy(c->at[c->group[4 * i + k + side * corners_of(c->elements) / 2]],
				       shape->corner + 3 * k, sizeof *c->at);
		}
		for (int k = 0; k < 3; k++)
			c->middle[i][k] = (shape->corner[k] + shape->share * shape->corner[3 + k] + shape->corner[6 + k] +
					   (1 - shape->share) * shape->corner[9 + k]) /
					  3;
	}
	c->measured = end;
}

static int by_length(const void *a, const void *b)
{
	const struct corner_hang *p = a, *q = b;
	if (p->length != q->length)
		return p->length > q->length ? -1 : 1;
	if (p->side != q->side)
		return p->side < q->side ? -1 : 1;
	return p->corner < q->corner ? -1 : p->corner > q->corner;
}

static void number_groups(struct corners *c)
{
	const uint32_t count = corners_of(c->elements), half = count / 2;
	for (uint32_t i = 0; i < count; i++) {
		const uint32_t place = c->places.of[i % half];
		const uint32_t same = corner_links_same(&c->links, i); // never after i
		c->group[i] = place == NONE ? NONE : same == i ? c->groups++ : c->group[same];
	}
}

static void list_members(struct corners *c)
{
	const uint32_t count = corners_of(c->elements);
	for (uint32_t i = 0; i < count; i++)
		if (c->group[i] != NONE)
			c->first[c->group[i] + 1]++;
	for (uint32_t g = 0; g < c->groups; g++)
		c->first[g + 1] += c->first[g];
	const uint32_t all = c->first[c->groups];
	// Each group's end is where the next begins; filled from behind it becomes its own beginning.
	for (uint32_t i = count; i-- > 0;)
		if (c->group[i] != NONE)
			c->members[--c->first[c->group[i] + 1]] = i;
	memmove(c->first, c->first + 1, c->groups * sizeof *c->first);
	c->first[c->groups] = all;
}

static enum status make_groups(struct corners *c, struct error *err)
{
	// An attempt without enough memory may have left some.
	free(c->first);
	free(c->at);
	c->groups = 0;
	number_groups(c);
	c->at = calloc(c->groups + 1, sizeof *c->at);
	c->first = calloc(c->groups + 1, sizeof *c->first);
	if (!c->first || !c->at)
		return error_set(err, STATUS_MEMORY, "out of memory");
	list_members(c);
	c->hangs = c->links.hangs;
	c->hang_count = c->links.hang_count;
	c->links.hangs = NULL;
	if (c->hang_count > 0)
		qsort(c->hangs, c->hang_count, sizeof *c->hangs, by_length);
	corner_links_finish(&c->links);
	corner_places_finish(&c->places);
	return STATUS_OK;
}

// ---- slices -----------------------------------------------------------------------------------------------------------

static enum status piece(struct corners *c, struct error *err)
{
	enum status s = STATUS_OK;
	bool done = true;
	switch (c->stage) {
	case LIST:
		s = corner_places_init(&c->places, c->elements, err);
		break;
	case FIND:
		s = corner_places_find(&c->places, MOVES, err);
		done = c->places.found;
		c->left = ((uint64_t)c->places.count + corners_of(c->elements)) * LOOKS;
		break;
	case WELD:
		corner_places_weld(&c->places, PIECE, &c->left);
		done = c->places.welded == c->places.count;
		break;
	case LINK:
		s = corner_links_init(&c->links, &c->places, err);
		break;
	case SORT:
		corner_links_sort(&c->links, MOVES);
		done = c->links.sorted;
		break;
	case CUT:
		s = corner_links_cut(&c->links, c->links.edges ? PIECE : MOVES, &c->left, err);
		done = c->links.cut;
		break;
	case JOIN:
		s = corner_links_join(&c->links, PIECE, err);
		done = c->links.edges_joined == c->links.edge_count;
		break;
	case GROUP:
		s = make_groups(c, err);
		break;
	case MEASURE:
		measure(c, PIECE);
		done = c->measured == c->elements->patches.count;
		break;
	case FINISHED:
		return STATUS_OK;
	}
	c->stage += s == STATUS_OK && done;
	return s;
}

enum status corners_step(struct corners *c, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	enum status s;
	do
		s = piece(c, err);
	while (s == STATUS_OK && c->stage != FINISHED && clock_us() - start < budget_us);
	return s;
}

bool corners_finished(const struct corners *c)
{
	return c->stage == FINISHED;
}

double corners_progress(const struct corners *c)
{
	double part = 0;
	if (c->stage == WELD)
		part = (double)c->places.welded / (c->places.count + 1);
	else if (c->stage == CUT)
		part = (double)c->links.sides_cut / (c->links.side_count + 1);
	else if (c->stage == JOIN)
		part = (double)c->links.edges_joined / (c->links.edge_count + 1);
	return ((double)c->stage + part) / FINISHED;
}
