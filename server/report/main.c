// candil-report FOLDER: what a study measured, as results.json, results.csv, report.html and PNGs in its folder. `candil
// study` runs it when its runs are done; by itself it makes the report again. It renders nothing.
#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/base/replace.h"
#include "server/base/room.h"
#include "server/report/hard.h"
#include "server/report/page.h"

enum exit_code { EXIT_REPORTED = 0, EXIT_COULD_NOT = 1, EXIT_USAGE = 2 };

struct arguments {
	const char *folder, *tables, *chart;
};

static const char usage[] =
    "usage: candil-report FOLDER [--tables TABLE.md] [--chart chart.js]\n"
    "\n"
    "Reads the folder of a study (study.json, runs.jsonl, images) and writes results.json, results.csv, report.html and, "
    "beside\n"
    "the images that the report shows, PNGs. Renders nothing. What is missing or broken in the folder is named in the "
    "report.\n"
    "\n"
    "  --tables TABLE.md   show the rows of this page of hard cases that the study's techniques have; default: the one that "
    "was\n"
    "                      installed with this program\n"
    "  --chart chart.js    the plots' library, Chart.js 3; default: " CANDIL_CHART_JS "\n"
    "\n"
    "Exit status: 0 the report is written, 1 it is not, 2 wrong arguments.\n";

// The page of hard cases of this installation, to be freed; NULL: it has none.
static char *installed_tables(void)
{
	char self[4096];
	const ssize_t length = readlink("/proc/self/exe", self, sizeof self);
	char *path = NULL;
	if (length <= 0 || (size_t)length == sizeof self)
		return NULL;
	for (ssize_t end = length, folders = 0; end > 0; end--)
		if (self[end - 1] == '/' && ++folders == 3) {
			if (asprintf(&path, "%.*sshare/candil/TABLE.md", (int)end, self) < 0)
				return NULL;
			break;
		}
	if (path && access(path, R_OK) == 0)
		return path;
	free(path);
	return NULL;
}

// A text of at most LIMIT_REPORT_BYTES, to be freed. NULL: it cannot be read.
static char *read_text(const char *path)
{
	struct stat about;
	FILE *file = fopen(path, "rbe");
	char *text = NULL;
	if (file && fstat(fileno(file), &about) == 0 && S_ISREG(about.st_mode) && about.st_size > 0 &&
	    about.st_size <= (off_t)LIMIT_REPORT_BYTES)
		text = calloc((size_t)about.st_size + 1, 1);
	if (text && fread(text, 1, (size_t)about.st_size, file) != (size_t)about.st_size) {
		free(text);
		text = NULL;
	}
	if (file)
		fclose(file);
	return text;
}

static enum status save(const struct study *study, const char *name, const char *text, struct error *err)
{
	char *path = NULL;
	if (!text || asprintf(&path, "%s/%s", study->folder, name) < 0)
		return error_set(err, STATUS_MEMORY, "no memory for %s", name);
	const enum status s = replace_file(path, 0666, text, strlen(text), err);
	free(path);
	return s;
}

static enum status save_page(const struct arguments *args, struct page *page, struct error *err)
{
	struct study *study = page->figures->study;
	char *chart = read_text(args->chart), *hard = NULL, *path = NULL, *link, *installed = installed_tables();
	const char *tables = args->tables ? args->tables : installed;
	struct error why;
	if (tables && hard_read(tables, &hard, &why) != STATUS_OK)
		study_miss(study, NULL, "the page of hard cases: %s", why.text);
	page->chart = chart;
	page->hard = hard;
	page->hard_link = link = hard ? realpath(tables, NULL) : NULL;
	page->hard_path = args->tables ? args->tables : "tests/hard/TABLE.md";
	enum status s = asprintf(&path, "%s/report.html", study->folder) < 0
			    ? error_set(err, STATUS_MEMORY, "no memory for a page")
			    : page_write(page, path, err);
	free(path);
	free(chart);
	free(hard);
	free(installed);
	free(link);
	return s;
}

static enum status report(const struct arguments *args, struct error *err)
{
	struct study study = {0};
	struct figures figures = {0};
	struct judgement judgement = {0};
	struct pictures pictures = {0};
	struct page page = {.figures = &figures, .judgement = &judgement, .pictures = &pictures};
	char *json = NULL, *csv = NULL;
	json_t *results = NULL;
	enum status s = study_read(args->folder, &study, err);
	if (s == STATUS_OK)
		s = figures_measure(&study, &figures, err);
	if (s == STATUS_OK)
		s = judge(&figures, &judgement, err);
	if (s == STATUS_OK)
		s = pictures_make(&figures, &judgement, &pictures, err);
	if (s != STATUS_OK)
		goto out;
	results = results_json(&figures, &judgement);
	json = results ? json_dumps(results, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) : NULL;
	csv = results_csv(&figures);
	page.results = results;
	s = save(&study, "results.json", json, err);
	if (s == STATUS_OK)
		s = save(&study, "results.csv", csv, err);
	if (s == STATUS_OK)
		s = save_page(args, &page, err);
out:
	json_decref(results);
	free(json);
	free(csv);
	pictures_finish(&pictures);
	judge_finish(&judgement);
	figures_finish(&figures);
	study_finish(&study);
	return s;
}

int main(int argc, char **argv)
{
	static const struct option options[] = {
	    {"tables", required_argument, NULL, 't'},
	    {"chart", required_argument, NULL, 'c'},
	    {"help", no_argument, NULL, 'h'},
	    {NULL, 0, NULL, 0},
	};
	struct arguments args = {.chart = CANDIL_CHART_JS};
	struct error err;
	int option;
	signal(SIGXFSZ, SIG_IGN); // a file that may not become so large has an error of its own
	while ((option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
		if (option == 't')
			args.tables = optarg;
		if (option == 'c')
			args.chart = optarg;
		if (option == 'h') {
			fputs(usage, stdout);
			return EXIT_REPORTED;
		}
		if (option == '?')
			return EXIT_USAGE;
	}
	if (argc - optind != 1) {
		fputs("candil-report: the folder of a study is needed; see --help\n", stderr);
		return EXIT_USAGE;
	}
	args.folder = argv[optind];
	if (report(&args, &err) == STATUS_OK)
		return EXIT_REPORTED;
	if (err.code == STATUS_MEMORY)
		room_advise(err.text, sizeof err.text);
	fprintf(stderr, "candil-report: %s\n", err.text);
	return EXIT_COULD_NOT;
}
