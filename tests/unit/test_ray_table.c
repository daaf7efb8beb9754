// The tables of rays: how evenly their points lie, that all cells have one area, and that neighbours are near each other.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/worker/technique/radiosity/ray_table.h"

// Whether each of 2^m boxes, 2^bits[d] along axis d, has exactly one of 2^m points.
static bool one_in_each(const struct table_ray *rays, uint32_t m, const uint32_t bits[4])
{
	uint8_t *seen = calloc(1u << m, 1);
	bool even = true;
	assert_non_null(seen);
	for (uint32_t i = 0; i < 1u << m; i++) {
		uint32_t box = 0;
		for (int d = 0; d < 4; d++)
			box = bits[d] ? box << bits[d] | rays[i].word[d] >> (32 - bits[d]) : box;
		even &= !seen[box]++;
	}
	free(seen);
	return even;
}

// Sobol' 1967: the first two dimensions are a (0, m, 2)-net, each by itself is even.
static void points_are_even(void **state)
{
	const uint32_t m = 10;
	struct table_ray *rays;
	(void)state;
	assert_int_equal(ray_table_sobol(1u << m, &rays, NULL), STATUS_OK);
	for (uint32_t d = 0; d < 4; d++) {
		uint32_t bits[4] = {0};
		bits[d] = m;
		assert_true(one_in_each(rays, m, bits));
	}
	for (uint32_t k = 0; k <= m; k++)
		assert_true(one_in_each(rays, m, (const uint32_t[4]){k, m - k}));
	assert_true(one_in_each(rays, m, (const uint32_t[4]){0, 0, 5, 5}) ||
		    one_in_each(rays, m, (const uint32_t[4]){0, 0, 4, 6}));
	free(rays);
}

// The direction that a ray of 3072 has beside its neighbours: eight cover an area of about eight of 3072 parts.
static void neighbours_are_near(void **state)
{
	const uint32_t count = 3072;
	double sum = 0;
	struct table_ray *rays;
	(void)state;
	assert_int_equal(ray_table_sobol(count, &rays, NULL), STATUS_OK);
	for (uint32_t i = 0; i < count; i += 8) {
		double low[2] = {1, 1}, high[2] = {0, 0};
		for (uint32_t k = 0; k < 8; k++)
			for (int d = 0; d < 2; d++) {
				low[d] = fmin(low[d], rays[i + k].word[d] / 4294967296.0);
				high[d] = fmax(high[d], rays[i + k].word[d] / 4294967296.0);
			}
		sum += (high[0] - low[0]) * (high[1] - low[1]);
	}
	assert_true(sum < 1.5);
	free(rays);
}

static double float_of(uint32_t word)
{
	float f;
	memcpy(&f, &word, sizeof f);
	return (double)f;
}

// Of n cells of area π/n, those within the radius r have the area π r², up to the ring that r is in.
static void cells_have_one_area(void **state)
{
	static const uint32_t counts[] = {1, 2, 3, 4, 7, 100, 3072, 49512};
	(void)state;
	for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
		const uint32_t n = counts[k];
		double mean[2] = {0, 0}, square = 0;
		struct table_ray *rays;
		assert_int_equal(ray_table_cells(n, &rays, NULL), STATUS_OK);
		for (uint32_t i = 0; i < n; i++) {
			const double x = float_of(rays[i].word[0]), y = float_of(rays[i].word[1]);
			mean[0] += x / n;
			mean[1] += y / n;
			square += (x * x + y * y) / n;
			assert_true(x * x + y * y < 1);
			assert_true(rays[i].word[2] == 0 && rays[i].word[3] == 0);
		}
		assert_true(fabs(mean[0]) < 1e-6 && fabs(mean[1]) < 1e-6);
		// Each ring's middle is at half of its area, so ∫ r² of the disc is exact but for a lone cell in the middle.
		assert_true(fabs(square - 0.5) <= 1.0 / ((double)n * n) + 1e-7);
		free(rays);
	}
}

// The least distance between middles of cells is near that of squares: no needles.
static void cells_are_about_square(void **state)
{
	const uint32_t n = 1000;
	const double side = sqrt(PI / n);
	struct table_ray *rays;
	(void)state;
	assert_int_equal(ray_table_cells(n, &rays, NULL), STATUS_OK);
	for (uint32_t i = 0; i < n; i++)
		for (uint32_t j = 0; j < i; j++) {
			const double x = float_of(rays[i].word[0]) - float_of(rays[j].word[0]);
			const double y = float_of(rays[i].word[1]) - float_of(rays[j].word[1]);
			assert_true(sqrt(x * x + y * y) > 0.7 * side);
		}
	free(rays);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(points_are_even), cmocka_unit_test(neighbours_are_near),
					   cmocka_unit_test(cells_have_one_area), cmocka_unit_test(cells_are_about_square)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
