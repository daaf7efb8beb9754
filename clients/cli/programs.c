#include "clients/cli/programs.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "clients/cli/interrupt.h"
#include "clients/libcandil/error.h"
#include "server/base/clock.h"
#include "server/base/pulse.h"
#include "server/base/room.h"

// The folder of this executable.
static bool own_folder(char *path, size_t capacity)
{
	ssize_t length = readlink("/proc/self/exe", path, capacity - 1);
	if (length <= 0)
		return false;
	path[length] = '\0';
	char *slash = strrchr(path, '/');
	if (!slash)
		return false;
	*slash = '\0';
	return true;
}

bool program_libexec(const char *name, char *path, size_t capacity)
{
	char folder[PROGRAM_PATH];
	if (!own_folder(folder, sizeof(folder)))
		return false;
	int length = snprintf(path, capacity, "%s/../libexec/candil/%s", folder, name);
	return length > 0 && (size_t)length < capacity;
}

void program_daemon(char *path, size_t capacity)
{
	char folder[PROGRAM_PATH];
	if (own_folder(folder, sizeof(folder))) {
		int length = snprintf(path, capacity, "%s/candild", folder);
		if (length > 0 && (size_t)length < capacity && access(path, X_OK) == 0)
			return;
	}
	snprintf(path, capacity, "candild");
}

bool program_has_room(const char *name, struct candil_error *error)
{
	const uint64_t limit = room_limit_mib();
	if (limit == 0 || limit << 20 >= ROOM_IMAGES_BYTES)
		return true;
	error_set(error, CANDIL_STATUS_MEMORY, "there is no room to start %s", name);
	room_advise(error->text, sizeof(error->text));
	return false;
}

int program_start(char *const argv[], posix_spawn_file_actions_t *actions, int kept, bool own_group, pid_t *pid)
{
	posix_spawnattr_t attributes;
	sigset_t none, ours;
	sigemptyset(&none);
	sigemptyset(&ours);
	sigaddset(&ours, SIGINT);
	sigaddset(&ours, SIGTERM);
	sigaddset(&ours, SIGPIPE);
	posix_spawnattr_init(&attributes);
	posix_spawnattr_setflags(
	    &attributes, (short)(POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | (own_group ? POSIX_SPAWN_SETPGROUP : 0)));
	posix_spawnattr_setsigmask(&attributes, &none);
	posix_spawnattr_setsigdefault(&attributes, &ours);
	int failure = posix_spawn_file_actions_addopen(actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
	if (failure == 0)
		failure = posix_spawn_file_actions_addclosefrom_np(actions, STDERR_FILENO + 1 + kept);
	if (failure == 0)
		failure = posix_spawnp(pid, argv[0], actions, &attributes, argv, environ);
	posix_spawnattr_destroy(&attributes);
	return failure;
}

static int start_piped(char *const argv[], int out, int err, pid_t *pid)
{
	posix_spawn_file_actions_t actions;
	posix_spawn_file_actions_init(&actions);
	posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
	posix_spawn_file_actions_adddup2(&actions, err, STDERR_FILENO);
	int failure = program_start(argv, &actions, 0, false, pid);
	posix_spawn_file_actions_destroy(&actions);
	return failure;
}

// Append what can be read from one stream to `text`. false: the stream has ended.
static bool collect_stream(int fd, char *text, size_t capacity, size_t *used)
{
	char chunk[4096];
	ssize_t got = read(fd, chunk, sizeof(chunk));
	if (got < 0)
		return errno == EINTR || errno == EAGAIN;
	size_t keep = capacity - 1 - *used < (size_t)got ? capacity - 1 - *used : (size_t)got;
	memcpy(text + *used, chunk, keep);
	*used += keep;
	text[*used] = '\0';
	return got > 0;
}

// Read both streams of a program until both have ended. Returns 0, ETIMEDOUT if they have not in its time, or EINTR after an
// interrupt.
static int collect_both(pid_t pid, int out_fd, int err_fd, struct program_time time, char *out, char *err, size_t capacity)
{
	const unsigned look_ms = time.still_ms / PULSE_LOOKS;
	size_t used[2] = {0, 0};
	char *text[2] = {out, err};
	struct pollfd p[2] = {{out_fd, POLLIN, 0}, {err_fd, POLLIN, 0}};
	struct pulse pulse;
	uint64_t work_us = 0;
	pulse_begin(&pulse, pid);
	while (p[0].fd >= 0 || p[1].fd >= 0) {
		if (interrupt_poll(p, 2, look_ms) < 0 && errno != EINTR)
			return errno;
		if (interrupt_seen())
			return EINTR;
		for (int i = 0; i < 2; i++) {
			if (p[i].fd >= 0 && p[i].revents != 0 && !collect_stream(p[i].fd, text[i], capacity, &used[i]))
				p[i].fd = -1;
			p[i].revents = 0;
		}
		if (clock_us() - pulse.looked_us >= look_ms * 1000ull)
			work_us += pulse_look(&pulse);
		if (pulse.still >= PULSE_LOOKS || work_us > time.work_ms * 1000ull)
			return ETIMEDOUT;
	}
	return 0;
}

int program_run(char *const argv[], struct program_time time, char *out, char *err, size_t capacity)
{
	int out_pipe[2] = {-1, -1}, err_pipe[2] = {-1, -1}, result = -1, failure = 0;
	pid_t pid;
	out[0] = err[0] = '\0';
	if (pipe2(out_pipe, O_CLOEXEC) != 0 || pipe2(err_pipe, O_CLOEXEC) != 0) {
		failure = errno;
	} else {
		failure = start_piped(argv, out_pipe[1], err_pipe[1], &pid);
		close(out_pipe[1]);
		close(err_pipe[1]);
		out_pipe[1] = err_pipe[1] = -1;
		if (failure == 0) {
			int status;
			failure = collect_both(pid, out_pipe[0], err_pipe[0], time, out, err, capacity);
			if (failure != 0)
				kill(pid, SIGKILL);
			while (waitpid(pid, &status, 0) < 0 && errno == EINTR)
				;
			if (failure == 0)
				result = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
		}
	}
	const int fds[] = {out_pipe[0], out_pipe[1], err_pipe[0], err_pipe[1]};
	for (size_t i = 0; i < 4; i++) {
		if (fds[i] >= 0)
			close(fds[i]);
	}
	errno = failure;
	return result;
}
