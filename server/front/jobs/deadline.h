// Deadlines. A job's clock runs from its request to the last byte of its image, so sampling has to end earlier than the
// deadline by what handing over will take: reading, the last look at the error, encoding, sending. That is learned from
// images of the same technique, format and size: a mean and a spread, each an exponential average, as a connection learns
// its round trips (Jacobson, Congestion avoidance and control, 1988). The worker is told when to end at BEGIN, and sizes its
// pieces to it.
//
// For the files of this folder alone, and for the front's one thread. Nothing here fails.
#ifndef CANDIL_FRONT_JOBS_DEADLINE_H
#define CANDIL_FRONT_JOBS_DEADLINE_H

#include "server/front/jobs/table.h"

// Set the deadline from the job's request and its arrival.
void job_set_deadline(struct job *job);

// Set when sampling has to end for the deadline, as it is about to begin.
void job_set_end(const struct jobs *jobs, struct job *job);

// Has the end of a job that is being traced come for its deadline? When sampling has to end and there is a picture;
// not while a slice of it is under way. `now` is clock_us().
bool job_is_late(const struct jobs *jobs, const struct job *job, uint64_t now);

// Is the deadline of a job over, and nothing to be had of the worker for it? So it is of one that waits, or is still being
// begun, as soon as the time has passed, and of one that has a picture to come if the worker has let an order wait for
// LIMIT_LATE_MS: it compiles, or hangs.
bool job_is_given_up(const struct jobs *jobs, const struct job *job, uint64_t now);

// Fail a job whose deadline has passed, with the reason why it has no picture.
void jobs_fail_late(struct jobs *jobs, struct job *job);

// Microseconds of device time that the next slice of the job may take: at most jobs->slice_us, less when the end of this or
// another job is near, whose image would have to wait for the slice.
uint32_t job_slice_us(const struct jobs *jobs, const struct job *job);

// The last byte of the job's last image has just been sent: learn how long the next one will take from READ.
void jobs_learn_handover(struct jobs *jobs, const struct job *job);

// Wake the loop when the next job may have to be given up; stop the timer if there is none.
void jobs_set_deadline_timer(struct jobs *jobs);

#endif
