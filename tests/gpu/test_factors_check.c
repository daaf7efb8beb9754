// Row sums and reciprocity of form factors are measured as a dense matrix in double has them, and the projections do what
// they say.
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
#include "server/worker/technique/radiosity/factors_check.h"
#include "server/worker/technique/radiosity/factors_project.h"
#include "server/worker/vk/device.h"
#include "tests/gpu/solver_model.h"

#define SKIPPED 77

static struct device *device;
static struct error err;

static bool near(double a, double b, double relative)
{
	return fabs(a - b) <= relative * fmax(fabs(a), fabs(b));
}

// A factor is at least 10^-(decade + 1).
static uint32_t decade_of(float value)
{
	const double decade = ceil(-log10((double)value) - 1e-9) - 1;
	return (uint32_t)fmin(fmax(decade, 0), FACTORS_DECADES - 1);
}

// The report of a dense matrix; a row without entries counts as never put.
static struct factors_report report_of(const struct system *s, const struct factors *f)
{
	struct factors_report r = {.sum_least = INFINITY, .all_least = INFINITY};
	const uint32_t n = s->count;
	double all = 0, different = 0;
	for (uint32_t i = 0; i < n; i++) {
		double sum = 0;
		if (f->rows[i].block == NONE)
			continue;
		for (uint32_t j = 0; j < n; j++) {
			const double a = (double)s->area[i] * (double)s->matrix[(size_t)i * n + j];
			const double b = (double)s->area[j] * (double)s->matrix[(size_t)j * n + i];
			sum += (double)s->matrix[(size_t)i * n + j];
			r.entries += s->matrix[(size_t)i * n + j] != 0;
			if (s->matrix[(size_t)i * n + j] != 0)
				r.decades[decade_of(s->matrix[(size_t)i * n + j])]++;
			if (j >= i || f->rows[j].block == NONE || (a == 0 && b == 0))
				continue;
			r.pairs++;
			r.reciprocity_most = fmax(r.reciprocity_most, fabs(a - b) / fmax(a, b));
			different += fabs(a - b);
			all += fmax(a, b);
		}
		r.rows++;
		r.sum_least = fmin(r.sum_least, sum);
		r.sum_most = fmax(r.sum_most, sum);
		r.sum_mean += sum;
		const double whole = sum + (double)f->rows[i].escaped + (double)f->rows[i].cut;
		r.all_least = fmin(r.all_least, whole);
		r.all_most = fmax(r.all_most, whole);
		r.all_mean += whole;
		r.closure_error = fmax(r.closure_error, fabs(whole - 1));
	}
	r.sum_mean /= r.rows;
	r.all_mean /= r.rows;
	r.reciprocity_mean = different / all;
	return r;
}

static void check_report(const struct system *s, const struct factors *f)
{
	struct factors_report r;
	const struct factors_report right = report_of(s, f);
	assert_int_equal(factors_check(f, s->area, &r, &err), STATUS_OK);
	printf("%u rows, %llu entries: sums %.6f … %.6f, closure %.2g, reciprocity %.2g, %.2g\n", r.rows,
	       (unsigned long long)r.entries, r.sum_least, r.sum_most, r.closure_error, r.reciprocity_most,
	       r.reciprocity_mean);
	assert_int_equal(r.rows, right.rows);
	assert_int_equal(r.entries, right.entries);
	assert_int_equal(r.pairs, right.pairs);
	assert_true(near(r.sum_least, right.sum_least, 1e-12) && near(r.sum_most, right.sum_most, 1e-12));
	assert_true(near(r.sum_mean, right.sum_mean, 1e-12) && near(r.closure_error, right.closure_error, 1e-9));
	assert_true(near(r.all_least, right.all_least, 1e-12) && near(r.all_most, right.all_most, 1e-12));
	assert_true(near(r.all_mean, right.all_mean, 1e-12));
	assert_memory_equal(r.decades, right.decades, sizeof r.decades);
	assert_true(near(r.reciprocity_most, right.reciprocity_most, 1e-9));
	assert_true(near(r.reciprocity_mean, right.reciprocity_mean, 1e-9));
}

