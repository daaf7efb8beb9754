#include "server/worker/technique/radiosity/factors_check.h"

#include <math.h>
#include <stdlib.h>

#include "server/base/angle.h"
#include "server/base/clock.h"

#define ROWS_AT_ONCE 16u // between two looks at the clock

static void look_at_sums(struct factors_check *c, uint32_t i, const struct row_view *row)
{
	struct factors_report *r = &c->report;
	const struct factors_row *of = &c->factors->rows[i];
	const double sum = row_view_sum(row), all = sum + (double)of->escaped + (double)of->cut;
	r->sum_least = r->rows == 0 ? sum : fmin(r->sum_least, sum);
	r->sum_most = fmax(r->sum_most, sum);
	r->sum_mean += sum;
	r->all_least = r->rows == 0 ? all : fmin(r->all_least, all);
	r->all_most = fmax(r->all_most, all);
	r->all_mean += all;
	r->closure_error = fmax(r->closure_error, fabs(all - 1));
	r->rows++;
	r->entries += row->count;
}

static void look_at_values(struct factors_report *r, const struct row_view *row)
{
	static const float least[FACTORS_DECADES - 1] = {1e-1f, 1e-2f, 1e-3f, 1e-4f, 1e-5f, 1e-6f, 1e-7f};
	for (uint32_t k = 0; k < row->count; k++) {
		uint32_t decade = 0;
		while (decade < FACTORS_DECADES - 1 && row->values[k] < least[decade])
			decade++;
		r->decades[decade]++;
	}
}

// The mean difference of a pair's two fluxes A_i F_ij and A_j F_ji, which are the same in truth, where each is found by how
// many of so many independent rays meet the other element, and their sum is known: `met` rays in all. Of equal areas each of
// these is as likely the one's as the other's, so that a single ray makes a difference of the whole sum, and many that of a
// normal distribution, sum sqrt(2 / (π met)). This goes from one to the other.
static double difference_by_chance(double sum, double areas, uint32_t rays)
{
	const double met = areas > 0 ? 2 * sum * rays / areas : 0;
	return sum / sqrt(1 + 0.5 * PI * fmax(met - 1, 0));
}

// Rows are gone through in order, so in each of the others what is looked for moves on, and one pass over all suffices:
// `next` is for each row its first entry not before the column that was looked for last.
static void look_at_pairs(struct factors_check *c, uint32_t i, const struct row_view *row)
{
	struct factors_report *r = &c->report;
	for (uint32_t k = 0; k < row->count; k++) {
		const uint32_t j = row->columns[k];
		const struct row_view other = factors_host_row(&c->host, j);
		if (j == i || !other.there)
			continue;
		while (c->next[j] < other.count && other.columns[c->next[j]] < i)
			c->next[j]++;
		const bool seen = c->next[j] < other.count && other.columns[c->next[j]] == i;
		// The pair was looked at in row j.
		if (seen && j < i)
			continue;
		const double a = (double)c->area[i] * (double)row->values[k];
		const double b = seen ? (double)c->area[j] * (double)other.values[c->next[j]] : 0;
		const double most = fmax(a, b);
		r->pairs++;
		if (most > 0)
			r->reciprocity_most = fmax(r->reciprocity_most, fabs(a - b) / most);
		c->differences += fabs(a - b);
		c->by_chance += difference_by_chance(a + b, (double)c->area[i] + (double)c->area[j], c->rays);
		c->fluxes += most;
	}
}

static void look_at_row(struct factors_check *c, uint32_t i)
{
	const struct row_view row = factors_host_row(&c->host, i);
	if (!row.there)
		return;
	look_at_sums(c, i, &row);
	look_at_values(&c->report, &row);
	look_at_pairs(c, i, &row);
}

static void conclude(struct factors_check *c)
{
	struct factors_report *r = &c->report;
	if (r->rows > 0) {
		r->sum_mean /= r->rows;
		r->all_mean /= r->rows;
	}
	r->reciprocity_mean = c->fluxes > 0 ? c->differences / c->fluxes : 0;
	// Of two numbers the larger is half of their sum and of their difference.
	const double sums = 2 * c->fluxes - c->differences;
	r->reciprocity_chance = c->rays > 0 && sums > 0 ? 2 * c->by_chance / (sums + c->by_chance) : 0;
	c->concluded = true;
}

enum status factors_check_init(struct factors_check *c, const struct factors *factors, const float *area,
			       const uint8_t *which, struct error *err)
{
	*c = (struct factors_check){.factors = factors, .area = area};
	c->next = calloc(factors->side ? factors->side : 1, sizeof *c->next);
	const enum status s =
	    c->next ? factors_host_init(&c->host, factors, which, err) : error_set(err, STATUS_MEMORY, "out of memory");
	if (s != STATUS_OK)
		factors_check_finish(c);
	return s;
}

enum status factors_check_step(struct factors_check *c, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	const uint32_t side = c->factors->side;
	if (c->concluded)
		return STATUS_OK;
	if (!factors_host_finished(&c->host))
		return factors_host_step(&c->host, budget_us, err);
	do
		for (uint32_t i = 0; i < ROWS_AT_ONCE && c->row < side; i++)
			look_at_row(c, c->row++);
	while (c->row < side && clock_us() - start < budget_us);
	if (c->row == side)
		conclude(c);
	return STATUS_OK;
}

bool factors_check_finished(const struct factors_check *c)
{
	return c->concluded;
}

void factors_check_finish(struct factors_check *c)
{
	factors_host_finish(&c->host);
	free(c->next);
	c->next = NULL;
}

enum status factors_check(const struct factors *f, const float *area, struct factors_report *report, struct error *err)
{
	struct factors_check check;
	enum status s = factors_check_init(&check, f, area, NULL, err);
	while (s == STATUS_OK && !factors_check_finished(&check))
		s = factors_check_step(&check, UINT32_MAX, err);
	*report = check.report;
	factors_check_finish(&check);
	return s;
}
