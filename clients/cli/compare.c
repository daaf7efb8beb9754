// compare: starts candil-compare in its place. That program links the image library, which would make this one slow to
// start.
#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "clients/cli/cli.h"
#include "clients/cli/programs.h"

static enum exit_code run_compare(struct cli *cli, const struct command *self, int argc, char **argv)
{
	char path[PROGRAM_PATH];
	static char name[] = "candil compare"; // the program's messages begin with it
	char *arguments[64];
	int count = 0;
	if (argc > 60)
		return cli_usage(self, "that is too many arguments");
	arguments[count++] = name;
	for (int i = 1; i < argc; i++)
		arguments[count++] = argv[i];
	static char json[] = "--json";
	if (cli->json)
		arguments[count++] = json;
	arguments[count] = NULL;
	if (argc == 2 && (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0))
		return cli_help(self);
	struct candil_error error;
	if (!program_has_room(name, &error))
		return cli_fail(cli, &error, stdout);
	if (program_libexec("candil-compare", path, sizeof(path)))
		execv(path, arguments);
	fprintf(stderr, "candil: cannot run candil-compare: %s; candil doctor says where it should be\n", strerror(errno));
	return EXIT_OTHER;
}

const struct command compare_command = {
    .name = "compare",
    .summary = "measure how far an image is from a reference",
    .help =
	"Usage: candil compare A B [C...] [--mask-above RADIANCE] [--error-image OUT.png]\n"
	"                      [--side-by-side OUT.png] [--html OUT.html] [--json]\n\n"
	"Prints the difference of image A from reference B: RMSE, relative MSE (mean of (a-b)²/(b²+0.01)), signed\n"
	"mean, and FLIP: how much a person sees of the difference, 0 to 1 (blue for green). No daemon is needed.\n"
	"The sizes are the same, or one is a whole multiple of the other (1024x1024 and 512x512), which is then\n"
	"averaged down to it.\n\n"
	"  --mask-above RADIANCE  leave out pixels where the reference is brighter\n"
	"  --error-image OUT.png  draw the error in false colours\n"
	"  --side-by-side OUT.png draw A, B and the error beside one another\n"
	"  --html OUT.html        write a page that slides and flips between A, B and any number of others, with the\n"
	"                         figures and the maps of each beside B; what is printed is of A and B\n\n"
	"Pictures of candil tell what they are of: a warning says where two are of other scenes or cameras, or share\n"
	"samples, which makes the difference smaller than the error.\n\n"
	"candil compare room.exr reference.exr --mask-above 10   leaves out the lamp that is seen itself\n\n"
	"--json: {\"a\", \"b\", \"width\", \"height\", \"pixels\", \"masked\", \"non_finite_a\", \"non_finite_b\",\n"
	"\"rmse\", \"relmse\", \"mean_difference\", \"mean_difference_relative\", \"max_abs\", \"flip\",\n"
	"\"flip_max\", \"flip_exposures\": null or {\"low\", \"high\", \"count\"}, \"mean_a\", \"mean_b\", \"mean_a_rgb\",\n"
	"\"mean_b_rgb\", \"mask_above\", \"warnings\"}; a value that is not finite is null\n",
    .run = run_compare,
};
