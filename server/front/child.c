#include "server/front/child.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/pidfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/ipc.h"

// Descriptors for the child are first copied to numbers from here on, above those at which the child expects them, so that
// none overwrites another.
#define SAFE_FD 16
#define LAST_WAIT_MS 1000
#define HIDDEN_US 100000 // from one look at a child that has ended and is hidden to the next

void child_init(struct child *child)
{
	*child = (struct child){.pid = 0, .pidfd = -1, .socket = -1};
}

static int child_spawn(pid_t *pid, enum program program, char *const argv[], int socket, int folder)
{
	posix_spawn_file_actions_t files;
	posix_spawnattr_t attributes;
	sigset_t none, pipe;
	sigemptyset(&none);
	sigemptyset(&pipe);
	sigaddset(&pipe, SIGPIPE);
	posix_spawn_file_actions_init(&files);
	posix_spawnattr_init(&attributes);
	int first_closed = IPC_FD + 1;
	int failed = posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
	failed |= posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
	failed |= posix_spawn_file_actions_adddup2(&files, socket, IPC_FD);
	if (folder >= 0) {
		failed |= posix_spawn_file_actions_adddup2(&files, folder, IPC_SCENE_DIR_FD);
		first_closed = IPC_SCENE_DIR_FD + 1;
	}
	failed |= posix_spawn_file_actions_addclosefrom_np(&files, first_closed);
	failed |=
	    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
	failed |= posix_spawnattr_setsigmask(&attributes, &none);
	failed |= posix_spawnattr_setsigdefault(&attributes, &pipe);
	failed |= posix_spawnattr_setpgroup(&attributes, 0);
	char **environment = inherit_environment(program, environ);
	if (!environment)
		failed = ENOMEM;
	if (!failed)
		failed = posix_spawn(pid, argv[0], &files, &attributes, argv, environment);
	free(environment);
	posix_spawnattr_destroy(&attributes);
	posix_spawn_file_actions_destroy(&files);
	return failed;
}

// A close-on-exec copy above SAFE_FD; -1 stays -1.
static int child_lift_fd(int fd)
{
	return fd < 0 ? -1 : fcntl(fd, F_DUPFD_CLOEXEC, SAFE_FD);
}

enum status child_start(struct child *child, enum program program, char *const argv[], int folder, struct error *err)
{
	int pair[2] = {-1, -1}, theirs = -1, theirs_folder = -1;
	enum status status = STATUS_INTERNAL;
	child_init(child);
	if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair) != 0) {
		error_errno(err, status, "cannot create a socket pair for %s", argv[0]);
		return status;
	}
	theirs = child_lift_fd(pair[1]);
	theirs_folder = child_lift_fd(folder);
	if (theirs < 0 || (folder >= 0 && theirs_folder < 0) || fcntl(pair[0], F_SETFL, O_NONBLOCK) != 0) {
		error_errno(err, status, "cannot prepare the descriptors of %s", argv[0]);
		goto out;
	}
	errno = child_spawn(&child->pid, program, argv, theirs, theirs_folder);
	if (errno) {
		child->pid = 0;
		error_errno(err, status, "cannot start %s", argv[0]);
		goto out;
	}
	// The number cannot mean another process by now: the kernel gives it to none until we collect this one.
	child->pidfd = pidfd_open(child->pid, 0);
	if (child->pidfd < 0) {
		error_errno(err, status, "cannot watch %s", argv[0]);
		kill(child->pid, SIGKILL);
		waitpid(child->pid, NULL, 0);
		child->pid = 0;
		goto out;
	}
	fcntl(child->pidfd, F_SETFD, FD_CLOEXEC);
	child->socket = pair[0];
	pair[0] = -1;
	status = STATUS_OK;
out:
	for (int i = 0; i < 2; i++)
		if (pair[i] >= 0)
			close(pair[i]);
	if (theirs >= 0)
		close(theirs);
	if (theirs_folder >= 0)
		close(theirs_folder);
	return status;
}

void child_kill(const struct child *child)
{
	if (child->pid > 0)
		kill(child->pid, SIGKILL);
}

