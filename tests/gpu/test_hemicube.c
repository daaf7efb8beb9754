// Form factors by hemicubes beside closed forms: squares that face or touch each other, half blocked, nearly touching; rows
// of closed rooms are whole; nothing sees itself or its own plane; the same bits whatever the batches and, for powers of
// two, the scale.
#include "tests/gpu/hemicube_result.h"

#include <stdio.h>
#include <stdlib.h>

#include "server/base/angle.h"

static struct patch_model model;
static const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0};

// What pixels on outlines may do to a form factor: an outline of length l in the top's plane at distance 1 goes through some
// l n / 2 pixels, each off by up to half of its share, which is at most (2 / n)² / π, and half of them each way: a random
// walk, 4 standard deviations of it, for pixels of the sides are as many again.
static double outline_error(double length, uint32_t pixels, uint32_t origins)
{
	const double share = 4.0 / ((double)pixels * pixels * PI);
	return 4 * 0.29 * share * sqrt(0.5 * length * pixels * origins) / origins;
}

static void check(const char *what, double is, double should, double most)
{
	printf("%s: %.7f, should be %.7f: off by %.1e of %.1e\n", what, is, should, fabs(is - should), most);
	assert_true(fabs(is - should) <= most);
}

static void two_squares(const double at[3], const double u[3], const double v[3])
{
	model_start(&model);
	model_add_quad(&model, o, x, y, 0);
	model_add_quad(&model, at, u, v, 0);
	model_close(&model, 2);
	assert_int_equal(model.elements.patches.count, 2);
}

static double check_pair(const char *what, uint32_t pixels, uint32_t origins, double outline)
{
	const struct hemicube_options options = {.pixels = pixels, .origins = origins};
	struct hemicube_result r = hemicube_result_make(&model, &options, 0, 4, 0);
	struct patch p;
	patches_get(&model.elements.patches, 1, &p);
	const double is = factor_at(&r, 0, 1);
	check(what, is, mean_from_origins(&model, 0, origins, &p.shape, NULL), outline_error(outline, pixels, origins));
	for (uint32_t i = 0; i < 4; i++)
		assert_true(fabs(hemicube_result_sum(&r, i) - 1) < 1e-6);
	// Backs see neither.
	assert_true(r.escaped[2] == 1 && r.escaped[3] == 1);
	hemicube_result_finish(&r);
	return is;
}

static void facing_squares(void **state)
{
	(void)state;
	two_squares((const double[3]){0, 0, 1}, y, x);
	for (uint32_t n = 16; n <= 256; n *= 4)
		check_pair("facing squares, one origin", n, 1, 8);
	const double is = check_pair("facing squares, 64 origins", 128, 64, 8);
	check("facing squares", is, 0.19982489569838, outline_error(8, 128, 64) + 2e-5);
	model_finish(&model);
}

static void squares_with_an_edge_in_common(void **state)
{
	(void)state;
	two_squares(o, y, (const double[3]){0, 0, 1});
	check_pair("square corner, one origin", 128, 1, 8);
	const double is = check_pair("square corner, 256 origins", 64, 256, 8);
	check("square corner", is, 0.20004377607540, outline_error(8, 64, 256) + 3e-4);
	model_finish(&model);
}

// From a point on the floor, what of the ceiling is not behind the half plane x < 1/2 at half the height.
static void beside_the_half(const double from[3], struct form_polygon *p)
{
	const double share = (0.5 - from[2]) / (1 - from[2]), low = from[0] + (0.5 - from[0]) / share;
	for (uint32_t i = 0; i < p->corners; i++)
		p->at[i][0] = fmax(p->at[i][0], low);
}

static void half_of_the_way_is_blocked(void **state)
{
	(void)state;
	const struct hemicube_options options = {.pixels = 128, .origins = 16};
	struct patch p;
	model_start(&model);
	model_add_quad(&model, o, x, y, 0);
	model_add_quad(&model, (const double[3]){0, 0, 1}, y, x, 0);
	model_add_quad(&model, (const double[3]){-60, -60, 0.5}, (const double[3]){0, 120, 0}, (const double[3]){60.5, 0, 0},
		       0);
	model_close(&model, 200);
	struct hemicube_result r = hemicube_result_make(&model, &options, 0, 2, 0);
	patches_get(&model.elements.patches, 1, &p);
	check("half blocked", factor_at(&r, 0, 1), mean_from_origins(&model, 0, 16, &p.shape, beside_the_half),
	      outline_error(8, 128, 16));
	assert_true(fabs(hemicube_result_sum(&r, 0) - 1) < 1e-6);
	hemicube_result_finish(&r);
	model_finish(&model);
}

