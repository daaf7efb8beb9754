// The listening Unix socket: made so that its owner alone can reach it, and every peer's user checked once more.
#ifndef CANDIL_FRONT_NET_H
#define CANDIL_FRONT_NET_H

#include <stdbool.h>
#include <sys/types.h>
#include <sys/un.h>

#include "server/base/error.h"

struct listener {
	int fd; // non-blocking; -1: none
	char path[sizeof((struct sockaddr_un *)0)->sun_path];
	dev_t device; // of the socket's file: what we unlink in the end is still ours
	ino_t inode;
};

// Listen at `path`, mode 0600. A socket file that nobody answers on is replaced; one that somebody answers on, or a file
// that is no socket, is an error. STATUS_CONNECT.
enum status net_listen(struct listener *listener, const char *path, struct error *err);

// Close it, and remove the file if it is still ours. fd -1 is allowed.
void net_close(struct listener *listener);

// The next connection, non-blocking and close-on-exec; -1 and errno if there is none.
int net_accept(const struct listener *listener);

// Is the peer of a Unix socket our own user, or root?
bool net_peer_allowed(int fd);

// Receive up to `bytes` and at most NET_FDS descriptors. As recvmsg: 0 at the end, -1 and errno. fds[i] are the caller's.
#define NET_FDS 4u
ssize_t net_receive(int fd, void *buffer, size_t bytes, int fds[NET_FDS], unsigned *fd_count);

#endif
