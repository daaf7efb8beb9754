// A process that the front starts, and its end of the socket pair to it. The child sees the pair at IPC_FD, perhaps a folder
// at IPC_SCENE_DIR_FD, /dev/null as standard input and output, our standard error, and nothing else of ours.
#ifndef CANDIL_FRONT_CHILD_H
#define CANDIL_FRONT_CHILD_H

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

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
};

void children_init(struct children *children, struct loop *loop);

// Collect those that are left. They have been killed, so this takes moments; one that will not end within a second is left
// to whoever collects orphans.
void children_finish(struct children *children);

void child_init(struct child *child);

// Start argv[0] (a path; argv ends with NULL). `folder` < 0: none. It runs in its own process group, so that a terminal's
// interrupt reaches the front alone. STATUS_INTERNAL if it cannot be started.
enum status child_start(struct child *child, char *const argv[], int folder, struct error *err);

// SIGKILL. Nothing if there is none.
void child_kill(const struct child *child);

// After pidfd became readable: collect it and close both descriptors (forgotten in `loop` first). `how` gets its end in
// words, "killed by signal 9" or "exited with status 1". Returns the signal, 0 if it was none.
int child_reap(struct child *child, struct loop *loop, char *how, size_t capacity);

// Kill it and let go: the loop collects it whenever it has ended. Never blocks.
void child_abandon(struct child *child, struct children *children);

#endif