// Noise on every factor, some of them gone, and row 5 never put.
static struct system noisy(uint32_t count)
{
	struct system s = system_make(count);
	system_fill(&s, 3, 0.5);
	for (uint32_t i = 0; i < count * count; i++)
		s.matrix[i] *= model_draw() % 6 == 0 ? 0 : (float)(0.5 + model_draw_unit());
	memset(s.matrix + (size_t)5 * count, 0, count * sizeof(float));
	return s;
}

static void read_back(const struct factors *f, struct system *s)
{
	memset(s->matrix, 0, (size_t)s->count * s->count * sizeof(float));
	for (uint32_t i = 0; i < s->count; i++) {
		uint32_t *columns;
		float *values;
		assert_int_equal(factors_read_row(f, i, &columns, &values, &err), STATUS_OK);
		for (uint32_t k = 0; f->rows[i].block != NONE && k < f->rows[i].count; k++)
			s->matrix[(size_t)i * s->count + columns[k]] = values[k];
		free(columns);
		free(values);
	}
}

// Put a projection in place of the matrix. By slices of `budget_us`.
static void project(struct factors *f, const float *area, bool average, bool close, uint32_t budget_us)
{
	const struct factors_wish wish = {average, close};
	struct factors_projection p;
	struct factors made;
	assert_int_equal(factors_projection_init(&p, f, area, NULL, &wish, &err), STATUS_OK);
	while (!factors_projection_finished(&p))
		assert_int_equal(factors_projection_step(&p, budget_us, &err), STATUS_OK);
	factors_projection_take(&p, &made);
	factors_projection_finish(&p);
	factors_finish(f);
	*f = made;
}

static void reports_are_right(void **state)
{
	(void)state;
	model_seed(11);
	struct factors f;
	struct system s = system_make(150);
	system_fill(&s, 4, 0.5);
	system_put(&s, device, 0, &f);
	check_report(&s, &f);
	factors_finish(&f);
	system_free(&s);
	s = noisy(201);
	system_put(&s, device, 4000, &f);
	check_report(&s, &f);
	factors_finish(&f);
	system_free(&s);
}

static void a_matrix_without_rows_has_a_report(void **state)
{
	(void)state;
	struct factors f;
	struct factors_report r;
	const float area[3] = {1, 1, 1};
	for (uint32_t side = 0; side < 4; side += 3) {
		assert_int_equal(factors_init(&f, device, side, &err), STATUS_OK);
		assert_int_equal(factors_check(&f, area, &r, &err), STATUS_OK);
		assert_true(r.rows == 0 && r.pairs == 0 && r.sum_mean == 0 && r.reciprocity_mean == 0);
		project(&f, area, true, true, 0);
		project(&f, area, false, true, 0);
		factors_finish(&f);
	}
}

static void closing_makes_sums_one(void **state)
{
	(void)state;
	model_seed(12);
	struct factors f;
	struct factors_report r;
	struct system s = noisy(150), was = s;
	system_put(&s, device, 0, &f);
	for (uint32_t i = 0; i < 150; i++)
		if (f.rows[i].block != NONE) {
			f.rows[i].escaped = (float)(i % 4) / 8;
			f.rows[i].cut = (float)(i % 3) / 16;
		}
	s = system_make(150);
	memcpy(s.area, was.area, 150 * sizeof(float));
	project(&f, s.area, false, true, 0);
	read_back(&f, &s);
	check_report(&s, &f);
	assert_int_equal(factors_check(&f, s.area, &r, &err), STATUS_OK);
	assert_true(r.closure_error < 1e-6);
	// Within a row the factors keep their ratios.
	for (uint32_t i = 0; i < 150; i++) {
		double ratio = 0;
		for (uint32_t j = 0; j < 150; j++) {
			const double before = (double)was.matrix[i * 150 + j], after = (double)s.matrix[i * 150 + j];
			assert_true((before > 0) == (after > 0));
			if (before > 0 && ratio > 0)
				assert_true(near(after / before, ratio, 1e-6));
			ratio = before > 0 ? after / before : ratio;
		}
	}
	factors_finish(&f);
	system_free(&s);
	system_free(&was);
}

