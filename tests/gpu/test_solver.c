// The solvers of radiosity against closed forms and LU decomposition, and each other; what they refuse; and that slices and
// the matrix's blocks change no bit.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/worker/devices.h"
#include "server/worker/vk/device.h"
#include "tests/gpu/solver_model.h"

#define SKIPPED 77
#define WAYS 3
#define RIGHT 1e-6 // relative error

static const char *const names[WAYS] = {"Jacobi", "Gauss-Seidel", "gradient"};
static struct device *device;
static struct error err;

static void paint(struct system *s, uint32_t first, uint32_t end, float albedo, float exitance)
{
	for (uint32_t i = 3 * first; i < 3 * end; i++) {
		s->albedo[i] = albedo;
		s->exitance[i] = exitance;
	}
}

static void a_closed_sphere_is_right(void **state)
{
	(void)state;
	static const float albedos[3] = {0.5f, 0.9f, 0.99f};
	struct system s = system_make(300);
	struct factors f;
	double right[900];
	system_add_sphere(&s, 0, 300);
	system_put(&s, device, 0, &f);
	for (int a = 0; a < 3; a++)
		for (int way = 0; way < WAYS; way++) {
			const double rho = (double)albedos[a], b = 3 / (1 - rho);
			paint(&s, 0, 300, albedos[a], 3);
			for (int i = 0; i < 900; i++)
				right[i] = b; // of a sphere H = B
			struct solved r = system_run(&s, &f, device, (enum solver_way)way, 1e-9, 10000, 100000);
			const double error = system_error(&s, r.irradiance, right);
			printf("%s, ρ %.2f: error %.2g, residual %.2g, %u products\n", names[way], rho, error, r.residual,
			       r.iterations);
			assert_int_equal(r.status, STATUS_OK);
			assert_true(r.residual <= 1e-9);
			assert_true(error <= RIGHT);
			free(r.irradiance);
		}
	factors_finish(&f);
	system_free(&s);
}

// Solve in all ways, and hold each to what is right.
static void check_ways(const struct system *s, uint32_t block_entries, const char *what)
{
	struct factors f;
	double *right = malloc(3ull * s->count * sizeof *right);
	assert_non_null(right);
	system_solve(s, right);
	system_put(s, device, block_entries, &f);
	for (int way = 0; way < WAYS; way++) {
		struct solved r = system_run(s, &f, device, (enum solver_way)way, 1e-9, 20000, 100000);
		assert_int_equal(r.status, STATUS_OK);
		const double error = system_error(s, r.irradiance, right);
		printf("%s, %s: error %.2g, residual %.2g, %u products\n", what, names[way], error, r.residual,
		       r.iterations);
		assert_true(r.residual <= 1e-9);
		assert_true(error <= RIGHT);
		free(r.irradiance);
	}
	factors_finish(&f);
	free(right);
}

static void reciprocal_matrices_are_solved_as_by_lu(void **state)
{
	(void)state;
	model_seed(3);
	struct system s = system_make(333);
	system_fill(&s, 10, 0.95);
	check_ways(&s, 0, "reciprocal");
	check_ways(&s, 5000, "in many blocks");
	system_fill(&s, 2, 1);
	check_ways(&s, 0, "dense, ρ up to 1");
	system_free(&s);
}

static void sampled_matrices_are_solved_as_by_lu(void **state)
{
	(void)state;
	model_seed(4);
	struct system s = system_make(300);
	system_fill(&s, 3, 0.9);
	for (uint32_t i = 0; i < 300 * 300; i++)
		s.matrix[i] *= (float)(0.3 + 1.4 * model_draw_unit());
	check_ways(&s, 0, "noisy");
	// Far from symmetric: what is below the diagonal does not see what sees it.
	for (uint32_t i = 0; i < 300; i++)
		for (uint32_t j = 0; j < i; j++)
			s.matrix[(size_t)i * 300 + j] *= model_draw() % 4 == 0;
	check_ways(&s, 0, "one-sided");
	system_free(&s);
}

static void a_dark_room_stays_dark(void **state)
{
	(void)state;
	struct system s = system_make(200);
	struct factors f;
	system_add_sphere(&s, 0, 100);
	system_add_sphere(&s, 100, 100);
	paint(&s, 0, 100, 0.9f, 1e6f);
	paint(&s, 100, 200, 0.9f, 0);
	system_put(&s, device, 0, &f);
	for (int way = 0; way < WAYS; way++) {
		struct solved r = system_run(&s, &f, device, (enum solver_way)way, 1e-6, 1000, 100000);
		assert_int_equal(r.status, STATUS_OK);
		for (uint32_t i = 0; i < 600; i++)
			assert_true(i < 300 ? fabs((double)r.irradiance[i] / 1e7 - 1) < 1e-5 : r.irradiance[i] == 0);
		free(r.irradiance);
	}
	factors_finish(&f);
	system_free(&s);
}

