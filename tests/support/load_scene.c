#include "tests/support/load_scene.h"

#include <fcntl.h>
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/base/ipc.h"
#include "server/base/memfd.h"

// Only calls that are safe between fork and exec.
static void run_loader(const char *loader, const char *name, int socket, int folder)
{
	if (dup2(socket, 30) < 0 || dup2(folder, 31) < 0 || dup2(30, IPC_FD) < 0 || dup2(31, IPC_SCENE_DIR_FD) < 0)
		_exit(126);
	close(30);
	close(31);
	execl(loader, loader, "--file", name, (char *)NULL);
	_exit(127);
}

static enum status receive(int socket, struct loaded_scene *scene, struct error *err)
{
	_Alignas(16) static char message[IPC_MAX_BYTES];
	const struct ipc_loaded *loaded = (const void *)message;
	size_t bytes;
	enum status s = ipc_receive(socket, message, sizeof message, &bytes, &scene->fd, err);
	if (s != STATUS_OK)
		return s;
	if (bytes != sizeof *loaded)
		return error_set(err, STATUS_LOADER_LOST, "the loader died");
	if (loaded->error.code != STATUS_OK) {
		*err = loaded->error;
		return err->code;
	}
	const void *map;
	s = memfd_map_sealed(scene->fd, &map, &scene->bytes, err);
	if (s == STATUS_OK)
		scene->blob = map;
	return s;
}

enum status load_scene(const char *loader, const char *file, struct loaded_scene *scene, struct error *err)
{
	char folder[1024], name[1024];
	int pair[2];
	snprintf(folder, sizeof folder, "%s", file);
	snprintf(name, sizeof name, "%s", file);
	memset(scene, 0, sizeof *scene);
	scene->fd = -1;
	int dir = open(dirname(folder), O_PATH | O_DIRECTORY);
	if (dir < 0)
		return error_errno(err, STATUS_SCENE_FILE, "cannot open the folder of %s", file);
	if (socketpair(AF_UNIX, SOCK_SEQPACKET, 0, pair) != 0) {
		close(dir);
		return error_errno(err, STATUS_INTERNAL, "socketpair");
	}
	const char *base = basename(name);
	pid_t child = fork();
	if (child == 0) {
		close(pair[0]);
		run_loader(loader, base, pair[1], dir);
	}
	close(pair[1]);
	close(dir);
	enum status s = child > 0 ? receive(pair[0], scene, err) : error_errno(err, STATUS_INTERNAL, "fork");
	close(pair[0]);
	if (child > 0)
		waitpid(child, NULL, 0);
	if (s != STATUS_OK)
		loaded_scene_finish(scene);
	return s;
}

void loaded_scene_finish(struct loaded_scene *scene)
{
	if (scene->blob)
		munmap((void *)(uintptr_t)scene->blob, scene->bytes);
	if (scene->fd >= 0)
		close(scene->fd);
	scene->blob = NULL;
	scene->fd = -1;
}
