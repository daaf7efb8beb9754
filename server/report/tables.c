#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/report/page.h"
#include "server/report/words.h"

// ---- cells ----

static void cell_seconds(struct html *html, double seconds)
{
	char text[WORDS_NUMBER];
	html_put(html, "<td>%s", words_seconds(seconds, text));
}

static void cell_error(struct html *html, double error)
{
	char text[WORDS_NUMBER];
	html_put(html, "<td>%s", words_error(error, text));
}

static void cell_share(struct html *html, double share)
{
	char text[WORDS_NUMBER];
	html_put(html, "<td>%s", words_share(share, text));
}

typedef const char *(*words_number)(double value, char out[WORDS_NUMBER]);

static void cell_interval(struct html *html, double value, struct interval interval, words_number words)
{
	char text[3][WORDS_NUMBER];
	html_put(html, "<td>%s", words(value, text[0]));
	if (isfinite(interval.low) && isfinite(interval.high) && interval.low < interval.high)
		html_put(html, "<br><small>%s … %s</small>", words(interval.low, text[1]), words(interval.high, text[2]));
}

static double number_of(const json_t *object, const char *key)
{
	const json_t *value = json_object_get(object, key);
	return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

static const char *text_of(const json_t *object, const char *key)
{
	const char *text = json_string_value(json_object_get(object, key));
	return text ? text : "";
}

static void name_settings(struct html *html, const char *technique, const json_t *settings, const char *effects)
{
	char *text = words_settings(settings);
	html_put(html, "%s, %s", technique, text ? text : "?");
	if (strcmp(effects, "auto") != 0)
		html_put(html, ", effects %s", effects);
	free(text);
}

// `heads`: the columns' names, each after its own "<th>".
static void open_table(struct html *html, const char *caption, const char *heads)
{
	html_put(html, "<div class=\"wide\"><table><caption>%s</caption><thead><tr>", caption);
	for (const char *next; *heads; heads = next) {
		next = strstr(heads + 1, "<th");
		next = next ? next : heads + strlen(heads);
		html_put(html, "<th scope=\"col\"");
		fwrite(heads + 3, 1, (size_t)(next - heads) - 3, html->out);
	}
	html_raw(html, "</tr></thead><tbody>\n");
}

static void close_table(struct html *html)
{
	html_raw(html, "</tbody></table></div>\n");
}

static void name_view(struct html *html, const struct page *page, uint32_t view)
{
	char unnamed[32];
	if (page->figures->study->views > 1)
		html_put(html, "<h3>%s</h3>\n", study_view_name(page->figures->study, view, unnamed));
}

// ---- points ----

static void row_of_point(struct html *html, const struct point *p)
{
	html_raw(html, p->pareto ? "<tr class=\"pareto\"><td>" : "<tr><td>");
	html_raw(html, p->pareto ? "★ " : "");
	name_settings(html, p->runs[0].technique, p->runs[0].settings, p->runs[0].effects);
	cell_interval(html, p->seconds, p->seconds_interval, words_seconds);
	cell_interval(html, p->relmse, p->relmse_interval, words_error);
	if (!p->resolved && isfinite(p->relmse))
		html_raw(html, "<br><small class=\"warn\">not resolved</small>");
	cell_error(html, p->rmse);
	html_raw(html, "<td>");
	html_raw(html, p->mean_difference > 0 ? "+" : "");
	char text[WORDS_NUMBER];
	html_text(html, words_error(p->mean_difference, text));
	cell_error(html, p->flip);
	if (isfinite(p->efficiency))
		cell_interval(html, p->efficiency, p->efficiency_interval, words_error);
	else
		html_raw(html, "<td>");
	cell_share(html, p->bias.tiles ? p->bias.share : (double)NAN);
	html_put(html, "<td>%zu</tr>\n", p->seeds);
}

void table_points(struct html *html, const void *context)
{
	const struct page *page = context;
	const struct figures *f = page->figures;
	for (uint32_t view = 0; view < f->study->views; view++) {
		name_view(html, page, view);
		open_table(
		    html,
		    "Every point, by technique and time. ★: nothing else is as quick and as accurate (the Pareto front). "
		    "Small figures: 95 % intervals over the seeds and the reference's own error; of two seeds they are "
		    "wide. "
		    "Efficiency: where noise is at least half of the error; its interval is over the seeds alone.",
		    "<th>settings<th>time<th>relMSE<th>RMSE<th>signed<br>mean<th>FLIP<th>efficiency<br>1/"
		    "(relMSE·s)<th>tiles "
		    "with<br>bias<th>seeds");
		for (size_t i = 0; i < f->point_count; i++)
			if (f->points[i].runs[0].view == view && (page->brief < PAGE_FRONT_ALONE || f->points[i].pareto))
				row_of_point(html, &f->points[i]);
		close_table(html);
	}
	if (page->brief >= PAGE_FRONT_ALONE)
		html_raw(html, "<p>Only those of the Pareto front find room on this page; results.csv has all.</p>\n");
}

void table_commands(struct html *html, const void *context)
{
	const struct page *page = context;
	const struct figures *f = page->figures;
	if (page->brief) {
		html_raw(html, "<p>They find no room on this page, and are in results.csv.</p>\n");
		return;
	}
	html_raw(html,
		 "<p>They name files as the study was told them: run them where the study's own command was run, which "
		 "is below.</p>\n");
	open_table(html, "The command of each point, of its first seed", "<th>settings<th class=\"t\">command");
	for (size_t i = 0; i < f->point_count; i++) {
		const struct point *p = &f->points[i];
		html_raw(html, "<tr><td>");
		name_settings(html, p->runs[0].technique, p->runs[0].settings, p->runs[0].effects);
		html_put(html, "<td class=\"free\"><code>%s</code></tr>\n",
			 p->shown ? p->shown->command : p->runs[0].command);
	}
	close_table(html);
}

void table_references(struct html *html, const void *context)
{
	const struct page *page = context;
	const struct figures *f = page->figures;
	char unnamed[32];
	open_table(html, "The references, and their own error with the 90 % interval that the reply stated",
		   "<th>view<th>samples<th>relMSE<th>known by<th>time<th>shown at<th class=\"t\">command");
	for (uint32_t view = 0; view < f->study->views; view++) {
		const struct reference *r = &f->views[view];
		html_put(html, "<tr><td>%s", study_view_name(f->study, view, unnamed));
		if (!r->run) {
			html_raw(html, "<td colspan=\"6\" class=\"t warn\">missing</tr>\n");
			continue;
		}
		html_put(html, "<td>%.0f", r->run->samples);
		cell_interval(html, r->relmse, (struct interval){r->low, r->high}, words_error);
		html_put(html, "<td>%s", r->run->error_kind);
		cell_seconds(html, r->run->seconds);
		html_put(html, "<td>%+.1f EV<td class=\"free\"><code>%s</code></tr>\n", r->exposure_ev, r->run->command);
	}
	close_table(html);
}

// ---- stages ----

static void row_of_stages(struct html *html, const json_t *point, const char *technique, const char *stages_key,
			  double seconds, const char *what)
{
	const json_t *stages = json_object_get(point, stages_key), *stage;
	char text[WORDS_NUMBER];
	size_t i;
	if (json_array_size(stages) == 0)
		return;
	html_raw(html, "<tr><td>");
	name_settings(html, technique, json_object_get(point, "settings"), text_of(point, "effects"));
	html_put(html, "<td class=\"t\">%s", what);
	cell_seconds(html, seconds);
	html_raw(html, "<td class=\"free\">");
	json_array_foreach(stages, i, stage) html_put(html, "%s%s&nbsp;%s", i == 0 ? "" : ", ", text_of(stage, "name"),
						      words_seconds(number_of(stage, "seconds"), text));
	html_raw(html, "</tr>\n");
}

void table_stages(struct html *html, const void *context)
{
	const struct page *page = context;
	const json_t *technique, *point;
	size_t t, i;
	if (page->brief >= PAGE_NO_STAGES) {
		html_raw(html, "<p>They find no room on this page, and are in results.json.</p>\n");
		return;
	}
	open_table(html,
		   "Time by stage, the median of the warm runs; of cold ones, which compile first; and of the first of its "
		   "settings where all was compiled, which makes what the scene keeps for them",
		   "<th>settings<th class=\"t\">runs<th>time<th class=\"t\">stages");
	json_array_foreach(json_object_get(page->results, "techniques"), t, technique)
	{
		const char *name = text_of(technique, "name");
		json_array_foreach(json_object_get(technique, "cold"), i, point)
		{
			row_of_stages(html, point, name, "cold_stages", number_of(point, "cold_seconds"), "cold");
			row_of_stages(html, point, name, "stages", number_of(point, "seconds"), "first of its settings");
		}
		json_array_foreach(json_object_get(technique, "points"), i, point)
		{
			row_of_stages(html, point, name, "stages", number_of(point, "seconds"), "warm");
			row_of_stages(html, point, name, "cold_stages", number_of(point, "cold_seconds"), "cold");
		}
	}
	close_table(html);
}

// ---- effects ----

void table_ablation(struct html *html, const void *context)
{
	const struct page *page = context;
	const json_t *ablation = json_object_get(page->results, "ablation"), *row;
	size_t i;
	if (json_array_size(ablation) == 0) {
		html_raw(html, "<p>The study has no runs with an effect switched off.</p>\n");
		return;
	}
	if (page->brief >= PAGE_FRONT_ALONE) {
		html_raw(html, "<p>They find no room on this page, and are in results.json.</p>\n");
		return;
	}
	open_table(html, "With one effect switched off, beside the same settings with all of them",
		   "<th>settings<th>time<th>time saved<th>relMSE<th>relMSE with all<th>error incurred<th>signed mean");
	json_array_foreach(ablation, i, row)
	{
		html_raw(html, "<tr><td>");
		name_settings(html, text_of(row, "technique"), json_object_get(row, "settings"), text_of(row, "effects"));
		cell_seconds(html, number_of(row, "seconds"));
		cell_share(html, number_of(row, "share_saved"));
		cell_error(html, number_of(row, "relmse"));
		cell_error(html, number_of(row, "relmse_whole"));
		cell_error(html, number_of(row, "relmse_incurred"));
		cell_error(html, number_of(row, "mean_difference"));
		html_raw(html, "</tr>\n");
	}
	close_table(html);
}

// ---- predictions ----

static void rows_of_runs(struct html *html, const json_t *runs)
{
	const json_t *run;
	size_t i;
	html_raw(html, "<details data-print><summary>every run</summary>\n");
	open_table(html, "What was said of each run, and what came out",
		   "<th>run<th class=\"t\">of<th class=\"t\">by<th>said<th>low<th>high<th>true");
	json_array_foreach(runs, i, run)
	{
		const bool is_time = strcmp(text_of(run, "of"), "seconds") == 0;
		html_put(html, "<tr><td>%s<td class=\"t\">%s<td class=\"t\">%s", text_of(run, "run"),
			 is_time ? "time" : "relMSE", text_of(run, "from"));
		static const char *const keys[] = {"predicted", "low", "high", "true"};
		for (size_t k = 0; k < 4; k++)
			(is_time ? cell_seconds : cell_error)(html, number_of(run, keys[k]));
		html_raw(html, "</tr>\n");
	}
	close_table(html);
	html_raw(html, "</details>\n");
}

void table_predictions(struct html *html, const void *context)
{
	const struct page *page = context;
	const json_t *predictions = json_object_get(page->results, "predictions");
	const json_t *summary = json_object_get(predictions, "summary"), *row;
	const double left_out = number_of(predictions, "not_resolved");
	size_t i;
	if (left_out > 0)
		html_put(html,
			 "<p class=\"soft\">%.0f predictions of an error are left out: their points are not resolved.</p>\n",
			 left_out);
	if (json_array_size(summary) == 0) {
		html_raw(html, "<p>No reply and no quote of this study predicted a figure that is known.</p>\n");
		return;
	}
	open_table(
	    html,
	    "What replies and quotes said beside what came out. The ratio is said over true; nine of ten were wrong by the "
	    "factor "
	    "at most, either way; held: how often the truth lay in the interval that was stated, which should be 90 %.",
	    "<th>technique<th class=\"t\">figure<th class=\"t\">said by<th>runs<th>median ratio<th>factor of 90 %<th>held");
	json_array_foreach(summary, i, row)
	{
		html_put(html, "<tr><td>%s<td class=\"t\">%s<td class=\"t\">%s<td>%d<td>%.2f<td>× %.2f",
			 text_of(row, "technique"), strcmp(text_of(row, "of"), "seconds") == 0 ? "time" : "relMSE",
			 text_of(row, "from"), (int)number_of(row, "runs"), number_of(row, "median_ratio"),
			 number_of(row, "factor_90"));
		cell_share(html, number_of(row, "held"));
		html_raw(html, "</tr>\n");
	}
	close_table(html);
	if (!page->brief)
		rows_of_runs(html, json_object_get(predictions, "runs"));
}

// ---- how it was made ----

// A value of study.json as a row, objects with their members one by one.
static void fact(struct html *html, const char *name, const json_t *value)
{
	const char *key;
	json_t *member;
	if (json_is_object(value)) {
		json_object_foreach((json_t *)value, key, member)
		{
			char *joined = NULL;
			if (!json_is_object(member) && asprintf(&joined, "%s, %s", name, key) >= 0)
				fact(html, joined, member);
			free(joined);
		}
		return;
	}
	char *dumped = json_is_string(value) ? strdup(json_string_value(value))
					     : json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT | JSON_REAL_PRECISION(4));
	const bool none = !dumped || json_is_null(value) || strcmp(dumped, "[]") == 0;
	if (!none && strcmp(name, "command") == 0)
		html_put(html, "<dt>%s<dd><code class=\"command\">%s</code>\n", name, dumped);
	else if (!none)
		html_put(html, "<dt>%s<dd>%s\n", name, dumped);
	free(dumped);
}

