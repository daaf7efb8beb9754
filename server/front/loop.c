// Design note. epoll hands out events in batches. The callback of one event may close the descriptor of another event of the
// same batch, or even open a new descriptor under the same number. So each watch has a generation, which its events carry
// beside the descriptor, and an event is delivered only if its generation is still that of the watch.
#include "server/front/loop.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "server/base/clock.h"

#define EVENTS_PER_BATCH 64

struct watch {
	loop_ready *ready; // NULL: not watched
	void *owner;
	uint32_t events;
	uint32_t generation;
};

struct loop {
	int epoll;
	struct watch *watches; // by descriptor
	size_t watch_count;
	uint32_t generation;
	struct loop_timer *timers;
};

enum status loop_create(struct loop **loop, struct error *err)
{
	struct loop *l = calloc(1, sizeof *l);
	if (!l)
		return error_set(err, STATUS_MEMORY, "no memory for the event loop");
	l->epoll = epoll_create1(EPOLL_CLOEXEC);
	if (l->epoll < 0) {
		error_errno(err, STATUS_INTERNAL, "cannot create an epoll instance");
		free(l);
		return STATUS_INTERNAL;
	}
	*loop = l;
	return STATUS_OK;
}

void loop_destroy(struct loop *loop)
{
	if (!loop)
		return;
	close(loop->epoll);
	free(loop->watches);
	free(loop);
}

static bool loop_grow(struct loop *loop, size_t wanted)
{
	if (wanted <= loop->watch_count)
		return true;
	size_t count = loop->watch_count ? loop->watch_count : 64;
	while (count < wanted)
		count *= 2;
	struct watch *grown = realloc(loop->watches, count * sizeof *grown);
	if (!grown)
		return false;
	memset(grown + loop->watch_count, 0, (count - loop->watch_count) * sizeof *grown);
	loop->watches = grown;
	loop->watch_count = count;
	return true;
}

static struct epoll_event event_of(const struct watch *watch, int fd)
{
	return (struct epoll_event){.events = watch->events, .data.u64 = (uint64_t)watch->generation << 32 | (uint32_t)fd};
}

enum status loop_watch(struct loop *loop, int fd, uint32_t events, loop_ready *ready, void *owner, struct error *err)
{
	if (fd < 0 || !loop_grow(loop, (size_t)fd + 1))
		return error_set(err, STATUS_MEMORY, "no memory to watch one more descriptor");
	struct watch *w = &loop->watches[fd];
	*w = (struct watch){.ready = ready, .owner = owner, .events = events, .generation = ++loop->generation};
	struct epoll_event event = event_of(w, fd);
	if (epoll_ctl(loop->epoll, EPOLL_CTL_ADD, fd, &event) != 0) {
		w->ready = NULL;
		return error_errno(err, STATUS_INTERNAL, "cannot watch a descriptor");
	}
	return STATUS_OK;
}

static struct watch *loop_find(struct loop *loop, int fd)
{
	if (fd < 0 || (size_t)fd >= loop->watch_count || !loop->watches[fd].ready)
		return NULL;
	return &loop->watches[fd];
}

void loop_want(struct loop *loop, int fd, uint32_t events)
{
	struct watch *w = loop_find(loop, fd);
	if (!w || w->events == events)
		return;
	w->events = events;
	struct epoll_event event = event_of(w, fd);
	epoll_ctl(loop->epoll, EPOLL_CTL_MOD, fd, &event);
}

void loop_forget(struct loop *loop, int fd)
{
	struct watch *w = loop_find(loop, fd);
	if (!w)
		return;
	w->ready = NULL;
	epoll_ctl(loop->epoll, EPOLL_CTL_DEL, fd, NULL);
}

void loop_timer_set(struct loop *loop, struct loop_timer *timer, uint64_t due_us, loop_call *call, void *owner)
{
	timer->due_us = due_us;
	timer->call = call;
	timer->owner = owner;
	if (timer->running)
		return;
	timer->running = true;
	timer->next = loop->timers;
	loop->timers = timer;
}

void loop_timer_stop(struct loop *loop, struct loop_timer *timer)
{
	if (!timer->running)
		return;
	struct loop_timer **link = &loop->timers;
	while (*link && *link != timer)
		link = &(*link)->next;
	if (*link)
		*link = timer->next;
	timer->running = false;
}

static struct loop_timer *earliest(struct loop *loop)
{
	struct loop_timer *first = loop->timers;
	for (struct loop_timer *t = first; t; t = t->next)
		if (t->due_us < first->due_us)
			first = t;
	return first;
}

static void call_due(struct loop *loop)
{
	uint64_t now = clock_us();
	for (struct loop_timer *t = earliest(loop); t && t->due_us <= now; t = earliest(loop)) {
		loop_timer_stop(loop, t);
		t->call(t->owner);
	}
}

// Milliseconds for epoll_wait, rounded up, so that the loop does not spin until a timer is due.
static int wait_ms(struct loop *loop)
{
	const struct loop_timer *t = earliest(loop);
	if (!t)
		return -1;
	uint64_t now = clock_us();
	if (t->due_us <= now)
		return 0;
	uint64_t ms = (t->due_us - now + 999) / 1000;
	return ms > 3600000 ? 3600000 : (int)ms;
}

static void deliver(struct loop *loop, const struct epoll_event *event)
{
	struct watch *w = loop_find(loop, (int)(uint32_t)event->data.u64);
	if (w && w->generation == (uint32_t)(event->data.u64 >> 32))
		w->ready(w->owner, event->events);
}

enum status loop_run(struct loop *loop, loop_call *settle, void *owner, const bool *stop, struct error *err)
{
	struct epoll_event events[EVENTS_PER_BATCH];
	for (;;) {
		settle(owner);
		if (*stop)
			return STATUS_OK;
		int count = epoll_wait(loop->epoll, events, EVENTS_PER_BATCH, wait_ms(loop));
		if (count < 0 && errno != EINTR)
			return error_errno(err, STATUS_INTERNAL, "cannot wait for events");
		for (int i = 0; i < count; i++)
			deliver(loop, &events[i]);
		call_due(loop);
	}
}
