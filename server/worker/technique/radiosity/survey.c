#include "server/worker/technique/radiosity/survey.h"

#include <stdio.h>
#include <stdlib.h>

struct survey {
	struct solution *solution;
	float *area; // by element
	struct factors_check check;
	bool checking;
};

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

enum status survey_create(struct solution *solution, struct survey **survey, struct error *err)
{
	struct survey *s = calloc(1, sizeof *s);
	if (!s)
		return error_set(err, STATUS_MEMORY, "out of memory");
	s->solution = solution;
	*survey = s;
	return STATUS_OK;
}

void survey_destroy(struct survey *s)
{
	if (!s)
		return;
	factors_check_finish(&s->check);
	free(s->area);
	free(s);
}

// Another job may have found the same meanwhile: then nothing is left to do.
bool survey_finished(const struct survey *s)
{
	return s->solution->reported;
}

enum status survey_step(struct survey *s, uint32_t budget_us, struct error *err)
{
	if (survey_finished(s))
		return STATUS_OK;
	enum status status = s->checking ? STATUS_OK : begin_checking(s, err);
	if (status == STATUS_OK)
		status = factors_check_step(&s->check, budget_us, err);
	if (status == STATUS_OK && factors_check_finished(&s->check)) {
		s->solution->report = s->check.report;
		s->solution->reported = true;
	}
	return status;
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
