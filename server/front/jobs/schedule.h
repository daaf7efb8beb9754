// Which job gets the device for the next slice. No clock, no process: turns are counted, so that the same calls always give
// the same answer.
//
// The job with the least device time so far goes first: a small request is done before a large one has noticed. Past
// SCHEDULE_FAIR_US all jobs count as equal and take turns, so that a job of an hour does not wait until one of a minute has
// had as much. A job that was passed over SCHEDULE_PATIENCE times is served whatever the others have had, so that no stream
// of small requests starves it.
//
// For the files of this folder alone, and for the front's one thread. Nothing here fails.
#ifndef CANDIL_FRONT_JOBS_SCHEDULE_H
#define CANDIL_FRONT_JOBS_SCHEDULE_H

#include <stddef.h>
#include <stdint.h>

#define SCHEDULE_FAIR_US 2000000u
#define SCHEDULE_PATIENCE 8u

// A job's place in the schedule, in the job. Zeroed is a new one.
struct turn {
	uint64_t attained_us; // device time so far
	uint64_t served; // when it was served last, in turns
	uint32_t passed_over; // times since then
};

// Pick one of `count` ≥ 1 jobs that wait for the device, count the others as passed over, and return its index. *clock
// counts turns; it begins at 0 and belongs to the caller.
size_t schedule_pick(struct turn *const *turns, size_t count, uint64_t *clock);

// What a job, `left_us` before its end, adds in the mean to work of `us` by a new one, if no others come.
double schedule_delay_us(const struct turn *other, double left_us, double us);

// The job had a slice of so many microseconds of device time.
void schedule_charge(struct turn *turn, uint64_t device_us);

#endif
