#include "server/front/jobs/table.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/front/jobs/sweep.h"
#include "server/front/reply.h"
#include "server/front/session.h"
#include "server/front/share.h"

// ---- who is in it ----------------------------------------------------------------------------------------------------

struct job *jobs_by_id(const struct jobs *jobs, uint32_t id)
{
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i]->id == id)
			return jobs->job[i];
	return NULL;
}

struct job *jobs_find(struct jobs *jobs, const struct session *session, uint32_t request)
{
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i]->session == session && jobs->job[i]->request == request)
			return jobs->job[i];
	return NULL;
}

uint32_t jobs_using(const struct jobs *jobs, const struct scene *scene)
{
	uint32_t count = 0;
	for (unsigned i = 0; i < jobs->count; i++)
		count += subject_has(&jobs->job[i]->subject, scene);
	return count;
}

uint32_t jobs_new_id(struct jobs *jobs)
{
	do
		jobs->last_id++;
	while (jobs->last_id == 0 || jobs_by_id(jobs, jobs->last_id));
	return jobs->last_id;
}

bool job_is_first(const struct jobs *jobs, const struct job *job)
{
	for (unsigned i = 0; job->sweep && i < jobs->count; i++)
		if (jobs->job[i]->sweep == job->sweep)
			return jobs->job[i] == job;
	return true;
}

bool job_on_device(const struct job *job)
{
	return job->state == JOB_BEGINNING || job->state == JOB_ACTIVE || job->state == JOB_FINISHED;
}

// ---- in and out ------------------------------------------------------------------------------------------------------

enum status jobs_may_add(const struct jobs *jobs, const struct session *session, struct error *err)
{
	const unsigned own = session->peer->jobs;
	if (share_allows(own, 1, LIMIT_JOBS - jobs->count))
		return STATUS_OK;
	return error_set(err, STATUS_TOO_MANY_JOBS,
			 "the daemon has %u of %u jobs, %u of this process: try again when some have ended", jobs->count,
			 LIMIT_JOBS, own);
}

enum status job_create(struct jobs *jobs, struct session *session, uint32_t request, const struct subject *subject,
		       struct job **out, struct error *err)
{
	if (jobs->count == LIMIT_JOBS)
		return error_set(err, STATUS_TOO_MANY_JOBS, "the daemon has %u jobs: try again when some have ended",
				 LIMIT_JOBS);
	struct job *job = calloc(1, sizeof *job);
	if (!job)
		return error_set(err, STATUS_MEMORY, "no memory for one more job");
	job->id = jobs_new_id(jobs);
	job->session = session;
	job->request = request;
	job->subject = *subject;
	job->asked_us = clock_us();
	job->estimate = job->predicted = ESTIMATE_UNKNOWN;
	image_init(&job->preview);
	image_init(&job->final);
	image_init(&job->last);
	subject_hold(subject);
	session->peer->jobs++;
	jobs->job[jobs->count++] = job;
	*out = job;
	return STATUS_OK;
}

void jobs_let_others_try(struct jobs *jobs)
{
	for (unsigned i = 0; i < jobs->count; i++)
		jobs->job[i]->short_of_memory = false;
}

struct room_owner job_room(struct jobs *jobs, const struct job *job)
{
	return (struct room_owner){.all = &jobs->room,
				   .peer = &job->session->peer->room,
				   .connection = &job->session->room,
				   .most_images = jobs->most_images};
}

void job_release_image(struct jobs *jobs, const struct job *job, struct image *image)
{
	const struct room_owner owner = job_room(jobs, job);
	room_give_back(&owner, &image->place);
	image_close(image);
}

static void job_destroy(struct jobs *jobs, struct job *job)
{
	job->session->peer->jobs--;
	job_release_image(jobs, job, &job->preview);
	job_release_image(jobs, job, &job->final);
	job_release_image(jobs, job, &job->last);
	if (!job->sweep) {
		job->session->requests--;
	} else if (--job->sweep->jobs == 0) {
		job->session->requests--;
		sweep_destroy(job->sweep);
	}
	subject_release(&job->subject);
	free(job->quote);
	free(job);
}

void job_drop(struct jobs *jobs, struct job *job)
{
	if (job_on_device(job)) {
		worker_end(jobs->worker, job->id);
		jobs_let_others_try(jobs);
	}
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i] == job) {
			memmove(&jobs->job[i], &jobs->job[i + 1], (jobs->count - i - 1) * sizeof *jobs->job);
			jobs->count--;
			break;
		}
	job_destroy(jobs, job);
}

void jobs_clear(struct jobs *jobs)
{
	while (jobs->count > 0)
		job_destroy(jobs, jobs->job[--jobs->count]);
}

// ---- failures --------------------------------------------------------------------------------------------------------

void job_log_end(const struct job *job, const char *how)
{
	log_line(LOG_INFO, "job %u: %s: scene \"%s\", %ux%u, %u samples, %u slices, %llu ms on the device, %llu ms in all",
		 job->id, how, job->subject.part[PART_SCENE]->info.name, job->render.width, job->render.height,
		 job->render.samples, job->slices, (unsigned long long)job->device_us / 1000,
		 (unsigned long long)(clock_us() - job->asked_us) / 1000);
}

static void drop_sweep(struct jobs *jobs, const struct sweep *sweep)
{
	unsigned left = sweep->jobs; // it goes with the last
	for (unsigned i = jobs->count; i-- > 0 && left > 0;)
		if (jobs->job[i]->sweep == sweep) {
			job_drop(jobs, jobs->job[i]);
			left--;
		}
}

// All images of a sweep fail with one of them. So several jobs may go, and others change places in the table.
void jobs_fail(struct jobs *jobs, struct job *job, const struct error *err)
{
	if (!err || err->code == STATUS_CANCELLED)
		jobs->cancelled++;
	else
		jobs->failed++;
	job_log_end(job, err ? status_name(err->code) : "client gone");
	if (err)
		reply_error(job->session, job->request, err);
	if (job->sweep)
		drop_sweep(jobs, job->sweep);
	else
		job_drop(jobs, job);
}

void jobs_fail_all(struct jobs *jobs, const struct session *session, const struct error *err)
{
	for (unsigned i = jobs->count; i-- > 0;)
		if (i < jobs->count && (!session || jobs->job[i]->session == session))
			jobs_fail(jobs, jobs->job[i], err);
}

void jobs_fail_scene(struct jobs *jobs, const struct scene *scene, const struct error *err)
{
	for (unsigned i = jobs->count; i-- > 0;)
		if (i < jobs->count && subject_has(&jobs->job[i]->subject, scene))
			jobs_fail(jobs, jobs->job[i], err);
}

void jobs_fail_quarantined(struct jobs *jobs, const struct quarantine *quarantine)
{
	for (unsigned i = jobs->count; i-- > 0;) {
		struct job *job = i < jobs->count ? jobs->job[i] : NULL;
		const struct subject_hashes suspects = job ? subject_hashes_of(&job->subject) : (struct subject_hashes){0};
		struct error err;
		if (quarantine_check(quarantine, &suspects, &err) != STATUS_OK)
			jobs_fail(jobs, job, &err);
	}
}
