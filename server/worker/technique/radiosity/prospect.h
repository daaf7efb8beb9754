// What a solution will take before it is made: how many elements, rays to lights, rows and entries are still to be made, by
// what is kept with the scene; and, tried out by the code that makes them, what some of each take. What is tried out is
// thrown away, so that no quote costs a scene what it keeps. Device's thread only.
//
// Rows wanted. Those of a group of elements are made if light can reach it (reach.h). A few rows from all over the
// scene tell which groups see each other; by reciprocity that goes both ways, and with those that are lit it makes the
// groups that light reaches. Of these some more rows are made, against the clock, and their entries are counted.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_PROSPECT_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_PROSPECT_H

#include "server/base/error.h"
#include "server/base/work.h"
#include "server/worker/plan/plan.h"

struct devices;
struct solution;

// struct technique's `foresee`.
enum status radiosity_foresee(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
			      uint32_t budget_us, struct work *work, struct error *err);

// What a job by this plan has made, and what that took. `made`: the job has worked on the solution, which is finished.
void radiosity_work(const struct solution *solution, const struct resident_scene *scene, const struct plan *plan, bool made,
		    struct work *work);

#endif
