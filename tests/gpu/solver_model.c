#include "tests/gpu/solver_model.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>
#include <lapacke.h>

static uint32_t seed = 1;

void model_seed(uint32_t value)
{
	seed = value;
}

uint32_t model_draw(void)
{
	seed = seed * 747796405u + 2891336453u;
	const uint32_t word = ((seed >> ((seed >> 28) + 4)) ^ seed) * 277803737u;
	return word >> 22 ^ word;
}

double model_draw_unit(void)
{
	return (double)model_draw() * 0x1p-32;
}

struct system system_make(uint32_t count)
{
	struct system s = {.count = count};
	s.matrix = calloc((size_t)count * count + 1, sizeof *s.matrix);
	s.exitance = calloc(3 * (size_t)count + 1, sizeof *s.exitance);
	s.albedo = calloc(3 * (size_t)count + 1, sizeof *s.albedo);
	s.irradiance = calloc(3 * (size_t)count + 1, sizeof *s.irradiance);
	s.area = calloc((size_t)count + 1, sizeof *s.area);
	assert_true(s.matrix && s.exitance && s.albedo && s.irradiance && s.area);
	for (uint32_t i = 0; i < count; i++)
		s.area[i] = 1;
	return s;
}

void system_free(struct system *s)
{
	free(s->matrix);
	free(s->exitance);
	free(s->albedo);
	free(s->irradiance);
	free(s->area);
}

void system_add_sphere(struct system *s, uint32_t first, uint32_t count)
{
	double all = 0;
	for (uint32_t i = first; i < first + count; i++) {
		s->area[i] = (float)(0.1 + model_draw_unit());
		all += (double)s->area[i];
	}
	for (uint32_t i = first; i < first + count; i++)
		for (uint32_t j = first; j < first + count; j++)
			s->matrix[(size_t)i * s->count + j] = (float)((double)s->area[j] / all);
}

void system_fill(struct system *s, uint32_t sparse, double most)
{
	const uint32_t n = s->count;
	double *fluxes = calloc((size_t)n * n, sizeof *fluxes), largest = 0;
	assert_non_null(fluxes);
	for (uint32_t i = 0; i < n; i++)
		s->area[i] = (float)exp(4 * model_draw_unit());
	for (uint32_t i = 0; i < n; i++)
		for (uint32_t j = 0; j < i; j++)
			if (model_draw() % sparse == 0)
				fluxes[(size_t)i * n + j] = fluxes[(size_t)j * n + i] =
				    model_draw_unit() * (double)(s->area[i] * s->area[j]);
	for (uint32_t i = 0; i < n; i++) {
		double sum = 0;
		for (uint32_t j = 0; j < n; j++)
			sum += fluxes[(size_t)i * n + j];
		largest = fmax(largest, sum / (double)s->area[i]);
	}
	for (uint32_t i = 0; i < n; i++) {
		for (uint32_t j = 0; j < n; j++)
			s->matrix[(size_t)i * n + j] =
			    (float)(0.95 * fluxes[(size_t)i * n + j] / largest / (double)s->area[i]);
		for (uint32_t c = 0; c < 3; c++) {
			s->albedo[3 * i + c] = model_draw() % 5 == 0 ? 0 : (float)(most * model_draw_unit());
			s->exitance[3 * i + c] = model_draw() % 8 == 0 ? (float)((c + 1) * 100 * model_draw_unit()) : 0;
			s->irradiance[3 * i + c] = model_draw() % 3 == 0 ? (float)((c + 1) * model_draw_unit()) : 0;
		}
	}
	free(fluxes);
}

void system_put(const struct system *s, struct device *device, uint32_t block_entries, struct factors *factors)
{
	struct error err;
	uint32_t *columns = malloc((s->count + 1) * sizeof *columns);
	float *values = malloc((s->count + 1) * sizeof *values);
	assert_true(columns && values);
	assert_int_equal(factors_init(factors, device, s->count, &err), STATUS_OK);
	if (block_entries)
		factors->block_entries = block_entries;
	for (uint32_t i = 0; i < s->count; i++) {
		const struct factors_put row = {.element = i};
		uint32_t n = 0;
		for (uint32_t j = 0; j < s->count; j++)
			if (s->matrix[(size_t)i * s->count + j] != 0) {
				columns[n] = j;
				values[n++] = s->matrix[(size_t)i * s->count + j];
			}
		// A row without entries is as good as one that was never put.
		if (n > 0)
			assert_int_equal(factors_put_row(factors, &row, columns, values, n, &err), STATUS_OK);
	}
	free(columns);
	free(values);
}

void system_solve(const struct system *s, double *irradiance)
{
	const uint32_t n = s->count;
	double *a = malloc((size_t)n * n * sizeof *a), *h = malloc(n * sizeof *h);
	lapack_int *pivots = malloc(n * sizeof *pivots);
	assert_true(a && h && pivots);
	for (uint32_t c = 0; c < 3; c++) {
		for (uint32_t i = 0; i < n; i++) {
			h[i] = (double)s->irradiance[3 * i + c];
			for (uint32_t j = 0; j < n; j++) {
				const double f = (double)s->matrix[(size_t)i * n + j];
				h[i] += f * (double)s->exitance[3 * j + c];
				a[(size_t)i * n + j] = (i == j ? 1 : 0) - f * (double)s->albedo[3 * j + c];
			}
		}
		assert_int_equal(LAPACKE_dgesv(LAPACK_ROW_MAJOR, (lapack_int)n, 1, a, (lapack_int)n, pivots, h, 1), 0);
		for (uint32_t i = 0; i < n; i++)
			irradiance[3 * i + c] = h[i];
	}
	free(a);
	free(h);
	free(pivots);
}

struct solved system_run(const struct system *s, const struct factors *factors, struct device *device, enum solver_way way,
			 double residual, uint32_t iterations, uint32_t budget_us)
{
	struct solved out = {0};
	struct solver *solver;
	const struct solver_problem problem = {.factors = factors,
					       .exitance = s->exitance,
					       .albedo = s->albedo,
					       .irradiance = s->irradiance,
					       .area = s->area,
					       .way = way,
					       .residual = residual,
					       .iterations = iterations};
	out.status = solver_create(&problem, device, &solver, &out.err);
	if (out.status != STATUS_OK)
		return out;
	while (out.status == STATUS_OK && !solver_finished(solver))
		out.status = solver_step(solver, budget_us, &out.err);
	out.iterations = solver_iterations(solver);
	out.residual = solver_residual(solver);
	out.irradiance = malloc((3ull * s->count + 1) * sizeof *out.irradiance);
	assert_non_null(out.irradiance);
	if (out.status == STATUS_OK)
		assert_int_equal(solver_read(solver, out.irradiance, &out.err), STATUS_OK);
	solver_destroy(solver);
	return out;
}

double system_error(const struct system *s, const float *found, const double *right)
{
	double worst = 0;
	for (uint32_t i = 0; i < 3 * s->count; i++) {
		const double m = (double)s->exitance[i], rho = (double)s->albedo[i];
		const double b = m + rho * right[i];
		if (b > 0)
			worst = fmax(worst, fabs(m + rho * (double)found[i] - b) / b);
	}
	return worst;
}
