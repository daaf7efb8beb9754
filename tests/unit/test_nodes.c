// Transforms taken apart and put together, animations between their keys, and a BVH whose boxes are made anew.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "server/loader/bvh.h"
#include "server/scene/animation.h"
#include "server/scene/bvh_refit.h"
#include "server/scene/nodes.h"

static double random_share(void)
{
	static uint32_t x = 1;
	x = x * 1664525u + 1013904223u;
	return (x >> 8) / 16777216.0;
}

static double between(double low, double high)
{
	return low + (high - low) * random_share();
}

static struct transform_parts random_parts(bool mirror)
{
	struct transform_parts p;
	double square = 0;
	for (int i = 0; i < 3; i++) {
		p.translation[i] = between(-10, 10);
		p.scale[i] = between(0.1, 5);
	}
	for (int i = 0; i < 4; i++) {
		p.rotation[i] = between(-1, 1);
		square += p.rotation[i] * p.rotation[i];
	}
	for (int i = 0; i < 4; i++)
		p.rotation[i] /= sqrt(square);
	if (mirror)
		p.scale[0] = -p.scale[0];
	return p;
}

static double distance(const struct transform *a, const struct transform *b)
{
	double most = 0;
	for (int i = 0; i < 12; i++)
		most = fmax(most, fabs(a->c[i / 3][i % 3] - b->c[i / 3][i % 3]));
	return most;
}

static void parts_give_back_their_map(void **state)
{
	(void)state;
	for (int i = 0; i < 2000; i++) {
		const struct transform_parts parts = random_parts(i % 2);
		const struct transform map = transform_of_parts(&parts);
		const struct transform_parts found = transform_to_parts(&map);
		const struct transform again = transform_of_parts(&found);
		assert_true(distance(&map, &again) < 1e-12);
	}
	// Half turns, where the trace is least.
	for (int axis = 0; axis < 3; axis++) {
		struct transform_parts half = transform_no_parts;
		half.rotation[3] = 0;
		half.rotation[axis] = 1;
		const struct transform map = transform_of_parts(&half);
		const struct transform_parts found = transform_to_parts(&map);
		assert_true(fabs(fabs(found.rotation[axis]) - 1) < 1e-15);
	}
}

static void inverses_undo(void **state)
{
	(void)state;
	for (int i = 0; i < 2000; i++) {
		const struct transform_parts parts = random_parts(i % 2);
		const struct transform map = transform_of_parts(&parts);
		struct transform back;
		assert_true(transform_invert(&map, &back));
		const struct transform one = transform_compose(&back, &map);
		assert_true(distance(&one, &transform_identity) < 1e-12);
	}
}

static void what_flattens_has_no_inverse(void **state)
{
	struct transform_parts parts = transform_no_parts;
	struct transform back;
	(void)state;
	const double scales[][3] = {{0, 1, 1}, {1, 1, 0}, {0, 0, 0}, {1e-320, 1e-320, 1}};
	for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
		memcpy(parts.scale, scales[i], sizeof parts.scale);
		const struct transform map = transform_of_parts(&parts);
		assert_false(transform_invert(&map, &back));
	}
	const struct transform shear = {{{1, 0, 0}, {1, 1e-13, 0}, {0, 0, 1}, {0, 0, 0}}};
	assert_false(transform_invert(&shear, &back));
	// Small or large alone is fine.
	for (double s = 1e-50; s < 1e60; s *= 1e10) {
		parts = (struct transform_parts){.rotation = {0, 0, 0, 1}, .scale = {s, s, s}};
		const struct transform map = transform_of_parts(&parts);
		assert_true(transform_invert(&map, &back));
	}
}

static void cameras_and_lights_need_a_direction(void **state)
{
	struct blob_camera camera = {.eye = {1, 2, 3}};
	struct punctual_light light = {.kind = LIGHT_SPOT};
	double position[3];
	struct transform flat = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {4, 5, 6}}};
	(void)state;
	assert_false(node_place_camera(&flat, &camera));
	assert_true(camera.eye[0] == 1);
	assert_false(node_place_light(&flat, &light, position));
	light.kind = LIGHT_POINT;
	assert_true(node_place_light(&flat, &light, position) && position[2] == 6);
	flat.c[2][2] = 2;
	assert_true(node_place_camera(&flat, &camera));
	assert_true(camera.eye[0] == 4 && camera.forward[2] == -1 && camera.up[1] == 1);
	flat.c[3][1] = 2 * LIMIT_COORDINATE;
	assert_false(node_place_camera(&flat, &camera));
}

