#include "tests/gpu/voxel_model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"

void model_init(struct model *m)
{
	memset(m, 0, sizeof *m);
	for (int i = 0; i < 4; i++) {
		struct material *a = &m->materials[i];
		a->albedo[0] = a->albedo[1] = a->albedo[2] = 1;
		a->albedo_texture = a->emission_texture = a->specular_texture = a->surface_texture = a->normal_texture =
		    NONE;
		a->roughness = 1;
	}
}

void model_finish(struct model *m)
{
	while (m->scene.derived) {
		struct derived *d = m->scene.derived;
		m->scene.derived = d->next;
		d->destroy(d);
	}
	free(m->vertices);
	free(m->triangles);
	m->vertices = NULL;
	m->triangles = NULL;
}

static void *grown(void *p, uint32_t count, size_t size)
{
	// Doubled at each power of two.
	if (count & (count - 1) || !p)
		return count && p ? p : realloc(p, size);
	p = realloc(p, 2 * (size_t)count * size);
	if (!p)
		abort();
	return p;
}

void model_add(struct model *m, const double a[3], const double b[3], const double c[3], uint32_t material)
{
	const double *corners[3] = {a, b, c};
	struct triangle t = {.material = material};
	for (int k = 0; k < 3; k++) {
		struct vertex v = {.uv = {k == 1 ? 1.0f : 0.0f, k == 2 ? 1.0f : 0.0f}};
		for (int i = 0; i < 3; i++)
			v.position[i] = (float)corners[k][i];
		m->vertices = grown(m->vertices, m->vertex_count, sizeof v);
		t.vertex[k] = m->vertex_count;
		m->vertices[m->vertex_count++] = v;
	}
	m->triangles = grown(m->triangles, m->triangle_count, sizeof t);
	m->triangles[m->triangle_count++] = t;
}

void model_add_quad(struct model *m, const double corner[3], const double u[3], const double v[3], uint32_t material)
{
	double a[3], b[3], c[3];
	for (int i = 0; i < 3; i++) {
		a[i] = corner[i] + u[i];
		b[i] = corner[i] + u[i] + v[i];
		c[i] = corner[i] + v[i];
	}
	model_add(m, corner, a, b, material);
	model_add(m, corner, b, c, material);
}

static void on_sphere(const double middle[3], double radius, uint32_t i, uint32_t j, uint32_t rings, double out[3])
{
	const double theta = PI * i / rings, phi = PI * (j % (2 * rings)) / rings;
	out[0] = middle[0] + radius * sin(theta) * cos(phi);
	out[1] = middle[1] + radius * sin(theta) * sin(phi);
	out[2] = middle[2] + radius * cos(theta);
}

void model_add_sphere(struct model *m, const double middle[3], double radius, uint32_t rings, uint32_t material)
{
	for (uint32_t i = 0; i < rings; i++)
		for (uint32_t j = 0; j < 2 * rings; j++) {
			double p[4][3];
			on_sphere(middle, radius, i, j, rings, p[0]);
			on_sphere(middle, radius, i + 1, j, rings, p[1]);
			on_sphere(middle, radius, i + 1, j + 1, rings, p[2]);
			on_sphere(middle, radius, i, j + 1, rings, p[3]);
			if (i + 1 < rings)
				model_add(m, p[0], p[1], p[2], material);
			if (i > 0)
				model_add(m, p[0], p[2], p[3], material);
		}
}

void model_close(struct model *m)
{
	struct blob_view *v = &m->scene.view;
	m->scene.blob = v->blob = &m->header;
	v->sections[BLOB_VERTICES] = m->vertices;
	v->sections[BLOB_TRIANGLES] = m->triangles;
	v->sections[BLOB_MATERIALS] = m->materials;
	v->sections[BLOB_TEXTURES] = &m->texture;
	v->sections[BLOB_TEXELS] = m->texels;
	v->counts[BLOB_VERTICES] = m->vertex_count;
	v->counts[BLOB_TRIANGLES] = m->triangle_count;
	v->counts[BLOB_MATERIALS] = 4;
	v->counts[BLOB_TEXTURES] = 1;
	v->counts[BLOB_TEXELS] = 64;
	for (int c = 0; c < 3; c++) {
		v->bounds_min[c] = m->vertex_count ? INFINITY : 0;
		v->bounds_max[c] = m->vertex_count ? -INFINITY : 0;
		for (uint32_t i = 0; i < m->vertex_count; i++) {
			v->bounds_min[c] = fminf(v->bounds_min[c], m->vertices[i].position[c]);
			v->bounds_max[c] = fmaxf(v->bounds_max[c], m->vertices[i].position[c]);
		}
	}
}

// ---- the reference: polygon clipping (Sutherland and Hodgman 1974), separating axes, all in doubles ---------------------

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

// How far inside of each other along an axis of any length, in voxels; INFINITY for no axis.
static double depth_along(const double axis[3], double v[3][3], const double middle[3])
{
	const double length = sqrt(dot(axis, axis));
	if (length <= 1e-30)
		return INFINITY;
	double low = INFINITY, high = -INFINITY;
	for (int k = 0; k < 3; k++) {
		const double d[3] = {v[k][0] - middle[0], v[k][1] - middle[1], v[k][2] - middle[2]};
		low = fmin(low, dot(d, axis));
		high = fmax(high, dot(d, axis));
	}
	const double reach = 0.5 * (fabs(axis[0]) + fabs(axis[1]) + fabs(axis[2]));
	return fmin(reach - low, high + reach) / length;
}

