// One quote under way, for quotes.c and pilots.c alone. For the front's one thread.
#ifndef CANDIL_FRONT_QUOTES_QUOTE_H
#define CANDIL_FRONT_QUOTES_QUOTE_H

#include "server/front/quotes/quotes.h"

struct quote {
	struct quote *next;
	uint32_t id; // of its pilot; never 0
	struct session *session; // NULL: nobody waits for the answer
	uint32_t request;
	uint32_t job; // that is held back for it; 0: a client's question
	struct subject subject; // held
	candil_Render render;
	uint32_t pilot_ms; // as asked for
	uint32_t budget_us; // of the pilot; 0: the request is only looked over
	uint32_t limit_us; // of the whole pilot
	uint64_t send_by_us; // past it no pilot is sent
	uint32_t techniques; // of the pilot
	uint32_t told; // techniques whose work the pilot tells
	uint32_t try_us; // for which some of that is tried out
	struct work work[TECHNIQUE_COUNT]; // that was told
	bool started; // the scene is there, and what is to be done is known
	bool piloted; // the pilot is back, or none will be
	uint64_t code; // that the worker refused its pilot for; 0: none
	candil_Technique code_technique; // which needs that
	bool compiling, compiled; // it waits for that code; a process has tried to compile it
	bool barred; // no pilot, because one like it was lost with the worker
	uint64_t asked_us;
	uint64_t loaded_us; // since when its scene is known to be there; 0: not yet
	struct loop_timer timer; // its answer is due
	struct quotes *owner;
};

static inline struct rendered quote_frame(const struct quote *quote)
{
	return (struct rendered){.subject = &quote->subject, .render = &quote->render};
}

// Does it choose for a job with a deadline?
static inline bool quote_is_hurried(const struct quote *quote)
{
	return quote->job && quote->render.deadline_ms > 0;
}

// The quote with a number; NULL: there is none.
static inline struct quote *quote_by_id(const struct quotes *quotes, uint32_t id)
{
	struct quote *q = quotes->first;
	while (q && q->id != id)
		q = q->next;
	return q;
}

#endif
