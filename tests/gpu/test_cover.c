// How many triangles a piece of a draw has: closed forms for a camera at the origin that looks along −z, 90° high, 64 × 64
// pixels.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <string.h>

#include "server/worker/technique/deferred/deferred_cover.h"

#define COUNT 4u

static struct vertex vertices[3 * COUNT];
static struct triangle triangles[COUNT];
static struct blob_header header;
static struct resident_scene scene;
static struct plan plan;

// Right-angled, `side` metres, its right angle at (x, y, z).
static void set(uint32_t i, float x, float y, float z, float side)
{
	for (uint32_t k = 0; k < 3; k++) {
		const float at[3] = {x + (k == 1 ? side : 0), y + (k == 2 ? side : 0), z};
		memcpy(vertices[3 * i + k].position, at, sizeof at);
		triangles[i].vertex[k] = 3 * i + k;
	}
}

static int setup(void **state)
{
	(void)state;
	scene.view.blob = &header;
	scene.view.sections[BLOB_VERTICES] = vertices;
	scene.view.sections[BLOB_TRIANGLES] = triangles;
	scene.view.counts[BLOB_TRIANGLES] = COUNT;
	plan.width = plan.height = 64;
	plan.camera = (struct plan_camera){.forward = {0, 0, -1}, .right = {1, 0, 0}, .up = {0, 1, 0}};
	set(0, 0, 0, -1, 0.5f); // a quarter of the picture's sides
	set(1, -10, -10, -1, 40); // all of it
	set(2, 5, 5, -1, 1); // beside it
	set(3, 0, 0, 1, 1); // behind the eye
	return 0;
}

static double cost_of(uint32_t triangle)
{
	double cost = 0;
	assert_int_equal(deferred_drawable(&plan, &scene, 0, 64, triangle, 1, &cost), 1);
	return cost - DEFERRED_TRIANGLE_COST;
}

static void pixels_are_those_of_the_box_that_is_seen(void **state)
{
	(void)state;
	assert_float_equal(cost_of(0), 16 * 16, 1e-3);
	assert_float_equal(cost_of(1), 64 * 64, 1e-3);
	assert_float_equal(cost_of(2), 0, 0);
	assert_float_equal(cost_of(3), 0, 0);
	// With a corner at the eye or behind it, anything.
	vertices[0].position[2] = 0;
	assert_float_equal(cost_of(0), 64 * 64, 1e-3);
	set(0, 0, 0, -1, 0.5f);
	// Of a band, what is in it: rows 16 to 31 are those right above the middle.
	double cost = 0;
	deferred_drawable(&plan, &scene, 24, 8, 0, 1, &cost);
	assert_float_equal(cost, DEFERRED_TRIANGLE_COST + 16 * 8, 1e-3);
}

static void a_piece_ends_before_it_costs_too_much(void **state)
{
	(void)state;
	double cost = 0;
	assert_int_equal(deferred_drawable(&plan, &scene, 0, 64, 1, 3, &cost), 1);
	assert_float_equal(cost, DEFERRED_TRIANGLE_COST + 64 * 64, 1e-3);
	cost = 3 * DEFERRED_TRIANGLE_COST + 64 * 64;
	assert_int_equal(deferred_drawable(&plan, &scene, 0, 64, 1, 3, &cost), 3);
	cost = 3 * DEFERRED_TRIANGLE_COST + 64 * 64;
	assert_int_equal(deferred_drawable(&plan, &scene, 0, 64, 0, 4, &cost), 1);
	assert_int_equal(deferred_drawable(&plan, &scene, 0, 64, 0, 0, &cost), 0);
	assert_float_equal(cost, 0, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(pixels_are_those_of_the_box_that_is_seen),
					   cmocka_unit_test(a_piece_ends_before_it_costs_too_much)};
	return cmocka_run_group_tests(tests, setup, NULL);
}
