// Rows of form factors by contour integrals and rays: closed forms in every configuration, to a millionth where nothing is
// between; half of it behind a screen; rooms that are closed; bits that depend on the scene alone.
#include "tests/gpu/traced_mesh.h"

#include <stdio.h>
#include <stdlib.h>

#include "server/worker/devices.h"
#include "server/worker/technique/radiosity/analytic.h"
#include "server/worker/technique/radiosity/rays.h"
#include "tests/unit/form_factor_scenes.h"

#define SKIPPED 77
#define FACING 0.19982489569838738 // unit squares, face to face at distance 1

static struct device *device;
static struct mesh m;
static const struct plan plain = {.width = 1, .height = 1};

static void add_polygon(struct mesh *mesh, const struct form_polygon *p)
{
	double u[3], v[3];
	for (int c = 0; c < 3; c++) {
		u[c] = p->at[1][c] - p->at[0][c];
		v[c] = p->at[3][c] - p->at[0][c];
	}
	add_quad(mesh, p->at[0], u, v, 0);
}

static struct analytic *analytic_of(const struct traced_mesh *t, uint32_t rays)
{
	const struct patch_scene of = {&plain, (struct resident_scene *)(uintptr_t)&t->scene, &t->elements, &t->buffers};
	struct analytic *a;
	struct error err;
	if (analytic_create(&of, rays, device, &a, &err) != STATUS_OK)
		fail_msg("%s", err.text);
	assert_int_equal(analytic_compile(a, NULL), STATUS_OK);
	assert_true(analytic_compiled(a) && analytic_finished(a));
	return a;
}

// All rows, `slice_us` at a time, from the last to the first.
static void all_rows(const struct traced_mesh *t, uint32_t rays, uint32_t slice_us, struct factors *f)
{
	struct analytic *a = analytic_of(t, rays);
	struct error err;
	assert_int_equal(factors_init(f, device, t->elements.count, NULL), STATUS_OK);
	for (uint32_t i = t->elements.count; i-- > 0;) {
		analytic_begin(a, i);
		while (!analytic_finished(a))
			if (analytic_step(a, slice_us, f, &err) != STATUS_OK)
				fail_msg("%s", err.text);
	}
	analytic_destroy(a);
}

// All factors, by row. The caller frees them.
static double *dense(const struct factors *f)
{
	double *all = calloc((size_t)f->side * f->side, sizeof *all);
	assert_non_null(all);
	for (uint32_t i = 0; i < f->side; i++) {
		uint32_t *columns;
		float *values;
		assert_int_equal(factors_read_row(f, i, &columns, &values, NULL), STATUS_OK);
		for (uint32_t k = 0; k < f->rows[i].count; k++)
			all[(size_t)i * f->side + columns[k]] = (double)values[k];
		free(columns);
		free(values);
	}
	return all;
}

static double sum_of(const double *row, uint32_t n)
{
	double sum = 0;
	for (uint32_t i = 0; i < n; i++)
		sum += row[i];
	return sum;
}

// ---- closed forms -----------------------------------------------------------------------------------------------------

static void closed_forms_are_met_to_a_millionth(void **state)
{
	const size_t count = sizeof expected_of_floats / sizeof *expected_of_floats;
	double worst = 0;
	(void)state;
	for (size_t i = 0; i < count; i++) {
		const struct expected *e = &expected_of_floats[i];
		struct traced_mesh t;
		struct factors f;
		start(&m);
		add_polygon(&m, &e->a);
		add_polygon(&m, &e->b);
		traced_mesh_init(&t, device, &m, INFINITY);
		all_rows(&t, SIGHT_PROBE, 1000000, &f);
		double *is = dense(&f), exchange = 0, back = 0;
		const uint32_t n = t.elements.count, half = n / 2;
		// Both may be of several patches: triangles, where rounding has bent a needle.
		for (uint32_t k = 0; k < half; k++)
			for (uint32_t j = 0; j < half; j++) {
				struct patch p;
				patches_get(&t.elements.patches, k, &p);
				const bool first = p.triangle[0] < 2;
				exchange += first ? is[(size_t)k * n + j] * p.area : 0;
				back += first ? 0 : is[(size_t)k * n + j] * p.area;
			}
		worst = fmax(worst, fabs(exchange / e->exchange - 1));
		if (!(fabs(exchange / e->exchange - 1) <= 1e-6 && fabs(back / e->exchange - 1) <= 1e-6))
			fail_msg("%s: %.9g and back %.9g, not %.9g", e->name, exchange, back, e->exchange);
		free(is);
		factors_finish(&f);
		traced_mesh_finish(&t);
	}
	printf("%zu configurations, relative error %.2g at most\n", count, worst);
}

static void what_sees_nothing_has_nothing(void **state)
{
	static const double at[][3] = {{1, 0, 0}, {0, 0, -1}, {0.5, 0.25, 0}, {4, 1, -2}};
	static const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
	(void)state;
	// In one plane, back to back, overlapping in one plane, and one away below.
	for (size_t i = 0; i < 3; i++) {
		struct traced_mesh t;
		struct factors f;
		start(&m);
		add_quad(&m, o, x, y, 0);
		add_quad(&m, at[i], i == 1 ? y : x, i == 1 ? x : y, 0);
		traced_mesh_init(&t, device, &m, INFINITY);
		all_rows(&t, SIGHT_PROBE, 1000, &f);
		assert_int_equal(t.elements.count, 4);
		for (uint32_t k = 0; k < 2; k++) {
			assert_int_equal(f.rows[k].count, 0);
			assert_true(f.rows[k].escaped == 1 && f.rows[k].block != NONE);
		}
		factors_finish(&f);
		traced_mesh_finish(&t);
	}
}

