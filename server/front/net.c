#include "server/front/net.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <string.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define LOCK_PAUSE_NS 10000000
#define LOCK_TRIES 500u // five seconds

// Does somebody answer at the address, or may somebody? Only a refusal says that nobody listens: a socket of another type,
// or one that we may not connect to, is not ours to replace.
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

// Two daemons that start at once must not both find the old socket dead: the folder is locked while one looks, which is a
// matter of microseconds. Who holds it for longer is none of us. -1 and errno.
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

static enum status bind_and_listen(struct listener *listener, const struct sockaddr_un *address, struct error *err)
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

enum status net_listen(struct listener *listener, const char *path, struct error *err)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	*listener = (struct listener){.fd = -1};
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
	if (status != STATUS_OK && listener->fd >= 0) {
		close(listener->fd);
		listener->fd = -1;
	}
	return status;
}

void net_close(struct listener *listener)
{
	struct stat st;
	if (listener->fd < 0)
		return;
	if (lstat(listener->path, &st) == 0 && st.st_dev == listener->device && st.st_ino == listener->inode)
		unlink(listener->path);
	close(listener->fd);
	listener->fd = -1;
}

int net_accept(const struct listener *listener)
{
	return accept4(listener->fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
}

bool net_peer_allowed(int fd)
{
	struct ucred peer;
	socklen_t length = sizeof peer;
	if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &length) != 0)
		return false;
	return peer.uid == geteuid() || peer.uid == 0;
}

ssize_t net_receive(int fd, void *buffer, size_t bytes, int fds[NET_FDS], unsigned *fd_count)
{
	union {
		char space[CMSG_SPACE(NET_FDS * sizeof(int))];
		struct cmsghdr align;
	} control;
	struct iovec part = {.iov_base = buffer, .iov_len = bytes};
	struct msghdr m = {
	    .msg_iov = &part, .msg_iovlen = 1, .msg_control = control.space, .msg_controllen = sizeof control.space};
	*fd_count = 0;
	ssize_t got;
	do
		got = recvmsg(fd, &m, MSG_CMSG_CLOEXEC | MSG_DONTWAIT);
	while (got < 0 && errno == EINTR);
	if (got < 0)
		return got;
	for (struct cmsghdr *c = CMSG_FIRSTHDR(&m); c; c = CMSG_NXTHDR(&m, c)) {
		if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_RIGHTS)
			continue;
		size_t count = (c->cmsg_len - CMSG_LEN(0)) / sizeof(int);
		for (size_t i = 0; i < count && *fd_count < NET_FDS; i++)
			memcpy(&fds[(*fd_count)++], CMSG_DATA(c) + i * sizeof(int), sizeof(int));
	}
	return got;
}