static void averaging_makes_it_reciprocal(void **state)
{
	(void)state;
	model_seed(13);
	struct factors f;
	struct factors_report r;
	struct system was = noisy(150), s = system_make(150);
	memcpy(s.area, was.area, 150 * sizeof(float));
	system_put(&was, device, 2000, &f);
	f.rows[7].escaped = 0.25f;
	f.rows[8].cut = 0.5f;
	project(&f, s.area, true, false, 100000);
	read_back(&f, &s);
	check_report(&s, &f);
	assert_int_equal(factors_check(&f, s.area, &r, &err), STATUS_OK);
	assert_true(r.reciprocity_most < 3e-7);
	assert_true(f.rows[7].escaped == 0.25f && f.rows[8].cut == 0.5f && f.rows[5].block == NONE);
	assert_true(f.block_count > 1);
	for (uint32_t i = 0; i < 150; i++)
		for (uint32_t j = 0; j < 150; j++) {
			const double own = (double)was.matrix[i * 150 + j], its = (double)was.matrix[j * 150 + i];
			const double right = i == 5 ? 0
					     : j == 5
						 ? own
						 : (own + its) * (double)s.area[j] / ((double)s.area[i] + (double)s.area[j]);
			assert_true(near((double)s.matrix[i * 150 + j], right, 1e-6));
		}
	factors_finish(&f);
	system_free(&s);
	system_free(&was);
}

// As on a device whose memory the host does not see.
static void hide(struct factors *f)
{
	for (uint32_t b = 0; b < f->block_count; b++)
		f->blocks[b].columns.map = f->blocks[b].values.map = NULL;
}

// A report on the first 100 rows, in slices between which another row comes and all rows move.
static struct factors_report report_on_some(struct factors *f, const struct system *s, const uint8_t *which, uint32_t *steps)
{
	struct factors_check check;
	const uint32_t columns[2] = {3, 9};
	const float values[2] = {0.25f, 1e-9f};
	assert_int_equal(factors_check_init(&check, f, s->area, which, &err), STATUS_OK);
	assert_int_equal(factors_check_step(&check, 0, &err), STATUS_OK);
	assert_false(factors_check_finished(&check));
	assert_int_equal(factors_put_row(f, &(struct factors_put){.element = 150}, columns, values, 2, &err), STATUS_OK);
	assert_int_equal(factors_compact(f, &err), STATUS_OK);
	for (*steps = 1; !factors_check_finished(&check); ++*steps)
		assert_int_equal(factors_check_step(&check, 0, &err), STATUS_OK);
	factors_check_finish(&check);
	return check.report;
}

// It is that of a matrix which has no other rows. What the host does not see is copied, in slices too.
static void slices_of_some_rows_while_others_come(void **state)
{
	(void)state;
	for (uint32_t hidden = 0; hidden < 2; hidden++) {
		model_seed(14);
		struct factors f;
		struct factors_report all;
		struct system s = noisy(201);
		uint32_t steps;
		uint8_t *which = calloc(s.count, 1);
		system_put(&s, device, 4000, &f);
		for (uint32_t i = 0; i < 100; i++)
			which[i] = 1;
		if (hidden)
			hide(&f);
		const struct factors_report some = report_on_some(&f, &s, which, &steps);
		assert_true(steps >= (1 + hidden) * (201 / 16));
		assert_int_equal(some.rows, 99); // one of them was never put
		for (uint32_t i = 100; i < s.count; i++)
			factors_remove_row(&f, i);
		assert_int_equal(factors_check(&f, s.area, &all, &err), STATUS_OK);
		assert_memory_equal(&all, &some, sizeof all);
		factors_finish(&f);
		system_free(&s);
		free(which);
	}
}

