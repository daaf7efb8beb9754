// Voxels against a reference in double precision: which (cell, layer) pairs are occupied, and the area, the projections and
// the mean place of what is in each; nothing lost; the same bits in any order of the triangles and of the slices.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/gpu/voxel_result.h"

#define MARGIN 1e-3 // voxels: what is nearer to a cell's face than this may be in it or not

static const double zero[3] = {0, 0, 0};

// ---- against the reference -------------------------------------------------------------------------------------------

struct tally {
	uint32_t lost, extra, wrong_bit;
	double area_error, projection_error, place_error; // largest
	double area, expected_area;
};

static void compare_entry(const struct result *r, const struct expected *x, uint32_t bit, struct tally *t)
{
	const uint32_t e = entry_of(r, bit);
	const double area = real(r, 2, e, 3);
	t->wrong_bit += r->parts[1][4 * e + 3] != bit;
	t->area += area;
	t->area_error = fmax(t->area_error, fabs(area - x->area) / (1e-2 + x->area));
	for (int c = 0; c < 3; c++) {
		const double plus = projection(r, e, c, 0), minus = projection(r, e, c, 1);
		t->projection_error = fmax(t->projection_error, fabs(plus - x->plus[c]) / (1e-2 + x->plus[c]));
		t->projection_error = fmax(t->projection_error, fabs(minus - x->minus[c]) / (1e-2 + x->minus[c]));
		if (x->area < 1e-3)
			continue;
		const double place = (real(r, 0, e, c) - (double)r->grid.low[c]) / (double)r->grid.side;
		t->place_error = fmax(t->place_error, fabs(place - x->place[c] / x->area));
	}
}

static struct tally compare(const struct model *m, const struct result *r)
{
	struct expected *all = model_expect(m, &r->grid, MARGIN);
	struct tally t = {0};
	for (uint32_t bit = 0; bit < 32 * r->words; bit++) {
		const struct expected *x = &all[bit];
		const bool marked = is_marked(r, bit);
		t.lost += x->must && !marked;
		t.lost += bit % 2 == 0 && x->must_either && !marked && !is_marked(r, bit + 1);
		t.extra += marked && !x->may;
		t.expected_area += x->area;
		if (marked)
			compare_entry(r, x, bit, &t);
	}
	free(all);
	return t;
}

// `places`: how far off the means of places may be, in voxels.
static void assert_as_expected(struct model *m, uint32_t resolution, const char *what, double places)
{
	struct result r = build(m, resolution);
	const struct tally t = compare(m, &r);
	print_message(
	    "%s: %u triangles at %u, %u entries, %llu KiB; area %.6g of %.6g; largest errors: area %.1e, projections %.1e, "
	    "places %.1e voxels\n",
	    what, m->triangle_count, resolution, r.grid.entries, (unsigned long long)r.bytes >> 10, t.area, t.expected_area,
	    t.area_error, t.projection_error, t.place_error);
	assert_int_equal(t.lost, 0);
	assert_int_equal(t.extra, 0);
	assert_int_equal(t.wrong_bit, 0);
	assert_true(t.area_error < 2e-3);
	assert_true(t.projection_error < 3e-3);
	assert_true(t.place_error < places);
	assert_true(fabs(t.area - t.expected_area) <= 1e-3 * t.expected_area + 1e-5);
	result_finish(&r);
}

static uint64_t random_state = 1;

static double random_unit(void)
{
	random_state = random_state * 6364136223846793005ull + 1442695040888963407ull;
	return (double)(random_state >> 40) / 16777216.0;
}

static void random_point(double p[3], const double middle[3], double reach)
{
	for (int c = 0; c < 3; c++)
		p[c] = middle[c] + reach * (2 * random_unit() - 1);
}

// Triangles of all sizes, from a thousandth of a voxel to the whole scene.
// Triangles of all sizes, from a thousandth of a voxel to the whole scene.
static void add_random(struct model *m, uint32_t count)
{
	random_state = 1;
	for (uint32_t i = 0; i < count; i++) {
		double middle[3], v[3][3];
		random_point(middle, zero, 0.9);
		const double size = i % 50 == 0 ? 1.0 : pow(10, -4.5 + 3.5 * random_unit());
		for (int k = 0; k < 3; k++)
			random_point(v[k], middle, size);
		model_add(m, v[0], v[1], v[2], 0);
	}
}

