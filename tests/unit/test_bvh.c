// A BVH is a tree over each triangle once, its boxes hold what is below them, its depth is bounded, and it is the same
// twice.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/loader/bvh.h"

#define MOST 20000u

static struct vertex vertices[MOST * 3];
static struct triangle triangles[MOST];
static unsigned char seen[MOST];
static const struct bvh *tree;
static uint32_t deepest, next_leaf;

typedef enum status builder(const struct vertex *, const struct triangle *, uint32_t, struct bvh *, struct error *);

static float next(uint64_t *state)
{
	*state = *state * 6364136223846793005ull + 1442695040888963407ull;
	return (float)(*state >> 40) / 16777216.0f;
}

static void set_triangle(uint32_t i, float x, float y, float z, float size, uint64_t *seed)
{
	for (uint32_t k = 0; k < 3; k++) {
		float *p = vertices[i * 3 + k].position;
		p[0] = x + size * next(seed);
		p[1] = y + size * next(seed);
		p[2] = z + size * next(seed);
		triangles[i].vertex[k] = i * 3 + k;
	}
}

// Shapes that are kind to a builder, and some that are not.
static void scatter(uint32_t count)
{
	uint64_t seed = 1;
	for (uint32_t i = 0; i < count; i++)
		set_triangle(i, next(&seed), next(&seed), next(&seed), 0.01f, &seed);
}

static void pile_up(uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		uint64_t seed = 2;
		set_triangle(i, 0, 0, 0, 1, &seed); // all of them the same
	}
}

static void spread_exponentially(uint32_t count)
{
	uint64_t seed = 3;
	for (uint32_t i = 0; i < count; i++) {
		const float x = ldexpf(1.0f, (int)(i % 80) - 40);
		set_triangle(i, x, 0, 0, x * 0.1f, &seed);
	}
}

static void check_inside(uint32_t id, const float min[3], const float max[3])
{
	for (int k = 0; k < 3; k++)
		for (int c = 0; c < 3; c++) {
			const float v = vertices[triangles[id].vertex[k]].position[c];
			assert_true(v >= min[c] && v <= max[c]);
		}
}

static void walk(uint32_t node, uint32_t level, const float min[3], const float max[3]);

static void walk_child(uint32_t child, uint32_t count, uint32_t level, const float low[3], const float high[3],
		       const float min[3], const float max[3])
{
	for (int c = 0; c < 3; c++)
		assert_true(low[c] >= min[c] && high[c] <= max[c]);
	for (uint32_t i = child; i < child + count; i++) {
		assert_int_equal(i, next_leaf++);
		assert_false(seen[tree->order[i]]++);
		check_inside(tree->order[i], low, high);
	}
	assert_true(count <= BVH_LEAF_TRIANGLES);
	if (count == 0)
		walk(child, level + 1, low, high);
}

static void walk(uint32_t node, uint32_t level, const float min[3], const float max[3])
{
	const struct bvh_node *n = &tree->nodes[node];
	assert_true(node < tree->node_count);
	if (level > deepest)
		deepest = level;
	if (!isinf(n->min0[0]))
		walk_child(n->child0, n->count0, level, n->min0, n->max0, min, max);
	if (!isinf(n->min1[0]))
		walk_child(n->child1, n->count1, level, n->min1, n->max1, min, max);
}

static void check_tree(builder *build, uint32_t count)
{
	static const float min[3] = {-INFINITY, -INFINITY, -INFINITY}, max[3] = {INFINITY, INFINITY, INFINITY};
	struct bvh bvh, again;
	struct error err;
	assert_int_equal(build(vertices, triangles, count, &bvh, &err), STATUS_OK);
	memset(seen, 0, sizeof seen);
	tree = &bvh;
	deepest = next_leaf = 0;
	walk(0, 1, min, max);
	assert_int_equal(next_leaf, count);
	assert_int_equal(deepest, bvh.depth);
	assert_true(bvh.depth <= LIMIT_BVH_DEPTH);
	assert_int_equal(build(vertices, triangles, count, &again, &err), STATUS_OK);
	assert_int_equal(again.node_count, bvh.node_count);
	assert_memory_equal(again.nodes, bvh.nodes, bvh.node_count * sizeof *bvh.nodes);
	assert_memory_equal(again.order, bvh.order, count * sizeof *bvh.order);
	bvh_finish(&again);
	bvh_finish(&bvh);
}

static void check_all(builder *build)
{
	static void (*const shapes[])(uint32_t) = {scatter, pile_up, spread_exponentially};
	static const uint32_t counts[] = {1, 2, 3, 4, 5, 6, 17, 1000, MOST};
	for (size_t s = 0; s < sizeof shapes / sizeof shapes[0]; s++)
		for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
			shapes[s](counts[i]);
			check_tree(build, counts[i]);
		}
}

static void by_heuristic(void **state)
{
	(void)state;
	check_all(bvh_build);
}

static void balanced(void **state)
{
	struct bvh bvh;
	(void)state;
	check_all(bvh_build_balanced);
	spread_exponentially(MOST);
	assert_int_equal(bvh_build_balanced(vertices, triangles, MOST, &bvh, NULL), STATUS_OK);
	assert_true(bvh.depth <= 14); // log2(20000 / 2), rounded up
	bvh_finish(&bvh);
}

static void nothing_at_all(void **state)
{
	struct bvh bvh;
	(void)state;
	assert_int_equal(bvh_build(vertices, triangles, 0, &bvh, NULL), STATUS_OK);
	assert_int_equal(bvh.node_count, 1);
	assert_int_equal(bvh.depth, 1);
	assert_true(isinf(bvh.nodes[0].min0[0]) && isinf(bvh.nodes[0].max1[2]) && bvh.nodes[0].max1[2] > 0);
	assert_int_equal(bvh.nodes[0].count0 | bvh.nodes[0].count1, 0);
	bvh_finish(&bvh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(by_heuristic),
	    cmocka_unit_test(balanced),
	    cmocka_unit_test(nothing_at_all),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
