// Device time of named stages: a pair of time stamps around each of a stage's passes (GL_TIME_ELAPSED is not used because it
// reads zero on software drivers). Sums are kept by name, in the order in which names first came. Times are microseconds.
// Device's thread only; nothing here fails.
#ifndef CANDIL_WORKER_GL_TIMER_H
#define CANDIL_WORKER_GL_TIMER_H

#include "server/worker/gl/device.h"

#define GL_TIMER_STAGES 16u // stages of one timer at most
#define GL_TIMER_PENDING 64u // passes between two collections at most

// What one stage has taken.
struct gl_stage {
	const char *name; // a literal
	uint64_t us; // on the device and, by gl_timer_add, on the host
	uint32_t passes; // timed ones
};

// A timer, of one job or one build.
struct gl_timer {
	struct gl_stage stages[GL_TIMER_STAGES];
	uint32_t stage_count;
	struct {
		unsigned from, to; // query objects
		uint32_t stage;
	} pending[GL_TIMER_PENDING];
	uint32_t pending_count;
	unsigned queries[2 * GL_TIMER_PENDING];
};

// Make the timer's query objects.
void gl_timer_init(struct gl_timer *timer);

// Free them; the sums go too. A zeroed timer is fine.
void gl_timer_finish(struct gl_timer *timer);

// Put a time stamp before and behind the commands of one pass. Pairs do not nest. `stage` is a literal; the passes of a
// stage beyond GL_TIMER_STAGES are not timed.
void gl_timer_begin(struct gl_timer *timer, const char *stage);
void gl_timer_end(struct gl_timer *timer);

// Add time that a stage took on the host.
void gl_timer_add(struct gl_timer *timer, const char *stage, uint64_t us);

// Wait for the time stamps that are under way and add them up. gl_timer_begin does so by itself when there are too many.
void gl_timer_collect(struct gl_timer *timer);

#endif
