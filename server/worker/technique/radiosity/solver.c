#include "server/worker/technique/radiosity/solver.h"

#include <math.h>
#include <stdlib.h>

#include "server/base/clock.h"
#include "server/worker/technique/radiosity/solver_parts.h"
#include "server/worker/vk/command.h"

// What light loses in a bounce at least where it loses any: less than this is rounding of the sum of a row.
#define ABOUT_NOTHING 1e-6
#define TESTS_OF_ALL 4u // bounces after which it is asked where light is at all
#define TESTS_MOST 100u // bounces after which light that is not less than at first will never be
#define GROWS_TO 1e8 // times the light of the first bounce: it has no end
#define FLOATS_SHOW 3e-7 // of e: a smaller change of it is rounding
#define STALLS_MOST 3u // outer steps without success before the residual is left as it is
#define SUCCESS 0.5 // times the residual of the outer step before

static const double ones[4] = {1, 1, 1, 1};

// ---- begin and end
// --------------------------------------------------------------------------------------------------------

static bool all_finite(const float *of, uint64_t count)
{
	for (uint64_t i = 0; i < count; i++)
		if (!isfinite(of[i]) || of[i] < 0)
			return false;
	return true;
}

static enum status check_problem(const struct solver_problem *p, struct error *err)
{
	const uint64_t count = 3ull * p->factors->side;
	if (!all_finite(p->exitance, count) || !all_finite(p->albedo, count) || !all_finite(p->irradiance, count) ||
	    !all_finite(p->area, p->factors->side) || (p->start && !all_finite(p->start, count)))
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "some surface's emission, reflectance, light or area is negative or no number");

	return STATUS_OK;
}

enum status solver_create(const struct solver_problem *problem, struct device *device, struct solver **solver,
			  struct error *err)
{
	enum status status = check_problem(problem, err);
	if (status != STATUS_OK)
		return status;
	struct solver *s = calloc(1, sizeof *s);
	if (!s)
		return error_set(err, STATUS_MEMORY, "out of memory");
	s->device = device;
	s->factors = problem->factors;
	s->count = problem->factors->side;
	s->way = problem->way;
	s->target = problem->residual;
	s->limit = problem->start ? 1 : problem->iterations;
	s->parts = s->way == SOLVER_GAUSS_SEIDEL ? SOLVER_PARTS : 1;
	s->stage = s->count == 0 ? SOLVER_DONE : problem->start ? SOLVER_OUTER : SOLVER_TEST;
	s->told = s->count == 0 ? 0 : 1;
	for (int c = 0; c < 3; c++)
		s->scale[c] = 1;
	if (s->count > 0)
		status = solver_device_init(s, problem, err);
	if (status != STATUS_OK) {
		solver_destroy(s);
		return status;
	}
	*solver = s;
	return STATUS_OK;
}

void solver_destroy(struct solver *s)
{
	if (!s)
		return;
	solver_device_finish(s);
	free(s);
}

bool solver_finished(const struct solver *s)
{
	return s->stage == SOLVER_DONE;
}

double solver_residual(const struct solver *s)
{
	return s->told;
}

uint32_t solver_iterations(const struct solver *s)
{
	return s->iterations;
}

enum status solver_read(const struct solver *s, float *irradiance, struct error *err)
{
	const uint64_t bytes = s->count * 4ull * sizeof(float);
	if (s->count == 0)
		return STATUS_OK;
	float *field = malloc(2 * bytes), *more = malloc(bytes);
	enum status status = field && more ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	if (status == STATUS_OK)
		status = buffer_read(&s->field, s->device, 0, 2 * bytes, field, err);
	if (status == STATUS_OK)
		status = buffer_read(s->extra ? &s->change : &s->residual, s->device, 0, bytes, more, err);
	for (uint64_t i = 0; status == STATUS_OK && i < s->count; i++)
		for (uint64_t c = 0; c < 3; c++) {
			const double unit = s->extra ? 1 / s->scale[c] : 1;
			const double h =
			    (double)field[8 * i + c] + ((double)field[8 * i + 4 + c] + unit * (double)more[4 * i + c]);
			irradiance[3 * i + c] = (float)fmax(h, 0);
		}
	free(field);
	free(more);
	return status;
}

