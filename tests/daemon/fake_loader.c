// Stands in for candil-loader. The file's first word says what to do:
//   ok [BYTES]   a blob of BYTES (default 4096)          refuse     an error of its own
//   sky [BYTES]  the same, a picture of surroundings
//   sparse BYTES a blob that takes no memory             overrun    be ended for its processor time
//   hang         nothing, for ever                       die        be killed
//   burn US      a blob of US bytes, after so many µs      stop       itself
//   unsealed     a blob that could still change          dirty      text that is no UTF-8, counts out of bounds if asked
//   other-build  a message of another build              nonsense   a message too short
//   counts       array counts past their bounds
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "server/base/ipc.h"
#include "tests/daemon/fake.h"

static struct ipc_loaded loaded = {.head = {.op = IPC_LOADED}};

static const char *argument(int argc, char *const argv[], const char *name)
{
	for (int i = 1; i + 1 < argc; i++)
		if (!strcmp(argv[i], name))
			return argv[i + 1];
	exit(8);
}

static void read_orders(const char *file, char *orders, size_t capacity)
{
	int fd = openat(IPC_SCENE_DIR_FD, file, O_RDONLY | O_CLOEXEC);
	ssize_t got = fd >= 0 ? read(fd, orders, capacity - 1) : -1;
	if (got < 0) {
		error_errno(&loaded.error, STATUS_SCENE_FILE, "cannot open the file");
		ipc_send(IPC_FD, &loaded, sizeof loaded, -1, NULL);
		exit(0);
	}
	orders[got] = 0;
	close(fd);
}

static void describe(const char *file)
{
	loaded.info.triangles = 12;
	loaded.info.has_bounds_min = loaded.info.has_bounds_max = true;
	loaded.info.bounds_max = (candil_Vec3){1, 1, 1};
	snprintf(loaded.info.file, sizeof loaded.info.file, "%s", file);
	loaded.info.warnings_count = 1;
	snprintf(loaded.info.warnings[0], sizeof loaded.info.warnings[0], "%s",
		 fake_inherited(IPC_SCENE_DIR_FD) ? "inherited descriptors" : "none inherited");
}

int main(int argc, char *argv[])
{
	char orders[64], word[32] = "";
	unsigned long bytes = 4096;
	const char *file = argument(argc, argv, "--file");
	snprintf(loaded.info.light_units, sizeof loaded.info.light_units, "up %s unit %s", argument(argc, argv, "--up"),
		 argument(argc, argv, "--unit"));
	snprintf(loaded.build, sizeof loaded.build, "%s", ipc_build());
	read_orders(file, orders, sizeof orders);
	snprintf(loaded.info.hash, sizeof loaded.info.hash, "%.*s", (int)strcspn(orders, "\n"), orders);
	sscanf(orders, "%31s %lu", word, &bytes);
	describe(file);
	loaded.info.environment_width = loaded.info.environment_height = !strcmp(word, "sky");
	if (!strcmp(word, "hang"))
		for (;;)
			pause();
	if (!strcmp(word, "stop"))
		raise(SIGSTOP);
	while (!strcmp(word, "burn") && (unsigned long)clock() < bytes)
		;
	if (!strcmp(word, "die"))
		raise(SIGKILL);
	if (!strcmp(word, "other-build"))
		snprintf(loaded.build, sizeof loaded.build, "0.0");
	if (!strcmp(word, "refuse"))
		error_set(&loaded.error, STATUS_SCENE_INVALID, "the file is not to my taste");
	if (!strcmp(word, "dirty"))
		memcpy(loaded.info.warnings[0], "bad \xFF\xC0\x80 \x1B[2J text", 18);
	if (!strcmp(word, "counts"))
		loaded.info.warnings_count = 60000;
	if (!strcmp(word, "overrun"))
		raise(SIGXCPU);
	bool refused = loaded.error.code != STATUS_OK;
	int fd = -1;
	if (!strcmp(word, "sparse"))
		fd = fake_sparse_memfd(bytes);
	else if (!refused)
		fd = fake_memfd(bytes, 0, strcmp(word, "unsealed") != 0);
	ipc_send_patiently(IPC_FD, &loaded, strcmp(word, "nonsense") ? sizeof loaded : 12, fd, NULL);
	return 0;
}
