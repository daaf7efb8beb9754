#include "server/worker/technique/radiosity/patch_faces.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/vec3.h"

#define FLAT (4 * FLT_EPSILON) // of the largest coordinate: how far a corner may be from the plane of the others
#define LEAST_SINE 1e-3 // of a quad's corners: one that is hardly a corner makes a triangle
#define FELLOWS 4u // edges in the same place that are looked at, beside each: more where surfaces meet is no mesh

_Static_assert(PATCH_FACES_MOST <= UINT32_MAX / (6 * FELLOWS), "matches are counted in 32 bits");

// A corner of a triangle (3 triangle + corner), and where it is.
struct place {
	float at[3];
	uint32_t corner;
};

// An edge from one corner of a triangle to the next, by the numbers of its places, the lower one first.
struct side {
	uint32_t low, high;
	uint32_t corner;
	uint32_t turned; // it runs from high to low
};

// Two triangles that could be a quad, by their corners where the common edge begins.
struct match {
	float skew; // of the quad: 0 for a rectangle
	uint32_t corner[2];
};

// What is needed while faces are found.
struct finder {
	const struct vertex *vertices;
	const struct triangle *triangles;
	uint32_t count; // of triangles
	struct place *places; // three a triangle
	uint32_t *place_of; // by corner
	struct side *sides;
	struct match *matches;
	uint32_t *partner; // by triangle: the corner of the other where the common edge begins, or NONE
};

static const float *position(const struct finder *f, uint32_t corner)
{
	return f->vertices[f->triangles[corner / 3].vertex[corner % 3]].position;
}

static uint32_t next(uint32_t corner)
{
	return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static bool has_area(const struct finder *f, uint32_t triangle)
{
	double normal[3];
	vec3_across(position(f, 3 * triangle), position(f, 3 * triangle + 1), position(f, 3 * triangle + 2), normal);
	return vec3_normalize(normal);
}

static int by_place(const void *a, const void *b)
{
	const struct place *p = a, *q = b;
	for (int c = 0; c < 3; c++)
		if (p->at[c] != q->at[c])
			return p->at[c] < q->at[c] ? -1 : 1;
	return p->corner < q->corner ? -1 : p->corner > q->corner;
}

static int by_side(const void *a, const void *b)
{
	const struct side *p = a, *q = b;
	if (p->low != q->low)
		return p->low < q->low ? -1 : 1;
	if (p->high != q->high)
		return p->high < q->high ? -1 : 1;
	return p->corner < q->corner ? -1 : p->corner > q->corner;
}

static int by_skew(const void *a, const void *b)
{
	const struct match *p = a, *q = b;
	if (p->skew != q->skew)
		return p->skew < q->skew ? -1 : 1;
	for (int k = 0; k < 2; k++)
		if (p->corner[k] != q->corner[k])
			return p->corner[k] < q->corner[k] ? -1 : 1;
	return 0;
}

// The sides of all triangles that have an area, sorted. Returns their number.
static uint32_t sort_sides(struct finder *f)
{
	uint32_t n = 0;
	for (uint32_t corner = 0; corner < 3 * f->count; corner++) {
		f->places[corner].corner = corner;
		for (int c = 0; c < 3; c++)
			f->places[corner].at[c] = position(f, corner)[c] + 0.0f; // -0 becomes 0
	}
	qsort(f->places, 3 * (size_t)f->count, sizeof *f->places, by_place);
	for (uint32_t i = 0, number = 0; i < 3 * f->count; i++) {
		number += i > 0 && memcmp(f->places[i].at, f->places[i - 1].at, sizeof f->places[i].at) != 0;
		f->place_of[f->places[i].corner] = number;
	}
	for (uint32_t corner = 0; corner < 3 * f->count; corner++) {
		const uint32_t from = f->place_of[corner], to = f->place_of[next(corner)];
		const bool turned = from > to;
		if (has_area(f, corner / 3))
			f->sides[n++] = (struct side){turned ? to : from, turned ? from : to, corner, turned};
	}
	qsort(f->sides, n, sizeof *f->sides, by_side);
	return n;
}

// Whether two triangles with a side in common are a flat convex quad, and how far from a rectangle: the largest cosine of
// its angles.
static bool is_quad(const struct finder *f, uint32_t p, uint32_t q, float *skew)
{
	// Around the quad: where p's side ends, p's far corner, where the side begins, q's far corner.
	const float *at[4] = {position(f, next(p)), position(f, next(next(p))), position(f, p), position(f, next(next(q)))};
	double normal[3], side[4][3], far = 0, cross[3], off = 0;
	vec3_across(at[0], at[1], at[2], normal);
	vec3_normalize(normal);
	for (int i = 0; i < 4; i++) {
		for (int c = 0; c < 3; c++) {
			side[i][c] = (double)at[(i + 1) % 4][c] - (double)at[i][c];
			far = fmax(far, fabs((double)at[i][c]));
			off += i == 2 ? normal[c] * side[i][c] : 0;
		}
	}
	bool convex = fabs(off) <= FLAT * far;
	*skew = 0;
	for (int i = 0; i < 4; i++) {
		const double *u = side[i], *v = side[(i + 1) % 4];
		const double length = sqrt(vec3_dot(u, u) * vec3_dot(v, v));
		vec3_cross(u, v, cross);
		convex &= vec3_dot(cross, normal) > LEAST_SINE * length;
		*skew = fmaxf(*skew, (float)(fabs(vec3_dot(u, v)) / length));
	}
	return convex;
}

// Of n sides: pairs that could be quads, sorted. `out` may be NULL: their number alone.
static uint32_t find_matches(const struct finder *f, uint32_t n, struct match *out)
{
	uint32_t found = 0;
	for (uint32_t i = 0; i < n; i++) {
		const struct side *p = &f->sides[i];
		for (uint32_t k = i + 1; k < n && k <= i + FELLOWS; k++) {
			const struct side *q = &f->sides[k];
			float skew;
			if (q->low != p->low || q->high != p->high)
				break;
			if (q->turned == p->turned ||
			    f->triangles[p->corner / 3].material != f->triangles[q->corner / 3].material ||
			    !is_quad(f, p->corner, q->corner, &skew))
				continue;
			if (out)
				out[found] = (struct match){skew, {p->corner, q->corner}};
			found++;
		}
	}
	if (out)
		qsort(out, found, sizeof *out, by_skew);
	return found;
}

static struct patch_face face_of(const struct finder *f, uint32_t triangle)
{
	const uint32_t *v = f->triangles[triangle].vertex, q = f->partner[triangle];
	if (q == NONE)
		return (struct patch_face){{v[0], v[1], v[2], NONE}, {triangle, NONE}};
	const uint32_t p = f->partner[q / 3]; // where the common side begins, on this triangle
	return (struct patch_face){
	    {v[next(p) % 3], v[next(next(p)) % 3], v[p % 3], f->triangles[q / 3].vertex[next(next(q)) % 3]},
	    {triangle, q / 3}};
}

static enum status pair_up(struct finder *f, uint32_t sides, struct error *err)
{
	const uint32_t found = find_matches(f, sides, NULL);
	f->matches = malloc(found * sizeof *f->matches + 1);
	if (!f->matches)
		return error_set(err, STATUS_MEMORY, "out of memory");
	find_matches(f, sides, f->matches);
	for (uint32_t i = 0; i < found; i++) {
		const uint32_t p = f->matches[i].corner[0], q = f->matches[i].corner[1];
		if (f->partner[p / 3] != NONE || f->partner[q / 3] != NONE)
			continue;
		f->partner[p / 3] = q;
		f->partner[q / 3] = p;
	}
	return STATUS_OK;
}

static enum status list_faces(const struct finder *f, struct patch_faces *faces, struct error *err)
{
	faces->list = malloc(f->count * sizeof *faces->list + 1);
	if (!faces->list)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t t = 0; t < f->count; t++) {
		const bool flat = !has_area(f, t), second = f->partner[t] != NONE && f->partner[t] / 3 < t;
		faces->skipped += flat;
		if (!flat && !second)
			faces->list[faces->count++] = face_of(f, t);
	}
	if (faces->count > PATCH_FACES_MOST)
		return error_set(err, STATUS_SCENE_LIMIT, "the scene has %u faces, of which radiosity takes %u: simplify it",
				 faces->count, PATCH_FACES_MOST);
	return STATUS_OK;
}

