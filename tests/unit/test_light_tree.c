// The tree over lamps: a tree of all of them, bounds that hold what is below, trails that lead there, never too deep.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdbool.h>
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
	struct punctual_light lights[MOST];
	uint32_t count, light_count;
	uint32_t mixed; // 1: some lights are directional, others are not
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

// Where a light is within a node of its kind; a directional one has nothing but its direction.
static void check_light(const struct punctual_light *light, const struct light_node *n)
{
	const bool far = n->min[0] > n->max[0];
	double c = 0;
	assert_int_equal(far, light->kind == LIGHT_DIRECTIONAL);
	for (int k = 0; k < 3; k++) {
		assert_true(far || (light->position[k] >= n->min[k] && light->position[k] <= n->max[k]));
		c += (double)light->direction[k] * (double)n->axis[k];
	}
	if (light->kind == LIGHT_POINT)
		assert_true(n->cos_spread <= -1.0f);
	else
		assert_true(c >= (double)n->cos_spread - 1e-4);
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
		assert_true(i < l->count + l->light_count);
		l->leaves++;
		// The root over both kinds holds neither.
		for (uint32_t a = l->mixed; a <= above_count; a++)
			if (i < l->count)
				check_lamp(l, i, &l->nodes[path[a]]);
			else
				check_light(&l->lights[i - l->count], &l->nodes[path[a]]);
		if (i < l->count)
			assert_int_equal(l->trails[i], trail);
		return (double)n->power;
	}
	assert_true(n->child > node && n->child + 1 < light_tree_nodes(l->count + l->light_count));
	const double power = check_node(l, n->child, trail, depth + 1, path, above_count + 1) +
			     check_node(l, n->child + 1, trail | 1u << depth, depth + 1, path, above_count + 1);
	assert_true((node == 0 && l->mixed) || fabs(power / (double)n->power - 1) < 1e-5);
	return power;
}

static void check_tree(struct lamps *l)
{
	struct error err;
	const struct light_tree_lamps lamps = {
	    .materials = l->materials,
	    .vertices = l->vertices,
	    .triangles = l->triangles,
	    .emitters = l->emitters,
	    .emitter_count = l->count,
	    .lights = l->lights,
	    .light_count = l->light_count,
	    .first_light = l->count,
	};
	assert_int_equal(light_tree_build(&lamps, l->nodes, l->trails, &err), STATUS_OK);
	check_node(l, 0, 0, 0, NULL, 0);
	assert_int_equal(l->leaves, l->count + l->light_count);
	print_message("%u lamps, %u lights: %u levels\n", l->count, l->light_count, l->deepest);
	free(l);
}

static void check(uint32_t count, placer place)
{
	struct lamps *l = calloc(1, sizeof *l);
	assert_non_null(l);
	fill(l, count, place);
	check_tree(l);
}

// Lights of the kinds whose bits are in `kinds`, in turns, beside `count` emitters.
static void check_lights(uint32_t count, uint32_t light_count, uint32_t kinds)
{
	struct lamps *l = calloc(1, sizeof *l);
	uint32_t state = 9, kind = 0;
	assert_non_null(l);
	fill(l, count, scattered);
	l->light_count = light_count;
	for (uint32_t i = 0; i < light_count; i++) {
		struct punctual_light *light = &l->lights[i];
		for (kind = (kind + 1) % 3; !(kinds >> kind & 1u); kind = (kind + 1) % 3)
			;
		light->kind = kind;
		double length = 0;
		for (int k = 0; k < 3; k++) {
			light->position[k] = 20.0f * noise(&state);
			light->direction[k] = noise(&state) - 0.5f;
			light->intensity[k] = 1.0f + noise(&state);
			length += (double)light->direction[k] * (double)light->direction[k];
		}
		for (int k = 0; k < 3; k++)
			light->direction[k] /= (float)sqrt(length);
	}
	const uint32_t far = 1u << LIGHT_DIRECTIONAL;
	l->mixed = kinds & far && (count > 0 || kinds & ~far) && light_count > 1;
	check_tree(l);
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

static void lights_are_leaves_beside_emitters(void **state)
{
	(void)state;
	const uint32_t all = 1u << LIGHT_POINT | 1u << LIGHT_SPOT | 1u << LIGHT_DIRECTIONAL;
	check_lights(0, 1, 1u << LIGHT_POINT);
	check_lights(0, 5, 1u << LIGHT_DIRECTIONAL);
	check_lights(0, 9, all);
	check_lights(7, 2, 1u << LIGHT_SPOT | 1u << LIGHT_POINT);
	check_lights(700, 300, all);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(every_lamp_is_a_leaf),
	    cmocka_unit_test(no_placing_makes_it_too_deep),
	    cmocka_unit_test(lights_are_leaves_beside_emitters),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
