// candil-loader: one scene, one process. Started by the front with a socket at IPC_FD and the scene's folder at
// IPC_SCENE_DIR_FD it sends exactly one IPC_LOADED and exits. For people and tests, --describe with --dir prints instead.
//
// A parser that loops or crashes on a hostile file takes this process with it and nothing else: the front sees the socket
// close without a message.
#include <fcntl.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include "server/base/ipc.h"
#include "server/base/log.h"
#include "server/loader/describe.h"
#include "server/loader/load.h"

enum { EXIT_USAGE = 2 };

struct arguments {
	struct load_options load;
	const char *dir; // --describe only
	const char *blob; // --describe only: copy the blob into this file
	bool describe;
};

static int usage(void)
{
	fputs("usage: candil-loader --file NAME [--up y|z] [--unit METRES]            (started by candild)\n"
	      "       candil-loader --describe --dir PATH --file NAME [--up y|z] [--unit METRES] [--blob FILE]\n",
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
	    {NULL, 0, NULL, 0},
	};
	int option;
	while ((option = getopt_long(argc, argv, "", options, NULL)) != -1)
		if (!parse_option(a, option))
			return false;
	return optind == argc && a->load.file && a->describe == (a->dir != NULL) && (a->describe || !a->blob);
}

// No core file of a crash, an end to a parser that loops even if the front is gone, and where memory runs out because of a
// scene it is this process that the kernel ends, not the front.
static void set_limits(void)
{
	int fd = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
	if (fd >= 0) {
		ssize_t ignored = write(fd, "1000", 4); // best effort: there may be no /proc
		(void)ignored;
		close(fd);
	}
	setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
	setrlimit(RLIMIT_CPU, &(struct rlimit){LIMIT_LOAD_SECONDS, LIMIT_LOAD_SECONDS + 5});
}

static bool copy_blob(int fd, const char *path)
{
	char buffer[1 << 16];
	ssize_t n = 0;
	FILE *out = fopen(path, "wb");
	bool good = out && lseek(fd, 0, SEEK_SET) == 0;
	while (good && (n = read(fd, buffer, sizeof buffer)) > 0)
		good = fwrite(buffer, 1, (size_t)n, out) == (size_t)n;
	good = good && n == 0;
	if (out && fclose(out) != 0)
		good = false;
	if (!good)
		fprintf(stderr, "candil-loader: cannot write %s\n", path);
	return good;
}

static int describe(struct arguments *a, struct ipc_loaded *loaded)
{
	int fd;
	a->load.dir = open(a->dir, O_PATH | O_DIRECTORY | O_CLOEXEC);
	if (a->load.dir < 0) {
		perror(a->dir);
		return EXIT_USAGE;
	}
	const enum status status = load_scene(&a->load, &loaded->info, &fd, &loaded->error);
	close(a->load.dir);
	if (status != STATUS_OK) {
		fprintf(stderr, "candil-loader: %s: %s\n", status_name(status), loaded->error.text);
		return EXIT_FAILURE;
	}
	bool good = describe_print(&loaded->info);
	if (good && a->blob)
		good = copy_blob(fd, a->blob);
	close(fd);
	return good ? EXIT_SUCCESS : EXIT_FAILURE;
}

static int serve(struct arguments *a, struct ipc_loaded *loaded)
{
	int fd;
	struct error err;
	a->load.dir = IPC_SCENE_DIR_FD;
	loaded->head.op = IPC_LOADED;
	snprintf(loaded->build, sizeof loaded->build, "%s", ipc_build());
	loaded->error.code = load_scene(&a->load, &loaded->info, &fd, &loaded->error);
	if (ipc_send(IPC_FD, loaded, sizeof *loaded, fd, &err) != STATUS_OK) {
		log_line(LOG_ERROR, "the front did not take the scene: %s", err.text);
		return EXIT_FAILURE;
	}
	return EXIT_SUCCESS; // whether it loaded is in the message
}

int main(int argc, char **argv)
{
	struct arguments arguments = {.load = {.metres_per_unit = 1.0}};
	if (!parse_arguments(&arguments, argc, argv))
		return usage();
	log_init("candil-loader", LOG_WARNING);
	set_limits();
	struct ipc_loaded *loaded = calloc(1, sizeof *loaded);
	if (!loaded)
		return EXIT_FAILURE;
	const int result = arguments.describe ? describe(&arguments, loaded) : serve(&arguments, loaded);
	free(loaded);
	return result;
}