enum status solver_read_residual(const struct solver *s, float *residual, struct error *err)
{
	const uint64_t bytes = s->count * 4ull * sizeof(float);
	if (s->count == 0)
		return STATUS_OK;
	float *lacks = malloc(bytes), *albedo = malloc(bytes);
	enum status status = lacks && albedo ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	if (status == STATUS_OK)
		status = buffer_read(&s->residual, s->device, 0, bytes, lacks, err);
	if (status == STATUS_OK)
		status = buffer_read(&s->albedo, s->device, 0, bytes, albedo, err);
	for (uint64_t i = 0; status == STATUS_OK && i < s->count; i++)
		for (uint64_t c = 0; c < 3; c++)
			residual[3 * i + c] = -albedo[4 * i + c] * lacks[4 * i + c];
	free(lacks);
	free(albedo);
	return status;
}

// ---- is there a solution
// --------------------------------------------------------------------------------------------------

static enum status no_solution(struct error *err)
{
	return error_set(
	    err, STATUS_BAD_ARGUMENT,
	    "light in some room of the scene that nothing leaves does not become less from bounce to bounce, "
	    "because reflectance times the sum of form factors is 1 or more there: radiosity has no solution; make "
	    "reflectances smaller");
}

// Powers of ρ F of a vector of ones. If one of them has all elements below 1, or below the power before it, the series of
// bounces converges (a bound of the spectral radius: Collatz 1942, "Einschließungssatz für die charakteristischen Zahlen von
// Matrizen"). In a room that nothing leaves and whose reflectance is 1 they stay 1. If no light is there, as in a closed
// white body under a sky, that is no harm: so where they do not soon fall it is found, element by element, where light
// arrives, and the powers are those of ones there and zeros elsewhere. No element that light reaches sees one that it does
// not.
static enum status begin_test(struct solver *s, uint32_t with, struct error *err)
{
	const double what[4] = {0, 0, 0, with};
	enum status status = command_begin(s->device, err);
	if (status != STATUS_OK)
		return status;
	s->tests = 0;
	s->passed = 0;
	s->testing = with == TEST_ONES ? TEST_POWER : TEST_REACHED;
	solver_record_step(s, STEP_TEST, 0, s->count, what);
	return command_finish(s->device, err);
}

// A look at where light arrives is done: go on until it arrives nowhere else.
static void reached_done(struct solver *s)
{
	bool news = false;
	for (int c = 0; c < 3; c++)
		news = news || solver_maximum(s, 0, c) > 0;
	if (!news)
		s->testing = TEST_POWER;
}

static enum status power_done(struct solver *s, struct error *err)
{
	bool grows = false;
	for (int c = 0; c < 3; c++) {
		const double most = solver_maximum(s, 0, c), times = solver_maximum(s, 1, c);
		grows = grows || !(most < GROWS_TO);
		if (most < 1 - ABOUT_NOTHING * (s->tests + 1) || times < 1 - ABOUT_NOTHING)
			s->passed |= 1u << c;
	}
	s->tests++;
	if (!grows && s->passed == 7) {
		s->stage = SOLVER_OUTER;
		return buffer_clear(&s->change, s->device, err);
	}
	if (!s->lit && (grows || s->tests == TESTS_OF_ALL)) {
		s->lit = true;
		return begin_test(s, TEST_LIT, err);
	}
	return grows || s->tests == TESTS_MOST ? no_solution(err) : STATUS_OK;
}

static enum status test(struct solver *s, uint32_t budget_us, struct error *err)
{
	bool done;
	enum status status = STATUS_OK;
	if (s->testing == TEST_ONES)
		status = begin_test(s, TEST_ONES, err);
	const double what[4] = {0, 0, 0, s->testing};
	if (status == STATUS_OK)
		status = solver_sweep(s, false, STEP_COUNT, STEP_TEST, what, budget_us, &done, err);
	if (status != STATUS_OK || !done)
		return status;
	s->iterations = 0; // this was none
	if (s->testing == TEST_POWER)
		return power_done(s, err);
	reached_done(s);
	return STATUS_OK;
}

// ---- the outer step
// -------------------------------------------------------------------------------------------------------

// A power of two by which r is about 1 at most, so that scaling rounds nothing.
static double unit_of(double most)
{
	int exponent;
	(void)frexp(most, &exponent);
	return most > 0 ? ldexp(1, exponent > 120 ? -120 : exponent < -120 ? 120 : -exponent) : 1;
}

