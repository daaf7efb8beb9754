#include "server/worker/technique/radiosity/survey.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/base/angle.h"
#include "server/worker/technique/radiosity/radiosity_options.h"

struct survey {
	struct solution *solution;
	float *area; // by element
	struct factors_check check;
	bool checking;
	bool again; // it is that of the projected rows
};

static enum status begin_checking(struct survey *s, struct error *err)
{
	free(s->area);
	s->area = NULL;
	const struct solution *v = s->solution;
	enum status status = element_buffers_areas(&v->factors->buffers, &v->factors->elements, v->device, &s->area, err);
	if (status == STATUS_OK)
		status =
		    factors_check_init(&s->check, s->again ? &v->projected : &v->factors->factors, s->area, v->reached, err);
	s->checking = status == STATUS_OK;
	if (s->solution->options.factors.rows.way == ROWS_BY_HEMISPHERE)
		s->check.rays = s->solution->options.factors.rows.rays;
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
	if (status != STATUS_OK || !factors_check_finished(&s->check))
		return status;
	if (s->again)
		s->solution->projected_reciprocity = s->check.report.reciprocity_mean;
	else
		s->solution->report = s->check.report;
	s->solution->reported = s->again || s->solution->options.project == RADIOSITY_PROJECT_NONE;
	s->again = true;
	s->checking = false;
	factors_check_finish(&s->check);
	return STATUS_OK;
}

// The largest B of what light reaches, and the largest part of one that is reflected.
static void account_for_light(const struct solution *v, struct frame *f)
{
	double b = 0, most = 0;
	for (uint32_t i = 0; i < v->factors->elements.count; i++)
		for (uint32_t c = 0; c < 3 && v->reached[i]; c++) {
			const double h = (double)v->irradiance[3 * (size_t)i + c];
			const double reflected = (double)v->made_of[i].albedo[c] * h;
			most = fmax(most, reflected);
			b = fmax(b, PI * (double)v->made_of[i].emission[c] + reflected);
		}
	frame_add_figure(f, "b.most", b, "W/m²");
	frame_add_figure(f, "reflected.most", most, "W/m²");
}

void survey_account(const struct solution *solution, struct frame *f)
{
	const struct factors_report *r = &solution->report;
	if (!solution->reported)
		return;
	account_for_light(solution, f);
	frame_add_figure(f, "check.rows", r->rows, "");
	frame_add_figure(f, "check.factors", (double)r->entries, "");
	frame_add_figure(f, "sum.least", r->sum_least, "");
	frame_add_figure(f, "sum.mean", r->sum_mean, "");
	frame_add_figure(f, "sum.most", r->sum_most, "");
	frame_add_figure(f, "sum.all.least", r->all_least, "");
	frame_add_figure(f, "sum.all.mean", r->all_mean, "");
	frame_add_figure(f, "sum.all.most", r->all_most, "");
	frame_add_figure(f, "reciprocity.mean", r->reciprocity_mean, "");
	if (r->reciprocity_chance > 0)
		frame_add_figure(f, "reciprocity.chance", r->reciprocity_chance, "");
	if (solution->options.project != RADIOSITY_PROJECT_NONE)
		frame_add_figure(f, "reciprocity.projected", solution->projected_reciprocity, "");
	frame_add_figure(f, "reciprocity.most", r->reciprocity_most, "");
	frame_add_figure(f, "reciprocity.pairs", (double)r->pairs, "");
	for (uint32_t i = 0; i < FACTORS_DECADES; i++) {
		char name[24] = "values.0";
		if (i < FACTORS_DECADES - 1)
			snprintf(name, sizeof name, "values.1e-%u", i + 1);
		frame_add_figure(f, name, (double)r->decades[i], "");
	}
}
