// The event loop: descriptors, timers, and one call after each batch of events in which the owner settles what they changed.
// One thread. A callback may watch and forget any descriptor, its own included: events of a forgotten one are not delivered.
#ifndef CANDIL_FRONT_LOOP_H
#define CANDIL_FRONT_LOOP_H

#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"

struct loop;

typedef void loop_ready(void *owner, uint32_t events); // EPOLL… bits
typedef void loop_call(void *owner);

// Lives in its owner. Zeroed is a stopped timer; stop it before its memory goes.
struct loop_timer {
	uint64_t due_us; // clock_us()
	loop_call *call;
	void *owner;
	struct loop_timer *next;
	bool running;
};

enum status loop_create(struct loop **loop, struct error *err);
void loop_destroy(struct loop *loop);

// Call `ready` whenever `fd` shows one of `events` (level-triggered; EPOLLHUP and EPOLLERR always). The descriptor stays the
// caller's, who forgets it before closing it.
enum status loop_watch(struct loop *loop, int fd, uint32_t events, loop_ready *ready, void *owner, struct error *err);

// Change the events of a watched descriptor; no system call if they are the same.
void loop_want(struct loop *loop, int fd, uint32_t events);

// Negative and unknown descriptors are allowed.
void loop_forget(struct loop *loop, int fd);

// Call `call(owner)` once at or after due_us. A running timer is moved.
void loop_timer_set(struct loop *loop, struct loop_timer *timer, uint64_t due_us, loop_call *call, void *owner);
void loop_timer_stop(struct loop *loop, struct loop_timer *timer);

// Run until *stop. `settle` is called before each wait.
enum status loop_run(struct loop *loop, loop_call *settle, void *owner, const bool *stop, struct error *err);

#endif
