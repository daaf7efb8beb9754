// The tree over emitters: a tree of all of them, bounds that hold what is below, trails that lead there, never too deep.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/scene/light_tree.h"

#define MOST 3000u

struct lamps {
	struct material materials[3]; // the last one shines to both sides
	struct vertex vertices[3 * MOST];
	struct triangle triangles[MOST];
	struct emitter emitters[MOST];
	struct light_node nodes[2 * MOST];
	uint32_t trails[MOST];
	uint32_t count;
	uint32_t deepest, leaves;
};

static float noise(uint32_t *state)
{
	*state = *state * 1664525u + 1013904223u;
	return (float)(*state >> 8) / 16777216.0f;
}

typedef void (*placer)(uint32_t i, uint32_t *state, float at[3]);

static void scattered(uint32_t i, uint32_t *state, float at[3])
{
	(void)i;
	for (int k = 0; k < 3; k++)
		at[k] = 20.0f * noise(state);
}

static void at_one_place(uint32_t i, uint32_t *state, float at[3])
{
	(void)i;
	(void)state;
	memset(at, 0, 3 * sizeof *at);
}

// Each twice as far out as the one before: a split in the middle of the way leaves one behind at a time.
static void ever_farther(uint32_t i, uint32_t *state, float at[3])
{
	(void)state;
	at[0] = ldexpf(1.0f, (int)(i % 60));
	at[1] = at[2] = (float)(i / 60);
}

static void fill(struct lamps *l, uint32_t count, placer place)
{
	uint32_t state = 5;
	l->count = count;
	for (uint32_t m = 0; m < 3; m++)
		l->materials[m] = (struct material){.power_density = 1.0f + 9.0f * (float)m,
						    .flags = m == 2 ? MATERIAL_EMITS_BOTH_SIDES : 0};
	for (uint32_t i = 0; i < count; i++) {
		float at[3];
		place(i, &state, at);
		for (uint32_t c = 0; c < 3; c++)
			for (int k = 0; k < 3; k++)
				l->vertices[3 * i + c].position[k] = at[k] + 0.2f * noise(&state);
		l->triangles[i] = (struct triangle){{3 * i, 3 * i + 1, 3 * i + 2}, i % 3};
		l->emitters[i].triangle = i;
	}
}

static void check_lamp(const struct lamps *l, uint32_t i, const struct light_node *n)
{
	const struct triangle *t = &l->triangles[i];
	double u[3], v[3];
	for (int k = 0; k < 3; k++) {
		for (int c = 0; c < 3; c++) {
			assert_true(l->vertices[t->vertex[c]].position[k] >= n->min[k]);
			assert_true(l->vertices[t->vertex[c]].position[k] <= n->max[k]);
		}
		u[k] = (double)l->vertices[t->vertex[1]].position[k] - (double)l->vertices[t->vertex[0]].position[k];
		v[k] = (double)l->vertices[t->vertex[2]].position[k] - (double)l->vertices[t->vertex[0]].position[k];
	}
	const double x[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
	const double length = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
	const double c = (x[0] * (double)n->axis[0] + x[1] * (double)n->axis[1] + x[2] * (double)n->axis[2]) / length;
	if (t->material == 2)
		assert_true(n->cos_spread <= -1.0f);
	else
		assert_true(c >= (double)n->cos_spread - 1e-4);
}

// Every lamp below a node is within its bounds. Returns their power.
static double check_node(struct lamps *l, uint32_t node, uint32_t trail, uint32_t depth, const uint32_t *above,
			 uint32_t above_count)
{
	const struct light_node *n = &l->nodes[node];
	uint32_t path[33];
	if (above_count > 0)
		memcpy(path, above, above_count * sizeof *path);
	path[above_count] = node;
	assert_true(depth <= 31);
	l->deepest = depth > l->deepest ? depth : l->deepest;
	if (n->child & LIGHT_LEAF) {
		const uint32_t i = n->child & ~LIGHT_LEAF;
		assert_true(i < l->count);
		assert_int_equal(l->trails[i], trail);
		l->leaves++;
		for (uint32_t a = 0; a <= above_count; a++)
			check_lamp(l, i, &l->nodes[path[a]]);
		return (double)n->power;
	}
	assert_true(n->child > node && n->child + 1 < light_tree_nodes(l->count));
	const double power = check_node(l, n->child, trail, depth + 1, path, above_count + 1) +
			     check_node(l, n->child + 1, trail | 1u << depth, depth + 1, path, above_count + 1);
	assert_true(fabs(power / (double)n->power - 1) < 1e-5);
	return power;
}

static void check(uint32_t count, placer place)
{
	struct lamps *l = calloc(1, sizeof *l);
	struct error err;
	assert_non_null(l);
	fill(l, count, place);
	assert_int_equal(
	    light_tree_build(l->materials, l->vertices, l->triangles, l->emitters, count, l->nodes, l->trails, &err),
	    STATUS_OK);
	check_node(l, 0, 0, 0, NULL, 0);
	assert_int_equal(l->leaves, count);
	print_message("%u lamps: %u levels\n", count, l->deepest);
	free(l);
}

static void every_lamp_is_a_leaf(void **state)
{
	(void)state;
	const uint32_t counts[] = {1, 2, 3, 64, MOST};
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		check(counts[i], scattered);
}

static void no_placing_makes_it_too_deep(void **state)
{
	(void)state;
	check(MOST, at_one_place);
	check(MOST, ever_farther);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(every_lamp_is_a_leaf),
	    cmocka_unit_test(no_placing_makes_it_too_deep),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
