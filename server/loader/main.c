// candil-loader: one process for each scene. The front starts it with a socket at IPC_FD and the scene's folder at
// IPC_SCENE_DIR_FD. It sends exactly one IPC_LOADED and exits. For people and tests, --describe with --dir prints instead.
//
// If a parser loops or crashes on a hostile file, only this process is lost: the front sees the socket close without a
// message. If a parser is taken over, it is in a sandbox, which is entered after every descriptor is open and before a byte
// of the scene is read. --sandbox-report prints which parts of the sandbox this kernel supports.
//
// Design note. The decoder of images cannot be linked in the sandbox, and takes longer to link than most scenes without
// images take to load. So it is linked with --images alone. Without, a scene that has images fails and says so, as early as
// that is known, and whoever started this process starts it again with --images.
#include <fcntl.h>
#include <getopt.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/fence_json.h"
#include "server/base/ipc.h"
#include "server/base/library.h"
#include "server/base/log.h"
#include "server/base/room.h"
#include "server/loader/describe.h"
#include "server/loader/files.h"
#include "server/loader/load.h"
#include "server/loader/sandbox.h"

enum { EXIT_USAGE = 2, EXIT_IMAGES = 3 };

struct arguments {
	struct load_options load;
	const char *dir; // --describe only
	const char *blob; // --describe only: copy the blob into this file
	bool describe;
	bool report;
	bool images; // link their decoder
};

static int usage(void)
{
	fputs("usage: candil-loader --file NAME [--images] [--up y|z] [--unit METRES]            (started by candild)\n"
	      "       candil-loader --describe --dir PATH --file NAME [--images] [--up y|z] [--unit METRES] [--blob FILE]\n"
	      "       candil-loader --sandbox-report\n",
	      stderr);
	return EXIT_USAGE;
}

static bool parse_option(struct arguments *a, int option)
{
	char *end;
	switch (option) {
	case 'f':
		a->load.file = optarg;
		return true;
	case 'u':
		a->load.z_up = strcmp(optarg, "z") == 0;
		return a->load.z_up || strcmp(optarg, "y") == 0;
	case 'm':
		a->load.metres_per_unit = strtod(optarg, &end);
		return end != optarg && !*end && isfinite(a->load.metres_per_unit) && a->load.metres_per_unit > 0;
	case 'd':
		a->dir = optarg;
		return true;
	case 'b':
		a->blob = optarg;
		return true;
	case 'p':
		a->describe = true;
		return true;
	case 's':
		a->report = true;
		return true;
	case 'i':
		a->images = true;
		return true;
	}
	return false;
}

static bool parse_arguments(struct arguments *a, int argc, char **argv)
{
	static const struct option options[] = {
	    {"file", required_argument, NULL, 'f'},
	    {"up", required_argument, NULL, 'u'},
	    {"unit", required_argument, NULL, 'm'},
	    {"dir", required_argument, NULL, 'd'},
	    {"blob", required_argument, NULL, 'b'},
	    {"describe", no_argument, NULL, 'p'},
	    {"sandbox-report", no_argument, NULL, 's'},
	    {"images", no_argument, NULL, 'i'},
	    {NULL, 0, NULL, 0},
	};
	int option;
	while ((option = getopt_long(argc, argv, "", options, NULL)) != -1)
		if (!parse_option(a, option))
			return false;
	if (a->report)
		return argc == 2;
	return optind == argc && a->load.file && a->describe == (a->dir != NULL) && (a->describe || !a->blob);
}

// Only the scene file's own folder stays readable, which may be less than `dir`. If the folder cannot be opened, reading
// the scene fails later and reports it.
static void confine(int dir, const char *file, struct fence_report *report)
{
	int folder = -1;
	const char *name;
	struct error err;
	json_object_seed(0); // reads /dev/urandom, which is out of reach afterwards
	if (file && files_open_folder(dir, file, &folder, &name, &err) != STATUS_OK)
		folder = -1;
	sandbox_enter(folder, report);
	if (folder >= 0)
		close(folder);
}

static int report_sandbox(void)
{
	struct fence_report report;
	struct error err;
	if (!image_decoder_open(&err)) // its libraries start threads
		return library_missing("candil-loader", &err);
	confine(-1, NULL, &report);
	fence_try(&report);
	json_t *root = fence_json(&report);
	const bool good = root && json_dumpf(root, stdout, 0) == 0 && putchar('\n') != EOF && fflush(stdout) == 0;
	json_decref(root);
	return good ? EXIT_SUCCESS : EXIT_FAILURE;
}