// By how much a triangle and a cell overlap, at the separating axis that comes closest to parting them; negative: apart.
static double overlap_depth(double v[3][3], const double middle[3])
{
	double e[3][3], n[3], least = INFINITY;
	for (int k = 0; k < 3; k++)
		for (int c = 0; c < 3; c++)
			e[k][c] = v[(k + 1) % 3][c] - v[k][c];
	cross(e[0], e[1], n);
	const double l = fmax(dot(e[0], e[0]), fmax(dot(e[1], e[1]), dot(e[2], e[2])));
	// The normal of a line says nothing.
	if (dot(n, n) > 1e-10 * l * l)
		least = depth_along(n, v, middle);
	for (int c = 0; c < 3; c++) {
		const double axis[3] = {c == 0, c == 1, c == 2};
		least = fmin(least, depth_along(axis, v, middle));
		for (int k = 0; k < 3; k++) {
			double a[3];
			cross(axis, e[k], a);
			if (dot(a, a) > 1e-12 * dot(e[k], e[k]))
				least = fmin(least, depth_along(a, v, middle));
		}
	}
	return least;
}

struct polygon {
	double v[16][3];
	int count;
};

static void clip(struct polygon *p, int axis, double at, double side)
{
	struct polygon out = {.count = 0};
	for (int i = 0; i < p->count; i++) {
		const double *a = p->v[i], *b = p->v[(i + 1) % p->count];
		const double da = side * (a[axis] - at), db = side * (b[axis] - at);
		if (da >= 0)
			memcpy(out.v[out.count++], a, sizeof out.v[0]);
		if ((da < 0) != (db < 0)) {
			const double t = da / (da - db);
			for (int c = 0; c < 3; c++)
				out.v[out.count][c] = a[c] + t * (b[c] - a[c]);
			out.count++;
		}
	}
	*p = out;
}

static void add_polygon(struct expected *x, const struct polygon *p)
{
	for (int i = 1; i + 1 < p->count; i++) {
		double a[3], b[3], n[3];
		for (int c = 0; c < 3; c++) {
			a[c] = p->v[i][c] - p->v[0][c];
			b[c] = p->v[i + 1][c] - p->v[0][c];
		}
		cross(a, b, n);
		const double area = 0.5 * sqrt(dot(n, n));
		x->area += area;
		for (int c = 0; c < 3; c++) {
			x->place[c] += area * (p->v[0][c] + p->v[i][c] + p->v[i + 1][c]) / 3;
			if (n[c] > 0)
				x->plus[c] += 0.5 * n[c];
			else
				x->minus[c] -= 0.5 * n[c];
		}
	}
}

static void add_cell(struct expected *all, const struct voxel_grid *g, double v[3][3], const int32_t cell[3], double margin)
{
	double e1[3], e2[3], n[3], middle[3];
	struct polygon p = {.count = 3};
	memcpy(p.v, v, 9 * sizeof(double));
	for (int c = 0; c < 3; c++) {
		e1[c] = v[1][c] - v[0][c];
		e2[c] = v[2][c] - v[0][c];
		middle[c] = cell[c] + 0.5;
	}
	cross(e1, e2, n);
	int k = fabs(n[0]) > fabs(n[1]) ? 0 : 1;
	k = fabs(n[k]) > fabs(n[2]) ? k : 2;
	const double depth = overlap_depth(v, middle);
	const uint32_t bit = 2 * ((uint32_t)cell[0] + g->sides[0] * ((uint32_t)cell[1] + g->sides[1] * (uint32_t)cell[2]));
	// A line has no side: either layer may have it.
	const bool line = dot(n, n) <= 1e-9 * fmax(dot(e1, e1), dot(e2, e2)) * fmax(dot(e1, e1), dot(e2, e2));
	all[bit].must_either = all[bit].must_either || depth > margin;
	for (uint32_t layer = 0; layer < 2; layer++) {
		struct expected *x = &all[bit + layer];
		const bool own = layer == (n[k] < 0);
		x->may = x->may || ((own || line) && depth > -margin);
		x->must = x->must || (own && !line && depth > margin);
		if (own && depth > -margin) {
			struct polygon q = p;
			for (int c = 0; c < 3; c++) {
				clip(&q, c, cell[c], 1);
				clip(&q, c, cell[c] + 1, -1);
			}
			add_polygon(x, &q);
		}
	}
}

struct expected *model_expect(const struct model *m, const struct voxel_grid *g, double margin)
{
	struct expected *all = calloc(2 * (size_t)g->sides[0] * g->sides[1] * g->sides[2], sizeof *all);
	if (!all)
		abort();
	for (uint32_t i = 0; i < m->triangle_count; i++) {
		double v[3][3];
		int32_t first[3], last[3], cell[3];
		for (int c = 0; c < 3; c++) {
			double low = INFINITY, high = -INFINITY;
			for (int k = 0; k < 3; k++) {
				const float p = m->vertices[m->triangles[i].vertex[k]].position[c];
				v[k][c] = ((double)p - (double)g->low[c]) / (double)g->side;
				low = fmin(low, v[k][c]);
				high = fmax(high, v[k][c]);
			}
			first[c] = (int32_t)(low - margin);
			last[c] = (int32_t)(high + margin);
		}
		for (cell[2] = first[2]; cell[2] <= last[2]; cell[2]++)
			for (cell[1] = first[1]; cell[1] <= last[1]; cell[1]++)
				for (cell[0] = first[0]; cell[0] <= last[0]; cell[0]++)
					add_cell(all, g, v, cell, margin);
	}
	return all;
}
