// What finds corners on sides: the tree finds the points that a look at all of them finds, whatever they are, and stops
// where it is told; a sort in slices is a sort.
#include "tests/unit/form_factor_check.h"

#include <stdlib.h>
#include <string.h>

#include "server/worker/technique/radiosity/corner_tree.h"
#include "server/worker/technique/radiosity/sliced_sort.h"

#define POINTS 3000u

static float points[POINTS][3];

enum kind { CLOUD, GRID, LINE, ONE_PLACE, FAR_APART, KINDS };

static void make_points(enum kind kind, uint32_t *seed)
{
	for (uint32_t i = 0; i < POINTS; i++) {
		const double far = pow(10, 12 * noise(seed) - 6);
		for (uint32_t c = 0; c < 3; c++) {
			const uint32_t cell = c == 0 ? i % 15 : c == 1 ? i / 15 % 15 : i / 225;
			points[i][c] = (float)(kind == CLOUD       ? noise(seed)
					       : kind == GRID      ? (double)cell / 15
					       : kind == LINE      ? (i * 7919u % POINTS) * 1e-3 * (c + 1)
					       : kind == ONE_PLACE ? 0.25
								   : far * (noise(seed) - 0.5));
		}
	}
}

static double off(const float at[3], const struct corner_segment *s)
{
	double to[3], square = vec3_dot(s->along, s->along), sum = 0;
	for (int c = 0; c < 3; c++)
		to[c] = (double)at[c] - s->from[c];
	const double t = square > 0 ? fmin(fmax(vec3_dot(to, s->along) / square, 0), 1) : 0;
	for (int c = 0; c < 3; c++)
		sum += (to[c] - t * s->along[c]) * (to[c] - t * s->along[c]);
	return sqrt(sum);
}

static int by_point(const void *a, const void *b)
{
	const struct corner_hit *p = a, *q = b;
	return p->point < q->point ? -1 : p->point > q->point;
}

// Points that are all but on the border of what is near may be either.
static uint32_t check_find(const struct corner_tree *tree, const struct corner_segment *s)
{
	static struct corner_hit hits[POINTS];
	uint64_t left = UINT64_MAX;
	const uint32_t found = corner_tree_find(tree, s, hits, POINTS, &left);
	assert_true(UINT64_MAX - left <= POINTS);
	qsort(hits, found, sizeof *hits, by_point);
	for (uint32_t i = 0, k = 0; i < POINTS; i++) {
		const bool is = k < found && hits[k].point == i;
		const double distance = off(points[i], s);
		assert_true(!is || distance <= s->reach * (1 + 1e-9));
		assert_true(is || distance >= s->reach * (1 - 1e-9));
		assert_true(!is || (hits[k].t >= 0 && hits[k].t <= 1));
		k += is;
	}
	// No more than asked for, and none once there is nothing left to look at.
	assert_int_equal(corner_tree_find(tree, s, hits, found / 2, &left), found / 2);
	left = 5;
	assert_true(corner_tree_find(tree, s, hits, POINTS, &left) <= 5 && left == 0);
	assert_int_equal(corner_tree_find(tree, s, hits, POINTS, &left), 0);
	return found;
}

static void the_tree_finds_what_is_there(void **state)
{
	uint32_t seed = 3;
	(void)state;
	for (enum kind kind = CLOUD; kind < KINDS; kind++) {
		struct corner_tree tree;
		uint32_t found = 0, pieces = 1;
		make_points(kind, &seed);
		assert_int_equal(corner_tree_init(&tree, (const float(*)[3])points, POINTS, NULL), STATUS_OK);
		while (!corner_tree_build(&tree, 100))
			pieces++;
		assert_true(pieces > 10);
		for (uint32_t n = 0; n < 300; n++) {
			const float *from = points[(uint32_t)(POINTS * noise(&seed))],
				    *to = points[(uint32_t)(POINTS * noise(&seed))];
			struct corner_segment s = {.reach = pow(10, -6 * noise(&seed))};
			for (int c = 0; c < 3; c++) {
				s.from[c] = (double)from[c];
				s.along[c] = n % 3 ? (n % 2 || c == 1 ? (double)to[c] - (double)from[c] : 0) : 0;
			}
			found += check_find(&tree, &s);
		}
		assert_true(found > 300);
		corner_tree_finish(&tree);
	}
}

static void a_tree_of_nothing_finds_nothing(void **state)
{
	struct corner_tree tree;
	struct corner_hit hit;
	uint64_t left = 10;
	(void)state;
	assert_int_equal(corner_tree_init(&tree, (const float(*)[3])points, 0, NULL), STATUS_OK);
	assert_true(corner_tree_build(&tree, 1));
	assert_int_equal(corner_tree_find(&tree, &(struct corner_segment){.reach = 1e30}, &hit, 1, &left), 0);
	corner_tree_finish(&tree);
}

static int by_value(const void *a, const void *b)
{
	return memcmp(a, b, 3);
}

static void a_sort_in_slices_is_a_sort(void **state)
{
	static const uint32_t counts[] = {0, 1, 2, 1023, 1024, 1025, 2048, 3000, 5000, 9217}, moves[] = {1, 700, 100000};
	static unsigned char items[9217 * 3], spare[9217 * 3], sorted[9217 * 3];
	uint32_t seed = 1;
	(void)state;
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		for (size_t k = 0; k < sizeof moves / sizeof *moves; k++) {
			struct sliced_sort sort;
			for (uint32_t n = 0; n < 3 * counts[i]; n++)
				sorted[n] = items[n] = (unsigned char)(256 * noise(&seed));
			qsort(sorted, counts[i], 3, by_value);
			sliced_sort_begin(&sort, items, spare, counts[i], 3, by_value);
			while (!sort.done)
				sliced_sort_step(&sort, moves[k]);
			assert_true(sort.items == items || sort.items == spare);
			assert_memory_equal(sort.items, sorted, 3 * counts[i]);
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(the_tree_finds_what_is_there),
	    cmocka_unit_test(a_tree_of_nothing_finds_nothing),
	    cmocka_unit_test(a_sort_in_slices_is_a_sort),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