static void slices_and_blocks_change_no_bit(void **state)
{
	(void)state;
	model_seed(5);
	struct system s = system_make(400);
	struct factors whole, cut;
	system_fill(&s, 3, 0.9);
	system_put(&s, device, 0, &whole);
	system_put(&s, device, 1600, &cut);
	assert_true(whole.block_count == 1 && cut.block_count > 20);
	for (int way = 0; way < WAYS; way++) {
		struct solved a = system_run(&s, &whole, device, (enum solver_way)way, 1e-7, 1000, 10000000);
		const uint32_t budgets[2] = {0, 300};
		for (int k = 0; k < 3; k++) {
			struct solved b = system_run(&s, k == 2 ? &cut : &whole, device, (enum solver_way)way, 1e-7, 1000,
						     k < 2 ? budgets[k] : 1000);
			assert_int_equal(b.status, STATUS_OK);
			assert_int_equal(a.iterations, b.iterations);
			assert_memory_equal(&a.residual, &b.residual, sizeof a.residual);
			assert_memory_equal(a.irradiance, b.irradiance, 1200 * sizeof(float));
			free(b.irradiance);
		}
		free(a.irradiance);
	}
	factors_finish(&whole);
	factors_finish(&cut);
	system_free(&s);
}

static void what_is_black_or_dark_is_right(void **state)
{
	(void)state;
	model_seed(6);
	struct system s = system_make(120);
	system_fill(&s, 3, 0.8);
	memset(s.exitance, 0, 360 * sizeof(float));
	check_ways(&s, 0, "no emission");
	memset(s.albedo, 0, 360 * sizeof(float));
	struct factors f;
	system_put(&s, device, 0, &f);
	for (int way = 0; way < WAYS; way++) {
		// Nothing reflects, nothing shines: what comes is what is told, to the bit.
		struct solved r = system_run(&s, &f, device, (enum solver_way)way, 1e-6, 100, 100000);
		assert_int_equal(r.status, STATUS_OK);
		assert_true(r.residual == 0 && r.iterations == 1);
		assert_memory_equal(r.irradiance, s.irradiance, 360 * sizeof(float));
		free(r.irradiance);
	}
	factors_finish(&f);
	system_fill(&s, 3, 0);
	check_ways(&s, 0, "black");
	memset(s.exitance, 0, 360 * sizeof(float));
	memset(s.irradiance, 0, 360 * sizeof(float));
	system_put(&s, device, 0, &f);
	struct solved r = system_run(&s, &f, device, SOLVER_GRADIENT, 1e-6, 100, 100000);
	assert_true(r.status == STATUS_OK && r.residual == 0);
	for (int i = 0; i < 360; i++)
		assert_true(r.irradiance[i] == 0);
	free(r.irradiance);
	factors_finish(&f);
	system_free(&s);
}

static void any_unit_of_light_and_length_will_do(void **state)
{
	(void)state;
	for (int power = -30; power <= 30; power += 20) {
		model_seed(7);
		struct system s = system_make(150);
		system_fill(&s, 3, 0.9);
		for (int i = 0; i < 450; i++) {
			const float unit = i % 3 == 0 ? 1 : ldexpf(1, power);
			s.exitance[i] *= unit;
			s.irradiance[i] *= unit;
		}
		for (int i = 0; i < 150; i++)
			s.area[i] *= ldexpf(1, power);
		check_ways(&s, 0, "scaled");
		system_free(&s);
	}
}

static enum status status_of(const struct system *s, struct error *why)
{
	struct factors f;
	enum status status = STATUS_OK;
	system_put(s, device, 0, &f);
	for (int way = 0; way < WAYS; way++) {
		struct solved r = system_run(s, &f, device, (enum solver_way)way, 1e-6, 100000, 1000000);
		if (way > 0)
			assert_int_equal(r.status, status);
		status = r.status;
		*why = r.err;
		free(r.irradiance);
	}
	factors_finish(&f);
	return status;
}

