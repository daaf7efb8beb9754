#include "server/worker/technique/radiosity/patches.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/vec3.h"

#define STEPS 40 // of a search for an edge length, each of which halves what is left of its logarithm

// A face has at most (PATCHES_MOST + 1)² patches before they are counted.
_Static_assert((uint64_t)(PATCHES_MOST + 1u) * (PATCHES_MOST + 1u) < UINT64_MAX / PATCH_FACES_MOST, "sums fit");

// ---- cutting ----------------------------------------------------------------------------------------------------------

static double side_of(const struct patches *p, const struct patch_face *face, int from, int to)
{
	const float *a = p->vertices[face->corner[from]].position, *b = p->vertices[face->corner[to]].position;
	double sum = 0;
	for (int c = 0; c < 3; c++)
		sum += ((double)a[c] - (double)b[c]) * ((double)a[c] - (double)b[c]);
	return sqrt(sum);
}

// Parts of a side, at most PATCHES_MOST + 1. What rounding adds to a length is no reason for another part.
static uint32_t parts(double length, double edge)
{
	const double n = ceil(length / edge * (1 - 1e-6));
	return n >= PATCHES_MOST + 1.0 ? PATCHES_MOST + 1 : n > 1 ? (uint32_t)n : 1;
}

static struct patch_cut cut(const struct patches *p, const struct patch_face *face, double edge)
{
	const double a = side_of(p, face, 0, 1), b = side_of(p, face, 1, 2);
	if (face->corner[3] == NONE)
		return (struct patch_cut){.u = parts(fmax(fmax(a, b), side_of(p, face, 2, 0)), edge)};
	return (struct patch_cut){.u = parts(fmax(a, side_of(p, face, 2, 3)), edge),
				  .v = parts(fmax(b, side_of(p, face, 3, 0)), edge)};
}

static uint64_t patches_of(struct patch_cut c)
{
	return (uint64_t)c.u * (c.v ? c.v : c.u);
}

static uint64_t count_by(const struct patches *p, double edge)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < p->faces.count; i++)
		sum += patches_of(cut(p, &p->faces.list[i], edge));
	return sum;
}

// The least edge with which there are no more than `most` patches, which are no less than the faces.
static double edge_for(const struct patches *p, uint32_t most)
{
	double longest = 0;
	for (uint32_t i = 0; i < p->faces.count; i++)
		for (int k = 0; k < 4; k++) {
			const struct patch_face *face = &p->faces.list[i];
			const int corners = face->corner[3] == NONE ? 3 : 4;
			longest = fmax(longest, side_of(p, face, k % corners, (k + 1) % corners));
		}
	double low = longest / PATCHES_MOST, high = longest > 0 ? longest : 1;
	for (int i = 0; i < STEPS && low > 0; i++) {
		const double mid = sqrt(low) * sqrt(high);
		if (count_by(p, mid) <= most)
			high = mid;
		else
			low = mid;
	}
	return high;
}

static enum status choose_edge(struct patches *p, const struct patch_options *o, struct error *err)
{
	if (o->edge == 0 && o->count == 0)
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "radiosity needs the length of a patch's edge or a number of patches");
	if (!(o->edge >= 0))
		return error_set(err, STATUS_BAD_ARGUMENT, "the edge of a patch is %g m, which is no length", o->edge);
	if (o->edge > 0) {
		const uint64_t count = count_by(p, o->edge);
		p->edge = o->edge;
		if (count > PATCHES_MOST)
			return error_set(err, STATUS_LIMIT,
					 "patches of %g m would be %llu, and at most %u can be: %.4g m would do", o->edge,
					 (unsigned long long)count, PATCHES_MOST, edge_for(p, PATCHES_MOST) * 1.001);
		return STATUS_OK;
	}
	if (o->count > PATCHES_MOST)
		return error_set(err, STATUS_LIMIT, "%u patches are asked for, and at most %u can be", o->count,
				 PATCHES_MOST);
	p->edge = edge_for(p, o->count > p->faces.count ? o->count : p->faces.count);
	return STATUS_OK;
}

uint64_t patches_bytes(uint32_t triangles)
{
	return patch_faces_bytes(triangles) + (uint64_t)triangles * sizeof(struct patch_cut) + 1;
}

