#include "server/front/jobs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "protocol/header.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/front/jobs_table.h"
#include "server/front/reply.h"
#include "server/front/session.h"

// A job refused so often for want of memory lets no younger one begin before it.
#define MEMORY_PATIENCE 4u
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

static uint32_t new_id(struct jobs *jobs)
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
	job->id = new_id(jobs);
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

// Make a job of the next camera, if it is time. Fails only if the sweep has no other job.
static enum status advance(struct jobs *jobs, struct sweep *sweep, struct error *err)
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
	if (advance(jobs, sweep, &err) == STATUS_OK)
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

// ---- the device ------------------------------------------------------------------------------------------------------

static bool device_busy(const struct jobs *jobs, const struct job *but)
{
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i] != but && job_on_device(jobs->job[i]))
			return true;
	return false;
}

static bool is_loaded(const struct job *job)
{
	return job->scene->state == SCENE_READY && (!job->environment || job->environment->state == SCENE_READY);
}

static struct job *next_to_begin(const struct jobs *jobs)
{
	for (unsigned i = 0; i < jobs->count; i++) {
		struct job *job = jobs->job[i];
		if (job->state != JOB_WAITING || !is_loaded(job))
			continue;
		if (!job->short_of_memory)
			return job;
		if (job->refusals >= MEMORY_PATIENCE)
			return NULL;
	}
	return NULL;
}

static void begin(struct jobs *jobs)
{
	struct job *job = jobs->beginning ? NULL : next_to_begin(jobs);
	if (!job)
		return;
	job->state = JOB_BEGINNING;
	if (!job->begun_us)
		job->begun_us = clock_us();
	jobs->beginning = job->id;
	jobs->begin_behind_step = jobs->stepping != 0;
	worker_begin(jobs->worker, job->id, job->scene->id, job->environment ? job->environment->id : 0, &job->render);
}

static void step(struct jobs *jobs)
{
	struct job *active[LIMIT_JOBS];
	struct turn *turns[LIMIT_JOBS];
	size_t count = 0;
	// While a BEGIN is outstanding no STEP is put behind it: the new job, which may be a small one, would wait for one
	// more slice of a large one. With step before begin in each dispatch, the two take turns and neither holds up the
	// other.
	if (jobs->stepping || jobs->beginning)
		return;
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i]->state == JOB_ACTIVE) {
			active[count] = jobs->job[i];
			turns[count++] = &jobs->job[i]->turn;
		}
	if (count == 0)
		return;
	struct job *job = active[schedule_pick(turns, count, &jobs->turns)];
	jobs->stepping = job->id;
	jobs->held = job->id;
	jobs->step_sent_us = clock_us();
	worker_step(jobs->worker, job->id, job_slice_us(jobs, job));
}

void jobs_dispatch(struct jobs *jobs)
{
	jobs_end_late(jobs);
	if (jobs->worker->state != WORKER_READY)
		return;
	jobs_read_finished(jobs);
	step(jobs);
	begin(jobs);
}

void jobs_begun(struct jobs *jobs, uint32_t id, const struct ipc_begun *begun)
{
	struct job *job = jobs_by_id(jobs, id);
	jobs->beginning = 0;
	if (!job || job->state != JOB_BEGINNING)
		return;
	if (begun->error.code == STATUS_OK) {
		job->state = JOB_ACTIVE;
		bool *accepted = job->sweep ? &job->sweep->accepted : &job->accepted;
		if (!*accepted)
			reply_message(job->session, MESSAGE_ACCEPTED, job->request, candil_Accepted_fields,
				      &begun->accepted);
		*accepted = true;
		return;
	}
	// There is nothing to END: a job whose BEGIN failed does not exist over there.
	job->state = JOB_WAITING;
	if (begun->error.code == STATUS_MEMORY && device_busy(jobs, job)) {
		job->short_of_memory = true;
		job->refusals++;
		return;
	}
	jobs_fail(jobs, job, &begun->error);
}

static void add_up_sweep(const struct jobs *jobs, const struct sweep *sweep, candil_Progress *progress)
{
	progress->samples_done = 0;
	progress->fraction = 0;
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i]->sweep == sweep) {
			progress->samples_done += jobs->job[i]->samples_done;
			progress->fraction += jobs->job[i]->fraction;
		}
	sweep_progress(sweep, progress);
}

// Of what ends the job first: its samples, its target error (in the worker's fraction) or its deadline.
static double fraction_of(const struct job *job, uint64_t now)
{
	const double time =
	    job->render.deadline_ms > 0 ? (double)(now - job->asked_us) / (job->render.deadline_ms * 1000.0) : 0;
	return time > job->fraction ? fmin(time, 1) : job->fraction;
}

static void tell_progress(const struct jobs *jobs, struct job *job)
{
	uint64_t now = clock_us();
	uint64_t *told_us = job->sweep ? &job->sweep->progress_us : &job->progress_us;
	if (now < *told_us + job->render.progress_ms * 1000ull || !session_has_room(job->session, LIMIT_CHUNK_BYTES))
		return;
	*told_us = now;
	candil_Progress progress = {.samples_done = job->samples_done,
				    .samples = job->render.samples,
				    .fraction = fraction_of(job, now),
				    .device_us = job->device_us,
				    .elapsed_us = now - job->asked_us,
				    .estimated_relmse = job->estimated_relmse};
	if (job->sweep)
		add_up_sweep(jobs, job->sweep, &progress);
	reply_message(job->session, MESSAGE_PROGRESS, job->request, candil_Progress_fields, &progress);
}

void job_traced(struct jobs *jobs, struct job *job)
{
	struct error err;
	job->state = JOB_FINISHED;
	if (!job->sweep)
		return;
	tell_progress(jobs, job);
	advance(jobs, job->sweep, &err);
}

// A job that lacks memory in its midst, which others have now, gives back what it has and begins again after one of them:
// under another number, for a preview of what it was may still come.
static void wait_for_memory(struct jobs *jobs, struct job *job)
{
	worker_end(jobs->worker, job->id);
	jobs_let_others_try(jobs);
	job_begin_again(jobs, job);
	job->id = new_id(jobs);
	job->short_of_memory = true;
	job->refusals++;
}

void jobs_stepped(struct jobs *jobs, uint32_t id, const struct ipc_stepped *stepped)
{
	struct job *job = jobs_by_id(jobs, id);
	uint64_t wall_us = clock_us() - jobs->step_sent_us;
	jobs->stepping = 0;
	jobs->begin_behind_step = false;
	jobs->slices++;
	if (!job || job->state != JOB_ACTIVE)
		return;
	// Not every driver can tell how long its work took.
	uint64_t device_us = stepped->device_us ? stepped->device_us : wall_us;
	job->slices++;
	job->device_us += device_us;
	job->samples_done = stepped->samples_done;
	job->fraction = stepped->fraction;
	job->estimated_relmse = stepped->estimated_relmse;
	job->reached = stepped->reached != 0;
	schedule_charge(&job->turn, device_us);
	if (job->sweep) {
		job->sweep->turn = job->turn;
		job->sweep->device_us += device_us;
	}
	if (stepped->error.code == STATUS_MEMORY && device_busy(jobs, job)) {
		wait_for_memory(jobs, job);
		return;
	}
	if (stepped->error.code != STATUS_OK) {
		jobs_fail(jobs, job, &stepped->error);
		return;
	}
	if (stepped->finished) {
		job_traced(jobs, job);
		return;
	}
	tell_progress(jobs, job);
	job_ask_preview(jobs, job, stepped->samples_done);
}