static void nothing_is_too_near(void **state)
{
	(void)state;
	for (double gap = 1e-2; gap > 5e-6; gap /= 10) {
		two_squares((const double[3]){0, 0, gap}, y, x);
		const struct hemicube_options options = {.pixels = 64, .origins = 16};
		struct hemicube_result r = hemicube_result_make(&model, &options, 0, 2, 0);
		struct patch p;
		patches_get(&model.elements.patches, 1, &p);
		const double should = mean_from_origins(&model, 0, 16, &p.shape, NULL);
		printf("gap %g: %.7f, should be %.7f\n", gap, factor_at(&r, 0, 1), should);
		assert_true(fabs(factor_at(&r, 0, 1) - should) < 4.0 / (64 * 64));
		assert_true(fabs(factor_at(&r, 1, 0) - should) < 4.0 / (64 * 64));
		hemicube_result_finish(&r);
		model_finish(&model);
	}
}

// The inside of a cube, of side 1 and then scaled.
static void add_cube(double at, double side)
{
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < 2; k++) {
			double corner[3] = {at, at, at}, u[3] = {0}, v[3] = {0};
			corner[c] = k ? at + side : at;
			u[(c + 1) % 3] = v[(c + 2) % 3] = side;
			model_add_quad(&model, corner, k ? v : u, k ? u : v, 0);
		}
}

static void cube(double at, double side, uint32_t parts)
{
	model_start(&model);
	add_cube(at, side);
	model_close(&model, side / parts * 1.001);
	assert_int_equal(model.elements.patches.count, 6 * parts * parts);
}

static void rows_of_a_closed_cube_are_whole(void **state)
{
	(void)state;
	cube(0, 1, 4);
	const uint32_t n = model.elements.patches.count;
	for (uint32_t pixels = 16; pixels <= 64; pixels *= 2) {
		const struct hemicube_options options = {.pixels = pixels, .origins = 3};
		struct hemicube_result r = hemicube_result_make(&model, &options, 0, n, 0);
		double worst = 0;
		for (uint32_t i = 0; i < n; i++) {
			assert_true(r.escaped[i] == 0 && r.cut[i] == 0);
			worst = fmax(worst, fabs(hemicube_result_sum(&r, i) - 1));
			for (uint32_t j = 0; j < r.side; j++)
				if (j >= n || j / 16 == i / 16)
					assert_true(factor_at(&r, i, j) == 0);
		}
		printf("cube, %u pixels: rows are off 1 by %.1e at most\n", pixels, worst);
		assert_true(worst < 1e-7 * n);
		hemicube_result_finish(&r);
	}
	model_finish(&model);
}

// A ball of many small triangles: at its outline, where they are seen edge-on, depths are not those of pixels' middles.
static void add_ball(const double middle[3], double radius, int rings)
{
	double p[4][3];
	for (int i = 0; i < rings; i++)
		for (int k = 0; k < 2 * rings; k++) {
			for (int c = 0; c < 4; c++) {
				const double t = PI * (i + (c == 1 || c == 2)) / rings,
					     a = PI * (k + (c == 2 || c == 3)) / rings;
				p[c][0] = middle[0] + radius * sin(t) * cos(a);
				p[c][1] = middle[1] + radius * sin(t) * sin(a);
				p[c][2] = middle[2] + radius * cos(t);
			}
			if (i > 0)
				model_add(&model, p[0], p[1], p[3], NULL, 1);
			if (i + 1 < rings)
				model_add(&model, p[1], p[2], p[3], NULL, 1);
		}
}

static void next_to_nothing_is_seen_in_closed_bodies(void **state)
{
	(void)state;
	const struct hemicube_options options = {.pixels = 128, .origins = 4};
	model_start(&model);
	add_cube(0, 1);
	add_ball((const double[3]){0.4, 0.55, 0.5}, 0.3, 24);
	model_close(&model, 0.251);
	const uint32_t n = model.elements.patches.count;
	struct hemicube_result r = hemicube_result_make(&model, &options, 0, 96, 0);
	double behind = 0;
	for (uint32_t i = 0; i < 96; i++)
		for (uint32_t j = n; j < 2 * n; j++)
			behind += factor_at(&r, i, j);
	printf("%u patches: %.1e of 96 rows is behind surfaces\n", n, behind);
	assert_true(behind < 96 * 1e-5);
	hemicube_result_finish(&r);
	model_finish(&model);
}

static void batches_do_not_matter(void **state)
{
	(void)state;
	const struct hemicube_options options = {.pixels = 32, .origins = 5};
	cube(0, 1, 8);
	const uint32_t n = model.elements.patches.count;
	struct hemicube_result all = hemicube_result_make(&model, &options, 0, n, 0);
	for (uint32_t batch = 1; batch < 200; batch = 7 * batch + 3) {
		struct hemicube_result r = hemicube_result_make(&model, &options, 0, n, batch);
		assert_memory_equal(r.values, all.values, (size_t)n * r.side * sizeof *r.values);
		assert_memory_equal(r.escaped, all.escaped, n * sizeof *r.escaped);
		hemicube_result_finish(&r);
	}
	hemicube_result_finish(&all);
	model_finish(&model);
}