enum status patches_init(struct patches *p, const struct blob_view *scene, const struct patch_options *options,
			 struct error *err)
{
	enum status s;
	*p = (struct patches){.vertices = scene->sections[BLOB_VERTICES], .triangles = scene->sections[BLOB_TRIANGLES]};
	if ((s = patch_faces_init(&p->faces, scene, err)) != STATUS_OK || (s = choose_edge(p, options, err)) != STATUS_OK)
		goto failed;
	p->cuts = malloc(p->faces.count * sizeof *p->cuts + 1);
	if (!p->cuts) {
		s = error_set(err, STATUS_MEMORY, "out of memory");
		goto failed;
	}
	for (uint32_t i = 0; i < p->faces.count; i++) {
		p->cuts[i] = cut(p, &p->faces.list[i], p->edge);
		p->cuts[i].first = p->count;
		p->count += (uint32_t)patches_of(p->cuts[i]);
	}
	return STATUS_OK;
failed:
	patches_finish(p);
	return s;
}

void patches_finish(struct patches *p)
{
	free(p->cuts);
	patch_faces_finish(&p->faces);
	*p = (struct patches){0};
}

// ---- a patch ----------------------------------------------------------------------------------------------------------

// The place i parts of n from a to b: the same to the bit as n - i parts from b to a.
static void between(const double a[3], const double b[3], uint32_t i, uint32_t n, double out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = i == 0 ? a[c] : i == n ? b[c] : ((double)(n - i) * a[c] + (double)i * b[c]) / n;
}

static void in_quad(const double (*v)[3], struct patch_cut cut, uint32_t x, uint32_t y, double out[3])
{
	double low[3], high[3];
	between(v[0], v[1], x, cut.u, low);
	between(v[3], v[2], x, cut.u, high);
	between(low, high, y, cut.v, out);
}

// Row by row from corner 0: row r has r + 1 places.
static void in_triangle(const double (*v)[3], uint32_t n, uint32_t row, uint32_t x, double out[3])
{
	double low[3], high[3];
	between(v[0], v[1], row, n, low);
	between(v[0], v[2], row, n, high);
	between(low, high, x, row, out);
}

// Row r of a triangle has 2 r + 1 patches, and r² are before it. Every other one stands on its head.
static void triangle_shape(const double (*v)[3], uint32_t n, uint32_t cell, struct form_polygon *out)
{
	const uint32_t row = (uint32_t)sqrt((double)cell), x = cell - row * row, half = x / 2;
	const bool head = x % 2;
	out->corners = 3;
	in_triangle(v, n, row, half, out->at[0]);
	in_triangle(v, n, row + 1, half + head, out->at[1]);
	in_triangle(v, n, row + !head, half + 1, out->at[2]);
}

static void quad_shape(const double (*v)[3], struct patch_cut cut, uint32_t cell, struct form_polygon *out)
{
	const uint32_t x = cell % cut.u, y = cell / cut.u;
	out->corners = 4;
	for (uint32_t k = 0; k < 4; k++)
		in_quad(v, cut, x + (k == 1 || k == 2), y + (k > 1), out->at[k]);
}

static uint32_t face_of(const struct patches *p, uint32_t i)
{
	uint32_t low = 0, high = p->faces.count; // the face is low, or between
	while (high - low > 1) {
		const uint32_t mid = low + (high - low) / 2;
		if (p->cuts[mid].first <= i)
			low = mid;
		else
			high = mid;
	}
	return low;
}

void patches_get(const struct patches *p, uint32_t i, struct patch *out)
{
	const uint32_t at = face_of(p, i);
	const struct patch_face *face = &p->faces.list[at];
	const struct patch_cut cut = p->cuts[at];
	double v[4][3] = {{0}}, diagonal[2][3];
	for (uint32_t k = 0; k < 4 && face->corner[k] != NONE; k++)
		for (int c = 0; c < 3; c++)
			v[k][c] = (double)p->vertices[face->corner[k]].position[c];
	memset(out, 0, sizeof *out);
	if (cut.v)
		quad_shape((const double(*)[3])v, cut, i - cut.first, &out->shape);
	else
		triangle_shape((const double(*)[3])v, cut.u, i - cut.first, &out->shape);
	// Half of the product of its diagonals, or of two sides of a triangle.
	const double(*s)[3] = (const double(*)[3])out->shape.at;
	for (int c = 0; c < 3; c++) {
		diagonal[0][c] = s[2][c] - s[0][c];
		diagonal[1][c] = (cut.v ? s[3][c] : s[0][c]) - s[1][c];
	}
	vec3_cross(diagonal[0], diagonal[1], out->normal);
	out->area = 0.5 * sqrt(vec3_dot(out->normal, out->normal));
	vec3_normalize(out->normal);
	out->material = p->triangles[face->triangle[0]].material;
	memcpy(out->triangle, face->triangle, sizeof out->triangle);
	out->face = at;
}
