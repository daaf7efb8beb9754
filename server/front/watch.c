#include "server/front/watch.h"

#include "server/base/clock.h"

static void watch_look(void *owner);

static void look_again(struct watch *watch)
{
	loop_timer_set(watch->loop, &watch->timer, clock_us() + watch->pause_us, watch_look, watch);
}

static void watch_look(void *owner)
{
	struct watch *watch = owner;
	const uint64_t work_us = pulse_look(&watch->pulse);
	if (watch->looked(watch->owner, watch->pulse.still >= PULSE_LOOKS, work_us))
		look_again(watch);
}

void watch_begin(struct watch *watch, struct loop *loop, pid_t pid, unsigned patience_s, watch_looked *looked, void *owner)
{
	*watch = (struct watch){
	    .loop = loop, .pause_us = patience_s * 1000000ull / PULSE_LOOKS, .looked = looked, .owner = owner};
	pulse_begin(&watch->pulse, pid);
	look_again(watch);
}

void watch_forgive(struct watch *watch)
{
	watch->pulse.still = 0;
}

void watch_end(struct watch *watch)
{
	loop_timer_stop(watch->loop, &watch->timer);
}