static void scale_and_place_do_not_matter(void **state)
{
	(void)state;
	static const double sides[] = {0x1p-20, 0x1p20, 1e-3, 1e6, 1e-12, 1e12};
	const struct hemicube_options options = {.pixels = 32, .origins = 2};
	cube(0, 1, 3);
	const uint32_t n = model.elements.patches.count;
	struct hemicube_result one = hemicube_result_make(&model, &options, 0, n, 0);
	model_finish(&model);
	for (size_t k = 0; k < sizeof sides / sizeof *sides; k++) {
		cube(0, sides[k], 3);
		struct hemicube_result r = hemicube_result_make(&model, &options, 0, n, 0);
		double worst = 0;
		for (size_t i = 0; i < (size_t)n * r.side; i++)
			worst = fmax(worst, fabs((double)(r.values[i] - one.values[i])));
		printf("cube of side %g: factors are off by %.1e at most\n", sides[k], worst);
		// A power of two scales every number exactly. Else single pixels on outlines may go to the other side.
		assert_true(k < 2 ? worst == 0 : worst < 5 * 4.0 / (32 * 32 * PI));
		for (uint32_t i = 0; i < n; i++)
			assert_true(r.escaped[i] == 0);
		hemicube_result_finish(&r);
		model_finish(&model);
	}
	// Far from the origin corners are rounded to a thousandth of a patch.
	cube(3000, 1, 3);
	struct hemicube_result r = hemicube_result_make(&model, &options, 0, n, 0);
	for (uint32_t i = 0; i < n; i++)
		assert_true(fabs(hemicube_result_sum(&r, i) - 1) < 1e-5 && r.escaped[i] == 0);
	hemicube_result_finish(&r);
	hemicube_result_finish(&one);
	model_finish(&model);
}

// Half of a quad in between is there: x = 0 … 1/2.
static void masks_let_through(void **state)
{
	(void)state;
	const struct hemicube_options options = {.pixels = 128, .origins = 4};
	model_start(&model);
	model.materials[1].flags = MATERIAL_ALPHA_MASK;
	model.materials[1].alpha_cutoff = 0.5f;
	model.materials[1].albedo_texture = 0;
	model.textures[0] =
	    (struct texture_info){.width = 2, .height = 1, .flags = TEXTURE_NEAREST, .row_u = {1, 0, 0}, .row_v = {0, 1, 0}};
	model.texture_count = 1;
	model.texels[0] = 0xFFFFFFFF;
	model.texels[1] = 0x00FFFFFF;
	model.texel_count = 2;
	model_add_quad(&model, o, x, y, 0);
	model_add_quad(&model, (const double[3]){0, 0, 0.5}, x, y, 1);
	model_add_quad(&model, (const double[3]){0, 0, 1}, y, x, 0);
	model_close(&model, 2);
	struct hemicube_result r = hemicube_result_make(&model, &options, 0, 1, 0);
	const struct form_polygon there = {{{0, 0, 0.5}, {0, 1, 0.5}, {0.5, 1, 0.5}, {0.5, 0, 0.5}}, 4};
	const uint32_t patches = model.elements.patches.count;
	check("what is there of a mask", factor_at(&r, 0, patches + 1), mean_from_origins(&model, 0, 4, &there, NULL),
	      outline_error(8, 128, 4));
	assert_true(factor_at(&r, 0, 2) > 0.05);
	hemicube_result_finish(&r);
	model_finish(&model);
}

static void options_out_of_range_are_refused(void **state)
{
	(void)state;
	static const struct hemicube_options bad[] = {
	    {.pixels = 0, .origins = 1},
	    {.pixels = 33, .origins = 1},
	    {.pixels = 1026, .origins = 1},
	    {.pixels = 32, .origins = 0},
	    {.pixels = 32, .origins = 1025},
	    {.pixels = 32, .origins = 1, .mirrors = HEMICUBE_MIRRORS_PORTAL, .bounces = 11}};
	cube(0, 1, 1);
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct hemicube *h;
		assert_int_equal(hemicube_create(gl, &model.scene, &everything, &model.elements, &bad[i], &h, NULL),
				 STATUS_BAD_ARGUMENT);
		assert_null(h);
	}
	model_finish(&model);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(facing_squares),
	    cmocka_unit_test(squares_with_an_edge_in_common),
	    cmocka_unit_test(half_of_the_way_is_blocked),
	    cmocka_unit_test(nothing_is_too_near),
	    cmocka_unit_test(rows_of_a_closed_cube_are_whole),
	    cmocka_unit_test(next_to_nothing_is_seen_in_closed_bodies),
	    cmocka_unit_test(batches_do_not_matter),
	    cmocka_unit_test(scale_and_place_do_not_matter),
	    cmocka_unit_test(masks_let_through),
	    cmocka_unit_test(options_out_of_range_are_refused),
	};
	if (!hemicube_test_begin())
		return 77;
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	return failed + hemicube_test_end();
}
