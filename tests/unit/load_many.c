// The loader in a process that stays: it reads lines of a folder, a file in it and a file for the blob, apart by tabs, and
// answers with what `candil-loader --describe` writes of each, then a line "loaded" or "refused". It has no sandbox, and
// links the decoder of images once for all of them, which takes longer than loading most of what tests load.
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/sendfile.h>
#include <unistd.h>

#include "server/loader/describe.h"
#include "server/loader/load.h"

static bool copy(int fd, const char *name)
{
	const int out = open(name, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
	off_t from = 0;
	ssize_t n = out < 0 ? -1 : 1;
	while (n > 0)
		n = sendfile(out, fd, &from, 1 << 30);
	return out >= 0 && close(out) == 0 && n == 0;
}

static bool load(const char *folder, const char *file, const char *blob)
{
	static candil_SceneInfo info;
	static struct scene_remarks remarks;
	struct error err = {0};
	int fd;
	memset(&info, 0, sizeof info);
	memset(&remarks, 0, sizeof remarks);
	struct load_options options = {.file = file,
				       .dir = open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC),
				       .metres_per_unit = 1,
				       .decoder = &image_decoder};
	const enum status status = load_scene(&options, &info, &remarks, &fd, &err);
	bool good = status == STATUS_OK;
	if (!good)
		printf("candil-loader: %s: %s\n", status_name(status), err.text);
	else {
		good = describe_print(&info) && copy(fd, blob);
		close(fd);
	}
	close(options.dir);
	return good;
}

int main(void)
{
	char *line = NULL;
	size_t room = 0;
	ssize_t size;
	while ((size = getline(&line, &room, stdin)) > 0) {
		line[size - 1] = 0;
		char *rest = line;
		const char *folder = strsep(&rest, "\t"), *file = strsep(&rest, "\t");
		if (!rest)
			return EXIT_FAILURE;
		puts(load(folder, file, rest) ? "loaded" : "refused");
		fflush(stdout);
	}
	free(line);
	return EXIT_SUCCESS;
}
