// Pictures of radiosity from light that is known: each pixel against what follows from its ray in double precision.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/base/angle.h"
#include "tests/gpu/display_room.h"

#define SKIPPED 77

// ---- light that is known
// --------------------------------------------------------------------------------------------------

static uint32_t random_state = 1;

static float noise(void)
{
	random_state = random_state * 1664525u + 1013904223u;
	return (float)(random_state >> 8) / 16777216.0f;
}

// Each element has a value of its own.
static float *any_values(const struct room *r)
{
	float *v = malloc(3 * (size_t)r->elements.count * sizeof *v);
	for (size_t i = 0; i < 3 * (size_t)r->elements.count; i++)
		v[i] = 0.5f + 10 * noise();
	return v;
}

// Linear in space, above zero in the room; of backs twice as much.
static double linear(const double p[3], uint32_t c, bool front)
{
	return (front ? 1 : 2) * (10 + (c + 1.0) * p[0] - 2 * p[1] + (1.0 - c) * p[2]);
}

static float *linear_corners(const struct room *r)
{
	const struct elements *e = &r->elements;
	float *v = malloc(12 * (size_t)e->count * sizeof *v);
	for (uint32_t i = 0; i < e->count; i++)
		for (uint32_t k = 0; k < 4; k++) {
			const float *at = &e->shapes[i % e->patches.count].corner[3 * k];
			const double p[3] = {(double)at[0], (double)at[1], (double)at[2]};
			for (uint32_t c = 0; c < 3; c++)
				v[12 * (size_t)i + 3 * k + c] = (float)linear(p, c, i < e->patches.count);
		}
	return v;
}

static float *same_corners(const struct room *r, const float value[3])
{
	float *v = malloc(12 * (size_t)r->elements.count * sizeof *v);
	for (size_t i = 0; i < 12 * (size_t)r->elements.count; i++)
		v[i] = value[i % 3];
	return v;
}

static void assert_close(const float *got, const double *expected, double relative, uint32_t pixel)
{
	for (int c = 0; c < 3; c++)
		if (!(fabs((double)got[c] - expected[c]) <= relative * fabs(expected[c])))
			fail_msg("pixel %u, channel %d: %.9g instead of %.9g", pixel, c, (double)got[c], expected[c]);
}

// The one element in a pixel's middle and a hundredth of a pixel about it; NONE: an edge is there, or nothing.
static uint32_t element_of(const struct room *r, uint32_t pixel)
{
	uint32_t found = NONE;
	for (int k = 0; k < 5; k++) {
		const double x = pixel % SIDE + 0.5 + (k == 1) * 0.01 - (k == 2) * 0.01;
		const double y = (double)(pixel / SIDE) + 0.5 + (k == 3) * 0.01 - (k == 4) * 0.01;
		const uint32_t e = display_element_seen(&r->elements, &r->model.scene.view, &r->plan, x, y);
		if (k > 0 && e != found)
			return NONE;
		found = e;
	}
	return found;
}

// ---- looked up
// ------------------------------------------------------------------------------------------------------------

static void constant_is_albedo_times_irradiance(void **state)
{
	(void)state;
	for (int kind = 0; kind < ROOMS; kind++) {
		struct room r;
		room_init(&r, kind, 0.3);
		float *values = any_values(&r);
		struct frame *f = room_draw(&r, &(struct display_options){0}, values);
		uint32_t seen = 0;
		for (uint32_t i = 0; i < SIDE * SIDE; i++) {
			const uint32_t e = element_of(&r, i);
			double expected[3];
			for (int c = 0; e != NONE && c < 3; c++)
				expected[c] = room_albedo[c] / PI * (double)values[3 * (size_t)e + (size_t)c];
			if (e != NONE)
				assert_close(f->radiance + 3 * (size_t)i, expected, 1e-5, i);
			seen += e != NONE;
		}
		assert_true(seen > SIDE * SIDE / 3);
		frame_destroy(f);
		free(values);
		room_finish(&r);
	}
}

