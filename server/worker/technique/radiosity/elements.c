#include "server/worker/technique/radiosity/elements.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/vec3.h"

// Of a patch's side: how far it must reach onto its face's first triangle to count as on it. More than floats round.
#define REACH 1e-4

_Static_assert(PATCH_FACES_MOST <= UINT32_MAX >> RADIOSITY_FACE_SHIFT, "a face's number fits in a triangle's word");

// ---- faces and triangles ----------------------------------------------------------------------------------------------

static void minus(const struct patches *p, const struct patch_face *face, int a, int b, double out[3])
{
	const float *x = p->vertices[face->corner[a]].position, *y = p->vertices[face->corner[b]].position;
	for (int c = 0; c < 3; c++)
		out[c] = (double)x[c] - (double)y[c];
}

// x2 and y2 of a quad, seen along the normal of its diagonals: by Cramer's rule.
static void shape_of(const struct patches *p, uint32_t at, struct radiosity_face *out)
{
	const struct patch_face *face = &p->faces.list[at];
	const struct patch_cut *cut = &p->cuts[at];
	double one[3], two[3], three[3], across[3], normal[3], product[3];
	*out = (struct radiosity_face){cut->first, cut->u, cut->v, 1, 1};
	if (!cut->v)
		return;
	minus(p, face, 1, 0, one);
	minus(p, face, 2, 0, two);
	minus(p, face, 3, 0, three);
	minus(p, face, 3, 1, across);
	vec3_cross(two, across, normal);
	vec3_cross(one, three, product);
	const double whole = vec3_dot(product, normal);
	vec3_cross(two, three, product);
	out->x2 = (float)(vec3_dot(product, normal) / whole);
	vec3_cross(one, two, product);
	out->y2 = (float)(vec3_dot(product, normal) / whole);
}

// Which corner of a triangle is a vertex.
static uint32_t corner_of(const struct triangle *triangle, uint32_t vertex)
{
	return triangle->vertex[0] == vertex ? 0 : triangle->vertex[1] == vertex ? 1 : 2;
}

static void mark_triangles(struct elements *e, uint32_t at)
{
	const struct patches *p = &e->patches;
	const struct patch_face *face = &p->faces.list[at];
	const uint32_t word = at << RADIOSITY_FACE_SHIFT, first = face->triangle[0], second = face->triangle[1];
	e->triangles[first] = word | corner_of(&p->triangles[first], face->corner[0]);
	// The second's corner 0 may be another vertex in the same place. Its corner before that one is the face's last.
	if (second != NONE)
		e->triangles[second] =
		    word | RADIOSITY_FACE_SECOND | (corner_of(&p->triangles[second], face->corner[3]) + 1) % 3;
}

// ---- patches ----------------------------------------------------------------------------------------------------------

static double area_of(const double a[3], const double b[3], const double c[3])
{
	double u[3], v[3], across[3];
	for (int i = 0; i < 3; i++) {
		u[i] = b[i] - a[i];
		v[i] = c[i] - a[i];
	}
	vec3_cross(u, v, across);
	return 0.5 * sqrt(vec3_dot(across, across));
}

// Whether a quad's cell is on its face's second triangle alone. Corner 1 is the cell's nearest to the first. Of the line
// between the two, y x2 = x y2, x and y are those of quad_place.
static bool on_second(const struct radiosity_face *f, uint32_t cell)
{
	const uint32_t column = cell % f->u, row = cell / f->u;
	const double u = (column + 1.0) / f->u, v = (double)row / f->v;
	const double a = (double)f->x2 - 1, b = (double)f->y2 - 1;
	const double x = u * (1 + a * v), y = v * (1 + b * u);
	return x * (double)f->y2 - y * (double)f->x2 < REACH * ((double)f->y2 / f->u + (double)f->x2 / f->v);
}

static void make_patch(const struct elements *e, uint32_t i, struct radiosity_patch *out)
{
	struct patch patch;
	patches_get(&e->patches, i, &patch);
	const double(*at)[3] = (const double(*)[3])patch.shape.at;
	const struct radiosity_face *face = &e->faces[patch.face];
	const bool second = face->v != 0 && on_second(face, i - face->first);
	*out = (struct radiosity_patch){
	    .area = (float)patch.area, .share = 1, .face = patch.face, .triangle = patch.triangle[second]};
	for (uint32_t k = 0; k < 4; k++)
		for (int c = 0; c < 3; c++)
			out->corner[3 * k + (uint32_t)c] = (float)at[k < patch.shape.corners ? k : 2][c];
	if (patch.shape.corners == 4) {
		const double one = area_of(at[0], at[1], at[2]), two = area_of(at[0], at[2], at[3]);
		out->share = one + two > 0 ? (float)(one / (one + two)) : 1;
	}
}

// ---- all of them ------------------------------------------------------------------------------------------------------

uint64_t elements_bytes(uint32_t triangles, uint32_t patches)
{
	return patches_bytes(triangles) + (uint64_t)triangles * (sizeof(struct radiosity_face) + sizeof(uint32_t)) +
	       (uint64_t)patches * sizeof(struct radiosity_patch) + 3;
}

