#include "server/report/results.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/report/words.h"

static void put(json_t *object, const char *key, double value)
{
	json_object_set_new(object, key, results_number(value));
}

// A value with the ends of its interval.
static void put_interval(json_t *object, const char *key, double value, struct interval interval)
{
	char low[LIMIT_NAME], high[LIMIT_NAME];
	snprintf(low, sizeof low, "%s_low", key);
	snprintf(high, sizeof high, "%s_high", key);
	put(object, key, value);
	put(object, low, interval.low);
	put(object, high, interval.high);
}

// The median of each stage over the runs that are warm, or cold: [{"name", "seconds"}], in the order of the first run.
static json_t *stages_of(const struct point *p, bool warm)
{
	json_t *stages = json_array();
	double values[RUNS_OF_POINT];
	const struct study_run *first = NULL;
	const json_t *stage;
	size_t i;
	for (i = 0; i < p->count && !first; i++)
		if (p->runs[i].warm == warm && p->runs[i].stages)
			first = &p->runs[i];
	if (!first)
		return stages;
	json_array_foreach(first->stages, i, stage)
	{
		const char *name = json_string_value(json_object_get(stage, "name"));
		size_t count = 0;
		for (size_t k = 0; k < p->count && name; k++) {
			const json_t *other = NULL;
			size_t at;
			if (p->runs[k].warm != warm)
				continue;
			json_array_foreach(p->runs[k].stages, at, other)
			{
				const char *of = json_string_value(json_object_get(other, "name"));
				const double us = json_number_value(json_object_get(other, "us"));
				if (of && strcmp(of, name) == 0 && us >= 0 && isfinite(us)) {
					values[count++] = 1e-6 * us;
					break;
				}
			}
		}
		if (count > 0)
			json_array_append_new(
			    stages, json_pack("{s:s, s:f}", "name", name, "seconds", statistics_median(values, count)));
	}
	return stages;
}

static json_t *point_json(const struct point *p)
{
	const struct study_run *run = &p->runs[0], *shown = p->shown ? p->shown : run;
	json_t *point = json_pack("{s:i, s:O, s:s, s:s}", "view", (int)run->view, "settings", run->settings, "effects",
				  run->effects, "command", shown->command);
	if (!point)
		return NULL;
	put_interval(point, "seconds", p->seconds, p->seconds_interval);
	put_interval(point, "relmse", p->relmse, p->relmse_interval);
	put(point, "relmse_measured", p->relmse_measured);
	put(point, "relmse_noise", p->relmse_noise);
	json_object_set_new(point, "resolved", json_boolean(p->resolved));
	put(point, "rmse", p->rmse);
	put(point, "mean_difference", p->mean_difference);
	put(point, "flip", p->flip);
	put(point, "flip_max", p->flip_max);
	put_interval(point, "efficiency", p->efficiency, p->efficiency_interval);
	json_object_set_new(point, "pareto", json_boolean(p->pareto));
	json_object_set_new(point, "runs", json_integer((json_int_t)p->count));
	json_object_set_new(point, "seeds", json_integer((json_int_t)p->seeds));
	json_object_set_new(point, "warm_runs", json_integer((json_int_t)p->warm_runs));
	put(point, "cold_seconds", p->cold_seconds);
	json_object_set_new(point, "stages", stages_of(p, true));
	json_object_set_new(point, "cold_stages", stages_of(p, false));
	json_object_set_new(point, "bias",
			    p->bias.tiles ? json_pack("{s:i, s:f, s:f}", "tiles", (int)p->bias.tiles, "share", p->bias.share,
						      "share_uncorrected", p->bias.by_chance)
					  : json_null());
	json_object_set_new(point, "image", p->shown ? json_string(p->shown->image) : json_null());
	return point;
}

static json_t *lowest_json(const struct judge_floor *floor)
{
	static const char *const falls[] = {"unknown", "falling", "held"};
	json_t *lowest = json_pack("{s:f, s:s}", "relmse", floor->point->relmse, "with_samples", falls[floor->fall]);
	put(lowest, "samples", floor->point->runs[0].samples);
	put_interval(lowest, "level", floor->level, floor->interval);
	return lowest;
}

