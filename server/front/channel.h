// What a session speaks through, and the door at which channels come in. Sessions know no descriptor and no socket: a
// channel is a table of calls, and each kind of channel is one file that fills the table. channel_unix.c is the one kind so
// far.
//
// All calls are for the front's one thread (loop.h), and none of them waits.
//
// Example: a whole program: whatever the peer says comes back to it
//	#include <assert.h>
//	#include <string.h>
//	#include <sys/socket.h>
//	#include <unistd.h>
//
//	#include "server/front/channel.h"
//
//	static struct channel channel;
//	static bool over;
//
//	static void on_ready(void *owner, uint32_t events)
//	{
//		char bytes[64];
//		size_t count, written;
//		(void)owner, (void)events;
//		const enum channel_result result = channel.kind->read(&channel, bytes, sizeof bytes, &count, NULL);
//		// A session keeps what `write` does not take, and wants EPOLLOUT until it is gone. So few bytes are taken.
//		if (result == CHANNEL_DONE)
//			assert(channel.kind->write(&channel, bytes, count, &written) == CHANNEL_DONE && written == count);
//		over = result == CHANNEL_ENDED || result == CHANNEL_BROKEN;
//	}
//
//	static void on_settle(void *owner)
//	{
//		(void)owner;
//	}
//
//	int main(void)
//	{
//		struct loop *loop;
//		struct error err;
//		char back[6] = "";
//		int pair[2];
//		assert(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) == 0);
//		assert(loop_create(&loop, &err) == STATUS_OK);
//		assert(channel_unix_adopt(&channel, loop, pair[0], &err) == STATUS_OK);
//		assert(channel.kind->peer_allowed(&channel)); // our own user
//		assert(channel.kind->watch(&channel, on_ready, NULL, &err) == STATUS_OK);
//		assert(write(pair[1], "hello", 5) == 5 && shutdown(pair[1], SHUT_WR) == 0);
//		assert(loop_run(loop, on_settle, NULL, &over, &err) == STATUS_OK);
//		assert(read(pair[1], back, 5) == 5 && strcmp(back, "hello") == 0);
//		channel.kind->close(&channel);
//		loop_destroy(loop);
//		close(pair[1]);
//		return 0;
//	}
#ifndef CANDIL_FRONT_CHANNEL_H
#define CANDIL_FRONT_CHANNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/front/loop.h"

enum channel_result {
	CHANNEL_DONE, // at least one byte went over
	CHANNEL_LATER, // nothing can go over now: `ready` is called when it can
	CHANNEL_ENDED, // the peer writes no more (read only)
	CHANNEL_BROKEN, // the channel is of no use any more
};

// Descriptors that came with bytes. They are open, close-on-exec, and the receiver's to close.
#define CHANNEL_FDS 4u
struct channel_fds {
	int fd[CHANNEL_FDS];
	unsigned count;
};

struct channel;

struct channel_kind {
	// Call `ready` from the loop whenever the channel is as `want` says: with EPOLLIN if `read` has something to say,
	// with EPOLLOUT if `write` takes bytes, and with EPOLLHUP or EPOLLERR, wanted or not, if the channel is over. At
	// first EPOLLIN is wanted. As long as `read` has something to say, `ready` is called again after each turn of the
	// loop: a kind that holds bytes back within itself has to see to that. To be called once. Failures: STATUS_MEMORY,
	// STATUS_INTERNAL.
	enum status (*watch)(struct channel *channel, loop_ready *ready, void *owner, struct error *err);

	// Say which of EPOLLIN and EPOLLOUT are wanted from now on; 0: neither. Does not fail.
	void (*want)(struct channel *channel, uint32_t events);

	// Read at least one and at most `room` ≥ 1 bytes into `buffer`. With CHANNEL_DONE *bytes says how many. `fds` gets
	// the descriptors that came with them, none on any other result; NULL: they are closed. A kind that cannot pass
	// descriptors always brings none; more than CHANNEL_FDS at once are closed.
	enum channel_result (*read)(struct channel *channel, void *buffer, size_t room, size_t *bytes,
				    struct channel_fds *fds);

	// Write the first of `bytes` ≥ 1 bytes, as many as are taken at once. With CHANNEL_DONE *written says how many. The
	// daemon passes no descriptors to its clients.
	enum channel_result (*write)(struct channel *channel, const void *data, size_t bytes, size_t *written);

	// Nothing more will be written: the peer reads the end behind what was written. It may still write, and be read.
	void (*end)(struct channel *channel);

	// May the daemon serve this peer? The answer does not change in a channel's life. False if it cannot be told.
	bool (*peer_allowed)(const struct channel *channel);

	// Forget it in the loop and free all that it has. `ready` is not called any more. *channel may be used anew.
	void (*close)(struct channel *channel);
};

// Lives in its owner, may be copied until it is watched, and must be closed.
struct channel {
	const struct channel_kind *kind;
	struct loop *loop;
	int fd; // for the kind alone
	uint64_t peer; // whose it is: those of one number share (peer.h)
};

enum listener_result {
	LISTENER_ACCEPTED,
	LISTENER_NONE, // nobody waits, or whoever did has gone
	LISTENER_EXHAUSTED, // somebody waits, but the system has no descriptor or memory left: pause and try again later
};

struct listener;

struct listener_kind {
	// Take the next connection; *channel is the caller's with LISTENER_ACCEPTED. The peer's right is not yet checked.
	enum listener_result (*accept)(struct listener *listener, struct channel *channel);

	// Stop calling `ready`, or go on with it. Whoever comes meanwhile waits.
	void (*pause)(struct listener *listener, bool paused);

	// Accept no more, forget it in the loop and free it.
	void (*close)(struct listener *listener);
};

// The first member of each kind's own structure.
struct listener {
	const struct listener_kind *kind;
};

// ---- channel_unix.c: Unix stream sockets, which pass descriptors and know their peer's user. All of one process are one
// peer's, and so are those of all processes that are not of our namespace

// Listen at `path`, mode 0600, and call `ready` whenever somebody waits. A socket file that nobody answers on is replaced;
// one that somebody answers on, or a file that is no socket, is an error. Closing the listener removes the file if it is
// still the listener's own. Failures: STATUS_CONNECT, STATUS_MEMORY, STATUS_INTERNAL.
enum status channel_unix_listen(struct listener **listener, struct loop *loop, const char *path, loop_ready *ready,
				void *owner, struct error *err);

// Make a channel of a connected stream socket, which is taken over, on failure too. Failure: STATUS_INTERNAL.
enum status channel_unix_adopt(struct channel *channel, struct loop *loop, int fd, struct error *err);

#endif
