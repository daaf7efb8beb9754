#include "server/worker/technique/radiosity/hemicube_table.h"

#include <math.h>
#include <stdlib.h>

#include "server/base/angle.h"

// ∂²/∂x∂y of it is 1 / (π (x² + y² + 1)²).
double hemicube_top_share(double x, double y)
{
	const double a = sqrt(1 + x * x), b = sqrt(1 + y * y);
	return (x / a * atan(y / a) + y / b * atan(x / b)) / (2 * PI);
}

// ∂²/∂x∂z of it is z / (π (x² + z² + 1)²).
double hemicube_side_share(double x, double z)
{
	const double c = sqrt(1 + z * z);
	return (atan(x) - atan(x / c) / c) / (2 * PI);
}

static double middle_of_top(double x, double y)
{
	const double d = x * x + y * y + 1;
	return 1 / (PI * d * d);
}

static double middle_of_side(double x, double z)
{
	const double d = x * x + z * z + 1;
	return z / (PI * d * d);
}

typedef double share_function(double a, double b);

static double rectangle(share_function *share, double a, double b, double side)
{
	return share(a + side, b + side) - share(a, b + side) - share(a + side, b) + share(a, b);
}

enum status hemicube_table_make(uint32_t pixels, bool middles, double **table, struct error *err)
{
	const uint32_t half = pixels / 2;
	const double side = 1.0 / half;
	double *t = malloc(hemicube_table_entries(pixels) * sizeof *t);
	*table = t;
	if (!t)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t y = 0; y < half; y++)
		for (uint32_t x = 0; x < half; x++) {
			const double a = x * side, b = y * side, m = 0.5 * side;
			t[y * half + x] =
			    middles ? side * side * middle_of_top(a + m, b + m) : rectangle(hemicube_top_share, a, b, side);
			t[(half + y) * half + x] = middles ? side * side * middle_of_side(a + m, b + m)
							   : rectangle(hemicube_side_share, a, b, side);
		}
	return STATUS_OK;
}

static double sum_of(const double *from, uint32_t count)
{
	double sum = 0;
	for (uint32_t i = 0; i < count; i++)
		sum += from[i];
	return sum;
}

// Round `count` numbers of the sum `all`, added up in this order, so that they sum up to `total`.
static void round_all(const double *from, uint32_t count, double all, uint64_t total, uint32_t *words)
{
	double sum = 0;
	uint64_t given = 0;
	for (uint32_t i = 0; i < count; i++) {
		sum += from[i];
		const uint64_t up_to = (uint64_t)(sum / all * (double)total + 0.5);
		words[i] = (uint32_t)(up_to - given);
		given = up_to;
	}
}

void hemicube_table_round(uint32_t pixels, const double *table, uint32_t unit, uint32_t *words)
{
	const uint32_t part = hemicube_table_entries(pixels) / 2;
	const double top = sum_of(table, part), side = sum_of(table + part, part);
	// 4 · of_top + 8 · of_side is to be a multiple of 8, and `unit` if the sum is 1.
	const uint64_t of_top = 2 * (uint64_t)(0.5 * top * unit + 0.5);
	const uint64_t all = 8 * (uint64_t)((4 * top + 8 * side) * unit / 8 + 0.5);
	round_all(table, part, top, of_top, words);
	round_all(table + part, part, side, (all - 4 * of_top) / 8, words + part);
}
