// What the files of jobs share: jobs.c (the table, and how jobs end), device.c, images.c, deadline.c and lost.c. For these
// alone.
#ifndef CANDIL_FRONT_JOBS_TABLE_H
#define CANDIL_FRONT_JOBS_TABLE_H

#include "server/front/jobs/jobs.h"

// NULL: it has ended.
struct job *jobs_by_id(const struct jobs *jobs, uint32_t id);

// A number that no job has.
uint32_t jobs_new_id(struct jobs *jobs);

// The worker holds memory of the device for it.
bool job_on_device(const struct job *job);

// The images of a sweep are sent in order: only the first that it has may ask for room among those that wait to be sent, or
// one behind it could take the room that it needs. A render is always first.
bool job_is_first(const struct jobs *jobs, const struct job *job);

// Its last image is all queued: DONE, or a sweep's next image.
void job_finish(struct jobs *jobs, struct job *job);

// Make a job of a sweep's next camera, if it is time. Fails only if the sweep has no other job.
enum status jobs_advance_sweep(struct jobs *jobs, struct sweep *sweep, struct error *err);

// Close one of the job's images, if there is one, and give its room back, if it has some.
void job_release_image(struct jobs *jobs, const struct job *job, struct image *image);

// Its last slice is done: for its last image, and for a sweep's next one.
void job_traced(struct jobs *jobs, struct job *job);

// Jobs whose deadline has come: those that have a picture end with it, those that wait fail.
void jobs_end_late(struct jobs *jobs);

// Device time that a slice of the job may take.
uint32_t job_slice_us(const struct jobs *jobs, const struct job *job);

// Learn from an image how long the next will take from READ to its bytes.
void jobs_learn_encoding(struct jobs *jobs, const struct job *job);

// Ask for an intermediate image if it is time for one.
void job_ask_preview(struct jobs *jobs, struct job *job, uint32_t samples);

// Ask for the images of finished jobs, as far as there is room for them.
void jobs_read_finished(struct jobs *jobs);

// What the worker has of a job is lost, or about to be: it waits for its turn to begin, as if it had never begun.
void job_begin_again(struct jobs *jobs, struct job *job);

// Device memory is free, or about to be: jobs that lacked some may try again.
void jobs_let_others_try(struct jobs *jobs);

#endif