static void vertex_keeps_what_is_linear(void **state)
{
	(void)state;
	for (int kind = 0; kind < ROOMS; kind++) {
		struct room r;
		room_init(&r, kind, 0.3);
		float *values = linear_corners(&r);
		struct frame *f = room_draw(&r, &(struct display_options){.corners = true}, values);
		uint32_t seen = 0;
		for (uint32_t i = 0; i < SIDE * SIDE; i++) {
			const uint32_t e = element_of(&r, i);
			double at[3], expected[3];
			if (e == NONE)
				continue;
			room_place(&r, i, at);
			for (uint32_t c = 0; c < 3; c++)
				expected[c] = room_albedo[c] / PI * linear(at, c, e < r.elements.patches.count);
			assert_close(f->radiance + 3 * (size_t)i, expected, 2e-5, i);
			seen++;
		}
		assert_true(seen > SIDE * SIDE / 3);
		frame_destroy(f);
		free(values);
		room_finish(&r);
	}
}

static void values_are_shown_as_they_are(void **state)
{
	(void)state;
	struct room r;
	room_init(&r, ROOM_SHAPES, 0.2);
	float *values = malloc(3 * (size_t)r.elements.count * sizeof *values);
	display_view_fill(DISPLAY_VIEW_ID, &(struct display_source){.elements = &r.elements}, values);
	struct frame *f = room_draw(&r, &(struct display_options){.plain = true}, values);
	char *seen = calloc(r.elements.count, 1), *shown = calloc(r.elements.count, 1);
	for (uint32_t i = 0; i < SIDE * SIDE; i++) {
		const uint32_t e = display_element_seen(&r.elements, &r.model.scene.view, &r.plan, i % SIDE + 0.5,
							(double)(i / SIDE) + 0.5);
		const float *got = f->radiance + 3 * (size_t)i;
		uint32_t of = 0;
		while (of < r.elements.count && memcmp(values + 3 * (size_t)of, got, 3 * sizeof *got) != 0)
			of++;
		if (of == r.elements.count)
			assert_true(got[0] == 0 && got[1] == 0 && got[2] == 0 && e == NONE);
		else
			shown[of] = 1;
		if (e != NONE)
			seen[e] = 1;
		if (element_of(&r, i) != NONE)
			assert_int_equal(of, e);
	}
	uint32_t both[2] = {0};
	for (uint32_t e = 0; e < r.elements.count; e++) {
		both[0] += seen[e] != 0;
		both[1] += shown[e] != 0;
	}
	assert_int_equal(both[0], both[1]);
	assert_true(both[0] > 40);
	free(seen);
	free(shown);
	frame_destroy(f);
	free(values);
	room_finish(&r);
}

// ---- gathered
// -------------------------------------------------------------------------------------------------------------

static void a_furnace_is_even(void **state)
{
	(void)state;
	static const float light[3] = {3, 2, 1};
	struct room r;
	room_init(&r, ROOM_BOX, 0.5);
	float *values = same_corners(&r, light);
	const struct display_options options = {.corners = true, .gather = 70, .light = {.points = 1}};
	struct frame *f = room_draw(&r, &options, values);
	double expected[3];
	for (int c = 0; c < 3; c++)
		expected[c] = room_albedo[c] * room_albedo[c] / PI * (double)light[c];
	for (uint32_t i = 0; i < SIDE * SIDE; i++)
		assert_close(f->radiance + 3 * (size_t)i, expected, 1e-5, i);
	assert_int_equal(f->rays, 70 * SIDE * SIDE);
	frame_destroy(f);
	free(values);
	room_finish(&r);
}

// All walls shine: H = π L / (1 − ρ) and what is seen is L / (1 − ρ), of which one bounce is direct light.
static void shining_walls_are_counted_once(void **state)
{
	(void)state;
	struct room r;
	double expected[3];
	float light[3];
	room_init(&r, ROOM_BOX, 0.5);
	room_shine(&r);
	for (int c = 0; c < 3; c++) {
		expected[c] = room_emission[c] / (1 - room_albedo[c]);
		light[c] = (float)(PI * expected[c]);
	}
	float *values = same_corners(&r, light);
	const struct display_options gather = {.corners = true, .gather = 16, .light = {.points = 1, .lamps = true}};
	struct frame *f = room_draw(&r, &gather, values);
	for (uint32_t i = 0; i < SIDE * SIDE; i++)
		assert_close(f->radiance + 3 * (size_t)i, expected, 1e-4, i);
	frame_destroy(f);
	f = room_draw(&r, &(struct display_options){.corners = true}, values);
	for (uint32_t i = 0; i < SIDE * SIDE; i++)
		assert_close(f->radiance + 3 * (size_t)i, expected, 1e-5, i);
	frame_destroy(f);
	free(values);
	room_finish(&r);
}

