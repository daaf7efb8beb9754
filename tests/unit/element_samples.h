// Meshes of faces of many shapes, and places within patches whose element is known.
#ifndef CANDIL_TESTS_ELEMENT_SAMPLES_H
#define CANDIL_TESTS_ELEMENT_SAMPLES_H

#include "tests/unit/patch_mesh.h"

#include "server/worker/technique/radiosity/elements.h"

#define ELEMENT_MESHES 5u
#define ELEMENT_FACES 60u // of each

// A place within a patch.
struct element_sample {
	uint32_t patch, triangle;
	double uv[2]; // barycentrics of the triangle's corners 1 and 2
	double inside[2]; // where within the patch
	double at[3];
	double size; // of the patch: its longest side
};

// A convex quad in a plane of any direction whose corners are on a circle that is drawn out: four angles at least 0.3 apart.
static inline void add_convex(struct mesh *m, double stretch, double shift)
{
	double angle[4], x[3], y[3], p[4][3], at = 6.28 * noise(&m->seed);
	for (int k = 0; k < 3; k++) {
		x[k] = noise(&m->seed) - 0.5;
		y[k] = stretch * (noise(&m->seed) - 0.5);
	}
	for (int i = 0; i < 4; i++, at += 1.55)
		angle[i] = at + 1.2 * (noise(&m->seed) - 0.5);
	for (int i = 0; i < 4; i++)
		for (int k = 0; k < 3; k++)
			p[i][k] = cos(angle[i]) * x[k] + sin(angle[i]) * y[k] + shift;
	const int d = noise(&m->seed) < 0.5;
	add(m, p[d], p[1 + d], p[2 + d], m->count);
	add(m, p[2 + d], p[(3 + d) % 4], p[d], m->triangles[m->count - 1].material);
}

static inline void add_any(struct mesh *m, double stretch, double shift)
{
	double p[3][3];
	for (int k = 0; k < 3; k++) {
		p[0][k] = noise(&m->seed) + shift;
		p[1][k] = p[0][k] + noise(&m->seed) - 0.5;
		p[2][k] = 0.5 * (p[0][k] + p[1][k]) + stretch * (noise(&m->seed) - 0.5);
	}
	add(m, p[0], p[1], p[2], m->count);
}

// The mesh `kind` below ELEMENT_MESHES: triangles; needles; quads that are no parallelograms, also drawn out, also far from
// the origin; parallelograms. Each face has a material of its own, so that no two triangles of different faces pair up.
static inline void element_mesh(struct mesh *m, uint32_t kind)
{
	start(m);
	for (uint32_t i = 0; i < ELEMENT_FACES; i++) {
		const double o[3] = {i, 0, 0}, u[3] = {noise(&m->seed), 0.1, 0.2}, v[3] = {-0.2, 0.1, 0.2 + noise(&m->seed)};
		if (kind < 2)
			add_any(m, kind ? 1e-3 : 1, 0);
		else if (kind < 4)
			add_convex(m, kind == 3 ? 0.02 : 1, kind == 3 ? 3 : 0);
		else
			add_quad(m, o, u, v, i);
	}
	shuffle(m);
}

// Barycentrics of a place in a triangle's plane, of corners 1 and 2.
static inline void element_barycentrics(const struct mesh *m, uint32_t triangle, const double at[3], double uv[2])
{
	const uint32_t *v = m->triangles[triangle].vertex;
	const float *p = m->vertices[v[0]].position, *q = m->vertices[v[1]].position, *r = m->vertices[v[2]].position;
	double normal[3], one[3], two[3], to[3], cross[3];
	vec3_across(p, q, r, normal);
	for (int k = 0; k < 3; k++) {
		one[k] = (double)q[k] - (double)p[k];
		two[k] = (double)r[k] - (double)p[k];
		to[k] = at[k] - (double)p[k];
	}
	vec3_cross(to, two, cross);
	uv[0] = vec3_dot(cross, normal) / vec3_dot(normal, normal);
	vec3_cross(one, to, cross);
	uv[1] = vec3_dot(cross, normal) / vec3_dot(normal, normal);
}

// The place of a patch at `inside`, as patch_at of element.glsl numbers it.
static inline void element_place(const struct form_polygon *s, const double inside[2], double out[3])
{
	const double a = inside[0], b = inside[1];
	const bool quad = s->corners == 4;
	const double w[4] = {quad ? (1 - a) * (1 - b) : 1 - a - b, quad ? a * (1 - b) : a, quad ? a * b : b,
			     quad ? (1 - a) * b : 0};
	for (int k = 0; k < 3; k++) {
		out[k] = 0;
		for (uint32_t c = 0; c < s->corners; c++)
			out[k] += w[c] * s->at[c][k];
	}
}

// Any place of a patch that is `margin` of it away from its sides.
static inline struct element_sample element_sample(struct mesh *m, const struct patches *p, uint32_t i, double margin)
{
	struct element_sample out = {.patch = i};
	struct patch patch;
	double a = noise(&m->seed), b = noise(&m->seed);
	patches_get(p, i, &patch);
	if (patch.shape.corners == 3 && a + b > 1) {
		a = 1 - a;
		b = 1 - b;
	}
	out.inside[0] = margin + (1 - 3 * margin) * a;
	out.inside[1] = margin + (1 - 3 * margin) * b;
	element_place(&patch.shape, out.inside, out.at);
	for (uint32_t k = 0; k < patch.shape.corners; k++)
		out.size = fmax(out.size, distance(patch.shape.at[k], patch.shape.at[(k + 1) % patch.shape.corners]));
	out.triangle = patch.triangle[0];
	element_barycentrics(m, out.triangle, out.at, out.uv);
	if (patch.triangle[1] != NONE && fmin(fmin(out.uv[0], out.uv[1]), 1 - out.uv[0] - out.uv[1]) < 0) {
		out.triangle = patch.triangle[1];
		element_barycentrics(m, out.triangle, out.at, out.uv);
	}
	return out;
}

#endif