static void a_closed_room_without_absorption_is_refused(void **state)
{
	(void)state;
	struct system s = system_make(80);
	system_add_sphere(&s, 0, 40);
	system_add_sphere(&s, 40, 40);
	paint(&s, 0, 80, 0.5f, 1);
	paint(&s, 40, 80, 1, 1);
	assert_int_equal(status_of(&s, &err), STATUS_BAD_ARGUMENT);
	assert_non_null(strstr(err.text, "reflectance"));
	// In one channel alone, and be there next to no light; but not where there is none at all.
	paint(&s, 0, 80, 0.5f, 0);
	s.exitance[1] = 1;
	for (uint32_t i = 40; i < 80; i++)
		s.albedo[3 * i + 1] = 1;
	assert_int_equal(status_of(&s, &err), STATUS_OK);
	s.irradiance[3 * 60 + 2] = 1;
	assert_int_equal(status_of(&s, &err), STATUS_OK);
	s.irradiance[3 * 60 + 1] = 1e-20f;
	assert_int_equal(status_of(&s, &err), STATUS_BAD_ARGUMENT);
	s.irradiance[3 * 60 + 1] = s.irradiance[3 * 60 + 2] = 0;
	s.exitance[3 * 79 + 1] = 1e-20f;
	assert_int_equal(status_of(&s, &err), STATUS_BAD_ARGUMENT);
	// Factors that are too large do it, too.
	paint(&s, 0, 80, 0.5f, 1);
	for (uint32_t i = 0; i < 80 * 80; i++)
		s.matrix[i] *= 2.1f;
	assert_int_equal(status_of(&s, &err), STATUS_BAD_ARGUMENT);
	// Rounding that makes every row a little less than 1 is no hole.
	paint(&s, 0, 80, 1, 1);
	for (uint32_t i = 0; i < 80 * 80; i++)
		s.matrix[i] *= (float)((1 - 3e-7) / 2.1f);
	assert_int_equal(status_of(&s, &err), STATUS_BAD_ARGUMENT);
	system_free(&s);
}

static void white_surfaces_are_solved_where_light_is_lost(void **state)
{
	(void)state;
	struct system s = system_make(60);
	system_add_sphere(&s, 0, 60);
	paint(&s, 0, 60, 1, 1);
	// Something absorbs.
	paint(&s, 0, 1, 0.5f, 1);
	check_ways(&s, 0, "all white but one");
	// A small hole.
	paint(&s, 0, 60, 1, 1);
	for (uint32_t i = 0; i < 60; i++)
		s.matrix[(size_t)i * 60] *= 0.5f;
	check_ways(&s, 0, "a hole");
	system_free(&s);
	// A long corridor of white boxes, each of which sees its neighbours alone, open at one end.
	s = system_make(12);
	for (uint32_t i = 0; i < 12; i++) {
		s.matrix[(size_t)i * 12 + (i > 0 ? i - 1 : i)] += 0.5f;
		if (i < 11)
			s.matrix[(size_t)i * 12 + i + 1] += 0.5f;
	}
	paint(&s, 0, 12, 1, 1);
	check_ways(&s, 0, "corridor");
	system_free(&s);
}

static void the_limit_of_iterations_holds(void **state)
{
	(void)state;
	struct system s = system_make(100);
	struct factors f;
	double last = INFINITY;
	system_add_sphere(&s, 0, 100);
	paint(&s, 0, 100, 0.9f, 1);
	system_put(&s, device, 0, &f);
	for (int way = 0; way < WAYS; way++, last = INFINITY)
		for (uint32_t limit = 1; limit <= 32; limit *= 2) {
			struct solved r = system_run(&s, &f, device, (enum solver_way)way, 1e-8, limit, 100000);
			assert_int_equal(r.status, STATUS_OK);
			assert_true(r.iterations <= limit);
			assert_true(r.residual < last || r.residual <= 1e-8);
			assert_true(r.residual > 1e-8 || way == SOLVER_GRADIENT);
			last = r.residual;
			// Half done, it is less than all, and not nothing.
			assert_true(r.irradiance[0] > 0.9f && r.irradiance[0] < 10.001f);
			free(r.irradiance);
		}
	factors_finish(&f);
	system_free(&s);
}

static void systems_without_elements_or_factors_end(void **state)
{
	(void)state;
	for (uint32_t count = 0; count < 70; count += 23) {
		struct system s = system_make(count);
		struct factors f;
		for (uint32_t i = 0; i < 3 * count; i++) {
			s.albedo[i] = 1;
			s.exitance[i] = 5;
			s.irradiance[i] = (float)i;
		}
		system_put(&s, device, 0, &f);
		for (int way = 0; way < WAYS; way++) {
			struct solved r = system_run(&s, &f, device, (enum solver_way)way, 1e-6, 100, 0);
			assert_int_equal(r.status, STATUS_OK);
			assert_memory_equal(r.irradiance, s.irradiance, 3 * count * sizeof(float));
			free(r.irradiance);
		}
		factors_finish(&f);
		system_free(&s);
	}
}

