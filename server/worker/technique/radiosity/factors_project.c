#include "server/worker/technique/radiosity/factors_project.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"

#define ROWS_AT_ONCE 16u // between two looks at the clock

static struct row_view row_of(const struct factors_projection *p, uint32_t i)
{
	return factors_host_row(&p->host, i);
}

enum status factors_projection_init(struct factors_projection *p, const struct factors *from, const float *area,
				    const uint8_t *which, const struct factors_wish *wish, struct error *err)
{
	const size_t side = from->side;
	*p = (struct factors_projection){.from = from, .area = area, .wish = *wish};
	p->stage = wish->average ? PROJECTION_COUNT : PROJECTION_ROWS;
	p->first = calloc(side + 2, sizeof *p->first);
	p->columns = malloc((side + 1) * sizeof *p->columns);
	p->merged = malloc((side + 1) * sizeof *p->merged);
	enum status s = p->first && p->columns && p->merged ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	if (s == STATUS_OK)
		s = factors_host_init(&p->host, from, which, err);
	if (s == STATUS_OK)
		s = factors_init(&p->to, from->device, from->side, err);
	if (s != STATUS_OK) {
		factors_projection_finish(p);
		return s;
	}
	p->to.block_entries = from->block_entries;
	p->to.packs_on_host = from->packs_on_host;
	return STATUS_OK;
}

void factors_projection_finish(struct factors_projection *p)
{
	factors_host_finish(&p->host);
	free(p->first);
	free(p->rows);
	free(p->values);
	free(p->columns);
	free(p->merged);
	factors_finish(&p->to);
	*p = (struct factors_projection){0};
}

bool factors_projection_finished(const struct factors_projection *p)
{
	return p->stage == PROJECTION_DONE;
}

void factors_projection_take(struct factors_projection *p, struct factors *to)
{
	*to = p->to;
	p->to = (struct factors){0};
}

// ---- by columns ---------------------------------------------------------------------------------------------------------

// Entries are counted two places on, so that filling in leaves each column's first one place on, which is where it belongs.
static void count_row(struct factors_projection *p, uint32_t i)
{
	const struct row_view row = row_of(p, i);
	for (uint32_t k = 0; k < row.count; k++)
		p->first[row.columns[k] + 2ull]++;
}

static enum status begin_turning(struct factors_projection *p, struct error *err)
{
	const uint64_t side = p->from->side;
	uint64_t all = 0;
	for (uint64_t j = 2; j < side + 2; j++)
		all += p->first[j];
	p->rows = malloc((all + 1) * sizeof *p->rows);
	p->values = malloc((all + 1) * sizeof *p->values);
	if (!p->rows || !p->values) {
		free(p->rows);
		free(p->values);
		p->rows = NULL;
		p->values = NULL;
		return error_set(err, STATUS_MEMORY, "out of memory");
	}
	for (uint64_t j = 2; j <= side; j++)
		p->first[j] += p->first[j - 1];
	p->stage = PROJECTION_TURN;
	p->row = 0;
	return STATUS_OK;
}

static void turn_row(struct factors_projection *p, uint32_t i)
{
	const struct row_view row = row_of(p, i);
	for (uint32_t k = 0; k < row.count; k++) {
		const uint64_t at = p->first[row.columns[k] + 1ull]++;
		p->rows[at] = i;
		p->values[at] = row.values[k];
	}
}

// ---- rows ---------------------------------------------------------------------------------------------------------------

// The factor of element i from both of a pair. Of rows by as many rays each, the variance of A_i F_ij goes by the element's
// own area, A_i, so that the mean of least variance of A_i F_ij and A_j F_ji weights each by the area of the other element.
static double factor_of_pair(double area, double other_area, double own, double its)
{
	return (own + its) * (other_area / (area + other_area));
}

// Merge row i with column i. Returns the number of entries.
static uint32_t merge(struct factors_projection *p, uint32_t i, const struct row_view *row)
{
	uint64_t at = p->wish.average ? p->first[i] : 0;
	const uint64_t end = p->wish.average ? p->first[i + 1ull] : 0;
	uint32_t n = 0;
	for (uint32_t k = 0; k < row->count || at < end;) {
		const uint32_t here = k < row->count ? row->columns[k] : NONE, there = at < end ? p->rows[at] : NONE;
		const uint32_t j = here < there ? here : there;
		const double own = here == j ? (double)row->values[k] : 0, its = there == j ? (double)p->values[at] : 0;
		k += here == j;
		at += there == j;
		// Of a row that is not there nothing is known.
		const bool both = p->wish.average && row_of(p, j).there && p->area[i] > 0;
		p->columns[n] = j;
		p->merged[n++] = (float)(both ? factor_of_pair((double)p->area[i], (double)p->area[j], own, its) : own);
	}
	return n;
}

static enum status put_row(struct factors_projection *p, uint32_t i, struct error *err)
{
	const struct row_view row = row_of(p, i);
	const struct factors_row *of = &p->from->rows[i];
	const struct factors_put put = {.element = i, .escaped = of->escaped, .cut = of->cut};
	const double all = fmax(1 - (double)of->escaped - (double)of->cut, 0);
	if (!row.there)
		return STATUS_OK;
	const uint32_t n = merge(p, i, &row);
	const double sum = row_view_sum(&(struct row_view){.values = p->merged, .count = n});
	for (uint32_t k = 0; p->wish.close && sum > 0 && k < n; k++)
		p->merged[k] = (float)((double)p->merged[k] * (all / sum));
	return factors_put_row(&p->to, &put, p->columns, p->merged, n, err);
}

static enum status do_row(struct factors_projection *p, struct error *err)
{
	enum status s = STATUS_OK;
	if (p->stage == PROJECTION_COUNT)
		count_row(p, p->row);
	else if (p->stage == PROJECTION_TURN)
		turn_row(p, p->row);
	else
		s = put_row(p, p->row, err);
	p->row += s == STATUS_OK;
	return s;
}

static enum status end_stage(struct factors_projection *p, struct error *err)
{
	if (p->stage == PROJECTION_COUNT)
		return begin_turning(p, err);
	p->stage = p->stage == PROJECTION_TURN ? PROJECTION_ROWS : PROJECTION_DONE;
	p->row = 0;
	if (p->stage == PROJECTION_DONE)
		factors_host_finish(&p->host);
	return STATUS_OK;
}

enum status factors_projection_step(struct factors_projection *p, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = factors_projection_finished(p) ? STATUS_OK : factors_host_step(&p->host, budget_us, err);
	if (s != STATUS_OK || factors_projection_finished(p) || !factors_host_finished(&p->host))
		return s;
	do {
		for (uint32_t i = 0; s == STATUS_OK && i < ROWS_AT_ONCE && p->row < p->from->side; i++)
			s = do_row(p, err);
		if (s == STATUS_OK && p->row == p->from->side)
			s = end_stage(p, err);
	} while (s == STATUS_OK && !factors_projection_finished(p) && clock_us() - start < budget_us);
	return s;
}
