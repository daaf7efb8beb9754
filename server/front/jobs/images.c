#include "server/front/jobs/images.h"

#include <inttypes.h>
#include <stdio.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/front/jobs/deadline.h"
#include "server/front/jobs/progress.h"
#include "server/front/jobs/table.h"
#include "server/front/session.h"

#define PREVIEW_US 1000000u

// What is kept of the last preview makes room for what comes after it.
static enum room_answer take_room(struct jobs *jobs, struct job *job, struct image *image, bool own_only)
{
	const struct room_owner owner = job_room(jobs, job);
	const uint64_t bytes = image_estimate(&job->render);
	const enum room_answer answer = room_take(&owner, &image->place, bytes, own_only);
	if (answer == ROOM_TAKEN || !image_waits(&job->last))
		return answer;
	job_release_image(jobs, job, &job->last);
	return room_take(&owner, &image->place, bytes, own_only);
}

// A preview is due when the samples have doubled or a second has passed since the last one, but not while that is on its
// way.
void job_ask_preview(struct jobs *jobs, struct job *job, uint32_t samples)
{
	uint64_t now = clock_us();
	if (!job->render.progressive || !job_is_first(jobs, job) || job->preview_due || image_waits(&job->preview) ||
	    samples <= job->preview_samples)
		return;
	if (samples < 2 * (uint64_t)job->preview_samples && now < job->preview_us + PREVIEW_US)
		return;
	// Where another job waits for room, it is the next to get a descriptor that is free.
	const bool short_of_room = jobs->short_of_room || job->session->peer->short_of_room;
	if (short_of_room && job->session->room.images > 0)
		return;
	if (take_room(jobs, job, &job->preview, short_of_room) != ROOM_TAKEN)
		return;
	job->preview_due = true;
	job->preview_samples = samples;
	job->preview.estimate = job->estimate;
	job->preview_us = now;
	worker_read(jobs->worker, job->id, false, &job->predicted);
}

// A job's last READ frees its memory on the device as soon as the worker has copied the picture. While an image waits for
// common room, no younger one gets any: small images could keep a large one out for ever. One that only its peer's own
// images keep out holds up none of others.
void jobs_read_finished(struct jobs *jobs)
{
	jobs->short_of_room = false;
	for (unsigned i = 0; i < jobs->count; i++)
		jobs->job[i]->session->peer->short_of_room = false;
	for (unsigned i = 0; i < jobs->count; i++) {
		struct job *job = jobs->job[i];
		if (job->state != JOB_FINISHED || !job_is_first(jobs, job))
			continue;
		bool *peer_short = &job->session->peer->short_of_room;
		enum room_answer answer = take_room(jobs, job, &job->final, jobs->short_of_room || *peer_short);
		jobs->short_of_room |= answer == ROOM_COMMON_FULL;
		*peer_short |= answer == ROOM_SHARE_FULL;
		if (answer != ROOM_TAKEN)
			continue;
		worker_read(jobs->worker, job->id, true, &job->predicted);
		job->read_us = clock_us();
		job->state = JOB_READING;
		jobs_let_others_try(jobs);
	}
}

static void take_over(struct jobs *jobs, struct job *job, struct image *image, int fd, const candil_ImageFrame *frame)
{
	const struct room_owner owner = job_room(jobs, job);
	image_set(image, fd, frame);
	room_resize(&owner, &image->place, frame->bytes);
}

void jobs_image(struct jobs *jobs, uint32_t id, const struct ipc_image *image, int fd)
{
	struct job *job = jobs_by_id(jobs, id);
	bool final = image->frame.final || (job && !job->preview_due);
	if (!job || (final && job->state != JOB_READING)) {
		if (fd >= 0)
			close(fd);
		return;
	}
	if (image->error.code != STATUS_OK && final) {
		jobs_fail(jobs, job, &image->error);
		return;
	}
	// Without one intermediate image a job goes on to its last.
	if (image->error.code != STATUS_OK) {
		job->preview_due = false;
		job_release_image(jobs, job, &job->preview);
		return;
	}
	candil_ImageFrame frame = image->frame;
	frame.final = final;
	frame.index = job->index;
	if (final) {
		job->done = image->done;
		job->work = image->work;
		job->scaled = image_is_scaled(&frame);
		job->encoded_us = clock_us();
		job->state = JOB_SENDING;
		take_over(jobs, job, &job->final, fd, &frame);
		job_release_image(jobs, job, &job->last);
		// A preview that has not been announced is of no use any more.
		if (image_waits(&job->preview) && !job->preview.announced)
			job_release_image(jobs, job, &job->preview);
	} else {
		job->preview_due = false;
		take_over(jobs, job, &job->preview, fd, &frame);
	}
}

