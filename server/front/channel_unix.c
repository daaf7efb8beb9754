// Design note. A Unix socket of mode 0600 is reached by its owner and root alone, and SO_PEERCRED says once more who the
// peer is. The file is made with its mode and replaced under a lock, so that there is no moment in which others could
// connect or two daemons take each other's place.
#include "server/front/channel.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#define LOCK_PAUSE_NS 10000000
#define LOCK_TRIES 500u // five seconds

struct unix_listener {
	struct listener base;
	struct loop *loop;
	int fd; // non-blocking; -1: none
	char path[sizeof((struct sockaddr_un *)0)->sun_path];
	dev_t device; // of the socket's file: what is unlinked in the end is still ours
	ino_t inode;
};

// ---- channels --------------------------------------------------------------------------------------------------------

static enum status unix_watch(struct channel *channel, loop_ready *ready, void *owner, struct error *err)
{
	return loop_watch(channel->loop, channel->fd, EPOLLIN, ready, owner, err);
}

static void unix_want(struct channel *channel, uint32_t events)
{
	loop_want(channel->loop, channel->fd, events);
}

// Keep the descriptors that a message brought, or close them.
static void take_fds(struct msghdr *message, struct channel_fds *fds)
{
	for (struct cmsghdr *c = CMSG_FIRSTHDR(message); c; c = CMSG_NXTHDR(message, c)) {
		if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_RIGHTS)
			continue;
		size_t count = (c->cmsg_len - CMSG_LEN(0)) / sizeof(int);
		for (size_t i = 0; i < count; i++) {
			int fd;
			memcpy(&fd, CMSG_DATA(c) + i * sizeof fd, sizeof fd);
			if (fds && fds->count < CHANNEL_FDS)
				fds->fd[fds->count++] = fd;
			else
				close(fd);
		}
	}
}

static enum channel_result unix_read(struct channel *channel, void *buffer, size_t room, size_t *bytes,
				     struct channel_fds *fds)
{
	// The kernel closes those descriptors that have no place here.
	union {
		char space[CMSG_SPACE(CHANNEL_FDS * sizeof(int))];
		struct cmsghdr align;
	} control;
	struct iovec part = {.iov_base = buffer, .iov_len = room};
	struct msghdr m = {
	    .msg_iov = &part, .msg_iovlen = 1, .msg_control = control.space, .msg_controllen = sizeof control.space};
	if (fds)
		fds->count = 0;
	ssize_t got;
	do
		got = recvmsg(channel->fd, &m, MSG_CMSG_CLOEXEC | MSG_DONTWAIT);
	while (got < 0 && errno == EINTR);
	if (got < 0)
		return errno == EAGAIN ? CHANNEL_LATER : CHANNEL_BROKEN;
	take_fds(&m, got > 0 ? fds : NULL);
	*bytes = (size_t)got;
	return got > 0 ? CHANNEL_DONE : CHANNEL_ENDED;
}

static enum channel_result unix_write(struct channel *channel, const void *data, size_t bytes, size_t *written)
{
	ssize_t sent;
	do
		sent = send(channel->fd, data, bytes, MSG_NOSIGNAL | MSG_DONTWAIT);
	while (sent < 0 && errno == EINTR);
	if (sent < 0)
		return errno == EAGAIN ? CHANNEL_LATER : CHANNEL_BROKEN;
	*written = (size_t)sent;
	return CHANNEL_DONE;
}

static void unix_end(struct channel *channel)
{
	shutdown(channel->fd, SHUT_WR);
}

static bool unix_peer_allowed(const struct channel *channel)
{
	struct ucred peer;
	socklen_t length = sizeof peer;
	if (getsockopt(channel->fd, SOL_SOCKET, SO_PEERCRED, &peer, &length) != 0)
		return false;
	return peer.uid == geteuid() || peer.uid == 0;
}

static void unix_close(struct channel *channel)
{
	loop_forget(channel->loop, channel->fd);
	close(channel->fd);
	channel->fd = -1;
}

static const struct channel_kind unix_channel = {.watch = unix_watch,
						 .want = unix_want,
						 .read = unix_read,
						 .write = unix_write,
						 .end = unix_end,
						 .peer_allowed = unix_peer_allowed,
						 .close = unix_close};

// Process ids are reused, but not while we count on one: a peer goes with its last connection, and shares with a namesake
// until then.
static uint64_t unix_peer(int fd)
{
	struct ucred peer;
	socklen_t length = sizeof peer;
	return getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &length) == 0 && peer.pid > 0 ? (uint64_t)peer.pid : 0;
}

enum status channel_unix_adopt(struct channel *channel, struct loop *loop, int fd, struct error *err)
{
	int flags = fcntl(fd, F_GETFL), type = 0, listens = 1;
	socklen_t type_bytes = sizeof type, listens_bytes = sizeof listens;
	if (getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &type_bytes) != 0 || type != SOCK_STREAM ||
	    getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &listens, &listens_bytes) != 0 || listens) {
		close(fd);
		return error_set(err, STATUS_CONNECT, "descriptor %d is no connected stream socket", fd);
	}
	if (flags < 0 || fcntl(fd, F_SETFL, flags | O_NONBLOCK) != 0 || fcntl(fd, F_SETFD, FD_CLOEXEC) != 0) {
		enum status status = error_errno(err, STATUS_INTERNAL, "cannot use descriptor %d", fd);
		close(fd);
		return status;
	}
	*channel = (struct channel){.kind = &unix_channel, .loop = loop, .fd = fd, .peer = unix_peer(fd)};
	return STATUS_OK;
}

// ---- the listener ----------------------------------------------------------------------------------------------------

