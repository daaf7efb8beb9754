// How far a job is, from image to image: what its client is told, when it is traced, when it is done, and a sweep's next
// image.
//
// For the files of this folder alone, and for the front's one thread.
#ifndef CANDIL_FRONT_JOBS_PROGRESS_H
#define CANDIL_FRONT_JOBS_PROGRESS_H

#include "server/front/jobs/table.h"

// Make a job of a sweep's next camera, which there must be. Failures, with the sweep as it was: STATUS_TOO_MANY_JOBS,
// STATUS_MEMORY.
enum status jobs_add_frame(struct jobs *jobs, struct sweep *sweep, struct error *err);

// Send PROGRESS, of a sweep's job that of the whole sweep, if it is time for it and the session takes it; else it is left
// out.
void job_tell_progress(const struct jobs *jobs, struct job *job);

// Send PROGRESS to the clients whose job the worker is at without saying anything, and wake the loop when it is time again.
void jobs_tell_quiet(struct jobs *jobs);

// The job's last slice is done: it is FINISHED, and its sweep may begin its next image. Does not fail: a next image that
// finds no place now comes when this one is done.
void job_traced(struct jobs *jobs, struct job *job);

// The job's last image is all queued: send DONE, or begin a sweep's next image, and drop the job. If that next image finds
// no place, the sweep fails.
void job_finish(struct jobs *jobs, struct job *job);

#endif