static json_t *techniques_json(const struct figures *f, const struct judgement *j)
{
	json_t *techniques = json_array();
	for (size_t t = 0; t < j->technique_count; t++) {
		json_t *points = json_array(), *colds = json_array(), *floors = json_array(), *lowest = json_array();
		for (size_t i = 0; i < f->point_count; i++)
			if (judge_technique_of(j, f->points[i].runs[0].technique) == t)
				json_array_append_new(points, point_json(&f->points[i]));
		for (size_t i = 0; i < f->cold_count; i++)
			if (judge_technique_of(j, f->colds[i].runs[0].technique) == t)
				json_array_append_new(colds, point_json(&f->colds[i]));
		for (uint32_t view = 0; view < j->view_count; view++) {
			const struct judge_floor *floor = &j->views[view].floors[t];
			json_array_append_new(floors, results_number(judge_level(floor)));
			json_array_append_new(lowest, floor->point ? lowest_json(floor) : json_null());
		}
		json_array_append_new(techniques, json_pack("{s:s, s:b, s:o, s:o, s:o, s:o, s:o}", "name",
							    j->techniques[t].name, "noise", j->techniques[t].converges,
							    "floor", results_number(judge_floor_of_all(j, t)), "floors",
							    floors, "lowest", lowest, "points", points, "cold", colds));
	}
	return techniques;
}

// ---- views ----

static json_t *row_json(const struct judgement *j, const struct judge_row *row)
{
	json_t *points = json_array();
	for (size_t t = 0; t < j->technique_count; t++) {
		const struct point *p = row->points[t];
		if (!p)
			continue;
		json_t *point = json_pack("{s:s, s:O, s:s}", "technique", j->techniques[t].name, "settings",
					  p->runs[0].settings, "command", p->shown->command);
		put(point, "seconds", p->seconds);
		put(point, "relmse", p->relmse);
		put(point, "flip", p->flip);
		json_array_append_new(points, point);
	}
	return json_pack("{s:f, s:o}", row->is_time ? "seconds" : "relmse", row->target, "points", points);
}

static json_t *view_json(const struct figures *f, const struct judgement *j, uint32_t view)
{
	char unnamed[32];
	const struct reference *r = &f->views[view];
	const struct judge_view *v = &j->views[view];
	json_t *reference = r->run ? json_pack("{s:s, s:s, s:s}", "image", r->run->image, "command", r->run->command, "kind",
					       r->run->error_kind)
				   : json_null();
	json_t *spans = json_array(), *overtakes = json_array(), *times = json_array(), *errors = json_array();
	if (r->run) {
		put(reference, "samples", r->run->samples);
		put_interval(reference, "relmse", r->relmse, (struct interval){r->low, r->high});
		put(reference, "seconds", r->run->seconds);
		put(reference, "exposure_ev", r->exposure_ev);
	}
	for (size_t i = 0; i < v->span_count; i++)
		json_array_append_new(spans, json_pack("{s:s, s:f, s:f, s:f, s:b, s:s?}", "technique",
						       j->techniques[v->spans[i].technique].name, "from_seconds",
						       v->spans[i].first->seconds, "best_seconds", v->spans[i].best->seconds,
						       "relmse", v->spans[i].best->relmse, "resolved",
						       v->spans[i].best->resolved, "not_told_from",
						       v->spans[i].rival ? v->spans[i].rival->runs[0].technique : NULL));
	for (size_t i = 0; i < v->overtake_count; i++) {
		const struct judge_overtake *o = &v->overtakes[i];
		json_t *settings = o->point ? json_incref((json_t *)o->point->runs[0].settings) : json_null();
		json_array_append_new(
		    overtakes, json_pack("{s:s, s:s, s:o, s:b, s:b, s:o}", "technique", j->techniques[o->winner].name,
					 "overtaken", j->techniques[o->loser].name, "seconds", results_number(o->seconds),
					 "from_first", o->from_first, "closer", o->closer, "settings", settings));
	}
	for (size_t i = 0; i < v->row_count; i++)
		json_array_append_new(v->rows[i].is_time ? times : errors, row_json(j, &v->rows[i]));
	return json_pack("{s:s, s:O?, s:o, s:o, s:o, s:o, s:o}", "name", study_view_name(f->study, view, unnamed), "camera",
			 json_object_get(json_array_get(json_object_get(f->study->json, "views"), view), "camera"),
			 "reference", reference, "best", spans, "overtakes", overtakes, "equal_time", times, "equal_error",
			 errors);
}