// Forwards, backwards and to and fro.
static void windows_have_the_rows_of_the_matrix(void **state)
{
	(void)state;
	model_seed(15);
	struct factors f;
	struct factors_window both = {0}, bare = {.columns_only = true};
	struct system s = noisy(150);
	system_put(&s, device, 4000, &f);
	hide(&f);
	for (uint32_t k = 0; k < 450; k++) {
		const uint32_t i = k < 150 ? k : k < 300 ? 299 - k : k * 77 % 150;
		struct row_view row, columns_of;
		uint32_t *columns;
		float *values;
		assert_int_equal(factors_read_row(&f, i, &columns, &values, &err), STATUS_OK);
		assert_int_equal(factors_window_row(&both, &f, i, &row, &err), STATUS_OK);
		assert_int_equal(factors_window_row(&bare, &f, i, &columns_of, &err), STATUS_OK);
		assert_true(row.there == (f.rows[i].block != NONE) && row.count == (row.there ? f.rows[i].count : 0));
		assert_true(columns_of.count == row.count && !columns_of.values);
		if (row.count > 0) {
			assert_memory_equal(row.columns, columns, row.count * sizeof *columns);
			assert_memory_equal(row.values, values, row.count * sizeof *values);
			assert_memory_equal(columns_of.columns, columns, row.count * sizeof *columns);
		}
		free(columns);
		free(values);
	}
	factors_window_finish(&both);
	factors_window_finish(&bare);
	factors_finish(&f);
	system_free(&s);
}

// Every third row, backwards: they are the same to the bit, and no other is there.
static void rows_are_taken_over_from_another_matrix(void **state)
{
	(void)state;
	model_seed(16);
	struct factors from, to;
	struct system s = noisy(150);
	uint32_t list[50], n = 0;
	uint64_t entries = 0;
	system_put(&s, device, 4000, &from);
	hide(&from);
	assert_int_equal(factors_init(&to, device, 150, &err), STATUS_OK);
	to.block_entries = 2000;
	for (uint32_t i = 150; i-- > 0;)
		if (i % 3 == 1 && from.rows[i].block != NONE)
			list[n++] = i;
	assert_int_equal(factors_take(&to, &from, list, n, &err), STATUS_OK);
	hide(&to);
	for (uint32_t i = 0; i < 150; i++) {
		uint32_t *columns[2];
		float *values[2];
		const bool taken = i % 3 == 1 && from.rows[i].block != NONE;
		assert_true((to.rows[i].block != NONE) == taken);
		if (!taken)
			continue;
		assert_int_equal(factors_read_row(&from, i, &columns[0], &values[0], &err), STATUS_OK);
		assert_int_equal(factors_read_row(&to, i, &columns[1], &values[1], &err), STATUS_OK);
		assert_int_equal(to.rows[i].count, from.rows[i].count);
		assert_true(to.rows[i].escaped == from.rows[i].escaped && to.rows[i].cut == from.rows[i].cut);
		entries += to.rows[i].count;
		for (uint32_t k = 0; k < to.rows[i].count; k++)
			assert_true(columns[0][k] == columns[1][k] && values[0][k] == values[1][k]);
		for (int k = 0; k < 2; k++) {
			free(columns[k]);
			free(values[k]);
		}
	}
	assert_true(to.entries == entries && to.block_count > 1);
	factors_finish(&from);
	factors_finish(&to);
	system_free(&s);
}