// A screen half-way between two squares hides the half of the lines between them whose middle is over it.
static void half_is_hidden(void **state)
{
	struct traced_mesh t;
	struct factors f;
	(void)state;
	start(&m);
	add_quad(&m, (const double[3]){0, 0, 0}, (const double[3]){1, 0, 0}, (const double[3]){0, 1, 0}, 0);
	add_quad(&m, (const double[3]){0, 0, 1}, (const double[3]){0, 1, 0}, (const double[3]){1, 0, 0}, 0);
	add_quad(&m, (const double[3]){-1, -1, 0.5}, (const double[3]){1.5, 0, 0}, (const double[3]){0, 3, 0}, 0);
	traced_mesh_init(&t, device, &m, INFINITY);
	all_rows(&t, 4096, 1000000, &f);
	double *is = dense(&f);
	printf("half hidden: %.6g, not %.6g\n", is[1], FACING / 2);
	assert_true(fabs(is[1] - FACING / 2) < 1e-3 * FACING && is[1] == is[6]);
	free(is);
	factors_finish(&f);
	traced_mesh_finish(&t);
}

static void all_is_hidden(void **state)
{
	struct traced_mesh t;
	struct factors f;
	(void)state;
	start(&m);
	add_quad(&m, (const double[3]){0, 0, 0}, (const double[3]){1, 0, 0}, (const double[3]){0, 1, 0}, 0);
	add_quad(&m, (const double[3]){0, 0, 1}, (const double[3]){0, 1, 0}, (const double[3]){1, 0, 0}, 0);
	add_quad(&m, (const double[3]){-1, -1, 0.5}, (const double[3]){3, 0, 0}, (const double[3]){0, 3, 0}, 0);
	traced_mesh_init(&t, device, &m, INFINITY);
	all_rows(&t, SIGHT_PROBE, 1000000, &f);
	double *is = dense(&f);
	assert_true(is[1] == 0 && is[6] == 0);
	free(is);
	factors_finish(&f);
	traced_mesh_finish(&t);
}

// ---- rooms ------------------------------------------------------------------------------------------------------------

// A box whose fronts are inside.
static void room(void)
{
	start(&m);
	add_box(&m, (const double[3]){0.25, 7, -2}, (const double[3]){1, 2, 1}, 0, 0);
	for (uint32_t i = 0; i < m.count; i++) {
		const uint32_t first = m.triangles[i].vertex[0];
		m.triangles[i].vertex[0] = m.triangles[i].vertex[1];
		m.triangles[i].vertex[1] = first;
	}
}

static void rows_of_a_room_are_1_whatever_the_slices(void **state)
{
	struct traced_mesh t;
	struct factors one, two;
	double worst = 0;
	(void)state;
	room();
	traced_mesh_init(&t, device, &m, 0.5);
	all_rows(&t, SIGHT_PROBE, 1, &one);
	all_rows(&t, SIGHT_PROBE, 10000000, &two);
	double *a = dense(&one), *b = dense(&two);
	const uint32_t n = t.elements.count;
	assert_memory_equal(a, b, (size_t)n * n * sizeof *a);
	for (uint32_t i = 0; i < n / 2; i++)
		worst = fmax(worst, fabs(sum_of(a + (size_t)i * n, n) - 1));
	for (uint32_t i = n / 2; i < n; i++)
		assert_true(sum_of(a + (size_t)i * n, n) == 0 && one.rows[i].escaped == 1);
	printf("rows of a room of %u patches: off 1 by %.2g at most\n", n / 2, worst);
	assert_true(worst < 1e-6);
	free(a);
	free(b);
	factors_finish(&one);
	factors_finish(&two);
	traced_mesh_finish(&t);
}

static void numbers_of_rays_that_cannot_be_are_refused(void **state)
{
	static const uint32_t bad[] = {0, SIGHT_PROBE - 16, SIGHT_PROBE + 1, SIGHT_RAYS_MOST + 16};
	struct traced_mesh t;
	struct analytic *a;
	(void)state;
	room();
	traced_mesh_init(&t, device, &m, INFINITY);
	const struct patch_scene of = {&plain, &t.scene, &t.elements, &t.buffers};
	for (int i = 0; i < 4; i++) {
		assert_int_equal(analytic_create(&of, bad[i], device, &a, NULL), STATUS_BAD_ARGUMENT);
		assert_null(a);
	}
	traced_mesh_finish(&t);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(closed_forms_are_met_to_a_millionth),
	    cmocka_unit_test(what_sees_nothing_has_nothing),
	    cmocka_unit_test(half_is_hidden),
	    cmocka_unit_test(all_is_hidden),
	    cmocka_unit_test(rows_of_a_room_are_1_whatever_the_slices),
	    cmocka_unit_test(numbers_of_rays_that_cannot_be_are_refused),
	};
	struct error err;
	if (device_create(&(struct device_options){0}, &device, &err) != STATUS_OK) {
		print_message("skipped: %s\n", err.text);
		return SKIPPED;
	}
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	devices_finish(&(struct devices){.vk = device});
	return failed;
}