json_t *results_json(const struct figures *f, const struct judgement *j)
{
	static const char *const kept[] = {"scene", "command", "candil", "device",  "machine", "started",  "ended",
					   "size",  "seeds",   "title",  "skipped", "notes",   "budget_s", "complete"};
	json_t *views = json_array(), *study = json_object();
	for (uint32_t view = 0; view < j->view_count; view++)
		json_array_append_new(views, view_json(f, j, view));
	for (size_t i = 0; i < sizeof kept / sizeof *kept; i++) {
		json_t *value = json_object_get(f->study->json, kept[i]);
		if (value)
			json_object_set(study, kept[i], value);
	}
	json_t *method =
	    json_pack("{s:s, s:f, s:i, s:i, s:s, s:s, s:s, s:f, s:i}", "interval",
		      "over seeds: of 8 or more the studentised bootstrap, of fewer Student's t of the logarithm",
		      "interval_share", STATISTICS_SHARE, "resamples", (int)STATISTICS_RESAMPLES, "seed",
		      (int)STATISTICS_SEED, "relmse", "mean((x-r)^2/(r^2+0.01)) less the reference's own, never below 0",
		      "seconds", "median of warm runs, arrival to last byte", "bias",
		      "Welch's t-test of each tile's mean luminance; Benjamini-Hochberg", "bias_alpha", BIAS_ALPHA, "tile",
		      (int)f->tile);
	return json_pack("{s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:O, s:o}", "version", 1, "words", words_of(f, j),
			 "techniques", techniques_json(f, j), "views", views, "ablation", ablation_json(f), "predictions",
			 predictions_json(f), "study", study, "missing", f->study->missing, "method", method);
}

// ---- CSV ----

// A spreadsheet takes a text that begins so for a formula, and runs it; after an apostrophe it does not.
static void csv_text(FILE *out, const char *text)
{
	fputc('"', out);
	if (*text && strchr("=+-@\t\r", *text))
		fputc('\'', out);
	for (; *text; text++) {
		if (*text == '"')
			fputc('"', out);
		fputc(*text, out);
	}
	fputc('"', out);
}

static void csv_number(FILE *out, double value)
{
	if (isfinite(value))
		fprintf(out, ",%.9g", value);
	else
		fputc(',', out);
}

char *results_csv(const struct figures *f)
{
	char *text = NULL, unnamed[32];
	size_t bytes = 0;
	FILE *out = open_memstream(&text, &bytes);
	if (!out)
		return NULL;
	fputs("view,technique,effects,settings,seconds,seconds_low,seconds_high,cold_seconds,relmse,relmse_low,relmse_high,"
	      "relmse_measured,relmse_noise,resolved,rmse,mean_difference,flip,efficiency,efficiency_low,efficiency_high,"
	      "pareto,runs,seeds,"
	      "bias_share,command\r\n",
	      out);
	for (size_t i = 0; i < f->point_count; i++) {
		const struct point *p = &f->points[i];
		const struct study_run *run = &p->runs[0];
		char *settings = words_settings(run->settings);
		csv_text(out, study_view_name(f->study, run->view, unnamed));
		fputc(',', out);
		csv_text(out, run->technique);
		fputc(',', out);
		csv_text(out, run->effects);
		fputc(',', out);
		csv_text(out, settings ? settings : "");
		free(settings);
		const double before[] = {
		    p->seconds,     p->seconds_interval.low, p->seconds_interval.high, p->cold_seconds,
		    p->relmse,      p->relmse_interval.low,  p->relmse_interval.high,  p->relmse_measured,
		    p->relmse_noise};
		for (size_t k = 0; k < sizeof before / sizeof *before; k++)
			csv_number(out, before[k]);
		fprintf(out, ",%d", p->resolved);
		const double after[] = {p->rmse,       p->mean_difference,         p->flip,
					p->efficiency, p->efficiency_interval.low, p->efficiency_interval.high};
		for (size_t k = 0; k < sizeof after / sizeof *after; k++)
			csv_number(out, after[k]);
		fprintf(out, ",%d,%zu,%zu", p->pareto, p->count, p->seeds);
		csv_number(out, p->bias.tiles ? p->bias.share : (double)NAN);
		fputc(',', out);
		csv_text(out, p->shown ? p->shown->command : run->command);
		fputs("\r\n", out);
	}
	const bool whole = !ferror(out);
	if (fclose(out) == 0 && whole)
		return text;
	free(text);
	return NULL;
}
