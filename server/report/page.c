#include "server/report/page.h"

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
		snprintf(caption, sizeof caption, "%s, relMSE %s, FLIP %s", words_seconds(p->seconds, seconds),
			 words_error(p->relmse, error), words_error(p->flip, flip));
	const double samples = page->figures->views[view].run ? page->figures->views[view].run->samples : (double)NAN;
	if ((p ? asprintf(&title, "%s, %s", p->runs[0].technique, settings ? settings : "?")
	       : asprintf(&title, isfinite(samples) ? "reference, samples %.0f" : "reference", samples)) < 0)
		title = NULL;
	if (number >= 0 && title)
		shot_figure(html, (unsigned)number, page->pictures->width, page->pictures->height, p != NULL, title,
			    caption);
	free(settings);
	free(title);
}

// The techniques that have nothing to show for a target.
static void write_absent(struct html *html, const struct judgement *j, const struct judge_row *row)
{
	const char *absent[JUDGE_TECHNIQUES];
	size_t count = 0;
	for (size_t t = 0; t < j->technique_count; t++)
		if (!row->points[t])
			absent[count++] = j->techniques[t].name;
	if (count == 0)
		return;
	html_raw(html, "<p class=\"soft\">");
	for (size_t i = 0; i < count; i++)
		html_put(html, "%s%s", i == 0 ? "" : i + 1 < count ? ", " : " and ", absent[i]);
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
	write_absent(html, j, row);
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
		html_raw(
		    html,
		    "<p>Unknown: the study has no technique with noise and at least two seeds beside a reference.</p>\n");
}

static void write_tile(struct html *html, const void *context)
{
	const struct page *page = context;
	html_put(html, "%u x %u", page->figures->tile, page->figures->tile);
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
	hard_write(html, page->hard, page->judgement);
	html_raw(html, "</details>\n");
}

static void write_data(struct html *html, const void *context)
{
	const struct page *page = context;
	json_t *shown = json_copy((json_t *)page->results);
	json_object_del(shown, "missing");
	if (page->brief)
		json_object_del(shown, "predictions");
	html_json(html, shown);
	json_decref(shown);
}

static void write_chart(struct html *html, const void *context)
{
	const struct page *page = context;
	if (page->chart)
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
	for (page->brief = false;; page->brief = true) {
		struct html html;
		enum status s = html_init(&html, err);
		if (s == STATUS_OK)
			html_template(&html, page_report, slots, page);
		const size_t bytes = s == STATUS_OK ? html_size(&html) : 0;
		if (bytes <= LIMIT_REPORT_BYTES && s == STATUS_OK)
			s = html_save(&html, path, err);
		else if (s == STATUS_OK && page->brief)
			s = error_set(err, STATUS_LIMIT,
				      "the page has %zu bytes; the limit is %u: study fewer points or views", bytes,
				      LIMIT_REPORT_BYTES);
		html_finish(&html);
		if (s != STATUS_OK || page->brief || bytes <= LIMIT_REPORT_BYTES)
			return s;
	}
}
