// What the solver has left over of each element, to be shown: B - M - ρ (D + F B), the light that an element sends beside
// the light that it should send by what all others send, W/m², as a solution has them. Made in slices by the solver's own
// product (solver.h), for a solution that is finished. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_RESIDUAL_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_RESIDUAL_H

#include "server/worker/technique/radiosity/solution.h"

struct residual;

// Begin. The solution is held while the residual lives, and its survey is over: `reached` is there. STATUS_MEMORY,
// STATUS_DEVICE.
enum status residual_create(const struct solution *solution, struct residual **residual, struct error *err);
void residual_destroy(struct residual *residual); // NULL is allowed

// Work for about budget_us. STATUS_MEMORY, STATUS_DEVICE.
enum status residual_step(struct residual *residual, uint32_t budget_us, struct error *err);
bool residual_finished(const struct residual *residual);

// Its magnitude once it is finished, 3 floats of each element. Elements that the solution's light does not reach have none.
const float *residual_values(const struct residual *residual);

// The largest of them, W/m².
double residual_most(const struct residual *residual);

#endif
