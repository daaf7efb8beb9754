// The event loop: descriptors, timers, and one call after each batch of events in which the owner settles what they changed.
//
// The front has one thread, the one that calls loop_run. Every function of server/front is for that thread alone, and so is
// every call that a part of the front makes to its owner. None of them waits for anything; only loop_run does.
//
// A callback may watch and forget any descriptor, its own included, and set and stop any timer. Events of a forgotten
// descriptor are not delivered, even those of the batch that is under way.
#ifndef CANDIL_FRONT_LOOP_H
#define CANDIL_FRONT_LOOP_H

#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"

struct loop;

typedef void loop_ready(void *owner, uint32_t events); // EPOLL… bits
typedef void loop_call(void *owner);

// Lives in its owner, who stops it before its memory goes. Zeroed is a stopped timer.
struct loop_timer {
	uint64_t due_us; // clock_us()
	loop_call *call;
	void *owner;
	struct loop_timer *next;
	bool running;
};

// *loop is the caller's, to be destroyed after all that watch or wait in it. Failures: STATUS_MEMORY, STATUS_INTERNAL.
enum status loop_create(struct loop **loop, struct error *err);

// NULL is allowed.
void loop_destroy(struct loop *loop);

// Call ready(owner, events) whenever `fd` shows one of `events` (level-triggered; EPOLLHUP and EPOLLERR always). The
// descriptor stays the caller's, who forgets it before closing it. Failures, with nothing watched: STATUS_MEMORY,
// STATUS_INTERNAL.
enum status loop_watch(struct loop *loop, int fd, uint32_t events, loop_ready *ready, void *owner, struct error *err);

// Change the events of a watched descriptor; nothing for one that is not watched, no system call if the events are the same.
void loop_want(struct loop *loop, int fd, uint32_t events);

// Watch it no more. Negative descriptors and those that are not watched are allowed.
void loop_forget(struct loop *loop, int fd);

// Call call(owner) once, at or after due_us (of clock_us()). A timer that runs is set anew. Does not fail.
void loop_timer_set(struct loop *loop, struct loop_timer *timer, uint64_t due_us, loop_call *call, void *owner);

// A timer that does not run is allowed.
void loop_timer_stop(struct loop *loop, struct loop_timer *timer);

// Deliver events and call timers until *stop. settle(owner) is called before each wait, and once more before the return.
// Failure: STATUS_INTERNAL.
enum status loop_run(struct loop *loop, loop_call *settle, void *owner, const bool *stop, struct error *err);

#endif
