// Device time of named stages: a pair of time stamps around each of a stage's passes (on software drivers
// GL_TIME_ELAPSED reads zero). Sums are kept by name, in the order in which names first came.
#ifndef CANDIL_WORKER_GL_TIMER_H
#define CANDIL_WORKER_GL_TIMER_H

#include "server/worker/gl/device.h"

#define GL_TIMER_STAGES 16u
#define GL_TIMER_PENDING 64u

struct gl_stage {
	const char *name; // a literal
	uint64_t us;
	uint32_t passes;
};

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

void gl_timer_init(struct gl_timer *timer);
void gl_timer_finish(struct gl_timer *timer);

// Around the commands of one pass; no nesting. With a full timer the pass is not timed.
void gl_timer_begin(struct gl_timer *timer, const char *stage);
void gl_timer_end(struct gl_timer *timer);

// Time that a stage took on the host.
void gl_timer_add(struct gl_timer *timer, const char *stage, uint64_t us);

// Wait for the stamps that are under way and add them up. Called by itself when too many are.
void gl_timer_collect(struct gl_timer *timer);

#endif
