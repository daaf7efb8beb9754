#include "clients/cli/doctor_checks.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/landlock.h>
#include <linux/openat2.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/pulse.h"

#define STARTS_MOST 3u // of workers that are waited for one after the other
#define PING_MS (1000u * LIMIT_HANG_SECONDS)
#define LOOK_MS (PING_MS / PULSE_LOOKS)
#define ASK_MS 50u // between two looks whether a worker is ready by now
#define NOT_FOUND 127 // exit status of the dynamic linker when a library is missing

const char *doctor_package_of(const char *library)
{
	static const struct {
		const char *begin, *package;
	} known[] = {
	    {"libOpenImageIO", "libopenimageio2.4"},
	    {"libembree3.so", "libembree3-3"},
	    {"libtinygltf.so", "libtinygltf2d"},
	    {"libseccomp.so", "libseccomp2"},
	    {"libvulkan.so", "libvulkan1"},
	    {"libxxhash.so", "libxxhash0"},
	    {"libgomp.so", "libgomp1"},
	    {"libjansson.so", "libjansson4"},
	    {"libstdc++.so", "libstdc++6"},
	    {"libgcc_s.so", "libgcc-s1"},
	    {"libasan.so", "libasan8"},
	    {"libubsan.so", "libubsan1"},
	};
	for (size_t i = 0; i < sizeof(known) / sizeof(known[0]); i++) {
		if (strncmp(library, known[i].begin, strlen(known[i].begin)) == 0)
			return known[i].package;
	}
	return NULL;
}

// The dynamic linker says "…: error while loading shared libraries: libx.so.1: cannot open…".
static void find_missing_library(const char *text, char *library, size_t capacity)
{
	static const char before[] = "shared libraries: ";
	const char *at = strstr(text, before);
	if (!at)
		return;
	at += sizeof(before) - 1;
	snprintf(library, capacity, "%.*s", (int)strcspn(at, ":\n"), at);
}

void doctor_check_program(struct program_check *check, char *argument)
{
	static char out[4096], err[4096];
	char *argv[] = {check->path, argument, NULL};
	check->works = false;
	check->library[0] = '\0';
	if (strchr(check->path, '/') && access(check->path, X_OK) != 0) {
		snprintf(check->why, sizeof(check->why), "%s", strerror(errno));
		return;
	}
	int status = program_run(argv, DOCTOR_TIME, out, err, sizeof(out));
	if (status < 0) {
		snprintf(check->why, sizeof(check->why), "%s", strerror(errno));
	} else if (status == NOT_FOUND) {
		find_missing_library(err, check->library, sizeof(check->library));
		snprintf(check->why, sizeof(check->why), "%.*s", (int)strcspn(err, "\n"), err);
	} else if (status > 128) {
		snprintf(check->why, sizeof(check->why), "it is killed by signal %d as it starts", status - 128);
	} else {
		check->works = true;
		check->why[0] = '\0';
	}
}

// Look at a process and find its parent. Its name is compared, for the number may be of another namespace's.
static void check_process(pid_t pid, struct process_check *check, pid_t *parent)
{
	char path[64], line[256], name[32] = "";
	unsigned long long number;
	bool bare = true;
	snprintf(path, sizeof(path), "/proc/%d/status", (int)pid);
	FILE *file = pid > 0 ? fopen(path, "re") : NULL;
	while (file && fgets(line, sizeof(line), file)) {
		if (sscanf(line, "Name: %31s", name) == 1)
			check->seen = strcmp(name, check->name) == 0;
		else if (sscanf(line, "PPid: %llu", &number) == 1)
			*parent = (pid_t)number;
		else if (sscanf(line, "CapPrm: %llx", &number) == 1 || sscanf(line, "CapEff: %llx", &number) == 1)
			bare = bare && number == 0;
		else if (sscanf(line, "NoNewPrivs: %llu", &number) == 1)
			check->no_new_privileges = number == 1;
		else if (sscanf(line, "Seccomp: %llu", &number) == 1)
			check->seccomp = number == 2;
	}
	check->no_capabilities = check->seen && bare;
	if (file)
		fclose(file);
}

// A worker that is starting has neither a device nor a reason for having none, so the check waits for it, as long as it
// works.
static void check_worker_of(candil_client *client, struct daemon_check *check)
{
	const struct timespec pause = {0, ASK_MS * 1000 * 1000};
	static struct candil_stats stats;
	struct candil_error error;
	struct pulse pulse = {0};
	uint32_t first = 0;
	while (pulse.still < PULSE_LOOKS) {
		if (candil_stats(client, &stats, &error) != CANDIL_STATUS_OK) {
			snprintf(check->device, sizeof(check->device), "%s", error.text);
			return;
		}
		first = first == 0 ? stats.worker_starts : first;
		if (stats.device[0] || stats.device_error[0] || stats.worker_starts >= first + STARTS_MOST)
			break;
		if (pulse.looked_us == 0 || pulse.pid != (pid_t)stats.worker_pid)
			pulse_begin(&pulse, (pid_t)stats.worker_pid);
		else if (clock_us() - pulse.looked_us >= LOOK_MS * 1000ull)
			pulse_look(&pulse);
		nanosleep(&pause, NULL);
	}
	pid_t front = 0;
	check_process((pid_t)stats.worker_pid, &check->processes[1], &front);
	check_process(front, &check->processes[0], &front);
	check->ready = stats.device[0] && !stats.device_error[0];
	check->connections = stats.max_connections;
	check->scenes = stats.max_scenes;
	snprintf(check->note, sizeof(check->note), "%s", stats.device_note);
	snprintf(check->device, sizeof(check->device), "%s",
		 check->ready            ? stats.device
		 : stats.device_error[0] ? stats.device_error
					 : "its worker does not become ready; the daemon's log says why");
}

void doctor_check_daemon(struct daemon_check *check, const char *address)
{
	struct candil_error error;
	candil_client *client;
	*check = (struct daemon_check){.processes = {{.name = "candild"}, {.name = "candil-worker"}}};
	if (address)
		snprintf(check->address, sizeof(check->address), "%s", address);
	else if (!candil_default_address(check->address, sizeof(check->address)))
		snprintf(check->address, sizeof(check->address), "XDG_RUNTIME_DIR is not set");
	check->reachable = candil_connect(address, &client, &error) == CANDIL_STATUS_OK;
	if (check->reachable) {
		candil_set_timeout(client, PING_MS);
		check->reachable = candil_ping(client, NULL, &error) == CANDIL_STATUS_OK;
		snprintf(check->what, sizeof(check->what), "%s",
			 check->reachable ? candil_server(client)->name : error.text);
		if (check->reachable)
			check_worker_of(client, check);
		candil_disconnect(client);
	} else {
		snprintf(check->what, sizeof(check->what), "%s", error.text);
	}
}

void doctor_check_kernel(struct kernel_check *check)
{
	int fd = memfd_create("candil-doctor", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	check->memfd_sealing = fd >= 0 && fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE) == 0;
	if (fd >= 0)
		close(fd);
	struct open_how how = {.flags = O_PATH | O_CLOEXEC | O_DIRECTORY, .resolve = RESOLVE_BENEATH};
	long opened = syscall(SYS_openat2, AT_FDCWD, ".", &how, sizeof(how));
	check->openat2 = opened >= 0 || (errno != ENOSYS && errno != EPERM);
	if (opened >= 0)
		close((int)opened);
	check->seccomp = prctl(PR_GET_SECCOMP) >= 0;
	long abi = syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
	check->landlock_abi = abi > 0 ? (int)abi : 0;
}