static void test_random_triangles_fill_what_they_overlap(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	add_random(&m, 2000);
	model_close(&m);
	assert_as_expected(&m, 64, "random", 0.01);
	model_finish(&m);
}

static void test_spheres_have_their_area(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	model_add_sphere(&m, zero, 1, 32, 0);
	model_add_sphere(&m, (const double[3]){0.1, 0.2, -0.05}, 0.3, 8, 0);
	model_close(&m);
	assert_as_expected(&m, 64, "spheres", 0.01);
	assert_as_expected(&m, 16, "spheres", 0.01);
	model_finish(&m);
}

static void test_flat_and_aligned_scenes_lie_in_one_layer_of_cells(void **state)
{
	(void)state;
	for (int axis = 0; axis < 3; axis++) {
		struct model m;
		double u[3] = {0}, v[3] = {0};
		model_init(&m);
		u[(axis + 1) % 3] = 1;
		v[(axis + 2) % 3] = 0.5;
		model_add_quad(&m, zero, u, v, 0);
		model_close(&m);
		assert_as_expected(&m, 64, "flat", 1e-4);
		struct result r = build(&m, 64);
		// 61.25 by 30.625 voxels: one layer of cells, one side.
		assert_in_range(r.grid.entries, 61 * 31, 63 * 33);
		for (uint32_t e = 0; e < r.grid.entries; e++)
			assert_true(projection(&r, e, axis, 1) == 0.0);
		result_finish(&r);
		model_finish(&m);
	}
}

static void test_needles_and_points_are_not_lost(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	model_add(&m, zero, (const double[3]){1, 0.7, 0.4}, (const double[3]){1, 0.700001, 0.4}, 0);
	model_add(&m, (const double[3]){0, 0.5, 0}, (const double[3]){1, 0.5, 0}, (const double[3]){0.5, 0.5, 1e-6}, 0);
	model_add(&m, (const double[3]){0.2, 0.1, 0}, (const double[3]){0.9, 0.1, 0.33}, (const double[3]){0.9, 0.1, 0.33},
		  0);
	model_add(&m, (const double[3]){0.3, 0.2, 0.1}, (const double[3]){0.3, 0.2, 0.1}, (const double[3]){0.3, 0.2, 0.1},
		  0);
	model_add(&m, (const double[3]){0, 0.9, 0}, (const double[3]){1, 0.91, 0.3}, (const double[3]){0.4, 0.9041, 0.1201},
		  0);
	model_close(&m);
	assert_as_expected(&m, 64, "needles", 0.01);
	assert_as_expected(&m, 128, "needles", 0.01);
	model_finish(&m);
	// Each alone, too: a scene of one point has a grid.
	model_init(&m);
	model_add(&m, (const double[3]){3, 3, 3}, (const double[3]){3, 3, 3}, (const double[3]){3, 3, 3}, 0);
	model_close(&m);
	struct result r = build(&m, 64);
	assert_int_equal(r.grid.entries, 1);
	result_finish(&r);
	model_finish(&m);
}

static void test_an_empty_scene_has_no_entries(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	model_close(&m);
	struct result r = build(&m, 64);
	assert_int_equal(r.grid.entries, 0);
	for (uint32_t i = 0; i < r.words; i++)
		assert_int_equal(r.bits[2 * i], 0);
	result_finish(&r);
	model_finish(&m);
}

// ---- the same bits ---------------------------------------------------------------------------------------------------

