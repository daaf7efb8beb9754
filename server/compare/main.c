// candil-compare A B: the difference between picture A and the reference B. `candil compare` runs it.
#include <getopt.h>
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/room.h"
#include "server/compare/gallery.h"
#include "server/compare/report.h"

enum exit_code { EXIT_COMPARED = 0, EXIT_COULD_NOT = 1, EXIT_USAGE = 2, EXIT_MEMORY = 6 }; // as candil's

struct arguments {
	const char *a, *b;
	char *const *files; // `count` of them: a, b and, for a page, more
	int count;
	const char *error_image, *side_by_side, *html; // NULL: do not draw
	double mask_above;
	bool json;
};

static const char usage[] =
    "usage: %s A B [C...] [--mask-above RADIANCE] [--error-image OUT.png] [--side-by-side OUT.png]\n"
    "                      [--html OUT.html] [--json]\n"
    "\n"
    "Compare picture A with the reference B: RMSE, relMSE = mean((a-b)^2 / (b^2 + 0.01)), the signed mean difference,\n"
    "the largest one, pixels that are not finite and FLIP, what a person sees of the difference (0: nothing, 1: blue for\n"
    "green; of two PNG as they are shown, of radiance at every exposure that the reference calls for). All on linear RGB;\n"
    "a PNG is decoded first. Where one picture is a whole multiple of the other's size it is scaled down by a box filter.\n"
    "\n"
    "  --mask-above RADIANCE   leave out pixels of which the reference, at the compared size, exceeds this in a channel\n"
    "  --error-image OUT.png   draw the error in false colours, and print their scale\n"
    "  --side-by-side OUT.png  draw A, B and the error beside one another\n"
    "  --html OUT.html         write a page that slides and flips between A, B and any number of others, with the figures\n"
    "                          and the maps of each beside B; the printed figures stay those of A and B\n"
    "  --json                  print one JSON object\n"
    "\n"
    "Exit status: 0 compared, 1 could not compare, 2 wrong arguments, 6 no memory to compare.\n";

static bool parse_radiance(const char *text, double *value)
{
	char *end;
	*value = strtod(text, &end);
	return end != text && *end == 0 && !isnan(*value);
}

// What its messages call it: "candil compare" where that started it, else the file's name.
static char *own_name(char *started_as)
{
	char *slash = strrchr(started_as, '/');
	return slash ? slash + 1 : started_as;
}

// Returns 0, or one more than the exit code with which the program must end.
static int parse(int argc, char **argv, struct arguments *args)
{
	static const struct option options[] = {
	    {"mask-above", required_argument, NULL, 'm'},
	    {"error-image", required_argument, NULL, 'e'},
	    {"side-by-side", required_argument, NULL, 's'},
	    {"html", required_argument, NULL, 'p'},
	    {"json", no_argument, NULL, 'j'},
	    {"help", no_argument, NULL, 'h'},
	    {NULL, 0, NULL, 0},
	};
	*args = (struct arguments){.mask_above = (double)INFINITY};
	int option;
	while ((option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
		if (option == 'm' && !parse_radiance(optarg, &args->mask_above)) {
			fprintf(stderr, "%s: --mask-above needs a number, not \"%s\"\n", argv[0], optarg);
			return EXIT_USAGE + 1;
		}
		if (option == 'e')
			args->error_image = optarg;
		if (option == 's')
			args->side_by_side = optarg;
		if (option == 'p')
			args->html = optarg;
		if (option == 'j')
			args->json = true;
		if (option == 'h') {
			printf(usage, argv[0]);
			return EXIT_COMPARED + 1;
		}
		if (option == '?')
			return EXIT_USAGE + 1;
	}
	args->files = argv + optind;
	args->count = argc - optind;
	if (args->count < 2 || (args->count > 2 && !args->html)) {
		fprintf(stderr, "%s: two pictures are needed, or with --html two or more; see %s --help\n", argv[0],
			argv[0]);
		return EXIT_USAGE + 1;
	}
	args->a = argv[optind];
	args->b = argv[optind + 1];
	return 0;
}

static enum status output(const struct arguments *args, const struct report *report, const struct picture *a,
			  const struct picture *b, const float *error, struct error *err)
{
	enum status s = STATUS_OK;
	// The figures are printed last: with --json, a failure is printed as an object in their place.
	if (args->error_image)
		s = report_draw_error(args->error_image, a->width, a->height, error, err);
	if (s == STATUS_OK && args->side_by_side)
		s = report_draw_side_by_side(args->side_by_side, a, b, error, err);
	if (s == STATUS_OK && args->html)
		s = gallery_write(args->html, args->files, args->count, args->mask_above, err);
	if (s == STATUS_OK && args->json)
		s = report_print_json(report, err);
	else if (s == STATUS_OK)
		report_print(report);
	if (s == STATUS_OK && !args->json && (args->error_image || args->side_by_side))
		report_print_scale();
	if (s == STATUS_OK && fflush(stdout) != 0)
		s = error_errno(err, STATUS_IO, "cannot write the figures");
	return s;
}

static enum status compare(const struct arguments *args, struct error *err)
{
	struct picture a = {0}, b = {0};
	float *error = NULL;
	struct report report = {.name_a = args->a, .name_b = args->b, .mask_above = args->mask_above};
	enum status s = picture_read(args->a, &a, err);
	if (s == STATUS_OK)
		s = picture_read(args->b, &b, err);
	report.warning_count = origin_compare(&a.origin, &b.origin, report.warnings);
	if (s == STATUS_OK)
		s = metrics_fit(&a, &b, err);
	if (s != STATUS_OK)
		goto out;
	error = malloc((size_t)a.width * a.height * sizeof *error);
	if (!error) {
		s = error_set(err, STATUS_MEMORY, "no memory to compare");
		goto out;
	}
	s = comparison_make(&a, &b, args->mask_above, &report.comparison, error, NULL, err);
	if (s == STATUS_OK)
		s = output(args, &report, &a, &b, error, err);
out:
	free(error);
	picture_finish(&a);
	picture_finish(&b);
	return s;
}

int main(int argc, char **argv)
{
	struct arguments args;
	signal(SIGXFSZ, SIG_IGN); // a file that may not become so large has an error of its own
	static char unnamed[] = "candil-compare";
	if (argc < 1)
		return EXIT_USAGE;
	argv[0] = argv[0][0] ? own_name(argv[0]) : unnamed; // getopt_long puts it before its sentences
	int ended = parse(argc, argv, &args);
	if (ended)
		return ended - 1;
	struct error err;
	if (compare(&args, &err) != STATUS_OK) {
		const bool memory = err.code == STATUS_MEMORY;
		if (memory)
			room_advise(err.text, sizeof err.text);
		fprintf(stderr, "%s: %s\n", argv[0], err.text);
		if (args.json)
			report_print_failure(&err, memory ? EXIT_MEMORY : EXIT_COULD_NOT);
		return memory ? EXIT_MEMORY : EXIT_COULD_NOT;
	}
	return EXIT_COMPARED;
}
