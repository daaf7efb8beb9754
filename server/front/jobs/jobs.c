#include "server/front/jobs/jobs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/header.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/front/jobs/table.h"
#include "server/front/reply.h"
#include "server/front/session.h"

#define ENCODE_US 0.05 // a byte, until there was an image to learn from
#define MAX_STAGES (sizeof((candil_Done *)0)->stages / sizeof(candil_Stage))

void jobs_init(struct jobs *jobs, struct worker *worker, uint32_t slice_ms)
{
	*jobs = (struct jobs){.worker = worker, .slice_us = slice_ms * 1000u, .encode_us = ENCODE_US};
}

// ---- the table -------------------------------------------------------------------------------------------------------

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

static bool job_uses(const struct job *job, const struct scene *scene)
{
	return job->scene == scene || job->environment == scene;
}

uint32_t jobs_using(const struct jobs *jobs, const struct scene *scene)
{
	uint32_t count = 0;
	for (unsigned i = 0; i < jobs->count; i++)
		count += job_uses(jobs->job[i], scene);
	return count;
}

uint32_t jobs_new_id(struct jobs *jobs)
{
	do
		jobs->last_id++;
	while (jobs->last_id == 0 || jobs_by_id(jobs, jobs->last_id));
	return jobs->last_id;
}

static enum status add(struct jobs *jobs, struct session *session, uint32_t request, struct scene *scene,
		       struct scene *environment, struct job **out, struct error *err)
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
	job->scene = scene;
	job->environment = environment;
	job->asked_us = clock_us();
	job->estimated_relmse = -1;
	image_init(&job->preview);
	image_init(&job->final);
	scene_hold(scene);
	if (environment)
		scene_hold(environment);
	jobs->job[jobs->count++] = job;
	*out = job;
	return STATUS_OK;
}

static void set_deadline(struct job *job)
{
	const uint64_t ms = job->render.deadline_ms;
	job->deadline_us = ms > 0 ? job->asked_us + ms * 1000 : UINT64_MAX;
}

enum status jobs_add(struct jobs *jobs, struct session *session, uint32_t request, struct scene *scene,
		     struct scene *environment, const candil_Render *render, struct error *err)
{
	struct job *job;
	enum status status = add(jobs, session, request, scene, environment, &job, err);
	if (status != STATUS_OK)
		return status;
	job->render = *render;
	set_deadline(job);
	session->requests++;
	return STATUS_OK;
}

static enum status add_frame(struct jobs *jobs, struct sweep *sweep, struct error *err)
{
	struct job *job;
	enum status status = add(jobs, sweep->session, sweep->request, sweep->scene, sweep->environment, &job, err);
	if (status != STATUS_OK)
		return status;
	job->sweep = sweep;
	job->index = sweep->next++;
	job->turn = sweep->turn;
	sweep_frame(sweep, job->index, &job->render);
	set_deadline(job);
	sweep->jobs++;
	return STATUS_OK;
}

enum status jobs_add_sweep(struct jobs *jobs, struct session *session, uint32_t request, struct scene *scene,
			   struct scene *environment, candil_Sweep *message, struct error *err)
{
	struct sweep *sweep = sweep_create(session, request, scene, environment, message);
	if (!sweep)
		return error_set(err, STATUS_MEMORY, "no memory for a sweep");
	enum status status = add_frame(jobs, sweep, err);
	if (status != STATUS_OK) {
		sweep->message = NULL; // stays the caller's
		sweep_destroy(sweep);
		return status;
	}
	session->requests++;
	return STATUS_OK;
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

// Its device memory is free, or about to be: those that lacked some may try again.
void jobs_let_others_try(struct jobs *jobs)
{
	for (unsigned i = 0; i < jobs->count; i++)
		jobs->job[i]->short_of_memory = false;
}

static void destroy(struct jobs *jobs, struct job *job)
{
	job_release_image(jobs, job, &job->preview);
	job_release_image(jobs, job, &job->final);
	if (!job->sweep) {
		job->session->requests--;
	} else if (--job->sweep->jobs == 0) {
		job->session->requests--;
		sweep_destroy(job->sweep);
	}
	scene_release(job->scene);
	if (job->environment)
		scene_release(job->environment);
	free(job);
}

static void drop(struct jobs *jobs, struct job *job)
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
	destroy(jobs, job);
}

