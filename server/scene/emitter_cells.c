#include "server/scene/emitter_cells.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/base/luminance.h"
#include "server/scene/alias.h"
#include "server/scene/lights.h"
#include "server/scene/texel.h"

#define PYRAMID_LEVELS 32u
#define PYRAMID_BASE (1u << 22) // cells of its finest level, at most
#define BOX_CELLS 8.0 // a cell's mean is that of at most so many cells of the pyramid, each way

// The mean light of a texture, by halves. With one plane it is the luminance of an emission. Emissions of several factors
// share a pyramid of three planes: what red, green and blue of factor 1 add to the luminance.
struct pyramid {
	float *levels[PYRAMID_LEVELS]; // `planes` values a cell
	uint32_t planes;
	uint32_t width[PYRAMID_LEVELS], height[PYRAMID_LEVELS];
	uint32_t count;
};

static const struct material *material_of(const struct blob_view *scene, uint32_t emitter)
{
	const struct emitter *emitters = scene->sections[BLOB_EMITTERS];
	const struct triangle *triangles = scene->sections[BLOB_TRIANGLES];
	const struct material *materials = scene->sections[BLOB_MATERIALS];
	return &materials[triangles[emitters[emitter].triangle].material];
}

static const struct texture_info *texture_of(const struct blob_view *scene, uint32_t emitter)
{
	const uint32_t texture = material_of(scene, emitter)->emission_texture;
	return texture == NONE ? NULL : &((const struct texture_info *)scene->sections[BLOB_TEXTURES])[texture];
}

bool emitter_cells_wanted(const struct blob_view *scene)
{
	const struct material *materials = scene->sections[BLOB_MATERIALS];
	uint32_t m = 0;
	while (m < scene->counts[BLOB_MATERIALS] && materials[m].emission_texture == NONE)
		m++;
	if (m == scene->counts[BLOB_MATERIALS])
		return false;
	for (uint32_t i = 0; i < scene->counts[BLOB_EMITTERS]; i++)
		if (texture_of(scene, i))
			return true;
	return false;
}

// ---- sizes --------------------------------------------------------------------------------------------------------------

// The texture coordinates, in texels, of an emitter's corners. False if they are no use.
static bool corners_in_texels(const struct blob_view *scene, uint32_t emitter, double out[3][2])
{
	const struct texture_info *t = texture_of(scene, emitter);
	const struct emitter *emitters = scene->sections[BLOB_EMITTERS];
	const struct triangle *tri = &((const struct triangle *)scene->sections[BLOB_TRIANGLES])[emitters[emitter].triangle];
	const struct vertex *vertices = scene->sections[BLOB_VERTICES];
	const struct vertex_uv1 *uv1 = scene->sections[BLOB_UV1];
	for (int c = 0; c < 3; c++) {
		const float *uv = t->flags & TEXTURE_UV1 ? uv1[tri->vertex[c]].uv : vertices[tri->vertex[c]].uv;
		const double u = (double)uv[0], v = (double)uv[1];
		out[c][0] = ((double)t->row_u[0] * u + (double)t->row_u[1] * v + (double)t->row_u[2]) * t->width;
		out[c][1] = ((double)t->row_v[0] * u + (double)t->row_v[1] * v + (double)t->row_v[2]) * t->height;
		if (!(fabs(out[c][0]) < 1e9 && fabs(out[c][1]) < 1e9))
			return false;
	}
	return true;
}

// The level at which a textured emitter's cells have sides of about half a texel: the longest side decides.
static uint32_t level_of(const struct blob_view *scene, uint32_t emitter)
{
	double at[3][2], longest = 0;
	if (!corners_in_texels(scene, emitter, at))
		return 0;
	for (int c = 0; c < 3; c++)
		longest = fmax(longest, hypot(at[(c + 1) % 3][0] - at[c][0], at[(c + 1) % 3][1] - at[c][1]));
	uint32_t level = 0;
	while (level < CELL_LEVEL_MAX && ldexp(longest, -(int)level) > 0.75)
		level++;
	return level;
}

// A textured emitter, with the level that its texels ask for.
struct order {
	const struct texture_info *texture;
	uint32_t emitter, level;
};

// How many triangles ask for each level.
struct demand {
	uint32_t triangles[CELL_LEVEL_MAX + 1];
	uint32_t sum;
};

// Count the demand of the textured emitters, and list them unless `out` is NULL.
static struct demand demand_of(const struct blob_view *scene, struct order *out)
{
	struct demand d = {0};
	for (uint32_t i = 0; i < scene->counts[BLOB_EMITTERS]; i++) {
		const struct texture_info *t = texture_of(scene, i);
		if (!t)
			continue;
		const uint32_t level = level_of(scene, i);
		d.triangles[level]++;
		if (out)
			out[d.sum] = (struct order){t, i, level};
		d.sum++;
	}
	return d;
}