uint64_t patch_faces_bytes(uint32_t triangles)
{
	const uint64_t corner =
	    sizeof(struct place) + sizeof(uint32_t) + sizeof(struct side) + FELLOWS * sizeof(struct match);
	return triangles * (3 * corner + sizeof(uint32_t) + sizeof(struct patch_face)) + 1;
}

enum status patch_faces_init(struct patch_faces *faces, const struct blob_view *scene, struct error *err)
{
	struct finder f = {.vertices = scene->sections[BLOB_VERTICES],
			   .triangles = scene->sections[BLOB_TRIANGLES],
			   .count = scene->counts[BLOB_TRIANGLES]};
	enum status s;
	*faces = (struct patch_faces){0};
	if (f.count > 2 * PATCH_FACES_MOST)
		return error_set(err, STATUS_SCENE_LIMIT,
				 "the scene has %u triangles, of which radiosity takes %u: simplify it", f.count,
				 2 * PATCH_FACES_MOST);
	f.places = malloc(3 * f.count * sizeof *f.places + 1);
	f.place_of = malloc(3 * f.count * sizeof *f.place_of + 1);
	f.sides = malloc(3 * f.count * sizeof *f.sides + 1);
	f.partner = malloc(f.count * sizeof *f.partner + 1);
	if (!f.places || !f.place_of || !f.sides || !f.partner) {
		s = error_set(err, STATUS_MEMORY, "out of memory");
		goto out;
	}
	memset(f.partner, 0xFF, f.count * sizeof *f.partner);
	if ((s = pair_up(&f, sort_sides(&f), err)) == STATUS_OK)
		s = list_faces(&f, faces, err);
	if (s != STATUS_OK)
		patch_faces_finish(faces);
out:
	free(f.matches);
	free(f.partner);
	free(f.sides);
	free(f.place_of);
	free(f.places);
	return s;
}

void patch_faces_finish(struct patch_faces *faces)
{
	free(faces->list);
	*faces = (struct patch_faces){0};
}
