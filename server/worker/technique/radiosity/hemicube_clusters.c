#include "server/worker/technique/radiosity/hemicube_clusters.h"

#include <math.h>
#include <stdlib.h>

#include "server/base/vec3.h"

#define GROUP 4u // boxes of a level in one of the next
#define SNAP 0.0078125 // of a pixel: rasterisers round corners to 1/256 or better
#define SLACK 1e-6 // of distances: what projecting in floats rounds

// ---- making them ------------------------------------------------------------------------------------------------------

static bool is_cut(const struct resident_scene *scene, uint32_t triangle, uint32_t mask_flags)
{
	const struct triangle *triangles = scene_section(scene, BLOB_TRIANGLES);
	const struct material *materials = scene_section(scene, BLOB_MATERIALS);
	return (materials[triangles[triangle].material].flags & mask_flags) != 0;
}

static struct hemicube_box box_between(const double low[3], const double high[3])
{
	struct hemicube_box b;
	for (int a = 0; a < 3; a++) {
		b.at[a] = 0.5 * low[a] + 0.5 * high[a];
		b.reach[a] = 0.5 * high[a] - 0.5 * low[a];
	}
	return b;
}

static struct hemicube_box box_of_cluster(const struct resident_scene *scene, const struct hemicube_cluster *c)
{
	const struct vertex *vertices = scene_section(scene, BLOB_VERTICES);
	const struct triangle *triangles = scene_section(scene, BLOB_TRIANGLES);
	double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
	for (uint32_t i = c->first; i < c->end; i++)
		for (int k = 0; k < 3; k++)
			for (int a = 0; a < 3; a++) {
				const double at = (double)vertices[triangles[i].vertex[k]].position[a];
				low[a] = fmin(low[a], at);
				high[a] = fmax(high[a], at);
			}
	return box_between(low, high);
}

static struct hemicube_box box_of_boxes(const struct hemicube_box *boxes, uint32_t count)
{
	double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
	for (uint32_t i = 0; i < count; i++)
		for (int a = 0; a < 3; a++) {
			low[a] = fmin(low[a], boxes[i].at[a] - boxes[i].reach[a]);
			high[a] = fmax(high[a], boxes[i].at[a] + boxes[i].reach[a]);
		}
	return box_between(low, high);
}

// Cut the scene, into `list` or, where that is NULL, to count. Returns how many clusters there are.
static uint32_t cut_scene(const struct resident_scene *scene, uint32_t triangles, uint32_t mask_flags,
			  struct hemicube_cluster *list)
{
	const uint32_t all = scene_count(scene, BLOB_TRIANGLES);
	uint32_t count = 0;
	for (uint32_t first = 0, end; first < all; first = end) {
		const bool cut = is_cut(scene, first, mask_flags);
		for (end = first + 1; end < all && end - first < triangles && is_cut(scene, end, mask_flags) == cut; end++)
			;
		if (list)
			list[count] = (struct hemicube_cluster){.first = first, .end = end, .cut = cut};
		count++;
	}
	return count;
}

static uint32_t groups_of(uint32_t boxes)
{
	return boxes / GROUP + (boxes % GROUP > 0);
}

static enum status group(struct hemicube_clusters *c, struct error *err)
{
	while (c->counts[c->levels - 1] > 1 && c->levels < HEMICUBE_LEVELS_MOST) {
		const uint32_t below = c->counts[c->levels - 1], count = groups_of(below);
		const struct hemicube_box *from = c->boxes[c->levels - 1];
		struct hemicube_box *boxes = malloc(count * sizeof *boxes);
		if (!boxes)
			return error_set(err, STATUS_MEMORY, "out of memory");
		for (uint32_t i = 0; i < count; i++)
			boxes[i] = box_of_boxes(from + i * GROUP, below - i * GROUP < GROUP ? below - i * GROUP : GROUP);
		c->boxes[c->levels] = boxes;
		c->counts[c->levels] = count;
		c->levels++;
	}
	return STATUS_OK;
}

enum status hemicube_clusters_init(struct hemicube_clusters *c, const struct resident_scene *scene, uint32_t triangles,
				   uint32_t mask_flags, struct error *err)
{
	const uint32_t count = cut_scene(scene, triangles, mask_flags, NULL);
	*c = (struct hemicube_clusters){.levels = 1};
	c->list = malloc(((size_t)count + 1) * sizeof *c->list);
	c->boxes[0] = malloc(((size_t)count + 1) * sizeof *c->boxes[0]);
	if (!c->list || !c->boxes[0])
		return error_set(err, STATUS_MEMORY, "out of memory");
	c->counts[0] = cut_scene(scene, triangles, mask_flags, c->list);
	for (uint32_t i = 0; i < count; i++)
		c->boxes[0][i] = box_of_cluster(scene, &c->list[i]);
	return group(c, err);
}

