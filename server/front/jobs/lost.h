// A worker is lost: which job is blamed, and which jobs begin again (jobs_worker_lost, in jobs.h).
//
// For the files of this folder alone, and for the front's one thread.
#ifndef CANDIL_FRONT_JOBS_LOST_H
#define CANDIL_FRONT_JOBS_LOST_H

struct job;
struct jobs;

// What the worker has of a job is lost, or about to be: the job is WAITING, as if it had never begun. Its place in the
// schedule, its account of time and an image that is being sent stay. Does not fail.
void job_begin_again(struct jobs *jobs, struct job *job);

#endif
