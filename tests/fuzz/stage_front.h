// The whole front in a fuzz target: its loop, sessions, scenes, jobs and quotes, as candild runs them. Around it nothing is
// real: its children are puppets of this process, its clients too, and its clock goes on only when the target says so, so
// that an input does the same each time. What a puppet receives and sends goes through real sockets.
//
// It stands in for the front's child.h and fence.h, clock.h, log.h and pulse.h, whose own objects are then not linked, and
// for epoll_wait.
#ifndef CANDIL_TESTS_STAGE_FRONT_H
#define CANDIL_TESTS_STAGE_FRONT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "server/base/ipc.h"

#define STAGE_CLIENTS 3u
#define STAGE_PUPPETS 16u
#define STAGE_REQUESTS 8192u // ids are counted modulo this

// A message between the front and a child, of any kind.
union stage_message {
	struct ipc_head head;
	struct ipc_begin begin;
	struct ipc_begun begun;
	struct ipc_stepped stepped;
	struct ipc_image image;
	struct ipc_pilot pilot;
	struct ipc_piloted piloted;
	struct ipc_ready ready;
	struct ipc_lost lost;
	struct ipc_state state;
	struct ipc_loaded loaded;
	uint8_t bytes[IPC_MAX_BYTES];
};

enum stage_role { STAGE_NOBODY, STAGE_LOADER, STAGE_WORKER, STAGE_COMPILER };

// What the front has started.
struct puppet {
	enum stage_role role;
	pid_t pid; // none that exists
	int socket; // its end
	int end; // the front's pidfd shows what is written here
	bool ended;
	int signal; // that ended it
	unsigned said; // messages so far
};

// Run a front until `act` has nothing left, and then to its orderly end. `act` is called whenever the front waits, and
// returns false when nothing is left to do.
void stage_run(bool (*act)(void *owner), void *owner);

// The first child of a role that has not ended; NULL: none.
struct puppet *stage_puppet(enum stage_role role);

// Do what the front last ordered, as a child that works does: answer the oldest order, or say what it says unasked. False:
// it had nothing to do.
bool stage_work(struct puppet *puppet);

// The same without sending it: the message that would be the next, in `m`. `op` 0: whichever it is. Returns its bytes; 0:
// none.
size_t stage_answer(struct puppet *puppet, uint32_t op, union stage_message *m);

// Send the front a message, with the descriptor `fd`, which stays the caller's; negative: none.
void stage_say(struct puppet *puppet, const void *message, size_t bytes, int fd);

// It ends, by a signal or, if that is 0, by itself.
void stage_end(struct puppet *puppet, int signal_number);

// A client connects, if it is not connected; sends bytes, with the descriptor of a folder if asked; goes.
void stage_send(unsigned client, const void *bytes, size_t size, bool folder);
void stage_hang_up(unsigned client);

// Does this client read what comes, as it does at first?
void stage_reads(unsigned client, bool reads);

// How many replies that end a request of this id the client has had in this run, on all its connections. What comes that is
// no stream of replies aborts.
unsigned stage_ends(unsigned client, uint32_t request);

// Let time pass until the front's next timer is due.
void stage_pass(void);

// A sealed memfd of a few bytes, as scenes and images come. Stays the stage's.
int stage_sealed(void);

#endif
