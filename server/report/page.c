#include "server/report/page.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/report/hard.h"
#include "server/report/page/report.css.h"
#include "server/report/page/report.html.h"
#include "server/report/page/report.js.h"
#include "server/report/words.h"

static void write_title(struct html *html, const void *context)
{
	const struct page *page = context;
	html_text(html, page->figures->study->title);
}

static void write_style(struct html *html, const void *context)
{
	const struct page *page = context;
	shot_style(html);
	html_raw(html, page_report_style);
	if (page->brief < PAGE_FRONT_ALONE)
		fwrite(page->pictures->css.text, 1, html_size((struct html *)&page->pictures->css), html->out);
}

static void write_words(struct html *html, const void *context)
{
	const struct page *page = context;
	const json_t *word;
	size_t i;
	json_array_foreach(json_object_get(page->results, "words"), i, word)
	    html_put(html, "<li>%s\n", json_string_value(word));
}

// ---- rows of pictures ----

static void write_shot(struct html *html, const struct page *page, uint32_t view, const struct point *p)
{
	const int number = pictures_find(page->pictures, view, p);
	char seconds[WORDS_NUMBER], error[WORDS_NUMBER], flip[WORDS_NUMBER], caption[192] = "the reference";
	char *settings = p ? words_settings(p->runs[0].settings) : NULL, *title = NULL;
	if (p)
		snprintf(caption, sizeof caption, "%s, relMSE %s%s, FLIP %s", words_seconds(p->seconds, seconds),
			 words_error(p->relmse, error), p->resolved ? "" : " (not resolved)", words_error(p->flip, flip));
	const double samples = page->figures->views[view].run ? page->figures->views[view].run->samples : (double)NAN;
	if ((p ? asprintf(&title, "%s, %s", p->runs[0].technique, settings ? settings : "?")
	       : asprintf(&title, isfinite(samples) ? "reference, samples %.0f" : "reference", samples)) < 0)
		title = NULL;
	if (number >= 0 && title && page->brief < PAGE_FRONT_ALONE)
		shot_figure(html, (unsigned)number, page->pictures->width, page->pictures->height, p != NULL, title,
			    caption);
	free(settings);
	free(title);
}

// The techniques that have nothing to show for a target, for one of two reasons.
static void write_absent(struct html *html, const struct judgement *j, const struct judge_row *row, bool unresolved)
{
	const char *absent[JUDGE_TECHNIQUES];
	size_t count = 0;
	for (size_t t = 0; t < j->technique_count; t++)
		if (!row->points[t] && row->unresolved[t] == unresolved)
			absent[count++] = j->techniques[t].name;
	if (count == 0)
		return;
	html_raw(html, "<p class=\"soft\">");
	for (size_t i = 0; i < count; i++)
		html_put(html, "%s%s", i == 0 ? "" : i + 1 < count ? ", " : " and ", absent[i]);
	if (unresolved)
		html_put(html, " %s within the reference's own error.</p>\n", count == 1 ? "has one" : "have some");
	else
		html_put(html, " %s%s.</p>\n", count == 1 ? "has no picture" : "have no pictures",
			 row->is_time ? " in this time" : " so accurate");
}

static void write_row(struct html *html, const struct page *page, uint32_t view, const struct judge_row *row)
{
	const struct judgement *j = page->judgement;
	char target[WORDS_NUMBER], name[32];
	html_raw(html, "<section class=\"row\"><h3>");
	if (j->view_count > 1)
		html_put(html, "%s: ", study_view_name(page->figures->study, view, name));
	html_put(html,
		 row->is_time ? "the best of each within %s</h3>\n" : "the quickest of each with relMSE up to %s</h3>\n",
		 row->is_time ? words_seconds(row->target, target) : words_error(row->target, target));
	write_absent(html, j, row, false);
	write_absent(html, j, row, true);
	html_raw(html, "<div class=\"strip\" data-strip>\n");
	for (size_t t = 0; t < j->technique_count; t++)
		if (row->points[t])
			write_shot(html, page, view, row->points[t]);
	write_shot(html, page, view, NULL);
	html_raw(html, "</div></section>\n");
}

static void write_rows(struct html *html, const struct page *page, bool is_time)
{
	bool any = false;
	for (uint32_t view = 0; view < page->judgement->view_count; view++)
		for (size_t r = 0; r < page->judgement->views[view].row_count; r++)
			if (page->judgement->views[view].rows[r].is_time == is_time) {
				write_row(html, page, view, &page->judgement->views[view].rows[r]);
				any = true;
			}
	html_raw(html, any ? "" : "<p>There is nothing to compare: no point has a picture, an error and a time.</p>\n");
}

static void write_equal_time(struct html *html, const void *context)
{
	write_rows(html, context, true);
}

static void write_equal_error(struct html *html, const void *context)
{
	write_rows(html, context, false);
}

static void write_legend(struct html *html, const void *context)
{
	const struct page *page = context;
	shot_legend(html);
	if (page->pictures->width < page->figures->study->width || page->pictures->height < page->figures->study->height)
		html_put(html,
			 "<p class=\"soft\">Shown are %u x %u pixels of %u x %u, where the techniques differ most; whole "
			 "pictures "
			 "are PNGs beside this page.</p>\n",
			 page->pictures->width, page->pictures->height, page->figures->study->width,
			 page->figures->study->height);
}

