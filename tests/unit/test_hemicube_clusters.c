// What the faces of hemicubes may see of clusters: whatever a ray through the middle of a pixel meets is listed for that
// pixel's face, little else is where pixels are few, and triangles with masks have clusters of their own.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/base/vec3.h"
#include "server/worker/technique/radiosity/hemicube_clusters.h"

#define TRIANGLES 600u
#define ALL_FACES 31u

static struct vertex vertices[3 * TRIANGLES];
static struct triangle triangles[TRIANGLES];
static struct material materials[2];
static struct resident_scene scene;

static double number(double low, double high)
{
	return low + (high - low) * rand() / RAND_MAX;
}

// Triangles of sides of about `size`, in a row of heaps, for those of a cluster are near each other; every seventh has a
// mask.
static void make_scene(double size)
{
	double at[3] = {0, 0, 0};
	for (uint32_t i = 0; i < TRIANGLES; i++) {
		for (int a = 0; a < 3; a++) {
			at[a] = i % 4 ? at[a] : number(-10, 10);
			for (int k = 0; k < 3; k++)
				vertices[3 * i + (uint32_t)k].position[a] = (float)(at[a] + number(-size, size));
		}
		triangles[i] = (struct triangle){.vertex = {3 * i, 3 * i + 1, 3 * i + 2}, .material = i % 7 == 0};
	}
	materials[1].flags = MATERIAL_ALPHA_MASK;
	scene.view.sections[BLOB_VERTICES] = vertices;
	scene.view.sections[BLOB_TRIANGLES] = triangles;
	scene.view.sections[BLOB_MATERIALS] = materials;
	scene.view.counts[BLOB_VERTICES] = 3 * TRIANGLES;
	scene.view.counts[BLOB_TRIANGLES] = TRIANGLES;
	scene.view.counts[BLOB_MATERIALS] = 2;
}

static void make_origin(struct hemicube_origin *o)
{
	for (int a = 0; a < 3; a++) {
		o->at[a] = number(-10, 10);
		o->x[a] = number(-1, 1);
		o->z[a] = number(-1, 1);
	}
	vec3_normalize(o->z);
	const double along = vec3_dot(o->x, o->z);
	for (int a = 0; a < 3; a++)
		o->x[a] -= along * o->z[a];
	vec3_normalize(o->x);
	vec3_cross(o->z, o->x, o->y);
}

// Whether a ray meets a triangle.
static bool meets(const double from[3], const double d[3], const struct triangle *t)
{
	double a[3], e1[3], e2[3], p[3], q[3];
	for (int c = 0; c < 3; c++) {
		const double first = (double)vertices[t->vertex[0]].position[c];
		a[c] = from[c] - first;
		e1[c] = (double)vertices[t->vertex[1]].position[c] - first;
		e2[c] = (double)vertices[t->vertex[2]].position[c] - first;
	}
	vec3_cross(d, e2, p);
	vec3_cross(a, e1, q);
	const double by = vec3_dot(e1, p), u = vec3_dot(a, p) / by, v = vec3_dot(d, q) / by;
	return u >= 0 && v >= 0 && u + v <= 1 && vec3_dot(e2, q) / by > 0;
}

// The direction of the middle of a pixel: of the face's direction, and along its rows and columns.
static void direction(const struct hemicube_origin *o, uint32_t face, uint32_t n, uint32_t column, uint32_t row, double d[3])
{
	const double u = (2 * column + 1.0) / n - 1, v = (2 * row + 1.0) / n;
	const double sign = face == 2 || face == 4 ? -1 : 1;
	for (int a = 0; a < 3; a++)
		d[a] = face == 0  ? o->z[a] + u * o->x[a] + (v - 1) * o->y[a]
		       : face < 3 ? sign * o->x[a] + u * o->y[a] + v * o->z[a]
				  : sign * o->y[a] + u * o->x[a] + v * o->z[a];
}

static uint32_t cluster_at(const struct hemicube_clusters *c, uint32_t triangle)
{
	uint32_t i = 0;
	while (c->list[i].end <= triangle)
		i++;
	return i;
}

