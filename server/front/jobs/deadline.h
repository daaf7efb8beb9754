// Deadlines. A job's clock runs from its request to its encoded image, so tracing has to end earlier than the deadline by
// the time that reading and encoding the image took lately.
//
// For the files of this folder alone, and for the front's one thread. Nothing here fails.
#ifndef CANDIL_FRONT_JOBS_DEADLINE_H
#define CANDIL_FRONT_JOBS_DEADLINE_H

#include "server/front/jobs/table.h"

#define DEADLINE_ENCODE_US 0.05 // a byte, until there was an image to learn from

// Set the deadline from the job's request and its arrival.
void job_set_deadline(struct job *job);

// Has the deadline of a job come? Of one that waits, when the time has passed. Of one that is being traced, when just
// enough is left to encode its image and its first sample is there; not while a slice of it is under way. `now` is
// clock_us().
bool job_is_late(const struct jobs *jobs, const struct job *job, uint64_t now);

// End a job that waits with STATUS_DEADLINE. As jobs_fail, it may take others along.
void job_fail_late(struct jobs *jobs, struct job *job);

// Microseconds of device time that the next slice of the job may take: at most jobs->slice_us, less when the deadline is
// near.
uint32_t job_slice_us(const struct jobs *jobs, const struct job *job);

// The job's last image has just come: learn from it how long the next one will take from READ to its bytes.
void jobs_learn_encoding(struct jobs *jobs, const struct job *job);

// Wake the loop at the next deadline of a job that waits; stop the timer if there is none.
void jobs_set_deadline_timer(struct jobs *jobs);

#endif