static enum status begin_inner(struct solver *s, struct error *err)
{
	const bool relaxes = s->way != SOLVER_GRADIENT;
	double scale[4] = {0};
	for (int c = 0; c < 3; c++)
		scale[c] = s->scale[c] = unit_of(solver_maximum(s, 2, c));
	scale[3] = relaxes;
	s->stage = relaxes ? SOLVER_RELAX : SOLVER_AIM;
	s->extra = true;
	s->gradients = 0;
	enum status status = command_begin(s->device, err);
	if (status != STATUS_OK)
		return status;
	solver_record_step(s, STEP_START, 0, s->count, scale);
	return command_finish(s->device, err);
}

static enum status outer_done(struct solver *s, struct error *err)
{
	double residual = 0;
	s->extra = false;
	for (int c = 0; c < 3; c++) {
		const double by = solver_maximum(s, 1, c);
		s->bright[c] = fmax(solver_maximum(s, 0, c), by);
		if (!isfinite(s->bright[c]))
			return no_solution(err);
		if (by > 0)
			residual = fmax(residual, by / s->bright[c]);
	}
	if (s->outer > 0 && residual > SUCCESS * s->outer) {
		s->stalled++;
		if (s->way == SOLVER_GRADIENT)
			s->way = SOLVER_JACOBI;
	}
	s->outer = residual;
	s->told = residual;
	if (residual <= s->target || s->iterations >= s->limit || s->stalled >= STALLS_MOST) {
		s->stage = SOLVER_DONE;
		return STATUS_OK;
	}
	return begin_inner(s, err);
}

static enum status outer(struct solver *s, uint32_t budget_us, struct error *err)
{
	bool done;
	const double back[4] = {1 / s->scale[0], 1 / s->scale[1], 1 / s->scale[2], 0};
	const enum status status = solver_sweep(s, true, STEP_FOLD, STEP_RESIDUAL, back, budget_us, &done, err);
	return status == STATUS_OK && done ? outer_done(s, err) : status;
}

// ---- the inner iteration
// --------------------------------------------------------------------------------------------------

// After an iteration, with the change of ρ e and its size in the maxima.
static enum status inner_done(struct solver *s, bool stuck, struct error *err)
{
	bool enough = true;
	double told = 0;
	for (int c = 0; c < 3; c++) {
		const double by = solver_maximum(s, 0, c), size = solver_maximum(s, 1, c);
		const double bright = s->bright[c] * s->scale[c] + size;
		if (!(by < GROWS_TO))
			return no_solution(err);
		enough = enough && by <= fmax(0.5 * s->target * bright, FLOATS_SHOW * size);
		if (by > 0)
			told = fmax(told, by / bright);
	}
	s->told = told;
	if (s->iterations >= s->limit)
		s->stage = SOLVER_DONE;
	else if (enough || stuck)
		s->stage = SOLVER_OUTER;
	return STATUS_OK;
}

static enum status relax(struct solver *s, uint32_t budget_us, struct error *err)
{
	bool done;
	const enum status status = solver_sweep(s, false, STEP_COUNT, STEP_RELAX, ones, budget_us, &done, err);
	return status == STATUS_OK && done ? inner_done(s, false, err) : status;
}

static enum status gradient(struct solver *s, uint32_t budget_us, struct error *err)
{
	bool done, stuck;
	enum status status = solver_sweep(s, false, STEP_COUNT, STEP_TURN, ones, budget_us, &done, err);
	if (status != STATUS_OK || !done)
		return status;
	status = solver_gradient(s, &stuck, err);
	return status == STATUS_OK ? inner_done(s, stuck, err) : status;
}

static enum status piece(struct solver *s, uint32_t budget_us, struct error *err)
{
	switch (s->stage) {
	case SOLVER_TEST:
		return test(s, budget_us, err);
	case SOLVER_OUTER:
		return outer(s, budget_us, err);
	case SOLVER_RELAX:
		return relax(s, budget_us, err);
	case SOLVER_AIM:
		return gradient(s, budget_us, err);
	default:
		return STATUS_OK;
	}
}

enum status solver_step(struct solver *s, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	uint64_t spent = 0;
	enum status status;
	do {
		status = piece(s, (uint32_t)(budget_us > spent ? budget_us - spent : 0), err);
		spent = clock_us() - start;
	} while (status == STATUS_OK && s->stage != SOLVER_DONE && spent < budget_us);
	return status;
}