void table_facts(struct html *html, const void *context)
{
	const struct page *page = context;
	const json_t *study = json_object_get(page->results, "study");
	static const char *const keys[] = {"command", "scene", "size",     "candil",  "device",
					   "machine", "seeds", "budget_s", "started", "ended"};
	html_raw(html, "<dl class=\"facts\">\n");
	for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
		if (json_object_get(study, keys[i]))
			fact(html, keys[i], json_object_get(study, keys[i]));
	html_raw(html, "</dl>\n");
}

static void list_texts(struct html *html, const json_t *list, size_t most, const char *who, const char *what)
{
	const json_t *entry;
	size_t i;
	json_array_foreach(list, i, entry)
	{
		if (i == most) {
			html_put(html, "<li>%zu more, which results.json names\n", json_array_size(list) - i);
			break;
		}
		if (json_is_string(entry))
			html_put(html, "<li>%s\n", json_string_value(entry));
		else
			html_put(html, "<li><b>%s</b> %s\n", text_of(entry, who), text_of(entry, what));
	}
}

void table_missing(struct html *html, const void *context)
{
	const struct page *page = context;
	const json_t *study = json_object_get(page->results, "study"), *missing = page->figures->study->missing;
	const json_t *complete = json_object_get(study, "complete");
	const size_t most = page->brief >= PAGE_FRONT_ALONE ? 100 : SIZE_MAX;
	html_raw(html, "<ul>\n");
	if (json_is_false(complete))
		html_raw(html, "<li>The study is not complete: the same command goes on with it.\n");
	if (!page->chart)
		html_raw(html, "<li>The plots: Chart.js was not found when this page was written (Debian's package "
			       "libjs-chart.js). All "
			       "figures are in the tables.\n");
	if (!page->hard)
		html_raw(html, "<li>The rows of hard cases: candil-report was not told of their page (--tables).\n");
	list_texts(html, json_object_get(study, "skipped"), most, "technique", "why");
	list_texts(html, missing, most, "run", "why");
	list_texts(html, json_object_get(study, "notes"), most, "note", "why");
	html_raw(html, "</ul>\n");
}
