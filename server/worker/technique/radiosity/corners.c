#include "server/worker/technique/radiosity/corners.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/base/clock.h"
#include "server/base/vec3.h"
#include "server/worker/technique/radiosity/corner_fit.h"
#include "server/worker/technique/radiosity/corner_links.h"

#define PIECE 1024u // of places, sides, edges or patches
#define MOVES 16384u // of what is sorted
#define LOOKS 1024u // points that may be looked at for each place and side, in the mean
#define SWEEPS 64u // over corners on sides whose sides end in corners on sides
#define AROUND (0.9 * 2 * PI) // radians: a corner with less about it is at a border
#define STEPS_NEAR 1024u // members that may be looked at for one border corner

enum corner_stage { LIST, FIND, WELD, LINK, SORT, CUT, JOIN, GROUP, MEASURE, FINISHED };

struct corners {
	const struct elements *elements;
	enum corner_stage stage;
	struct corner_places places;
	struct corner_links links;
	uint64_t left; // points that may be looked at
	float *angle; // by patch corner, radians
	float (*middle)[3]; // by patch, metres
	uint32_t measured; // patches
	uint32_t *group; // by element corner; NONE: a triangle's fourth
	uint32_t groups;
	uint32_t *first; // by group, and one more: its first member
	uint32_t *members; // element corners
	float (*at)[3]; // by group, metres
	struct corner_hang *hangs; // the longest sides first; their `corner` is still one of an element
	uint32_t hang_count;
	float (*values)[3]; // by group, of the last call
	uint32_t *held; // hangs that count, of the last call
	uint8_t *decided; // by group
};

static uint32_t element_corners(const struct elements *e)
{
	return 4 * e->count;
}

uint64_t corners_bytes(uint32_t patches)
{
	const uint64_t corners = 4 * (uint64_t)patches;
	return sizeof(struct corners) + corner_places_bytes(patches) + corner_links_bytes(patches) +
	       corners * (sizeof(float) + 2 * (4 * sizeof(uint32_t) + 6 * sizeof(float) + 1)) + patches * 3 * sizeof(float) +
	       64;
}

