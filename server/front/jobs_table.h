// What jobs.c and jobs_lost.c share. For these two alone.
#ifndef CANDIL_FRONT_JOBS_TABLE_H
#define CANDIL_FRONT_JOBS_TABLE_H

#include "server/front/jobs.h"

// NULL: it has ended.
struct job *jobs_by_id(const struct jobs *jobs, uint32_t id);

// The worker holds memory of the device for it.
bool job_on_device(const struct job *job);

// Close one of the job's images and give its room back.
void job_release_image(struct job *job, struct image *image);

// Device memory is free, or about to be: jobs that lacked some may try again.
void jobs_let_others_try(struct jobs *jobs);

#endif