static void rays_that_escape_see_the_background(void **state)
{
	(void)state;
	static const float light[3] = {3, 2, 1};
	struct room r;
	room_init(&r, ROOM_SHAPES, 1);
	float *values = same_corners(&r, light);
	const float background[3] = {1, 2, 4};
	memcpy(r.plan.background, background, sizeof background);
	const struct display_options options = {.corners = true, .gather = 8, .light = {.points = 1}};
	struct frame *f = room_draw(&r, &options, values);
	for (uint32_t i = 0; i < SIDE * SIDE; i++) {
		const uint32_t e = display_element_seen(&r.elements, &r.model.scene.view, &r.plan, i % SIDE + 0.5,
							(double)(i / SIDE) + 0.5);
		double expected[3];
		for (int c = 0; c < 3; c++)
			expected[c] = (e == NONE ? 1 : room_albedo[c]) * (double)background[c];
		assert_close(f->radiance + 3 * (size_t)i, expected, 1e-5, i);
	}
	frame_destroy(f);
	free(values);
	room_finish(&r);
}

// A picture of the surroundings that is the same everywhere, one half of which is looked at nine times as often as the
// other: weights make up for it.
static void an_environment_is_weighted(void **state)
{
	(void)state;
	static const float light[3] = {3, 2, 1};
	static const struct environment_texel texels[2] = {{{1, 2, 4}, (float)(0.9 / (2 * PI))},
							   {{1, 2, 4}, (float)(0.1 / (2 * PI))}};
	static const struct environment_row rows[2] = {{1, 0}, {0.2f, 0}};
	struct model around;
	struct room r;
	room_init(&r, ROOM_SHAPES, 1);
	room_surround(&r, &around, texels, rows);
	float *values = same_corners(&r, light);
	const struct display_options options = {.corners = true, .gather = 100, .light = {.points = 1}};
	struct frame *f = room_draw(&r, &options, values);
	double sum[3] = {0}, count = 0;
	for (uint32_t i = 0; i < SIDE * SIDE; i++) {
		if (!f->met[i])
			continue;
		count++;
		for (int c = 0; c < 3; c++) {
			const double got = (double)f->radiance[3 * i + (uint32_t)c];
			const double expected = room_albedo[c] * (double)texels[0].radiance[c];
			assert_true(fabs(got - expected) < 0.15 * expected);
			sum[c] += got / expected;
		}
	}
	assert_true(count > SIDE * SIDE / 3);
	assert_true(f->rays <= (uint64_t)(150 * count) && f->rays >= (uint64_t)(100 * count));
	for (int c = 0; c < 3; c++)
		assert_true(fabs(sum[c] / count - 1) < 2e-3);
	frame_destroy(f);
	free(values);
	room_finish(&r);
	model_finish(&around);
}

// ---- mirrors
// --------------------------------------------------------------------------------------------------------------

static void mirrors_show_what_is_before_them(void **state)
{
	(void)state;
	struct room r;
	room_init(&r, ROOM_BOX, 0.4);
	room_polish_floor(&r);
	float *values = linear_corners(&r);
	for (int gathers = 0; gathers < 2; gathers++) {
		const struct display_options options = {
		    .corners = true, .gather = gathers ? 1 : 0, .bounces = 3, .light = {.points = 1}};
		struct frame *f = room_draw(&r, &options, values);
		uint32_t seen = 0;
		for (uint32_t i = 0; i < SIDE * SIDE; i++) {
			double at[3], expected[3], cosine;
			if (!room_mirrored(&r, i, at, &cosine))
				continue;
			for (uint32_t c = 0; c < 3; c++) {
				const double metal = room_metal[c] + (1 - room_metal[c]) * pow(1 - cosine, 5);
				expected[c] = metal * room_albedo[c] / PI * linear(at, c, true);
			}
			assert_close(f->radiance + 3 * (size_t)i, expected, 1e-4, i);
			seen++;
		}
		assert_true(seen > SIDE * SIDE / 8);
		assert_int_equal(f->non_finite_samples, 0);
		frame_destroy(f);
	}
	free(values);
	room_finish(&r);
}

