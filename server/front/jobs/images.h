// The images of jobs: room for them, asking the worker for them, sending them (jobs_image and jobs_fill, in jobs.h).
//
// For the files of this folder alone, and for the front's one thread. Nothing here fails: without room it asks again later.
#ifndef CANDIL_FRONT_JOBS_IMAGES_H
#define CANDIL_FRONT_JOBS_IMAGES_H

#include <stdbool.h>
#include <stdint.h>

struct job;
struct jobs;

// Ask the worker for an intermediate image of a job that has `samples` samples a pixel, if its client wants such images, it
// is time for one and there is room for it.
void job_ask_preview(struct jobs *jobs, struct job *job, uint32_t samples);

// Send the last intermediate image that came as the final one, and let the worker end the job, whatever it is doing for it.
// False, with nothing done: there is none.
bool job_send_last(struct jobs *jobs, struct job *job);

// Ask the worker for the last images of FINISHED jobs, in the order of arrival, as far as there is room for them, and let it
// end those jobs. The worker must be ready.
void jobs_read_finished(struct jobs *jobs);

#endif