enum status elements_begin(struct elements *e, const struct blob_view *scene, const struct patch_options *options,
			   struct error *err)
{
	*e = (struct elements){0};
	const enum status s = patches_init(&e->patches, scene, options, err);
	if (s != STATUS_OK)
		return s;
	const uint32_t faces = e->patches.faces.count, count = e->patches.count;
	e->count = 2 * count;
	e->triangle_count = scene->counts[BLOB_TRIANGLES];
	e->faces = malloc(faces * sizeof *e->faces + 1);
	e->triangles = malloc(e->triangle_count * sizeof *e->triangles + 1);
	e->shapes = malloc(count * sizeof *e->shapes + 1);
	if (!e->faces || !e->triangles || !e->shapes) {
		elements_finish(e);
		return error_set(err, STATUS_MEMORY, "out of memory");
	}
	memset(e->triangles, 0xFF, e->triangle_count * sizeof *e->triangles); // NONE
	for (uint32_t i = 0; i < faces; i++) {
		shape_of(&e->patches, i, &e->faces[i]);
		mark_triangles(e, i);
	}
	return STATUS_OK;
}

void elements_make(struct elements *e, uint32_t patches)
{
	const uint32_t left = e->patches.count - e->made;
	for (uint32_t end = e->made + (patches < left ? patches : left); e->made < end; e->made++)
		make_patch(e, e->made, &e->shapes[e->made]);
}

enum status elements_init(struct elements *e, const struct blob_view *scene, const struct patch_options *options,
			  struct error *err)
{
	const enum status s = elements_begin(e, scene, options, err);
	if (s == STATUS_OK)
		elements_make(e, e->patches.count);
	return s;
}

void elements_finish(struct elements *e)
{
	free(e->shapes);
	free(e->triangles);
	free(e->faces);
	patches_finish(&e->patches);
	*e = (struct elements){0};
}

// ---- where a place is: element.glsl's functions by their names --------------------------------------------------------

static double between(double x, double low, double high)
{
	return fmin(fmax(x, low), high);
}

static void quad_place(const struct radiosity_face *f, const double p[2], double out[2])
{
	const double a = (double)f->x2 - 1, b = (double)f->y2 - 1, k = 1 + b * p[0] - a * p[1];
	const double root = sqrt(fmax(k * k + 4 * a * p[1], 0));
	out[1] = k < 0 ? (root - k) / (2 * a) : 2 * p[1] / fmax(k + root, 1e-20);
	out[0] = p[0] / fmax(1 + a * out[1], 1e-20);
}

static void face_place(uint32_t word, const struct radiosity_face *f, const double uv[2], double out[2])
{
	const double own[3] = {1 - uv[0] - uv[1], uv[0], uv[1]};
	const uint32_t turn = word & RADIOSITY_FACE_TURN;
	const double one = own[(turn + 1) % 3], two = own[(turn + 2) % 3], x2 = (double)f->x2, y2 = (double)f->y2;
	out[0] = one;
	out[1] = two;
	if (f->v == 0)
		return;
	if (word & RADIOSITY_FACE_SECOND)
		quad_place(f, (const double[2]){x2 * one, y2 * one + two}, out);
	else
		quad_place(f, (const double[2]){one + x2 * two, y2 * two}, out);
}

static uint32_t least(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

static uint32_t patch_at(const struct radiosity_face *f, const double place[2])
{
	if (f->v != 0) {
		const uint32_t x = least((uint32_t)(between(place[0], 0, 1) * f->u), f->u - 1),
			       y = least((uint32_t)(between(place[1], 0, 1) * f->v), f->v - 1);
		return f->first + y * f->u + x;
	}
	const double n = f->u, s = between((place[0] + place[1]) * n, 0, n), t = between(place[1] * n, 0, s);
	const uint32_t row = least((uint32_t)s, f->u - 1), column = least((uint32_t)t, row);
	const bool head = t - column > s - row && column < row;
	return f->first + row * row + 2 * column + head;
}

uint32_t elements_corner_count(const struct elements *e, uint32_t patch)
{
	return e->faces[e->shapes[patch].face].v > 0 ? 4 : 3;
}

uint32_t elements_corners(const struct elements *e, uint32_t patch, const double origin[3], double world[4][3])
{
	const uint32_t count = elements_corner_count(e, patch);
	for (uint32_t k = 0; k < count; k++)
		for (uint32_t c = 0; c < 3; c++)
			world[k][c] = origin[c] + (double)e->shapes[patch].corner[3 * k + c];
	return count;
}

uint32_t elements_at(const struct elements *e, uint32_t triangle, const double uv[2], bool front)
{
	const uint32_t word = e->triangles[triangle];
	if (word == NONE)
		return NONE;
	const struct radiosity_face *f = &e->faces[word >> RADIOSITY_FACE_SHIFT];
	double place[2];
	face_place(word, f, uv, place);
	const uint32_t i = patch_at(f, place);
	return front ? i : i + e->patches.count;
}
