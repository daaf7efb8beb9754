// Looks at a child at even intervals while it has something to do, to see whether it is still at work (base/pulse.h).
//
// For the front's one thread (loop.h). Nothing fails.
#ifndef CANDIL_FRONT_WATCH_H
#define CANDIL_FRONT_WATCH_H

#include <stdbool.h>

#include "server/base/pulse.h"
#include "server/front/loop.h"

// One look more: the child `hangs`, for it was still for as long as it may be, and has worked for work_us since the last
// look. True: look again. After false the watch is not touched any more, so it may be begun anew or freed in the call.
typedef bool watch_looked(void *owner, bool hangs, uint64_t work_us);

struct watch {
	struct loop_timer timer; // running: there is a watch
	struct pulse pulse;
	struct loop *loop;
	uint64_t pause_us; // between two looks
	watch_looked *looked;
	void *owner;
};

// Watch a process that may be still for `patience_s`. There must be no watch, of this struct.
void watch_begin(struct watch *watch, struct loop *loop, pid_t pid, unsigned patience_s, watch_looked *looked, void *owner);

// It has answered, or cannot: it was not still so far.
void watch_forgive(struct watch *watch);

// End the watch, if there is one. A zeroed struct has none.
void watch_end(struct watch *watch);

#endif