// Rows of a sphere, each by so many independent rays.
static void sample_rows(struct system *s, uint32_t rays)
{
	double all = 0;
	for (uint32_t i = 0; i < s->count; i++)
		all += (double)s->area[i];
	memset(s->matrix, 0, (size_t)s->count * s->count * sizeof(float));
	for (uint32_t ray = 0; ray < rays * s->count; ray++) {
		double left = model_draw_unit() * all;
		uint32_t j = 0;
		while (j + 1 < s->count && left >= (double)s->area[j])
			left -= (double)s->area[j++];
		s->matrix[(size_t)(ray / rays) * s->count + j] += 1.0f / (float)rays;
	}
}

// Of two kinds of areas, 100 to 1, the mean square of a pair's error is that of two independent estimates by weights that
// their variances have: 1 / (1/v + 1/w). The plain mean has 25 times that.
static void averages_are_of_least_variance(void **state)
{
	(void)state;
	enum { COUNT = 60, RAYS = 4000 };
	model_seed(17);
	struct factors f;
	struct system s = system_make(COUNT);
	double all = 0, error = 0, expected = 0;
	for (uint32_t i = 0; i < COUNT; i++) {
		s.area[i] = i % 2 ? 0.01f : 1;
		all += (double)s.area[i];
	}
	sample_rows(&s, RAYS);
	system_put(&s, device, 0, &f);
	project(&f, s.area, true, false, 100000);
	read_back(&f, &s);
	for (uint32_t i = 0; i < COUNT; i += 2)
		for (uint32_t j = 1; j < COUNT; j += 2) {
			const double a = (double)s.area[i], b = (double)s.area[j], flux = a * b / all;
			const double of_a = a * flux * (1 - b / all) / RAYS, of_b = b * flux * (1 - a / all) / RAYS;
			const double off = a * (double)s.matrix[i * COUNT + j] - flux;
			error += off * off;
			expected += 1 / (1 / of_a + 1 / of_b);
		}
	printf("mean squares of errors: %.3g, expected %.3g\n", error, expected);
	assert_true(error < 1.2 * expected && error > expected / 1.2);
	factors_finish(&f);
	system_free(&s);
}

static void independent_rays_are_as_reciprocal_as_chance_has_it(void **state)
{
	(void)state;
	static const uint32_t rays[4] = {40, 150, 1000, 5000};
	model_seed(15);
	for (int k = 0; k < 4; k++) {
		struct factors f;
		struct factors_check check;
		struct system s = system_make(150);
		system_add_sphere(&s, 0, 150);
		sample_rows(&s, rays[k]);
		system_put(&s, device, 0, &f);
		assert_int_equal(factors_check_init(&check, &f, s.area, NULL, &err), STATUS_OK);
		check.rays = rays[k];
		while (!factors_check_finished(&check))
			assert_int_equal(factors_check_step(&check, 100000, &err), STATUS_OK);
		const struct factors_report *r = &check.report;
		printf("%u rays: they differ by %.4f of the light exchanged, by chance %.4f\n", rays[k], r->reciprocity_mean,
		       r->reciprocity_chance);
		assert_true(fabs(r->reciprocity_mean / r->reciprocity_chance - 1) < 0.1);
		factors_check_finish(&check);
		factors_finish(&f);
		system_free(&s);
	}
}

