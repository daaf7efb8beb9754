// The inside of solution.h, for the files solution*.c.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_SOLUTION_PARTS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_SOLUTION_PARTS_H

#include "server/worker/technique/radiosity/solution.h"

// ---- solution_begin.c ---------------------------------------------------------------------------------------------------

// Make what the stages work with, and compile it. What there is on failure solution_finish_making frees.
enum status solution_make_ready(struct solution *v, struct gl_device *gl, const struct plan *plan, struct error *err);

// ---- solution_project.c -------------------------------------------------------------------------------------------------

// Work for about budget_us on the projection of the form factors. STATUS_MEMORY, STATUS_DEVICE.
enum status solution_project(struct solution *v, uint32_t budget_us, bool *done, struct error *err);

// Free what it works with. Zeroed is fine.
void solution_end_projecting(struct solution *v);

// ---- solution_stages.c --------------------------------------------------------------------------------------------------

// Work for about budget_us on the stage that it is in, at least one piece. Fails as solution_step.
enum status solution_work(struct solution *v, uint32_t budget_us, struct error *err);

// Free what only the making needs.
void solution_finish_making(struct solution *v);

#endif