// Check that whatever a face's pixels meet is listed. Returns how many pixels meet something.
static uint32_t check_face(const struct hemicube_clusters *c, const struct hemicube_origin *o, uint32_t face, uint32_t n,
			   const uint32_t *faces)
{
	uint32_t met = 0;
	for (uint32_t row = 0; row < (face ? n / 2 : n); row++)
		for (uint32_t column = 0; column < n; column++) {
			double d[3];
			direction(o, face, n, column, row, d);
			for (uint32_t t = 0; t < TRIANGLES; t++)
				if (meets(o->at, d, &triangles[t])) {
					assert_true(faces[cluster_at(c, t)] >> face & 1);
					met++;
				}
		}
	return met;
}

static void whatever_a_pixel_meets_is_listed(void **state)
{
	(void)state;
	static struct hemicube_seen seen[TRIANGLES];
	uint32_t met = 0;
	for (int round = 0; round < 48; round++) {
		struct hemicube_clusters c;
		struct hemicube_origin o;
		const uint32_t n = round % 2 ? 6 : 16;
		make_scene(round % 3 ? 0.3 : 4);
		make_origin(&o);
		assert_int_equal(hemicube_clusters_init(&c, &scene, 1 + (uint32_t)round % 5, 0, NULL), STATUS_OK);
		uint32_t faces[TRIANGLES] = {0};
		const uint32_t count = hemicube_clusters_find(&c, &o, n, ALL_FACES, seen);
		for (uint32_t i = 0; i < count; i++) {
			assert_true(i == 0 || seen[i].cluster > seen[i - 1].cluster);
			faces[seen[i].cluster] = seen[i].faces;
		}
		for (uint32_t face = 0; face < 5; face++)
			met += check_face(&c, &o, face, n, faces);
		hemicube_clusters_finish(&c);
	}
	printf("%u pixels met triangles\n", met);
	assert_true(met > 10000);
}

static void small_triangles_are_left_out(void **state)
{
	(void)state;
	static struct hemicube_seen seen[TRIANGLES];
	struct hemicube_clusters c;
	uint32_t all = 0;
	make_scene(0.01);
	assert_int_equal(hemicube_clusters_init(&c, &scene, 1, 0, NULL), STATUS_OK);
	for (int i = 0; i < 20; i++) {
		struct hemicube_origin o;
		make_origin(&o);
		all += hemicube_clusters_find(&c, &o, 16, ALL_FACES, seen);
	}
	printf("%u of %u are listed\n", all, 20 * TRIANGLES);
	// A box of 0.02 m in 10 m is 1/60 of a pixel, and with what rounding may do 1/30: one in 900 is on a middle.
	assert_true(all < 20 * TRIANGLES / 200);
	hemicube_clusters_finish(&c);
}

static void only_faces_that_are_asked_for(void **state)
{
	(void)state;
	static struct hemicube_seen all[TRIANGLES], some[TRIANGLES];
	struct hemicube_clusters c;
	struct hemicube_origin o;
	make_scene(1);
	make_origin(&o);
	assert_int_equal(hemicube_clusters_init(&c, &scene, 2, 0, NULL), STATUS_OK);
	const uint32_t count = hemicube_clusters_find(&c, &o, 32, ALL_FACES, all);
	const uint32_t left = hemicube_clusters_find(&c, &o, 32, 5, some);
	uint32_t k = 0;
	for (uint32_t i = 0; i < count; i++)
		if (all[i].faces & 5) {
			assert_true(k < left && some[k].cluster == all[i].cluster && some[k].faces == (all[i].faces & 5));
			k++;
		}
	assert_true(k == left && k > 0 && k < count);
	hemicube_clusters_finish(&c);
}

static void masks_have_clusters_of_their_own(void **state)
{
	(void)state;
	struct hemicube_clusters c;
	make_scene(1);
	assert_int_equal(hemicube_clusters_init(&c, &scene, 4, MATERIAL_ALPHA_MASK, NULL), STATUS_OK);
	uint32_t next = 0;
	for (uint32_t i = 0; i < c.counts[0]; i++) {
		assert_int_equal(c.list[i].first, next);
		assert_true(c.list[i].end > next && c.list[i].end - next <= 4);
		next = c.list[i].end;
		for (uint32_t t = c.list[i].first; t < next; t++)
			assert_int_equal(c.list[i].cut, t % 7 == 0);
	}
	assert_int_equal(next, TRIANGLES);
	hemicube_clusters_finish(&c);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(whatever_a_pixel_meets_is_listed),
	    cmocka_unit_test(small_triangles_are_left_out),
	    cmocka_unit_test(only_faces_that_are_asked_for),
	    cmocka_unit_test(masks_have_clusters_of_their_own),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
