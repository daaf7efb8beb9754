#include "server/worker/technique/voxel/voxel_items.h"

#include <math.h>

// Tiles are larger than need be by this margin, in voxels, because the device rounds differently.
#define SLACK 1e-3

// A triangle over the grid, in voxels, with its axes permuted so that columns run along the third.
struct columns {
	double v[3][3]; // corners
	uint32_t axis;
	bool needle;
	int32_t first[2], last[2]; // columns of its bounding box
};

void voxel_items_init(struct voxel_items *items, const struct blob_view *scene, const struct voxel_ranges *ranges,
		      const struct voxel_grid *grid)
{
	*items = (struct voxel_items){.vertices = scene->sections[BLOB_VERTICES],
				      .triangles = scene->sections[BLOB_TRIANGLES],
				      .ranges = ranges,
				      .grid = *grid,
				      .triangle = ranges->count > 0 ? ranges->list[0].first : 0};
}

// The axis that is most along the triangle's normal. A degenerate triangle has no normal: then the axis along which it
// extends least.
static uint32_t choose_axis(double g[3][3], bool *needle)
{
	double e1[3], e2[3], l1 = 0, l2 = 0, l3 = 0;
	for (int c = 0; c < 3; c++) {
		e1[c] = g[1][c] - g[0][c];
		e2[c] = g[2][c] - g[0][c];
		l1 += e1[c] * e1[c];
		l2 += e2[c] * e2[c];
		l3 += (e2[c] - e1[c]) * (e2[c] - e1[c]);
	}
	double n[3] = {fabs(e1[1] * e2[2] - e1[2] * e2[1]), fabs(e1[2] * e2[0] - e1[0] * e2[2]),
		       fabs(e1[0] * e2[1] - e1[1] * e2[0])};
	const double longest = fmax(l1, fmax(l2, l3));
	*needle = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) <= VOXEL_NEEDLE * longest;
	if (*needle) {
		for (int c = 0; c < 3; c++)
			n[c] = -fabs(longest == l1 ? e1[c] : longest == l2 ? e2[c] : e2[c] - e1[c]);
	}
	const uint32_t a = n[0] > n[1] ? 0 : 1;
	return n[a] > n[2] ? a : 2;
}

static int32_t held(double x, uint32_t side)
{
	return x < 0 ? 0 : x >= side ? (int32_t)side - 1 : (int32_t)x;
}

static void columns_of(const struct voxel_items *it, uint32_t id, struct columns *k)
{
	const struct triangle *t = &it->triangles[id];
	double g[3][3];
	for (int v = 0; v < 3; v++)
		for (int c = 0; c < 3; c++)
			g[v][c] = ((double)it->vertices[t->vertex[v]].position[c] - (double)it->grid.low[c]) /
				  (double)it->grid.side;
	k->axis = choose_axis(g, &k->needle);
	for (int c = 0; c < 3; c++)
		for (int v = 0; v < 3; v++)
			k->v[v][c] = g[v][(k->axis + 1 + (uint32_t)c) % 3];
	for (int c = 0; c < 2; c++) {
		const uint32_t side = it->grid.sides[(k->axis + 1 + (uint32_t)c) % 3];
		k->first[c] = held(fmin(k->v[0][c], fmin(k->v[1][c], k->v[2][c])) - SLACK, side);
		k->last[c] = held(fmax(k->v[0][c], fmax(k->v[1][c], k->v[2][c])) + SLACK, side);
	}
}

// The columns along the first axis that the triangle passes through in rows [row, row + VOXEL_TILE) along the second.
static void span_of(const struct columns *k, int32_t row, int32_t *first, int32_t *last)
{
	const double from = row - SLACK, to = row + VOXEL_TILE + SLACK;
	double low = INFINITY, high = -INFINITY;
	for (int i = 0; i < 3; i++) {
		const double *p = k->v[i], *q = k->v[(i + 1) % 3];
		if (fmax(p[1], q[1]) < from || fmin(p[1], q[1]) > to)
			continue;
		const double dy = q[1] - p[1], slope = dy != 0 ? (q[0] - p[0]) / dy : 0;
		for (int end = 0; end < 2; end++) {
			const double *v = end ? q : p;
			const double y = fmin(to, fmax(from, v[1]));
			const double x = v[1] == y ? v[0] : p[0] + slope * (y - p[1]);
			low = fmin(low, x);
			high = fmax(high, x);
		}
	}
	if (low > high) {
		*first = 1;
		*last = 0;
		return;
	}
	*first = low - SLACK > k->first[0] ? (int32_t)(low - SLACK) : k->first[0];
	*last = high + SLACK < k->last[0] ? (int32_t)floor(high + SLACK) : k->last[0];
}

static uint32_t least(int32_t a, int32_t b)
{
	return (uint32_t)(a < b ? a : b);
}

static struct voxel_item item_of(const struct columns *k, uint32_t id, int32_t a, int32_t b, int32_t last_a)
{
	const uint32_t width = least(last_a - a, VOXEL_TILE - 1), height = least(k->last[1] - b, VOXEL_TILE - 1);
	return (struct voxel_item){.triangle = id,
				   .tile = (uint32_t)a | (uint32_t)b << VOXEL_TILE_B | width << VOXEL_TILE_WIDTH |
					   height << VOXEL_TILE_HEIGHT | k->axis << VOXEL_TILE_AXIS |
					   (uint32_t)k->needle << VOXEL_TILE_NEEDLE};
}

static void next_triangle(struct voxel_items *it)
{
	it->row = 0;
	it->tile = 0;
	it->done++;
	if (++it->triangle < it->ranges->list[it->range].end)
		return;
	if (++it->range < it->ranges->count)
		it->triangle = it->ranges->list[it->range].first;
}

// Hand out tiles of the triangle at the cursor. Past its last tile the cursor moves to the next triangle.
static uint32_t next_of_triangle(struct voxel_items *it, struct voxel_item *out, uint32_t capacity)
{
	struct columns k;
	uint32_t n = 0;
	columns_of(it, it->triangle, &k);
	while (n < capacity) {
		const int32_t b = k.first[1] + (int32_t)(VOXEL_TILE * it->row);
		if (b > k.last[1])
			break;
		int32_t first = k.first[0], last = k.last[0];
		if (last - first >= VOXEL_TILE)
			span_of(&k, b, &first, &last);
		const int32_t a = first + (int32_t)(VOXEL_TILE * it->tile);
		if (a > last) {
			it->row++;
			it->tile = 0;
			continue;
		}
		out[n++] = item_of(&k, it->triangle, a, b, last);
		it->tile++;
	}
	if (n < capacity)
		next_triangle(it);
	return n;
}

uint32_t voxel_items_next(struct voxel_items *it, struct voxel_item *out, uint32_t capacity)
{
	uint32_t n = 0;
	while (n < capacity && !voxel_items_ended(it))
		n += next_of_triangle(it, out + n, capacity - n);
	return n;
}