// A projection of some rows is that of a matrix without the others, which stays as it is, and to which rows come meanwhile;
// whatever the slices.
static void projections_are_of_some_rows(void **state)
{
	(void)state;
	static const struct factors_wish both = {true, true};
	model_seed(16);
	struct factors f, made[2];
	struct system s = noisy(201), was = system_make(201), a = system_make(201), b = system_make(201);
	const uint32_t columns[2] = {3, 9};
	const float values[2] = {0.25f, 0.5f};
	uint8_t *which = calloc(s.count, 1);
	system_put(&s, device, 4000, &f);
	for (uint32_t i = 0; i < 100; i++)
		which[i] = i != 5;
	for (int k = 0; k < 2; k++) {
		struct factors_projection p;
		assert_int_equal(factors_projection_init(&p, &f, s.area, which, &both, &err), STATUS_OK);
		for (uint32_t steps = 0; !factors_projection_finished(&p); steps++) {
			assert_int_equal(factors_projection_step(&p, k == 0 ? 0 : 100000, &err), STATUS_OK);
			if (k == 0 && steps % 7 == 0) {
				const struct factors_put put = {.element = 150 + steps};
				assert_int_equal(factors_put_row(&f, &put, columns, values, 2, &err), STATUS_OK);
				assert_int_equal(factors_compact(&f, &err), STATUS_OK);
			}
		}
		factors_projection_take(&p, &made[k]);
		factors_projection_finish(&p);
	}
	read_back(&f, &was);
	for (uint32_t i = 0; i < 100; i++)
		assert_memory_equal(was.matrix + (size_t)201 * i, s.matrix + (size_t)201 * i, 201 * sizeof(float));
	read_back(&made[0], &a);
	read_back(&made[1], &b);
	assert_memory_equal(a.matrix, b.matrix, (size_t)201 * 201 * sizeof(float));
	for (uint32_t i = 0; i < s.count; i++)
		if (!which[i])
			factors_remove_row(&f, i);
	project(&f, s.area, true, true, 100000);
	read_back(&f, &was);
	assert_memory_equal(a.matrix, was.matrix, (size_t)201 * 201 * sizeof(float));
	factors_finish(&f);
	factors_finish(&made[0]);
	factors_finish(&made[1]);
	system_free(&s);
	system_free(&was);
	system_free(&a);
	system_free(&b);
	free(which);
}

static void memory_that_the_host_does_not_see_is_copied(void **state)
{
	(void)state;
	model_seed(14);
	struct factors seen, hidden;
	struct system s = noisy(120), a = system_make(120), b = system_make(120);
	const uint32_t columns[2] = {3, 77};
	const float values[2] = {0.25f, 0.5f};
	struct factors *const both[2] = {&seen, &hidden};
	for (int k = 0; k < 2; k++) {
		const struct factors_put put = {.element = 9};
		struct factors *f = both[k];
		system_put(&s, device, 2000, f);
		if (k == 1)
			hide(f);
		assert_int_equal(factors_put_row(f, &put, columns, values, 2, &err), STATUS_OK);
		project(f, s.area, false, true, 100000);
		project(f, s.area, true, false, 100000);
		if (k == 1)
			hide(f);
		project(f, s.area, false, true, 100000);
		assert_int_equal(factors_compact(f, &err), STATUS_OK);
		read_back(f, k == 0 ? &a : &b);
	}
	assert_memory_equal(a.matrix, b.matrix, 120 * 120 * sizeof(float));
	assert_true(a.matrix[9 * 120 + 77] > 0);
	factors_finish(&seen);
	factors_finish(&hidden);
	system_free(&s);
	system_free(&a);
	system_free(&b);
}

int main(void)
{
	const struct device_options options = {0};
	if (device_create(&options, &device, &err) != STATUS_OK) {
		printf("skipped: %s\n", err.text);
		return SKIPPED;
	}
	const struct CMUnitTest tests[] = {cmocka_unit_test(reports_are_right),
					   cmocka_unit_test(a_matrix_without_rows_has_a_report),
					   cmocka_unit_test(closing_makes_sums_one),
					   cmocka_unit_test(averaging_makes_it_reciprocal),
					   cmocka_unit_test(slices_of_some_rows_while_others_come),
					   cmocka_unit_test(windows_have_the_rows_of_the_matrix),
					   cmocka_unit_test(rows_are_taken_over_from_another_matrix),
					   cmocka_unit_test(projections_are_of_some_rows),
					   cmocka_unit_test(independent_rays_are_as_reciprocal_as_chance_has_it),
					   cmocka_unit_test(averages_are_of_least_variance),
					   cmocka_unit_test(memory_that_the_host_does_not_see_is_copied)};
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	devices_finish(&(struct devices){.vk = device});
	return failed;
}