static void write_bias(struct html *html, const void *context)
{
	const struct page *page = context;
	const struct figures *f = page->figures;
	const struct judgement *j = page->judgement;
	char share[WORDS_NUMBER], chance[WORDS_NUMBER];
	bool any = false;
	html_raw(html, "<div class=\"strip\">\n");
	for (uint32_t view = 0; view < j->view_count; view++)
		for (size_t t = 0; t < j->technique_count; t++) {
			const struct point *p = judge_best(f, view, j->techniques[t].name);
			if (!p || p->bias.tiles == 0)
				continue;
			char *settings = words_settings(p->runs[0].settings);
			html_put(html, "<figure class=\"shot\" style=\"--w:%u;--h:%u\">", f->columns, f->rows);
			html_put(html, "<div class=\"pic b%u\" role=\"img\" aria-label=\"map of the bias of %s\"></div>",
				 (unsigned)(view * JUDGE_TECHNIQUES + t), j->techniques[t].name);
			html_put(
			    html,
			    "<figcaption><b>%s, %s</b>bias in %s of the tiles (%s without correction; 5 %% would be chance)"
			    "</figcaption></figure>\n",
			    j->techniques[t].name, settings ? settings : "?", words_share(p->bias.share, share),
			    words_share(p->bias.by_chance, chance));
			free(settings);
			any = true;
		}
	html_raw(html, "</div>\n");
	if (any)
		pictures_bias_legend(html);
	else
		html_raw(html, "<p>Unknown: beside a reference there must be a point with two seeds, and one with two seeds "
			       "that was made "
			       "as the reference was, with fewer samples: it tells the reference's own noise.</p>\n");
}

static void write_tile(struct html *html, const void *context)
{
	const struct page *page = context;
	html_put(html, "%u x %u", page->figures->tile, page->figures->tile);
}

// A path as part of an address: what has a meaning there, or none, by its code.
static void write_path(struct html *html, const char *path)
{
	for (; *path; path++) {
		char code[4] = {*path};
		if (!isalnum((unsigned char)*path) && !strchr("/-._~", *path))
			snprintf(code, sizeof code, "%%%02X", (unsigned)(unsigned char)*path);
		html_raw(html, code);
	}
}

static void write_hard(struct html *html, const void *context)
{
	const struct page *page = context;
	if (!page->hard || page->brief) {
		html_put(html, "<p>%s</p>\n",
			 page->hard ? "They find no room on this page." : "This page was written without them.");
		return;
	}
	html_put(html, "<details><summary>the rows of %s</summary>\n", page->hard_path);
	if (page->hard_link) {
		html_raw(html, "<p><a href=\"file://");
		write_path(html, page->hard_link);
		html_put(html, "\">%s</a>, where it lay when this page was written</p>\n", page->hard_path);
	}
	hard_write(html, page->hard, page->judgement);
	html_raw(html, "</details>\n");
}

static void forget(json_t *points)
{
	static const char *const long_ones[] = {"command", "stages", "cold_stages", "image", "bias"};
	json_t *point;
	size_t i;
	json_array_foreach(points, i, point)
	{
		for (size_t k = 0; k < sizeof long_ones / sizeof *long_ones; k++)
			json_object_del(point, long_ones[k]);
	}
}

// What the scripts get: what the page has, and no more.
static void write_data(struct html *html, const void *context)
{
	const struct page *page = context;
	if (page->brief >= PAGE_FRONT_ALONE) {
		html_raw(html, "{}");
		return;
	}
	json_t *shown = page->brief >= PAGE_NO_STAGES ? json_deep_copy(page->results) : json_copy((json_t *)page->results);
	json_t *technique;
	size_t t;
	json_object_del(shown, "missing");
	if (page->brief >= PAGE_NO_SINGLE_RUNS)
		json_object_del(shown, "predictions");
	json_array_foreach(page->brief >= PAGE_NO_STAGES ? json_object_get(shown, "techniques") : NULL, t, technique)
	{
		forget(json_object_get(technique, "points"));
		forget(json_object_get(technique, "cold"));
	}
	html_json(html, shown);
	json_decref(shown);
}

static void write_chart(struct html *html, const void *context)
{
	const struct page *page = context;
	if (page->chart && page->brief < PAGE_FRONT_ALONE)
		html_script(html, page->chart, strlen(page->chart));
}

static void write_script(struct html *html, const void *context)
{
	(void)context;
	shot_script(html);
	html_raw(html, page_report_script);
}

static const struct html_slot slots[] = {
    {"title", write_title},
    {"style", write_style},
    {"words", write_words},
    {"points", table_points},
    {"commands", table_commands},
    {"references", table_references},
    {"equal_time", write_equal_time},
    {"equal_error", write_equal_error},
    {"legend", write_legend},
    {"bias", write_bias},
    {"tile", write_tile},
    {"stages", table_stages},
    {"ablation", table_ablation},
    {"predictions", table_predictions},
    {"hard", write_hard},
    {"missing", table_missing},
    {"facts", table_facts},
    {"data", write_data},
    {"chart", write_chart},
    {"script", write_script},
    {NULL, NULL},
};

enum status page_write(struct page *page, const char *path, struct error *err)
{
	enum status s = STATUS_LIMIT;
	for (page->brief = PAGE_WHOLE; page->brief <= PAGE_FRONT_ALONE; page->brief++) {
		struct html html;
		s = html_init(&html, err);
		if (s == STATUS_OK)
			html_template(&html, page_report, slots, page);
		const size_t bytes = s == STATUS_OK ? html_size(&html) : 0;
		const bool fits = s == STATUS_OK && bytes <= LIMIT_REPORT_BYTES;
		if (fits)
			s = html_save(&html, path, err);
		else if (s == STATUS_OK)
			s = error_set(err, STATUS_LIMIT,
				      "the page has %zu bytes; the limit is %u: study fewer points or views", bytes,
				      LIMIT_REPORT_BYTES);
		html_finish(&html);
		if (fits || s != STATUS_LIMIT)
			return s;
	}
	return s;
}