// The account of a job whose worker does not say what it did.
static void account_without_worker(const struct jobs *jobs, struct job *job)
{
	candil_Done *done = &job->done;
	const candil_ImageFrame *frame = &job->final.frame;
	const struct estimate *own = &job->final.estimate;
	job->scaled = image_is_scaled(frame);
	const bool foreseen = own->kind == candil_ErrorKind_ERROR_KIND_UNKNOWN && !job->scaled;
	const struct estimate *e = foreseen ? &job->predicted : own;
	*done = (candil_Done){.samples = job->final.frame.samples,
			      .estimated_relmse = e->relmse,
			      .relmse_low = e->low,
			      .relmse_high = e->high,
			      .error_kind = e->kind};
	snprintf(done->device, sizeof done->device, "%s", jobs->worker->ready.device);
	snprintf(done->notes[done->notes_count++], sizeof done->notes[0],
		 "the worker did not give the picture in time: this is the last intermediate one");
	if (job->scaled)
		snprintf(done->notes[done->notes_count++], sizeof done->notes[0],
			 "it is made of %" PRIu32 " x %" PRIu32 " pixels, scaled, and their error is not known",
			 frame->made_width, frame->made_height);
}

bool job_send_last(struct jobs *jobs, struct job *job)
{
	struct image *last = image_waits(&job->preview) && !job->preview.announced ? &job->preview : &job->last;
	if (!image_waits(last))
		return false;
	if (job_on_device(job)) {
		worker_end(jobs->worker, job->id);
		jobs_let_others_try(jobs);
	}
	// The place that a final image has already is another's: one that does not come any more.
	job_release_image(jobs, job, &job->final);
	job->final = *last;
	job->final.frame.final = true;
	image_init(last);
	job->preview_due = false;
	job->late = true;
	job->read_us = 0;
	job->encoded_us = clock_us();
	account_without_worker(jobs, job);
	job->compiling = false;
	job->state = JOB_SENDING;
	return true;
}

// An intermediate image is sent. It is kept while a deadline may make it the last.
static void preview_is_sent(struct jobs *jobs, struct job *job)
{
	if (job->deadline_us == UINT64_MAX || job->state == JOB_SENDING) {
		job_release_image(jobs, job, &job->preview);
		return;
	}
	job_release_image(jobs, job, &job->last);
	job->last = job->preview;
	job->last.announced = false;
	job->last.sent = 0;
	image_init(&job->preview);
}

static bool job_pump(struct jobs *jobs, struct job *job)
{
	bool broken;
	struct image *image = image_waits(&job->preview) ? &job->preview : &job->final;
	if (!image_waits(image) || !job_is_first(jobs, job))
		return false;
	// The session asks for more when it has sent all that was queued before, so the last byte is sent by now.
	if (image_is_sent(image)) {
		if (image == &job->preview) {
			preview_is_sent(jobs, job);
		} else {
			job_release_image(jobs, job, image);
			job_finish(jobs, job);
		}
		return true;
	}
	bool queued = image_pump(image, job->session, job->request, &broken);
	if (broken) {
		struct error err;
		error_set(&err, STATUS_INTERNAL, "the image could not be read back");
		jobs_fail(jobs, job, &err);
		return true;
	}
	return queued;
}

bool jobs_fill(struct jobs *jobs, struct session *session)
{
	bool queued = false;
	// The oldest job comes first: younger ones could take all of the session's room for as long as its client asks for
	// more. When a job ends, the next moves into its place, and its sweep may put another at the table's end.
	for (unsigned i = 0; i < jobs->count;) {
		const uint32_t id = jobs->job[i]->id;
		if (jobs->job[i]->session == session)
			queued |= job_pump(jobs, jobs->job[i]);
		i += i < jobs->count && jobs->job[i]->id == id;
	}
	return queued;
}
