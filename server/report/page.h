// report.html: one file that a browser opens, without a request to any network, with every figure as a table and, where
// scripts run, plots and comparers. The template is page/report.html. One thread.
#ifndef CANDIL_REPORT_PAGE_H
#define CANDIL_REPORT_PAGE_H

#include "server/report/pictures.h"
#include "server/report/results.h"

struct page {
	const struct figures *figures;
	const struct judgement *judgement;
	const struct pictures *pictures;
	const json_t *results; // results_json's
	const char *chart; // the text of Chart.js; NULL: it is not there
	const char *hard; // the page of hard cases; NULL: it is not there
	const char *hard_path; // as the page names it
	const char *hard_link; // where it is, absolute; NULL: unknown
	unsigned brief; // how much is left out, PAGE_…
};

// What a page leaves out that would be too long, each also what the ones before it do. The files beside it have it all.
#define PAGE_WHOLE 0u
#define PAGE_NO_SINGLE_RUNS 1u // the rows of hard cases and of single runs, the table of commands
#define PAGE_NO_STAGES 2u // stages, and in the plots the commands
#define PAGE_FRONT_ALONE \
	3u // points that are not on the Pareto front, the plots, pictures, effects, and a long list of misses

// Write the page to a file, of LIMIT_REPORT_BYTES at most: a longer one becomes brief. STATUS_LIMIT: it is longer all the
// same; STATUS_IO; STATUS_MEMORY.
enum status page_write(struct page *page, const char *path, struct error *err);

// The page's tables, each a function that fills a slot of the template; `context` is a struct page.
void table_points(struct html *html, const void *context);
void table_commands(struct html *html, const void *context);
void table_stages(struct html *html, const void *context);
void table_ablation(struct html *html, const void *context);
void table_predictions(struct html *html, const void *context);
void table_facts(struct html *html, const void *context);
void table_missing(struct html *html, const void *context);
void table_references(struct html *html, const void *context);

#endif