// ---- animations ---------------------------------------------------------------------------------------------------------

static void is(const double v[4], double x, double y, double z)
{
	assert_true(fabs(v[0] - x) < 1e-12 && fabs(v[1] - y) < 1e-12 && fabs(v[2] - z) < 1e-12);
}

static void curves_of_every_kind(void **state)
{
	const float keys[] = {1, 3, /* values */ 0, 0, 0, 2, 4, -6};
	struct scene_channel c = {.path = CHANNEL_SCALE, .curve = CURVE_LINEAR, .keys = 2};
	double v[4];
	(void)state;
	const double times[] = {-5, 1, 1.5, 2, 3, 99}, shares[] = {0, 0, .25, .5, 1, 1};
	for (int i = 0; i < 6; i++) {
		animation_sample(&c, keys, times[i], v);
		is(v, 2 * shares[i], 4 * shares[i], -6 * shares[i]);
	}
	c.curve = CURVE_STEP;
	for (int i = 0; i < 6; i++) {
		animation_sample(&c, keys, times[i], v);
		is(v, shares[i] < 1 ? 0 : 2, shares[i] < 1 ? 0 : 4, shares[i] < 1 ? 0 : -6);
	}
	// x = t³ on [0, 2] is a cubic: its Hermite form gives it back.
	const float cubic[] = {0, 2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 12, 0, 0, 8, 1, 0, 12, 0, 0};
	c.curve = CURVE_CUBIC;
	for (double t = 0; t <= 2; t += 0.125) {
		animation_sample(&c, cubic, t, v);
		is(v, t * t * t, 1, 0);
	}
}

static void rotations_go_the_shorter_way(void **state)
{
	const float half = 0.70710678f;
	// From none to a quarter about Z, said with either sign.
	for (int sign = -1; sign <= 1; sign += 2) {
		const float keys[] = {0, 1, 0, 0, 0, 1, 0, 0, (float)sign * half, (float)sign * half};
		const struct scene_channel c = {.path = CHANNEL_ROTATION, .curve = CURVE_LINEAR, .keys = 2};
		for (double t = 0; t <= 1; t += 0.125) {
			double v[4];
			animation_sample(&c, keys, t, v);
			const double angle = 2 * atan2(fabs(v[2]), fabs(v[3]));
			assert_true(fabs(angle - t * 1.5707963267948966) < 1e-6);
			assert_true(fabs(v[2] * v[2] + v[3] * v[3] - 1) < 1e-12);
		}
	}
	(void)state;
}

static void one_key_stands_still(void **state)
{
	const float keys[] = {5, 1, 2, 3};
	const struct scene_channel c = {.path = CHANNEL_TRANSLATION, .curve = CURVE_LINEAR, .keys = 1};
	(void)state;
	for (double t = 0; t < 10; t += 2.5) {
		double v[4];
		animation_sample(&c, keys, t, v);
		is(v, 1, 2, 3);
	}
}

// ---- the BVH ------------------------------------------------------------------------------------------------------------

#define TRIANGLES 2000u

struct soup {
	struct vertex vertices[3 * TRIANGLES];
	struct triangle triangles[TRIANGLES];
	struct leaf_triangle leaves[TRIANGLES];
};

static void fill_leaves(struct soup *s, const uint32_t *order, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		const uint32_t *corner = s->triangles[order[i]].vertex;
		memcpy(s->leaves[i].v0, s->vertices[corner[0]].position, sizeof s->leaves[i].v0);
		memcpy(s->leaves[i].v1, s->vertices[corner[1]].position, sizeof s->leaves[i].v1);
		memcpy(s->leaves[i].v2, s->vertices[corner[2]].position, sizeof s->leaves[i].v2);
	}
}