static void test_order_and_slices_change_no_bit(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	add_random(&m, 3000);
	model_add_sphere(&m, zero, 0.5, 24, 1);
	for (int c = 0; c < 3; c++)
		m.materials[1].emission[c] = 10.0f * (float)(c + 1);
	model_close(&m);
	struct result once = build(&m, 64);
	for (uint32_t i = m.triangle_count - 1; i > 0; i--) {
		const uint32_t j = (uint32_t)(random_unit() * (i + 1));
		const struct triangle t = m.triangles[i];
		m.triangles[i] = m.triangles[j];
		m.triangles[j] = t;
	}
	while (m.scene.derived) {
		struct derived *d = m.scene.derived;
		m.scene.derived = d->next;
		d->destroy(d);
	}
	struct result again = {0};
	assert_int_equal(try_build(&m, 64, false, 1, &again, NULL), STATUS_OK);
	assert_same(&once, &again, true);
	result_finish(&once);
	result_finish(&again);
	model_finish(&m);
}

static void scaled(struct model *m, double scale, double offset)
{
	model_init(m);
	const double middle[3] = {offset, offset, offset};
	model_add_sphere(m, middle, scale, 16, 0);
	model_add_quad(m, (const double[3]){offset - scale, offset - 0.5 * scale, offset},
		       (const double[3]){2 * scale, 0, 0}, (const double[3]){0, 0.25 * scale, 0.5 * scale}, 0);
	model_close(m);
}

static void test_scale_and_offset_change_nothing(void **state)
{
	(void)state;
	struct model m;
	scaled(&m, 1, 0);
	struct result one = build(&m, 64);
	model_finish(&m);
	// A power of two scales every number exactly: all but the places are the same bits.
	for (int power = -20; power <= 20; power += 20) {
		scaled(&m, ldexp(1, power), 0);
		struct result r = build(&m, 64);
		assert_same(&one, &r, false);
		result_finish(&r);
		model_finish(&m);
	}
	const double scales[] = {1e-3, 1e6, 1e12, 1e-12};
	for (unsigned i = 0; i < sizeof scales / sizeof *scales; i++) {
		scaled(&m, scales[i], 0);
		struct result r = build(&m, 64);
		assert_true(fabs(area_of(&r) - area_of(&one)) < 1e-4 * area_of(&one));
		assert_true(abs((int)r.grid.entries - (int)one.grid.entries) <= (int)one.grid.entries / 500);
		result_finish(&r);
		model_finish(&m);
	}
	// Far away a float's steps are 1/128 here, and a voxel is 1/30: the surface is as rough as its corners.
	scaled(&m, 1, 1e5);
	assert_as_expected(&m, 64, "far", 0.25);
	model_finish(&m);
	result_finish(&one);
}

static void test_a_cube_holds_the_same_voxels(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	model_add_sphere(&m, zero, 1, 12, 0);
	for (uint32_t i = 0; i < m.vertex_count; i++)
		m.vertices[i].position[1] *= 0.2f;
	model_close(&m);
	struct result fitted = build(&m, 64), cube = {0};
	assert_int_equal(try_build(&m, 64, true, 1000000, &cube, NULL), STATUS_OK);
	assert_int_equal(fitted.grid.sides[1], 16);
	assert_int_equal(cube.grid.sides[1], 64);
	assert_int_equal(fitted.grid.entries, cube.grid.entries);
	for (int i = 0; i < VOXEL_PARTS; i++)
		for (uint32_t e = 0; e < fitted.grid.entries; e++)
			if (i != 0)
				assert_memory_equal(&fitted.parts[i][4 * e], &cube.parts[i][4 * e], i == 1 ? 12 : 16);
	result_finish(&fitted);
	result_finish(&cube);
	model_finish(&m);
}

int main(void)
{
	if (!voxel_test_begin())
		return 77;
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_random_triangles_fill_what_they_overlap),
	    cmocka_unit_test(test_spheres_have_their_area),
	    cmocka_unit_test(test_flat_and_aligned_scenes_lie_in_one_layer_of_cells),
	    cmocka_unit_test(test_needles_and_points_are_not_lost),
	    cmocka_unit_test(test_an_empty_scene_has_no_entries),
	    cmocka_unit_test(test_order_and_slices_change_no_bit),
	    cmocka_unit_test(test_scale_and_offset_change_nothing),
	    cmocka_unit_test(test_a_cube_holds_the_same_voxels),
	};
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	return failed + voxel_test_end();
}