// ---- bits
// -----------------------------------------------------------------------------------------------------------------

static void bands_and_slices_change_no_bit(void **state)
{
	(void)state;
	struct room r;
	room_init(&r, ROOM_BOX, 0.4);
	room_polish_floor(&r);
	room_shine(&r);
	r.plan.samples = 3;
	float *values = linear_corners(&r);
	const struct display_options all[] = {
	    {.corners = true, .bounces = 2},
	    {.corners = true, .gather = 40, .bounces = 2, .light = {.points = 2, .lamps = true, .shadows = true}}};
	for (int i = 0; i < 2; i++) {
		struct frame *whole = room_draw(&r, &all[i], values);
		r.rows = 8;
		r.slice_us = 1;
		struct frame *parts = room_draw(&r, &all[i], values);
		r.rows = 0;
		r.slice_us = 1000000;
		assert_memory_equal(whole->radiance, parts->radiance, 3 * (size_t)SIDE * SIDE * sizeof(float));
		frame_destroy(whole);
		frame_destroy(parts);
	}
	free(values);
	room_finish(&r);
}

// ---- views
// ----------------------------------------------------------------------------------------------------------------

static void views_are_of_elements(void **state)
{
	(void)state;
	struct room r;
	room_init(&r, ROOM_BOX, 2);
	const uint32_t n = r.elements.count, walls = r.elements.patches.count;
	assert_int_equal(n, 12);
	struct radiosity_surface surfaces[12] = {{.emission = {1, 0, 0}, .albedo = {.5f, .25f, 0}}};
	float irradiance[36] = {2, 4, 8}, residual[36] = {0, 0, 0, 3, 2, 1}, v[36];
	const uint32_t columns[2] = {1, 11};
	const float factors[2] = {.25f, .125f};
	const struct display_source s = {&r.elements, surfaces, irradiance, residual, columns, factors, 2};
	display_view_fill(DISPLAY_VIEW_B, &s, v);
	assert_float_equal(v[0], PI + 1, 1e-6);
	assert_float_equal(v[1], 1, 1e-6);
	display_view_fill(DISPLAY_VIEW_E, &s, v);
	assert_float_equal(v[0], PI, 1e-6);
	assert_float_equal(v[1], 0, 0);
	display_view_fill(DISPLAY_VIEW_ALBEDO, &s, v);
	assert_float_equal(v[1], .25, 0);
	display_view_fill(DISPLAY_VIEW_RESIDUAL, &s, v);
	assert_memory_equal(v, residual, sizeof v);
	display_view_fill(DISPLAY_VIEW_ROW, &s, v);
	assert_float_equal(v[5], 1, 0);
	assert_float_equal(v[33], .5, 0);
	assert_float_equal(v[0], 0, 0);
	display_view_fill(DISPLAY_VIEW_NORMAL, &s, v);
	for (uint32_t i = 0; i < walls; i++) {
		float sum = 0;
		for (uint32_t c = 0; c < 3; c++) {
			const float a = v[3 * i + c], b = v[3 * (i + walls) + c];
			assert_float_equal(a + b, 1, 1e-6);
			sum += (2 * a - 1) * (2 * a - 1);
		}
		assert_float_equal(sum, 1, 1e-5);
	}
	room_finish(&r);
}

int main(void)
{
	if (!room_begin())
		return SKIPPED;
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(constant_is_albedo_times_irradiance), cmocka_unit_test(vertex_keeps_what_is_linear),
	    cmocka_unit_test(values_are_shown_as_they_are),        cmocka_unit_test(a_furnace_is_even),
	    cmocka_unit_test(shining_walls_are_counted_once),      cmocka_unit_test(rays_that_escape_see_the_background),
	    cmocka_unit_test(an_environment_is_weighted),          cmocka_unit_test(mirrors_show_what_is_before_them),
	    cmocka_unit_test(bands_and_slices_change_no_bit),      cmocka_unit_test(views_are_of_elements)};
	return cmocka_run_group_tests(tests, NULL, NULL) + room_end();
}
