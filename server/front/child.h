// A process that the front starts, and the front's end of the socket pair between them. The child has its end at IPC_FD,
// perhaps a folder at IPC_SCENE_DIR_FD, /dev/null as standard input and output, the front's standard error, and no other
// descriptor.
//
// For the front's one thread (loop.h).
#ifndef CANDIL_FRONT_CHILD_H
#define CANDIL_FRONT_CHILD_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#include "server/front/inherit.h"
#include "server/front/loop.h"

struct child {
	pid_t pid; // 0: none
	int pidfd; // readable once it has ended; -1: none
	int socket; // SOCK_SEQPACKET, non-blocking; -1: none
};

// Children that were let go and have not been collected yet.
struct abandoned;
struct children {
	struct loop *loop;
	struct abandoned *first;
	unsigned count;
};

void children_init(struct children *children, struct loop *loop);

// Collect those that are left, and wait for them. They have been killed, so this takes moments; one that does not end within
// a second, or is traced and so hidden from its parent, is left to whoever collects orphans.
void children_finish(struct children *children);

void child_init(struct child *child);

// Start argv[0] (a path; argv ends with NULL) with the environment of `program`. `folder` stays the caller's; negative:
// none. The process has a group of its own, so that a terminal's interrupt reaches the front alone. Failure, with no child:
// STATUS_INTERNAL.
enum status child_start(struct child *child, enum program program, char *const argv[], int folder, struct error *err);

// Send it SIGKILL; its end shows at pidfd. Nothing if there is none.
void child_kill(const struct child *child);

// Has someone stopped it (SIGSTOP), and not let it go on?
bool child_is_stopped(const struct child *child);

// After pidfd became readable: collect it and close both descriptors (forgotten in `loop` first). `how` gets its end in
// words, "killed by signal 9" or "exited with status 1". Returns the signal, 0 if it was none. One that is traced is hidden
// from its parent until its tracer knows: it has "ended", by no signal that is known, and is left to `children`.
int child_reap(struct child *child, struct children *children, char *how, size_t capacity);

// Kill it and let go of it: the loop collects it whenever it has ended. Nothing if there is none. Never waits.
void child_abandon(struct child *child, struct children *children);

#endif