static enum listener_result unix_accept(struct listener *listener, struct channel *channel)
{
	struct unix_listener *l = (struct unix_listener *)listener;
	int fd = accept4(l->fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
	if (fd < 0)
		return errno == EMFILE || errno == ENFILE || errno == ENOMEM || errno == ENOBUFS ? LISTENER_EXHAUSTED
												 : LISTENER_NONE;
	*channel = (struct channel){.kind = &unix_channel, .loop = l->loop, .fd = fd, .peer = unix_peer(fd)};
	return LISTENER_ACCEPTED;
}

static void unix_pause(struct listener *listener, bool paused)
{
	struct unix_listener *l = (struct unix_listener *)listener;
	loop_want(l->loop, l->fd, paused ? 0 : EPOLLIN);
}

static void unix_close_listener(struct listener *listener)
{
	struct unix_listener *l = (struct unix_listener *)listener;
	struct stat st;
	// Without a path there is no file of ours.
	if (lstat(l->path, &st) == 0 && st.st_dev == l->device && st.st_ino == l->inode)
		unlink(l->path);
	loop_forget(l->loop, l->fd);
	if (l->fd >= 0)
		close(l->fd);
	free(l);
}

static const struct listener_kind unix_listener = {.accept = unix_accept, .pause = unix_pause, .close = unix_close_listener};

// Does somebody listen at the address, or may somebody? Only a refused connection says that nobody does: a socket of another
// type, or one that we may not connect to, is not ours to replace.
static bool answers(const struct sockaddr_un *address)
{
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (fd < 0)
		return true;
	int result = connect(fd, (const struct sockaddr *)address, sizeof *address);
	bool alive = result == 0 || errno != ECONNREFUSED;
	close(fd);
	return alive;
}

// Two daemons that start at once must not both find the old socket dead, so a daemon locks the folder while it looks. That
// takes microseconds: whoever holds the lock for longer is no daemon of ours. Returns the folder's descriptor, -1 and errno
// on failure.
static int lock_folder(const char *path)
{
	const struct timespec pause = {.tv_nsec = LOCK_PAUSE_NS};
	char copy[sizeof((struct sockaddr_un *)0)->sun_path];
	memcpy(copy, path, strlen(path) + 1);
	int fd = open(dirname(copy), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	for (unsigned i = 0; fd >= 0 && flock(fd, LOCK_EX | LOCK_NB) != 0; i++) {
		if (i == LOCK_TRIES || (errno != EWOULDBLOCK && errno != EINTR)) {
			int why = errno;
			close(fd);
			errno = why;
			return -1;
		}
		nanosleep(&pause, NULL);
	}
	return fd;
}

static enum status clear_way(const struct sockaddr_un *address, struct error *err)
{
	struct stat st;
	if (lstat(address->sun_path, &st) != 0)
		return errno == ENOENT ? STATUS_OK
				       : error_errno(err, STATUS_CONNECT, "cannot look at %s", address->sun_path);
	if (!S_ISSOCK(st.st_mode))
		return error_set(err, STATUS_CONNECT, "%s exists and is no socket: choose another --socket",
				 address->sun_path);
	if (answers(address))
		return error_set(err, STATUS_CONNECT,
				 "something answers at %s already, or may: stop it or choose another --socket",
				 address->sun_path);
	if (unlink(address->sun_path) != 0)
		return error_errno(err, STATUS_CONNECT, "cannot replace the dead socket %s", address->sun_path);
	return STATUS_OK;
}

static enum status bind_and_listen(struct unix_listener *listener, const struct sockaddr_un *address, struct error *err)
{
	listener->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (listener->fd < 0)
		return error_errno(err, STATUS_CONNECT, "cannot create a socket");
	// The file gets its mode as it is made: there is no moment in which others could connect.
	mode_t old = umask(0177);
	int bound = bind(listener->fd, (const struct sockaddr *)address, sizeof *address);
	int why = errno;
	umask(old);
	errno = why;
	struct stat st;
	if (bound != 0 || listen(listener->fd, SOMAXCONN) != 0 || lstat(address->sun_path, &st) != 0)
		return error_errno(err, STATUS_CONNECT, "cannot listen at %s", address->sun_path);
	listener->device = st.st_dev;
	listener->inode = st.st_ino;
	memcpy(listener->path, address->sun_path, sizeof listener->path);
	return STATUS_OK;
}

static enum status take_path(struct unix_listener *listener, const char *path, struct error *err)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	if (!*path || strlen(path) >= sizeof address.sun_path)
		return error_set(err, STATUS_CONNECT, "a socket's path has 1 to %zu bytes: choose another --socket",
				 sizeof address.sun_path - 1);
	memcpy(address.sun_path, path, strlen(path) + 1);
	int folder = lock_folder(path);
	if (folder < 0)
		return error_errno(err, STATUS_CONNECT, "cannot lock the folder of %.120s, choose another --socket", path);
	enum status status = clear_way(&address, err);
	if (status == STATUS_OK)
		status = bind_and_listen(listener, &address, err);
	close(folder);
	return status;
}

enum status channel_unix_listen(struct listener **listener, struct loop *loop, const char *path, loop_ready *ready,
				void *owner, struct error *err)
{
	struct unix_listener *l = calloc(1, sizeof *l);
	if (!l)
		return error_set(err, STATUS_MEMORY, "no memory to listen at %.120s", path);
	*l = (struct unix_listener){.base = {.kind = &unix_listener}, .loop = loop, .fd = -1};
	enum status status = take_path(l, path, err);
	if (status == STATUS_OK)
		status = loop_watch(loop, l->fd, EPOLLIN, ready, owner, err);
	if (status == STATUS_OK)
		*listener = &l->base;
	else
		unix_close_listener(&l->base);
	return status;
}