bool child_is_stopped(const struct child *child)
{
	siginfo_t info = {0};
	return child->pid > 0 && waitid(P_PIDFD, (id_t)child->pidfd, &info, WSTOPPED | WNOHANG | WNOWAIT) == 0 &&
	       info.si_pid == child->pid;
}

static void child_drop_fd(struct loop *loop, int *fd)
{
	if (*fd < 0)
		return;
	loop_forget(loop, *fd);
	close(*fd);
	*fd = -1;
}

// Collect it if that is possible now. false: not yet, though it has ended: whoever traces it (a debugger, a leak checker's
// thread) is told of its end first, and hides it from its parent until then (ptrace(2)). `info` is zeroed if there is
// nothing to tell.
static bool child_wait(const struct child *child, siginfo_t *info)
{
	*info = (siginfo_t){0};
	return waitid(P_PIDFD, (id_t)child->pidfd, info, WEXITED | WNOHANG) != 0 || info->si_pid == child->pid;
}

struct abandoned {
	struct child child;
	struct children *children;
	struct loop_timer timer; // until the next look, while it is hidden
	struct abandoned *next;
};

void children_init(struct children *children, struct loop *loop)
{
	*children = (struct children){.loop = loop};
}

// Close what there is of it, collected or not.
static void child_forget(struct abandoned *gone)
{
	struct children *children = gone->children;
	struct abandoned **link = &children->first;
	while (*link != gone)
		link = &(*link)->next;
	*link = gone->next;
	children->count--;
	loop_timer_stop(children->loop, &gone->timer);
	child_drop_fd(children->loop, &gone->child.pidfd);
	free(gone);
}

static void child_look(void *owner)
{
	struct abandoned *gone = owner;
	siginfo_t info;
	if (child_wait(&gone->child, &info)) {
		child_forget(gone);
		return;
	}
	// Its pidfd stays readable, so the loop would call without a pause.
	loop_forget(gone->children->loop, gone->child.pidfd);
	loop_timer_set(gone->children->loop, &gone->timer, clock_us() + HIDDEN_US, child_look, gone);
}

static void child_collect(void *owner, uint32_t events)
{
	(void)events;
	child_look(owner);
}

void children_finish(struct children *children)
{
	while (children->first) {
		struct abandoned *gone = children->first;
		struct pollfd ended = {.fd = gone->child.pidfd, .events = POLLIN};
		siginfo_t ignored;
		poll(&ended, 1, LAST_WAIT_MS);
		child_wait(&gone->child, &ignored);
		child_forget(gone);
	}
}

// Let go of one that has ended or is about to.
static void child_leave(struct child *child, struct children *children)
{
	child_drop_fd(children->loop, &child->socket);
	loop_forget(children->loop, child->pidfd);
	struct abandoned *gone = calloc(1, sizeof *gone);
	if (gone && loop_watch(children->loop, child->pidfd, EPOLLIN, child_collect, gone, NULL) == STATUS_OK) {
		*gone = (struct abandoned){.child = *child, .children = children, .next = children->first};
		children->first = gone;
		children->count++;
	} else {
		// Nobody collects it until the daemon ends, which is better than to wait for it here.
		close(child->pidfd);
		free(gone);
	}
	child_init(child);
}

int child_reap(struct child *child, struct children *children, char *how, size_t capacity)
{
	siginfo_t info;
	int signal_number = 0;
	snprintf(how, capacity, "ended");
	if (child->pid > 0 && !child_wait(child, &info)) {
		child_leave(child, children);
		return 0;
	}
	if (child->pid > 0 && info.si_pid > 0) {
		signal_number = info.si_code == CLD_EXITED ? 0 : info.si_status;
		if (info.si_code == CLD_EXITED)
			snprintf(how, capacity, "exited with status %d", info.si_status);
		else
			snprintf(how, capacity, "killed by signal %d", info.si_status);
	}
	child_drop_fd(children->loop, &child->socket);
	child_drop_fd(children->loop, &child->pidfd);
	child->pid = 0;
	return signal_number;
}

void child_abandon(struct child *child, struct children *children)
{
	if (child->pid <= 0)
		return;
	child_kill(child);
	child_leave(child, children);
}