// B - M - ρ (D + F B) of a start, by the device in slices of `budget_us`.
static void find_residual(const struct system *s, const struct factors *f, const float *start, uint32_t budget_us,
			  float *found)
{
	const struct solver_problem p = {.factors = f,
					 .exitance = s->exitance,
					 .albedo = s->albedo,
					 .irradiance = s->irradiance,
					 .area = s->area,
					 .residual = 1e-6,
					 .iterations = 100,
					 .start = start};
	struct solver *solver;
	assert_int_equal(solver_create(&p, device, &solver, &err), STATUS_OK);
	while (!solver_finished(solver))
		assert_int_equal(solver_step(solver, budget_us, &err), STATUS_OK);
	assert_int_equal(solver_iterations(solver), 1);
	assert_int_equal(solver_read_residual(solver, found, &err), STATUS_OK);
	solver_destroy(solver);
}

// The same in double on the host. Returns the largest B.
static double model_residual(const struct system *s, const float *start, double *residual)
{
	double most = 0;
	for (uint32_t i = 0; i < s->count; i++)
		for (uint32_t c = 0; c < 3; c++) {
			double h = (double)s->irradiance[3 * i + c];
			for (uint32_t j = 0; j < s->count; j++)
				h += (double)s->matrix[(size_t)i * s->count + j] *
				     ((double)s->exitance[3 * j + c] +
				      (double)s->albedo[3 * j + c] * (double)start[3 * j + c]);
			residual[3 * i + c] = (double)s->albedo[3 * i + c] * ((double)start[3 * i + c] - h);
			most = fmax(most, (double)s->exitance[3 * i + c] +
					      (double)s->albedo[3 * i + c] * (double)start[3 * i + c]);
		}
	return most;
}

// Returns the largest residual, relative to the largest B.
static double check_residual(const struct system *s, const struct factors *f, const float *start)
{
	float found[900], again[900];
	double right[900], worst = 0, largest = 0;
	const double most = model_residual(s, start, right);
	find_residual(s, f, start, 100000, found);
	find_residual(s, f, start, 1, again);
	for (uint32_t i = 0; i < 900; i++) {
		worst = fmax(worst, fabs((double)found[i] - right[i]));
		largest = fmax(largest, fabs(right[i]));
	}
	printf("residual %.3g of B at most, found to %.2g of it\n", largest / most, worst / largest);
	assert_true(worst <= 1e-6 * largest + 1e-10 * most);
	assert_memory_equal(found, again, sizeof found);
	return largest / most;
}

static void the_residual_of_any_light_is_that_of_the_host(void **state)
{
	(void)state;
	model_seed(9);
	struct system s = system_make(300);
	struct factors f;
	float start[900];
	system_fill(&s, 3, 0.95);
	system_put(&s, device, 4000, &f);
	for (uint32_t i = 0; i < 900; i++)
		start[i] = (float)(3 * model_draw_unit());
	double before = check_residual(&s, &f, start);
	for (int digits = 2; digits <= 6; digits++) {
		struct solved r = system_run(&s, &f, device, SOLVER_GRADIENT, pow(10, -digits), 1000, 100000);
		assert_int_equal(r.status, STATUS_OK);
		const double after = check_residual(&s, &f, r.irradiance);
		assert_true(after <= pow(10, -digits) && after <= before);
		before = after;
		free(r.irradiance);
	}
	factors_finish(&f);
	system_free(&s);
}

static void what_is_no_number_is_refused(void **state)
{
	(void)state;
	struct system s = system_make(5);
	s.exitance[7] = NAN;
	assert_int_equal(status_of(&s, &err), STATUS_BAD_ARGUMENT);
	s.exitance[7] = 0;
	s.area[3] = -1;
	assert_int_equal(status_of(&s, &err), STATUS_BAD_ARGUMENT);
	system_free(&s);
}

int main(void)
{
	const struct device_options options = {0};
	if (device_create(&options, &device, &err) != STATUS_OK) {
		printf("skipped: %s\n", err.text);
		return SKIPPED;
	}
	const struct CMUnitTest tests[] = {cmocka_unit_test(a_closed_sphere_is_right),
					   cmocka_unit_test(reciprocal_matrices_are_solved_as_by_lu),
					   cmocka_unit_test(sampled_matrices_are_solved_as_by_lu),
					   cmocka_unit_test(a_dark_room_stays_dark),
					   cmocka_unit_test(slices_and_blocks_change_no_bit),
					   cmocka_unit_test(what_is_black_or_dark_is_right),
					   cmocka_unit_test(any_unit_of_light_and_length_will_do),
					   cmocka_unit_test(a_closed_room_without_absorption_is_refused),
					   cmocka_unit_test(white_surfaces_are_solved_where_light_is_lost),
					   cmocka_unit_test(the_limit_of_iterations_holds),
					   cmocka_unit_test(systems_without_elements_or_factors_end),
					   cmocka_unit_test(the_residual_of_any_light_is_that_of_the_host),
					   cmocka_unit_test(what_is_no_number_is_refused)};
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	const bool valid = atomic_load(&device->validation_errors) == 0;
	devices_finish(&(struct devices){.vk = device});
	return failed || !valid;
}
