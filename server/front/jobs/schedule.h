// Which job gets the device for the next slice. No clock, no process: turns are counted, so that the same calls always give
// the same answer.
//
// The job with the least device time so far goes first: a small request is done before a large one has noticed. Past
// SCHEDULE_FAIR_US all jobs count as equal and take turns, so that a job of an hour does not wait until one of a minute has
// had as much. A job that was passed over SCHEDULE_PATIENCE times is served whatever the others have had, so that no stream
// of small requests starves it.
//
// All this is first between peers (peer.h), each with the device time that its jobs here have had together, then between
// the jobs of the peer whose turn it is. So a peer's ten jobs take no more from another's one than one would.
//
// For the front alone, and for its one thread. Nothing here fails.
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

// The same of a peer, in the peer. Zeroed is a new one.
struct peer_turn {
	struct turn turn; // attained_us: of its jobs that were looked at last
	uint64_t passed; // when it was passed over last, in turns
};

struct candidate {
	struct turn *job;
	struct peer_turn *peer;
};

// Pick one of `count` ≥ 1 jobs that wait for the device, count the other jobs of its peer and the other peers as passed
// over, and return its index. *clock counts turns; it begins at 0 and belongs to the caller.
size_t schedule_pick(const struct candidate *candidates, size_t count, uint64_t *clock);

// What a job, `left_us` before its end, adds in the mean to work of `us` by a new one of the same peer, if no others come.
// What all jobs of another peer add, if `other` and `left_us` are their sums and `us` is the work of all of this peer's.
double schedule_delay_us(const struct turn *other, double left_us, double us);

// The job had a slice of so many microseconds of device time.
void schedule_charge(struct turn *turn, uint64_t device_us);

#endif