static bool copy_blob(int fd, FILE *out)
{
	char buffer[1 << 16];
	ssize_t n = 0;
	bool good = lseek(fd, 0, SEEK_SET) == 0;
	while (good && (n = read(fd, buffer, sizeof buffer)) > 0)
		good = fwrite(buffer, 1, (size_t)n, out) == (size_t)n;
	return good && n == 0 && fflush(out) == 0;
}

// Without the room for the decoder nothing is read, and what is said is said already; else the file is. A limit of address
// space may be why memory was short, unless it is the one that every loader has (sandbox.c).
static void load(struct arguments *a, struct ipc_loaded *loaded, int *fd)
{
	*fd = -1;
	if (loaded->error.code != STATUS_OK)
		return;
	loaded->error.code = load_scene(&a->load, &loaded->info, &loaded->remarks, fd, &loaded->error);
	if (loaded->error.code == STATUS_MEMORY && room_limit_mib() < LIMIT_LOADER_BYTES >> 20)
		room_advise(loaded->error.text, sizeof loaded->error.text);
}

static int describe_in_sandbox(struct arguments *a, struct ipc_loaded *loaded, FILE *blob)
{
	int fd;
	struct fence_report report;
	confine(a->load.dir, a->load.file, &report);
	load(a, loaded, &fd);
	if (a->load.wants_decoder) {
		fputs("candil-loader: the scene has images: add --images\n", stderr);
		return EXIT_IMAGES;
	}
	if (loaded->error.code != STATUS_OK) {
		fprintf(stderr, "candil-loader: %s: %s\n", status_name(loaded->error.code), loaded->error.text);
		return EXIT_FAILURE;
	}
	bool good = describe_print(&loaded->info);
	if (good && blob && !copy_blob(fd, blob)) {
		fprintf(stderr, "candil-loader: cannot write %s\n", a->blob);
		good = false;
	}
	close(fd);
	return good ? EXIT_SUCCESS : EXIT_FAILURE;
}

static int describe(struct arguments *a, struct ipc_loaded *loaded)
{
	FILE *blob = NULL;
	int result = EXIT_USAGE;
	a->load.dir = open(a->dir, O_PATH | O_DIRECTORY | O_CLOEXEC);
	if (a->load.dir < 0) {
		perror(a->dir);
		return EXIT_USAGE;
	}
	if (a->blob)
		blob = fopen(a->blob, "wbe"); // before the sandbox, in which nothing can be opened for writing
	if (a->blob && !blob)
		perror(a->blob);
	else
		result = describe_in_sandbox(a, loaded, blob);
	close(a->load.dir);
	if (blob && fclose(blob) != 0)
		result = EXIT_FAILURE;
	return result;
}

static int serve(struct arguments *a, struct ipc_loaded *loaded)
{
	int fd;
	struct error err;
	struct fence_report report;
	a->load.dir = IPC_SCENE_DIR_FD;
	confine(a->load.dir, a->load.file, &report);
	loaded->head.op = IPC_LOADED;
	snprintf(loaded->build, sizeof loaded->build, "%s", ipc_build());
	load(a, loaded, &fd);
	loaded->wants_images = a->load.wants_decoder;
	if (ipc_send_patiently(IPC_FD, loaded, sizeof *loaded, fd, &err) != STATUS_OK) {
		log_line(LOG_ERROR, "the front did not take the scene: %s", err.text);
		return EXIT_FAILURE;
	}
	return EXIT_SUCCESS; // the message says whether loading succeeded
}

int main(int argc, char **argv)
{
	struct arguments arguments = {.load = {.metres_per_unit = 1.0}};
	if (!parse_arguments(&arguments, argc, argv))
		return usage();
	log_init("candil-loader", LOG_WARNING);
	if (arguments.report)
		return report_sandbox();
	struct ipc_loaded *loaded = calloc(1, sizeof *loaded);
	if (!loaded)
		return EXIT_FAILURE;
	int result;
	if (!arguments.describe && !ipc_end_with_parent(IPC_FD))
		result = EXIT_FAILURE;
	else if (arguments.images && !(arguments.load.decoder = image_decoder_open(&loaded->error)) &&
		 loaded->error.code != STATUS_MEMORY)
		result = library_missing("candil-loader", &loaded->error);
	else
		result = arguments.describe ? describe(&arguments, loaded) : serve(&arguments, loaded);
	free(loaded);
	return result;
}
