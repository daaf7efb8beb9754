#include "server/worker/technique/radiosity/residual.h"

#include <math.h>
#include <stdlib.h>

#include "server/worker/technique/radiosity/solver.h"

struct residual {
	const struct solution *solution;
	struct solver *solver; // until it is finished
	float *values;
	float most;
};

enum status residual_create(const struct solution *solution, struct residual **residual, struct error *err)
{
	const size_t count = solution->factors->elements.count;
	struct residual *r = calloc(1, sizeof *r);
	if (!r)
		return error_set(err, STATUS_MEMORY, "out of memory");
	r->solution = solution;
	r->values = calloc(3 * count + 1, sizeof *r->values);
	enum status s = r->values ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	if (s == STATUS_OK && count > 0)
		s = solution_create_solver(solution, solution->irradiance, &r->solver, err);
	if (s == STATUS_OK)
		*residual = r;
	else
		residual_destroy(r);
	return s;
}

void residual_destroy(struct residual *r)
{
	if (!r)
		return;
	solver_destroy(r->solver);
	free(r->values);
	free(r);
}

bool residual_finished(const struct residual *r)
{
	return !r->solver;
}

// The matrix may have rows that light of other requests has reached: there this solution knows of no light.
static void take_magnitude(struct residual *r)
{
	for (uint32_t i = 0; i < r->solution->factors->elements.count; i++)
		for (uint32_t c = 0; c < 3; c++) {
			float *value = &r->values[3 * (size_t)i + c];
			*value = r->solution->reached[i] ? fabsf(*value) : 0;
			r->most = fmaxf(r->most, *value);
		}
}

enum status residual_step(struct residual *r, uint32_t budget_us, struct error *err)
{
	if (residual_finished(r))
		return STATUS_OK;
	enum status s = solver_step(r->solver, budget_us, err);
	if (s != STATUS_OK || !solver_finished(r->solver))
		return s;
	s = solver_read_residual(r->solver, r->values, err);
	if (s != STATUS_OK)
		return s;
	take_magnitude(r);
	solver_destroy(r->solver);
	r->solver = NULL;
	return STATUS_OK;
}

const float *residual_values(const struct residual *r)
{
	return r->values;
}

double residual_most(const struct residual *r)
{
	return (double)r->most;
}