static uint32_t least(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

static uint64_t cells_below(const struct demand *d, uint32_t most)
{
	uint64_t sum = 1; // that of triangles without a texture
	for (uint32_t l = 0; l <= CELL_LEVEL_MAX; l++)
		sum += (uint64_t)d->triangles[l] << 2 * least(l, most);
	return sum;
}

// The highest level that the scene's number of cells allows.
static uint32_t highest_level(const struct demand *d)
{
	uint32_t most = CELL_LEVEL_MAX;
	while (most > 0 && cells_below(d, most) > CELLS_MAX)
		most--;
	return most;
}

uint32_t emitter_cells_count(const struct blob_view *scene)
{
	const struct demand d = demand_of(scene, NULL);
	return (uint32_t)cells_below(&d, highest_level(&d));
}

// ---- means of a texture -------------------------------------------------------------------------------------------------

static void pyramid_finish(struct pyramid *p)
{
	for (uint32_t i = 0; i < p->count; i++)
		free(p->levels[i]);
	*p = (struct pyramid){0};
}

static float *pyramid_add(struct pyramid *p, uint32_t width, uint32_t height)
{
	float *level = calloc((size_t)width * height * p->planes, sizeof *level);
	if (level) {
		p->width[p->count] = width;
		p->height[p->count] = height;
		p->levels[p->count++] = level;
	}
	return level;
}

// The next cell of half as many that cell i of `from` falls in.
static uint32_t halved(uint32_t i, uint32_t from, uint32_t to)
{
	return (uint32_t)((uint64_t)i * to / from);
}

// Add what each cell of one level has to the cell of the other that it falls in, and divide by their numbers.
static void reduce(struct pyramid *p, uint32_t to)
{
	const uint32_t w = p->width[to], h = p->height[to], fw = p->width[to - 1], fh = p->height[to - 1];
	const float *from = p->levels[to - 1];
	float *out = p->levels[to];
	for (uint32_t y = 0; y < fh; y++)
		for (uint32_t x = 0; x < fw; x++) {
			const size_t cell = (size_t)halved(y, fh, h) * w + halved(x, fw, w);
			for (uint32_t k = 0; k < p->planes; k++)
				out[cell * p->planes + k] += *from++;
		}
	const double scale = (double)w * h / ((double)fw * fh);
	for (size_t i = 0; i < (size_t)w * h * p->planes; i++)
		out[i] = (float)((double)out[i] * scale);
}

static bool same_factors(const struct material *a, const struct material *b)
{
	return a == b || memcmp(a->emission, b->emission, sizeof a->emission) == 0;
}

// Make the pyramid of the one image of some emitters.
static bool pyramid_init(struct pyramid *p, const struct blob_view *scene, const struct order *order, uint32_t count)
{
	static const float unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	const struct texture_info *t = order->texture;
	const struct material *m = material_of(scene, order->emitter);
	uint32_t w = t->width, h = t->height, same = 1;
	while (same < count && same_factors(m, material_of(scene, order[same].emitter)))
		same++;
	*p = (struct pyramid){.planes = same == count ? 1 : 3};
	while ((uint64_t)w * h > PYRAMID_BASE) {
		w = (w + 1) / 2;
		h = (h + 1) / 2;
	}
	float *base = pyramid_add(p, w, h);
	if (!base)
		return false;
	lights_texture_luminance(t, scene->sections[BLOB_TEXELS], p->planes == 1 ? &m->emission : unit, p->planes, w, h,
				 base);
	while (w > 1 || h > 1) {
		w = (w + 1) / 2;
		h = (h + 1) / 2;
		if (!pyramid_add(p, w, h))
			return false;
		reduce(p, p->count - 1);
	}
	return true;
}

// The light of an emission by its factor of each plane.
static double light_of(const struct pyramid *p, const double factors[3], uint32_t level, size_t cell)
{
	double sum = 0;
	for (uint32_t k = 0; k < p->planes; k++)
		sum += factors[k] * (double)p->levels[level][cell * p->planes + k];
	return sum;
}

// As wrap_index of shaders/common/texture.glsl.
static uint32_t wrapped(int64_t i, uint32_t side, uint32_t mode)
{
	const int64_t n = side, period = mode == WRAP_MIRROR ? 2 * n : n;
	if (mode == WRAP_CLAMP)
		return (uint32_t)(i < 0 ? 0 : i >= n ? n - 1 : i);
	const int64_t m = (i % period + period) % period;
	return (uint32_t)(m < n ? m : period - 1 - m);
}

// The mean over a box in texels.
static double box_mean(const struct pyramid *p, const double factors[3], const struct texture_info *t, const double low[2],
		       const double high[2])
{
	uint32_t l = 0;
	while (l + 1 < p->count &&
	       fmax((high[0] - low[0]) * p->width[l] / t->width, (high[1] - low[1]) * p->height[l] / t->height) > BOX_CELLS)
		l++;
	const uint32_t w = p->width[l], h = p->height[l];
	const double sx = (double)w / t->width, sy = (double)h / t->height;
	const double x0 = low[0] * sx, x1 = high[0] * sx, y0 = low[1] * sy, y1 = high[1] * sy;
	// A texture of a few cells that is repeated many times: its mean.
	if (x1 - x0 > 2 * BOX_CELLS || y1 - y0 > 2 * BOX_CELLS)
		return light_of(p, factors, p->count - 1, 0);
	double sum = 0, area = 0;
	for (int64_t y = (int64_t)floor(y0); (double)y < y1; y++)
		for (int64_t x = (int64_t)floor(x0); (double)x < x1; x++) {
			const double part = (fmin(x1, (double)x + 1) - fmax(x0, (double)x)) *
					    (fmin(y1, (double)y + 1) - fmax(y0, (double)y));
			const size_t row = wrapped(y, h, t->flags >> TEXTURE_WRAP_T_SHIFT & 3u);
			const size_t column = wrapped(x, w, t->flags >> TEXTURE_WRAP_S_SHIFT & 3u);
			sum += part * light_of(p, factors, l, row * w + column);
			area += part;
		}
	return area > 0 ? sum / area : 0;
}

// The mean over cell (a, b) of n² cells of a triangle: over the box about its corners, which the filter widens.
static double cell_mean(const struct pyramid *p, const double factors[3], const struct texture_info *t, double corners[3][2],
			uint32_t n, uint32_t a, uint32_t b)
{
	const bool upper = a + b >= n;
	const double x = upper ? n - 1 - a : a, y = upper ? n - 1 - b : b;
	const double own = upper ? 1 : 0, margin = t->flags & TEXTURE_NEAREST ? 1e-3 : 0.5;
	const double at[3][2] = {{x + own, y + own}, {x + 1, y}, {x, y + 1}}; // barycentrics of corners 1 and 2, times n
	double low[2], high[2];
	for (int i = 0; i < 2; i++) {
		low[i] = INFINITY;
		high[i] = -INFINITY;
		for (int c = 0; c < 3; c++) {
			const double v =
			    corners[0][i] +
			    (at[c][0] * (corners[1][i] - corners[0][i]) + at[c][1] * (corners[2][i] - corners[0][i])) / n;
			low[i] = fmin(low[i], v - margin);
			high[i] = fmax(high[i], v + margin);
		}
	}
	return box_mean(p, factors, t, low, high);
}

// ---- tables -------------------------------------------------------------------------------------------------------------

// Room for the work on one triangle.
struct work {
	double *weights;
	struct alias_row *rows;
};

// Fill a triangle's cells, and its grid's share: the mean of their densities.
static enum status fill_grid(struct emitter_cells *out, const struct blob_view *scene, const struct order *order,
			     uint32_t level, const struct pyramid *p, struct work *work, struct error *err)
{
	struct emitter_grid *g = &out->grids[order->emitter];
	const float *emission = material_of(scene, order->emitter)->emission;
	struct emitter_cell *cells = &out->cells[out->cell_count];
	const uint32_t n = 1u << level, count = n * n;
	double factors[3] = {1}, corners[3][2], sum;
	for (int c = 0; c < 3 && p->planes == 3; c++)
		factors[c] = (double)emission[c];
	const double mean = light_of(p, factors, p->count - 1, 0);
	const bool useful = corners_in_texels(scene, order->emitter, corners) && mean > 0;
	for (uint32_t i = 0; i < count; i++) {
		const double of = useful ? cell_mean(p, factors, order->texture, corners, n, i % n, i / n) / mean : 1;
		work->weights[i] = (1 - CELL_EVEN) * of + CELL_EVEN;
	}
	const enum status s = alias_build(work->weights, count, work->rows, &sum, err);
	if (s != STATUS_OK)
		return s;
	g->first = out->cell_count;
	g->level = level;
	g->share = (float)(sum / count);
	// The density is that of the table as it is, not of the weights.
	for (uint32_t i = 0; i < count; i++)
		cells[i] = (struct emitter_cell){work->rows[i].keep, work->rows[i].alias,
						 (float)((double)work->rows[i].pmf * count * (double)g->share)};
	out->cell_count += count;
	return STATUS_OK;
}

// By what a pyramid is made of: the texels, and how they are read. Transforms and ways to wrap may differ.
static int compare_images(const struct texture_info *a, const struct texture_info *b)
{
	const uint32_t read = TEXTURE_SRGB | TEXTURE_DEEP;
	const uint32_t x[] = {a->offset, a->width, a->height, a->flags & read};
	const uint32_t y[] = {b->offset, b->width, b->height, b->flags & read};
	for (int i = 0; a != b && i < 4; i++)
		if (x[i] != y[i])
			return x[i] < y[i] ? -1 : 1;
	return 0;
}

static int compare_orders(const void *a, const void *b)
{
	const struct order *x = a, *y = b;
	const int c = compare_images(x->texture, y->texture);
	return c != 0 ? c : x->emitter < y->emitter ? -1 : x->emitter > y->emitter;
}

// Fill the grids image by image, so that each has one pyramid, whatever the number of materials that it is part of.
static enum status fill_grids(struct emitter_cells *out, const struct blob_view *scene, struct order *order, uint32_t count,
			      uint32_t most, struct work *work, struct error *err)
{
	enum status s = STATUS_OK;
	qsort(order, count, sizeof *order, compare_orders);
	out->cells[out->cell_count++] = (struct emitter_cell){1, 0, 1};
	for (uint32_t i = 0; i < out->count; i++)
		out->grids[i] = (struct emitter_grid){0, 0, 1};
	for (uint32_t first = 0, next; first < count && s == STATUS_OK; first = next) {
		struct pyramid p;
		next = first + 1;
		while (next < count && compare_images(order[first].texture, order[next].texture) == 0)
			next++;
		if (!pyramid_init(&p, scene, &order[first], next - first))
			s = error_set(err, STATUS_MEMORY, "no memory for the means of an emissive texture");
		for (uint32_t i = first; i < next && s == STATUS_OK; i++)
			s = fill_grid(out, scene, &order[i], least(order[i].level, most), &p, work, err);
		pyramid_finish(&p);
	}
	return s;
}

// Weigh the emitters anew, by the light of their own part of the texture.
static enum status weigh_emitters(struct emitter_cells *out, const struct blob_view *scene, struct error *err)
{
	const struct emitter *emitters = scene->sections[BLOB_EMITTERS];
	const struct triangle *triangles = scene->sections[BLOB_TRIANGLES];
	double *weights = malloc(out->count * sizeof *weights), sum = 0;
	struct alias_row *rows = malloc(out->count * sizeof *rows);
	enum status s = weights && rows ? STATUS_OK : error_set(err, STATUS_MEMORY, "no memory for %u emitters", out->count);
	for (uint32_t i = 0; i < out->count && s == STATUS_OK; i++)
		weights[i] = fmax((double)material_of(scene, i)->power_density * (double)out->grids[i].share *
				      lights_area(scene->sections[BLOB_VERTICES], &triangles[emitters[i].triangle]),
				  DBL_MIN);
	if (s == STATUS_OK)
		s = alias_build(weights, out->count, rows, &sum, err);
	for (uint32_t i = 0; i < out->count && s == STATUS_OK; i++)
		out->emitters[i] = (struct emitter){emitters[i].triangle, rows[i].keep, rows[i].alias, rows[i].pmf};
	out->power = (float)fmin(sum, FLT_MAX);
	free(weights);
	free(rows);
	return s;
}

enum status emitter_cells_init(struct emitter_cells *out, const struct blob_view *scene, struct error *err)
{
	*out = (struct emitter_cells){.count = scene->counts[BLOB_EMITTERS]};
	struct order *order = malloc(out->count * sizeof *order);
	if (!order)
		return error_set(err, STATUS_MEMORY, "no memory for %u emissive triangles", out->count);
	const struct demand d = demand_of(scene, order);
	const uint32_t most = highest_level(&d);
	const size_t cells = cells_below(&d, most), largest = (size_t)1 << 2 * most;
	out->grids = malloc(out->count * sizeof *out->grids);
	out->cells = malloc(cells * sizeof *out->cells);
	out->emitters = malloc(out->count * sizeof *out->emitters);
	struct work work = {malloc(largest * sizeof *work.weights), malloc(largest * sizeof *work.rows)};
	enum status s = STATUS_OK;
	if (!out->grids || !out->cells || !out->emitters || !work.weights || !work.rows)
		s = error_set(err, STATUS_MEMORY, "no memory for %zu cells of emissive triangles", cells);
	if (s == STATUS_OK)
		s = fill_grids(out, scene, order, d.sum, most, &work, err);
	if (s == STATUS_OK)
		s = weigh_emitters(out, scene, err);
	free(order);
	free(work.weights);
	free(work.rows);
	if (s != STATUS_OK)
		emitter_cells_finish(out);
	return s;
}

void emitter_cells_trim(struct emitter_cells *c)
{
	free(c->cells);
	free(c->emitters);
	c->cells = NULL;
	c->emitters = NULL;
}

void emitter_cells_finish(struct emitter_cells *c)
{
	emitter_cells_trim(c);
	free(c->grids);
	*c = (struct emitter_cells){0};
}