void hemicube_clusters_finish(struct hemicube_clusters *c)
{
	for (uint32_t i = 0; i < c->levels; i++)
		free(c->boxes[i]);
	free(c->list);
	*c = (struct hemicube_clusters){0};
}

// ---- finding ----------------------------------------------------------------------------------------------------------

struct span {
	double low, high;
};

// A look at all clusters.
struct search {
	const struct hemicube_clusters *clusters;
	const struct hemicube_origin *origin;
	double half; // of a face's pixels
	struct hemicube_seen *seen;
	uint32_t count;
};

// 1 / w at both ends of a span that is above 0.
struct inverse {
	double of_low, of_high;
};

// Whether u / w may be at the middle of a pixel: `half` of them make up 1, they begin at `from`, and there are `count`.
static bool meets_middle(struct span u, struct inverse w, double half, double from, double count)
{
	const double low = (u.low * (u.low < 0 ? w.of_low : w.of_high) - from) * half - 0.5 - SNAP;
	const double high = (u.high * (u.high < 0 ? w.of_high : w.of_low) - from) * half - 0.5 + SNAP;
	if (!(high >= 0) || low > count - 1)
		return false;
	const double first = low > 0 ? (double)(int)low : 0;
	return (first < low ? first + 1 : first) <= high;
}

// Whether a face may see what lies within spans: in its direction, and along its rows and columns. Of a side, columns begin
// at the element's plane.
static bool may_see(double half, struct span w, struct span u, struct span v, bool side)
{
	if (!(w.high > 0) || w.high < u.low || w.high < -u.high || w.high < v.low || (!side && w.high < -v.high))
		return false;
	// Of what reaches behind the face's point, no projection is known.
	if (!(w.low > 0))
		return true;
	const struct inverse inverse = {1 / w.low, 1 / w.high};
	return meets_middle(u, inverse, half, -1, 2 * half) &&
	       meets_middle(v, inverse, half, side ? 0 : -1, side ? half : 2 * half);
}

static struct span span_of(const double axis[3], const double at[3], const double reach[3])
{
	const double middle = vec3_dot(axis, at);
	const double size = fabs(axis[0]) * reach[0] + fabs(axis[1]) * reach[1] + fabs(axis[2]) * reach[2];
	return (struct span){middle - size, middle + size};
}

static struct span negative(struct span s)
{
	return (struct span){-s.high, -s.low};
}

// Those of `faces` that may see something of a box.
static uint32_t faces_of(const struct search *s, const struct hemicube_box *b, uint32_t faces)
{
	double at[3], reach[3], size = 0;
	uint32_t some = 0;
	for (int a = 0; a < 3; a++) {
		at[a] = b->at[a] - s->origin->at[a];
		size += fabs(at[a]) + fabs(b->at[a]) + b->reach[a];
	}
	for (int a = 0; a < 3; a++)
		reach[a] = b->reach[a] + SLACK * size;
	const struct span z = span_of(s->origin->z, at, reach);
	if (!(z.high > 0))
		return 0;
	const struct span x = span_of(s->origin->x, at, reach), y = span_of(s->origin->y, at, reach);
	some |= faces & 1u && may_see(s->half, z, x, y, false) ? 1u : 0;
	some |= faces & 2u && may_see(s->half, x, y, z, true) ? 2u : 0;
	some |= faces & 4u && may_see(s->half, negative(x), y, z, true) ? 4u : 0;
	some |= faces & 8u && may_see(s->half, y, x, z, true) ? 8u : 0;
	some |= faces & 16u && may_see(s->half, negative(y), x, z, true) ? 16u : 0;
	return some;
}

// The depth is that of the levels.
static void find(struct search *s, uint32_t level, uint32_t i, uint32_t faces)
{
	const struct hemicube_clusters *c = s->clusters;
	const uint32_t left = faces_of(s, &c->boxes[level][i], faces);
	if (left == 0)
		return;
	if (level == 0) {
		s->seen[s->count++] = (struct hemicube_seen){.cluster = i, .faces = left};
		return;
	}
	for (uint32_t k = i * GROUP; k < (i + 1) * GROUP && k < c->counts[level - 1]; k++)
		find(s, level - 1, k, left);
}

uint32_t hemicube_clusters_find(const struct hemicube_clusters *clusters, const struct hemicube_origin *origin,
				uint32_t pixels, uint32_t faces, struct hemicube_seen *seen)
{
	const uint32_t last = clusters->levels - 1;
	struct search s = {.clusters = clusters, .origin = origin, .half = 0.5 * pixels, .seen = seen};
	for (uint32_t i = 0; i < clusters->counts[last]; i++)
		find(&s, last, i, faces);
	return s.count;
}
