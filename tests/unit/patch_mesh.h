// Meshes for the tests of patches.
#ifndef CANDIL_TESTS_PATCH_MESH_H
#define CANDIL_TESTS_PATCH_MESH_H

#include "tests/unit/form_factor_check.h"

#include <string.h>

#include "server/scene/blob.h"

#define MOST 4096u

struct mesh {
	struct vertex vertices[3 * MOST];
	struct triangle triangles[MOST];
	struct blob_view view;
	uint32_t count;
	uint32_t seed;
};

static inline void start(struct mesh *m)
{
	memset(m, 0, sizeof *m);
	m->seed = 5;
	m->view.sections[BLOB_VERTICES] = m->vertices;
	m->view.sections[BLOB_TRIANGLES] = m->triangles;
}

// A triangle with vertices of its own, begun at any of its corners.
static inline void add(struct mesh *m, const double *a, const double *b, const double *c, uint32_t material)
{
	const double *v[3] = {a, b, c};
	const uint32_t turn = (uint32_t)(3 * noise(&m->seed)), t = m->count++;
	assert_true(t < MOST);
	m->triangles[t].material = material;
	for (uint32_t i = 0; i < 3; i++) {
		m->triangles[t].vertex[i] = 3 * t + i;
		for (int k = 0; k < 3; k++)
			m->vertices[3 * t + i].position[k] = (float)v[(i + turn) % 3][k];
	}
	m->view.counts[BLOB_TRIANGLES] = m->count;
	m->view.counts[BLOB_VERTICES] = 3 * m->count;
}

// A quad, cut along either diagonal.
static inline void add_quad(struct mesh *m, const double at[3], const double u[3], const double v[3], uint32_t material)
{
	double p[4][3];
	for (int k = 0; k < 3; k++) {
		p[0][k] = at[k];
		p[1][k] = at[k] + u[k];
		p[2][k] = at[k] + u[k] + v[k];
		p[3][k] = at[k] + v[k];
	}
	const int d = noise(&m->seed) < 0.5;
	add(m, p[d], p[1 + d], p[2 + d], material);
	add(m, p[2 + d], p[(3 + d) % 4], p[d], material);
}

// A box about an upright axis through `at`, turned by an angle: its lower face at at[1].
static inline void add_box(struct mesh *m, const double at[3], const double size[3], double angle, uint32_t material)
{
	const double x[3] = {size[0] * cos(angle), 0, -size[0] * sin(angle)}, y[3] = {0, size[1], 0},
		     z[3] = {size[2] * sin(angle), 0, size[2] * cos(angle)};
	double far[3];
	const double minus[3][3] = {{-x[0], -x[1], -x[2]}, {-y[0], -y[1], -y[2]}, {-z[0], -z[1], -z[2]}};
	for (int k = 0; k < 3; k++)
		far[k] = at[k] + x[k] + y[k] + z[k];
	add_quad(m, at, z, y, material);
	add_quad(m, at, x, z, material);
	add_quad(m, at, y, x, material);
	add_quad(m, far, minus[1], minus[2], material);
	add_quad(m, far, minus[2], minus[0], material);
	add_quad(m, far, minus[0], minus[1], material);
}

// Triangles in another order.
static inline void shuffle(struct mesh *m)
{
	for (uint32_t i = m->count; i > 1; i--) {
		const uint32_t k = (uint32_t)(i * noise(&m->seed));
		const struct triangle t = m->triangles[k];
		m->triangles[k] = m->triangles[i - 1];
		m->triangles[i - 1] = t;
	}
}

static inline double area_of(const struct mesh *m)
{
	double sum = 0;
	for (uint32_t i = 0; i < m->count; i++) {
		double across[3];
		const uint32_t *v = m->triangles[i].vertex;
		vec3_across(m->vertices[v[0]].position, m->vertices[v[1]].position, m->vertices[v[2]].position, across);
		sum += 0.5 * sqrt(vec3_dot(across, across));
	}
	return sum;
}

// Five walls, a lamp below the ceiling, two boxes that are turned, which stand on the floor and have no face there.
static inline void cornell_box(struct mesh *m)
{
	static const double wall[5][3][3] = {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}},
					     {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
					     {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
					     {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}},
					     {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}}};
	start(m);
	for (uint32_t i = 0; i < 5; i++)
		add_quad(m, wall[i][0], wall[i][1], wall[i][2], i < 3 ? 0 : i);
	add_quad(m, (const double[3]){0.4, 0.999, 0.4}, (const double[3]){0.2, 0, 0}, (const double[3]){0, 0, 0.2}, 1);
	add_box(m, (const double[3]){0.2, 0, 0.3}, (const double[3]){0.3, 0.6, 0.3}, 0.3, 0);
	add_box(m, (const double[3]){0.5, 0, 0.7}, (const double[3]){0.3, 0.3, 0.3}, -0.3, 0);
}

#endif