void jobs_finish(struct jobs *jobs)
{
	loop_timer_stop(jobs->worker->loop, &jobs->deadline);
	while (jobs->count > 0)
		destroy(jobs, jobs->job[--jobs->count]);
}

// ---- ends ------------------------------------------------------------------------------------------------------------

static void log_end(const struct job *job, const char *how)
{
	log_line(LOG_INFO, "job %u: %s: scene \"%s\", %ux%u, %u samples, %u slices, %llu ms on the device, %llu ms in all",
		 job->id, how, job->scene->info.name, job->render.width, job->render.height, job->render.samples,
		 job->slices, (unsigned long long)job->device_us / 1000,
		 (unsigned long long)(clock_us() - job->asked_us) / 1000);
}

static void drop_sweep(struct jobs *jobs, const struct sweep *sweep)
{
	unsigned left = sweep->jobs; // it goes with the last
	for (unsigned i = jobs->count; i-- > 0 && left > 0;)
		if (jobs->job[i]->sweep == sweep) {
			drop(jobs, jobs->job[i]);
			left--;
		}
}

// All images of a sweep end with one of them. So several jobs may go, and places in the table change.
void jobs_fail(struct jobs *jobs, struct job *job, const struct error *err)
{
	if (!err || err->code == STATUS_CANCELLED)
		jobs->cancelled++;
	else
		jobs->failed++;
	log_end(job, err ? status_name(err->code) : "client gone");
	if (err)
		reply_error(job->session, job->request, err);
	if (job->sweep)
		drop_sweep(jobs, job->sweep);
	else
		drop(jobs, job);
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
		if (i < jobs->count && job_uses(jobs->job[i], scene))
			jobs_fail(jobs, jobs->job[i], err);
}

// The front's part of the account: the wait before the device, and what the worker cannot know.
static void complete_account(struct job *job)
{
	candil_Done *done = &job->done;
	if (done->stages_count == MAX_STAGES)
		done->stages_count--;
	memmove(&done->stages[1], &done->stages[0], done->stages_count * sizeof *done->stages);
	done->stages_count++;
	done->stages[0] = (candil_Stage){.name = "queue", .us = job->begun_us - job->asked_us};
	done->elapsed_us = clock_us() - job->asked_us;
	done->slices = job->slices;
	done->retries = job->retries;
	snprintf(done->reason, sizeof done->reason, "%s", job->late ? "time" : job->reached ? "error" : "samples");
}

static bool is_tracing(const struct jobs *jobs, const struct sweep *sweep)
{
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i]->sweep == sweep && jobs->job[i]->state < JOB_FINISHED)
			return true;
	return false;
}

enum status jobs_advance_sweep(struct jobs *jobs, struct sweep *sweep, struct error *err)
{
	if (sweep->next == sweep_count(sweep) || sweep->jobs >= SWEEP_JOBS || is_tracing(jobs, sweep))
		return STATUS_OK;
	// Without a place for it now there will be one when the other job has ended.
	enum status status = add_frame(jobs, sweep, err);
	return sweep->jobs > 0 ? STATUS_OK : status;
}

static void finish_frame(struct jobs *jobs, struct job *job)
{
	struct sweep *sweep = job->sweep;
	struct error err;
	complete_account(job);
	sweep_add(sweep, &job->done);
	jobs->done++;
	log_end(job, "done");
	if (sweep->finished == sweep_count(sweep)) {
		sweep_close(sweep, clock_us());
		reply_message(sweep->session, MESSAGE_DONE, sweep->request, candil_Done_fields, &sweep->total);
		drop(jobs, job);
		return;
	}
	// The sweep outlives its job, which must go first: there may be no other place in the table.
	job->sweep = NULL;
	sweep->jobs--;
	sweep->session->requests++; // for drop, which takes it for a render's
	drop(jobs, job);
	if (jobs_advance_sweep(jobs, sweep, &err) == STATUS_OK)
		return;
	jobs->failed++;
	reply_error(sweep->session, sweep->request, &err);
	sweep->session->requests--;
	sweep_destroy(sweep);
}

void job_finish(struct jobs *jobs, struct job *job)
{
	if (job->sweep) {
		finish_frame(jobs, job);
		return;
	}
	complete_account(job);
	reply_message(job->session, MESSAGE_DONE, job->request, candil_Done_fields, &job->done);
	jobs->done++;
	log_end(job, "done");
	drop(jobs, job);
}
