// Which pilot a quote needs, and when it may have the device. The rules:
//
// - One pilot is out at a time. It begins when no STEP and no BEGIN is outstanding, and none is sent meanwhile, so that its
//   times are its own.
// - It has an end of its own as a whole (struct ipc_pilot's limit_us). None begins while a job's deadline is nearer than
//   that, and one that is out when such a job comes is ended; if that cut it short, it is made again later.
// - It is ended when nobody waits for it any more, but for one whose question was answered without it: that tells the next.
// - After one the jobs have the device for at least as long as it took, if they can use it.
// - A job with a deadline gets none of techniques whose programs are still to be compiled, none that takes more than a share
//   of what is left of its time, and none that would not be back when the choice is due.
// - One that needs shader code which has to be compiled first waits for that (jobs_compile), and others are served
// meanwhile.
// - What was out when the worker was lost is not tried again.
//
// For quotes.c alone, and for the front's one thread. Nothing here fails.
#ifndef CANDIL_FRONT_QUOTES_PILOTS_H
#define CANDIL_FRONT_QUOTES_PILOTS_H

#include "server/front/quotes/quote.h"

#define PILOT_DEADLINE_SHARE 10u // one part of so many of what is left until a job's deadline may be its pilot's

// Decide by which techniques the quote's scene is to be looked at, and for how long: its `techniques`, `budget_us`,
// `limit_us` and `barred`. False: no pilot is needed.
bool pilot_plan(const struct quotes *quotes, struct quote *quote);

// The worker has refused the quote's pilot for want of code: it waits for that, or has the worker compile it if that was
// tried.
void pilot_compile_first(struct quote *quote, const struct ipc_piloted *piloted);

// Send the next one if it may have the device, or make way for it.
void pilots_dispatch(struct quotes *quotes);

// End the one that is out, if the worker can be told now.
void pilots_end(struct quotes *quotes);

// None is out any more: it came back, or was lost with the worker.
void pilots_back(struct quotes *quotes);

#endif
