// Which job gets the device for the next slice. No clock, no process: turns are counted, so that the same calls always give
// the same answer.
//
// The job with the least device time so far goes first: a small request is done before a large one has noticed. Past
// SCHEDULE_FAIR_US all jobs count as equal and take turns, so that one of an hour does not wait for one of a minute to catch
// up. A job passed over SCHEDULE_PATIENCE times is served whatever the others have had: no stream of small requests starves
// it.
#ifndef CANDIL_FRONT_JOBS_SCHEDULE_H
#define CANDIL_FRONT_JOBS_SCHEDULE_H

#include <stddef.h>
#include <stdint.h>

#define SCHEDULE_FAIR_US 2000000u
#define SCHEDULE_PATIENCE 8u

// A job's place; zeroed is a new one.
struct turn {
	uint64_t attained_us; // device time so far
	uint64_t served; // when it was served last, in turns
	uint32_t passed_over; // since then
};

// Pick from `count` ≥ 1 waiting jobs, count the others as passed over, and return the index. *clock counts turns; it begins
// at 0 and belongs to the caller.
size_t schedule_pick(struct turn *const *turns, size_t count, uint64_t *clock);

// A slice took so long.
void schedule_charge(struct turn *turn, uint64_t device_us);

#endif