static void make_soup(struct soup *s, uint32_t count)
{
	memset(s, 0, sizeof *s);
	for (uint32_t i = 0; i < count; i++) {
		const double at[3] = {between(-5, 5), between(-5, 5), between(-5, 5)};
		for (uint32_t k = 0; k < 3; k++) {
			s->triangles[i].vertex[k] = 3 * i + k;
			for (int c = 0; c < 3; c++)
				s->vertices[3 * i + k].position[c] = (float)(at[c] + between(-.1, .1));
		}
	}
}

static void nothing_moved_nothing_changes(void **state)
{
	static struct soup s;
	const uint32_t counts[] = {0, 1, 2, 4, 5, 100, TRIANGLES};
	(void)state;
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
		struct bvh bvh;
		make_soup(&s, counts[i]);
		assert_int_equal(bvh_build(s.vertices, s.triangles, counts[i], &bvh, NULL), STATUS_OK);
		fill_leaves(&s, bvh.order, counts[i]);
		const size_t bytes = bvh.node_count * sizeof *bvh.nodes;
		struct bvh_node *before = malloc(bytes);
		memcpy(before, bvh.nodes, bytes);
		bvh_refit(bvh.nodes, bvh.node_count, s.leaves);
		assert_memory_equal(before, bvh.nodes, bytes);
		free(before);
		bvh_finish(&bvh);
	}
}

static bool inside(const float min[3], const float max[3], const float p[3])
{
	return min[0] < p[0] && p[0] < max[0] && min[1] < p[1] && p[1] < max[1] && min[2] < p[2] && p[2] < max[2];
}

// Every corner lies strictly within all boxes above it.
static void check_boxes(const struct bvh *bvh, const struct soup *s, uint32_t node, const float min[3], const float max[3])
{
	const struct bvh_node *n = &bvh->nodes[node];
	for (int side = 0; side < 2; side++) {
		const float *low = side ? n->min1 : n->min0, *high = side ? n->max1 : n->max0;
		const uint32_t child = side ? n->child1 : n->child0, count = side ? n->count1 : n->count0;
		for (int c = 0; c < 3; c++)
			assert_true(min[c] <= low[c] && high[c] <= max[c]);
		for (uint32_t i = child; i < child + count; i++) {
			assert_true(inside(low, high, s->leaves[i].v0) && inside(low, high, s->leaves[i].v1) &&
				    inside(low, high, s->leaves[i].v2));
		}
		if (count == 0)
			check_boxes(bvh, s, child, low, high);
	}
}

static void boxes_follow_what_moved(void **state)
{
	static struct soup s;
	const float min[3] = {-1e6f, -1e6f, -1e6f}, max[3] = {1e6f, 1e6f, 1e6f};
	struct bvh bvh;
	(void)state;
	make_soup(&s, TRIANGLES);
	assert_int_equal(bvh_build(s.vertices, s.triangles, TRIANGLES, &bvh, NULL), STATUS_OK);
	const double before = bvh_cost(bvh.nodes, bvh.node_count);
	for (uint32_t i = 0; i < 3 * TRIANGLES; i += 2)
		for (int c = 0; c < 3; c++)
			s.vertices[i].position[c] = (float)(-3 * (double)s.vertices[i].position[c] + 1);
	fill_leaves(&s, bvh.order, TRIANGLES);
	bvh_refit(bvh.nodes, bvh.node_count, s.leaves);
	check_boxes(&bvh, &s, 0, min, max);
	assert_true(before > 1 && bvh_cost(bvh.nodes, bvh.node_count) > 2 * before);
	bvh_finish(&bvh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(parts_give_back_their_map),    cmocka_unit_test(inverses_undo),
	    cmocka_unit_test(what_flattens_has_no_inverse), cmocka_unit_test(cameras_and_lights_need_a_direction),
	    cmocka_unit_test(curves_of_every_kind),         cmocka_unit_test(rotations_go_the_shorter_way),
	    cmocka_unit_test(one_key_stands_still),         cmocka_unit_test(nothing_moved_nothing_changes),
	    cmocka_unit_test(boxes_follow_what_moved),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
