// Jobs and the device: whose turn it is to begin or to take a step, and what the worker answers (jobs_begun and
// jobs_stepped, in jobs.h). At most one BEGIN and one STEP are outstanding.
//
// For the files of this folder alone, and for the front's one thread. Nothing here fails. The worker must be ready.
#ifndef CANDIL_FRONT_JOBS_DEVICE_H
#define CANDIL_FRONT_JOBS_DEVICE_H

struct jobs;

// Order a slice of the job whose turn it is, if none is outstanding, and no BEGIN either.
void jobs_step_next(struct jobs *jobs);

// Order the oldest job that waits, and may begin, to begin, if no BEGIN is outstanding. To be called after jobs_step_next,
// so that the two orders take turns.
void jobs_begin_next(struct jobs *jobs);

#endif