enum status corners_create(const struct elements *elements, struct corners **out, struct error *err)
{
	const uint32_t count = element_corners(elements);
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
	free(c->values);
	free(c->held);
	free(c->decided);
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
				memcpy(c->at[c->group[4 * i + k + side * element_corners(c->elements) / 2]],
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
	const uint32_t count = element_corners(c->elements), half = count / 2;
	for (uint32_t i = 0; i < count; i++) {
		const uint32_t place = c->places.of[i % half];
		const uint32_t same = corner_links_same(&c->links, i); // never after i
		c->group[i] = place == NONE ? NONE : same == i ? c->groups++ : c->group[same];
	}
}

static void list_members(struct corners *c)
{
	const uint32_t count = element_corners(c->elements);
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
	free(c->values);
	free(c->held);
	free(c->decided);
	c->groups = 0;
	number_groups(c);
	c->at = calloc(c->groups + 1, sizeof *c->at);
	c->first = calloc(c->groups + 1, sizeof *c->first);
	c->values = malloc(c->groups * sizeof *c->values + 1);
	c->held = malloc(c->groups * sizeof *c->held + 1);
	c->decided = malloc(c->groups + 1);
	if (!c->first || !c->at || !c->values || !c->held || !c->decided)
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
		c->left = ((uint64_t)c->places.count + element_corners(c->elements)) * LOOKS;
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

// ---- values -----------------------------------------------------------------------------------------------------------

static bool is_reached(const uint8_t *reached, uint32_t corner)
{
	return !reached || reached[corner / 4];
}

// The mean of a group's irradiances, as the first one and the mean difference from it: that of equal ones is the same.
static void take_mean(const struct corners *c, uint32_t group, const float *irradiance, const uint8_t *reached, float out[3])
{
	const uint32_t half = element_corners(c->elements) / 2;
	const float *first = NULL;
	double sum[3] = {0}, weights = 0;
	for (uint32_t i = c->first[group]; i < c->first[group + 1]; i++) {
		const uint32_t corner = c->members[i];
		if (!is_reached(reached, corner))
			continue;
		const float *h = irradiance + 3 * (uint64_t)(corner / 4);
		const double weight = (double)c->angle[corner % half];
		first = first ? first : h;
		weights += weight;
		for (int k = 0; k < 3; k++)
			sum[k] += weight * ((double)h[k] - (double)first[k]);
	}
	for (int k = 0; k < 3; k++)
		out[k] = !first ? 0 : weights > 0 ? (float)((double)first[k] + sum[k] / weights) : first[k];
}

// Whether what light reaches about a group's corner is not all around it.
static bool is_border(const struct corners *c, uint32_t group, const uint8_t *reached)
{
	const uint32_t half = element_corners(c->elements) / 2;
	double around = 0;
	for (uint32_t i = c->first[group]; i < c->first[group + 1]; i++)
		around += is_reached(reached, c->members[i]) ? (double)c->angle[c->members[i] % half] : 0;
	return around > 0 && around < AROUND;
}

static bool is_listed(const uint32_t *list, uint32_t count, uint32_t element)
{
	for (uint32_t i = 0; i < count; i++)
		if (list[i] == element)
			return true;
	return false;
}

// The elements of a group, and those that share corners with them. Returns their number; 0: they are too many.
static uint32_t list_near(const struct corners *c, uint32_t group, const uint8_t *reached, uint32_t *near)
{
	uint32_t n = 0, steps = 0;
	for (uint32_t i = c->first[group]; i < c->first[group + 1]; i++) {
		const uint32_t own = c->members[i] / 4;
		for (uint32_t k = 4 * own; is_reached(reached, 4 * own) && k < 4 * own + 4; k++) {
			const uint32_t of = c->group[k];
			for (uint32_t m = of == NONE ? 0 : c->first[of]; of != NONE && m < c->first[of + 1]; m++) {
				const uint32_t element = c->members[m] / 4;
				if (++steps > STEPS_NEAR)
					return 0;
				if (!is_reached(reached, c->members[m]) || is_listed(near, n, element))
					continue;
				if (n == CORNER_FIT_MOST)
					return 0;
				near[n++] = element;
			}
		}
	}
	return n;
}

// Extrapolate what a group at a border has, if there is enough to go by.
static void extrapolate(struct corners *c, uint32_t group, const float *irradiance, const uint8_t *reached)
{
	uint32_t near[CORNER_FIT_MOST];
	struct corner_sample samples[CORNER_FIT_MOST];
	const uint32_t n = list_near(c, group, reached, near);
	for (uint32_t i = 0; i < n; i++)
		samples[i] = (struct corner_sample){c->middle[near[i] % c->elements->patches.count],
						    irradiance + 3 * (uint64_t)near[i]};
	corner_fit(c->at[group], samples, n, c->values[group]);
}

// Of each group the hang with the longest side, of which light reaches both elements. Returns their number.
static uint32_t choose_hangs(struct corners *c, const uint8_t *reached)
{
	uint32_t n = 0;
	memset(c->decided, 0, c->groups);
	for (uint32_t i = 0; i < c->hang_count; i++) {
		const struct corner_hang *h = &c->hangs[i];
		const uint32_t group = c->group[h->corner];
		if (c->decided[group] || !is_reached(reached, h->corner) || !is_reached(reached, h->side))
			continue;
		c->decided[group] = 1;
		c->held[n++] = i;
	}
	return n;
}

// Put a group's value where its side has it. Returns whether it was another.
static bool put_on_side(struct corners *c, const struct corner_hang *h)
{
	const uint32_t quarter = h->side & ~3u, half = element_corners(c->elements) / 2;
	const uint32_t corners = c->elements->faces[c->elements->shapes[h->side % half / 4].face].v ? 4 : 3;
	const float *a = c->values[c->group[h->side]], *b = c->values[c->group[quarter + (h->side % 4 + 1) % corners]];
	float *out = c->values[c->group[h->corner]], was[3];
	memcpy(was, out, sizeof was);
	for (int k = 0; k < 3; k++)
		out[k] = (float)((double)a[k] + (double)h->t * ((double)b[k] - (double)a[k]));
	return memcmp(was, out, sizeof was) != 0;
}

void corners_values(struct corners *c, const float *irradiance, const uint8_t *reached, float *out)
{
	const uint32_t count = element_corners(c->elements), held = choose_hangs(c, reached);
	for (uint32_t g = 0; g < c->groups; g++) {
		take_mean(c, g, irradiance, reached, c->values[g]);
		if (!c->decided[g] && is_border(c, g, reached))
			extrapolate(c, g, irradiance, reached);
	}
	// What depends on longer sides alone is right after one sweep. Sides in a ring approach the mean that satisfies them
	// all.
	bool changed = held > 0;
	for (uint32_t sweep = 0; sweep < SWEEPS && changed; sweep++) {
		changed = false;
		for (uint32_t i = 0; i < held; i++)
			changed |= put_on_side(c, &c->hangs[c->held[i]]);
	}
	for (uint32_t i = 0; i < count; i++) {
		const uint32_t group = c->group[i] == NONE ? c->group[i - 1] : c->group[i];
		for (uint32_t k = 0; k < 3; k++)
			out[3 * (uint64_t)i + k] = is_reached(reached, i) ? c->values[group][k] : 0;
	}
}
