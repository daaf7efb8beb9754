#include "server/worker/technique/radiosity/survey.h"

#include <stdio.h>
#include <stdlib.h>

#include "server/base/clock.h"

#define ROWS_AT_ONCE 16u // between two looks at the clock

struct survey {
	struct solution *solution;
	bool report;
	// Which elements light reaches: groups, each of whose rows tells which groups it sees.
	uint8_t *reached; // by element; NULL: the solution knows
	uint32_t *queue; // groups, in the order in which they were found
	uint32_t queued, done; // of the queue, and of those whose rows were gone through
	uint32_t next; // row within queue[done]
	struct factors_host host;
	// The report.
	float *area; // by element
	struct factors_check check;
	bool checking;
};

// ---- what is reached ----------------------------------------------------------------------------------------------------

static void reach(struct survey *s, uint32_t element)
{
	uint32_t first;
	if (s->reached[element])
		return;
	const struct factor_build *b = s->solution->factors;
	const uint32_t group = factor_build_group(b, element), count = factor_build_group_elements(b, group, &first);
	for (uint32_t i = first; i < first + count; i++)
		s->reached[i] = 1;
	s->queue[s->queued++] = group;
}

static enum status begin_reaching(struct survey *s, struct error *err)
{
	const struct factor_build *b = s->solution->factors;
	s->reached = calloc(b->elements.count + 1, sizeof *s->reached);
	s->queue = calloc(2 * (size_t)b->node_count + 1, sizeof *s->queue);
	if (!s->reached || !s->queue) {
		free(s->reached);
		free(s->queue);
		s->reached = NULL;
		s->queue = NULL;
		return error_set(err, STATUS_MEMORY, "out of memory");
	}
	for (uint32_t i = 0; i < b->elements.count; i++)
		if (solution_is_lit(s->solution, i))
			reach(s, i);
	return STATUS_OK;
}

// Go through the next row of the queue.
static void follow_row(struct survey *s)
{
	const struct factor_build *b = s->solution->factors;
	uint32_t first;
	if (s->next == factor_build_group_elements(b, s->queue[s->done], &first)) {
		s->done++;
		s->next = 0;
		return;
	}
	const struct row_view row = host_row(&b->factors, s->host.blocks, first + s->next++);
	for (uint32_t k = 0; k < row.count; k++)
		reach(s, row.columns[k]);
}

static enum status follow_rows(struct survey *s, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	bool anew; // rows that are there stay what they are
	const enum status status = factors_host_refresh(&s->host, &s->solution->factors->factors, &anew, err);
	if (status != STATUS_OK)
		return status;
	do
		for (uint32_t i = 0; i < ROWS_AT_ONCE && s->done < s->queued; i++)
			follow_row(s);
	while (s->done < s->queued && clock_us() - start < budget_us);
	if (s->done == s->queued) {
		s->solution->reached = s->reached;
		s->reached = NULL;
		factors_host_finish(&s->host);
	}
	return STATUS_OK;
}

// ---- the report ---------------------------------------------------------------------------------------------------------

static enum status begin_checking(struct survey *s, struct error *err)
{
	const struct elements *e = &s->solution->factors->elements;
	free(s->area);
	s->area = malloc((e->count + 1) * sizeof *s->area);
	if (!s->area)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < e->count; i++)
		s->area[i] = e->shapes[i % e->patches.count].area;
	const enum status status =
	    factors_check_init(&s->check, &s->solution->factors->factors, s->area, s->solution->reached, err);
	s->checking = status == STATUS_OK;
	return status;
}

static enum status check_rows(struct survey *s, uint32_t budget_us, struct error *err)
{
	enum status status = s->checking ? STATUS_OK : begin_checking(s, err);
	if (status == STATUS_OK)
		status = factors_check_step(&s->check, budget_us, err);
	if (status == STATUS_OK && factors_check_finished(&s->check)) {
		s->solution->report = s->check.report;
		s->solution->reported = true;
	}
	return status;
}

// ---- both ---------------------------------------------------------------------------------------------------------------

enum status survey_create(struct solution *solution, bool report, struct survey **survey, struct error *err)
{
	struct survey *s = calloc(1, sizeof *s);
	if (!s)
		return error_set(err, STATUS_MEMORY, "out of memory");
	s->solution = solution;
	s->report = report;
	*survey = s;
	return STATUS_OK;
}

void survey_destroy(struct survey *s)
{
	if (!s)
		return;
	factors_check_finish(&s->check);
	factors_host_finish(&s->host);
	free(s->area);
	free(s->reached);
	free(s->queue);
	free(s);
}

// Another job may have found the same meanwhile: then nothing is left to do.
bool survey_finished(const struct survey *s)
{
	return s->solution->reached && (!s->report || s->solution->reported);
}

enum status survey_step(struct survey *s, uint32_t budget_us, struct error *err)
{
	if (survey_finished(s))
		return STATUS_OK;
	if (s->solution->reached)
		return check_rows(s, budget_us, err);
	const enum status status = s->reached ? STATUS_OK : begin_reaching(s, err);
	return status == STATUS_OK ? follow_rows(s, budget_us, err) : status;
}

void survey_account(const struct solution *solution, struct frame *f)
{
	const struct factors_report *r = &solution->report;
	if (!solution->reported)
		return;
	frame_add_figure(f, "check.rows", r->rows, "");
	frame_add_figure(f, "check.factors", (double)r->entries, "");
	frame_add_figure(f, "sum.least", r->sum_least, "");
	frame_add_figure(f, "sum.mean", r->sum_mean, "");
	frame_add_figure(f, "sum.most", r->sum_most, "");
	frame_add_figure(f, "sum.all.least", r->all_least, "");
	frame_add_figure(f, "sum.all.mean", r->all_mean, "");
	frame_add_figure(f, "sum.all.most", r->all_most, "");
	frame_add_figure(f, "reciprocity.mean", r->reciprocity_mean, "");
	frame_add_figure(f, "reciprocity.most", r->reciprocity_most, "");
	frame_add_figure(f, "reciprocity.pairs", (double)r->pairs, "");
	for (uint32_t i = 0; i < FACTORS_DECADES; i++) {
		char name[24] = "values.0";
		if (i < FACTORS_DECADES - 1)
			snprintf(name, sizeof name, "values.1e-%u", i + 1);
		frame_add_figure(f, name, (double)r->decades[i], "");
	}
}
