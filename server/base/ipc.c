#include "server/base/ipc.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "server/base/log.h"

_Static_assert(sizeof(struct ipc_loaded) <= IPC_MAX_BYTES, "a scene's description fits one datagram");
_Static_assert(sizeof(struct ipc_begin) <= IPC_MAX_BYTES, "a request fits one datagram");
_Static_assert(sizeof(struct ipc_pilot) <= IPC_MAX_BYTES, "a pilot's request fits one datagram");
_Static_assert(sizeof(struct ipc_piloted) <= IPC_MAX_BYTES, "what a pilot saw fits one datagram");
_Static_assert(sizeof(struct ipc_image) <= IPC_MAX_BYTES, "a frame's account fits one datagram");

#define STRING_(x) #x
#define STRING(x) STRING_(x)

const char *ipc_build(void)
{
	static char build[64];
	// Every call writes the same bytes, so a race is harmless. Besides, callers are single-threaded.
	if (!build[0])
		snprintf(build, sizeof build, "%s/%zu.%zu.%zu.%zu.%zu.%zu.%zu.%zu.%zu", CANDIL_VERSION_STRING,
			 sizeof(struct ipc_begin), sizeof(struct ipc_begun), sizeof(struct ipc_stepped),
			 sizeof(struct ipc_image), sizeof(struct ipc_loaded), sizeof(struct ipc_piloted),
			 sizeof(struct ipc_read), sizeof(struct ipc_step), sizeof(struct ipc_pilot));
	return build;
}

enum status ipc_send(int socket, const void *message, size_t bytes, int fd, struct error *err)
{
	struct iovec part = {.iov_base = (void *)(uintptr_t)message, .iov_len = bytes};
	union {
		char space[CMSG_SPACE(sizeof(int))];
		struct cmsghdr align;
	} control = {0};
	struct msghdr m = {.msg_iov = &part, .msg_iovlen = 1};
	if (fd >= 0) {
		m.msg_control = control.space;
		m.msg_controllen = sizeof control.space;
		struct cmsghdr *c = CMSG_FIRSTHDR(&m);
		c->cmsg_level = SOL_SOCKET;
		c->cmsg_type = SCM_RIGHTS;
		c->cmsg_len = CMSG_LEN(sizeof(int));
		memcpy(CMSG_DATA(c), &fd, sizeof fd);
	}
	ssize_t sent;
	do
		sent = sendmsg(socket, &m, MSG_NOSIGNAL);
	while (sent < 0 && errno == EINTR);
	if (sent != (ssize_t)bytes)
		return error_errno(err, STATUS_IO, "cannot send to the other process");
	return STATUS_OK;
}

enum status ipc_send_patiently(int socket, const void *message, size_t bytes, int fd, struct error *err)
{
	const struct timespec pause = {.tv_nsec = IPC_PAUSE_MS * 1000000};
	const struct ipc_head waits = {.op = IPC_WAITS};
	for (unsigned tries = 0;; tries++) {
		const enum status s = ipc_send(socket, message, bytes, fd, err);
		if (s == STATUS_OK || errno != ETOOMANYREFS)
			return s;
		if (tries == 0)
			log_line(LOG_WARNING, "too many descriptors of this user are on their way: one more waits");
		if (tries % IPC_TRIES_TOLD == 0)
			ipc_send(socket, &waits, sizeof waits, -1, NULL); // a socket that is full has news of it already
		nanosleep(&pause, NULL);
	}
}

// Move the first descriptor to *fd. The buffer's padding leaves room for a second one, which is closed. True if there was
// more than one.
static bool take_descriptors(struct msghdr *m, int *fd)
{
	bool too_many = false;
	for (struct cmsghdr *c = CMSG_FIRSTHDR(m); c; c = CMSG_NXTHDR(m, c)) {
		if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_RIGHTS)
			continue;
		size_t count = (c->cmsg_len - CMSG_LEN(0)) / sizeof(int);
		for (size_t i = 0; i < count; i++) {
			int got;
			memcpy(&got, CMSG_DATA(c) + i * sizeof got, sizeof got);
			if (*fd < 0) {
				*fd = got;
			} else {
				close(got);
				too_many = true;
			}
		}
	}
	return too_many;
}

bool ipc_next_is(int socket, enum ipc_op op)
{
	struct ipc_head head;
	return recv(socket, &head, sizeof head, MSG_PEEK | MSG_DONTWAIT) == sizeof head && head.op == (uint32_t)op;
}

enum status ipc_receive(int socket, void *buffer, size_t capacity, size_t *bytes, int *fd, struct error *err)
{
	struct iovec part = {.iov_base = buffer, .iov_len = capacity};
	union {
		char space[CMSG_SPACE(sizeof(int))];
		struct cmsghdr align;
	} control;
	struct msghdr m = {
	    .msg_iov = &part, .msg_iovlen = 1, .msg_control = control.space, .msg_controllen = sizeof control.space};
	*fd = -1;
	ssize_t got;
	do
		got = recvmsg(socket, &m, MSG_CMSG_CLOEXEC);
	while (got < 0 && errno == EINTR);
	if (got < 0 && errno == ECONNRESET) {
		// It has closed before it read all that was sent. No message was received, so `control` holds nothing.
		*bytes = 0;
		return STATUS_OK;
	}
	if (got < 0)
		return error_errno(err, STATUS_IO, "cannot receive from the other process");
	bool too_many = take_descriptors(&m, fd);
	if (!too_many && *fd < 0 && (m.msg_flags & (MSG_TRUNC | MSG_CTRUNC)) == MSG_CTRUNC) {
		*fd = IPC_LOST_FD;
	} else if (too_many || (m.msg_flags & (MSG_TRUNC | MSG_CTRUNC))) {
		if (*fd >= 0)
			close(*fd);
		*fd = -1;
		return error_set(err, STATUS_INTERNAL, "a message of the other process is too long or brings too much");
	}
	*bytes = (size_t)got;
	return STATUS_OK;
}

bool ipc_end_with_parent(int socket)
{
	struct pollfd peer = {.fd = socket};
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	// A parent that ended before that call is not noticed by it, but its descriptors are closed by then.
	return poll(&peer, 1, 0) <= 0 || !(peer.revents & POLLHUP);
}
