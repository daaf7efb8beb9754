#include "server/front/jobs/progress.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "protocol/header.h"
#include "server/base/clock.h"
#include "server/front/jobs/compile.h"
#include "server/front/jobs/deadline.h"
#include "server/front/jobs/sweep.h"
#include "server/front/reply.h"
#include "server/front/session.h"

#define QUIET_US 250000u // without a word of the worker, after which clients are told without it
#define QUIET_BEGIN_US 1000000u // the same where ACCEPTED is still to come
#define MAX_STAGES (sizeof((candil_Done *)0)->stages / sizeof(candil_Stage))

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

// How much of the job is done, 0 to 1, as to what will end it first: its samples or its target error, which the worker's
// fraction is about, or its deadline.
static double fraction_of(const struct job *job, uint64_t now)
{
	const double time =
	    job->render.deadline_ms > 0 ? (double)(now - job->asked_us) / (job->render.deadline_ms * 1000.0) : 0;
	return time > job->fraction ? fmin(time, 1) : job->fraction;
}

static const char *stage_of(const struct job *job)
{
	return job->compiling ? "compile" : job->state == JOB_BEGINNING ? "begin" : "render";
}

void job_tell_progress(const struct jobs *jobs, struct job *job)
{
	uint64_t now = clock_us();
	uint64_t *told_us = job->sweep ? &job->sweep->progress_us : &job->progress_us;
	if (now < *told_us + job->render.progress_ms * 1000ull)
		return;
	*told_us = now;
	if (!session_has_room(job->session, LIMIT_CHUNK_BYTES))
		return;
	// What is foreseen is the whole picture's error.
	const bool foreseen = job->estimate.kind == candil_ErrorKind_ERROR_KIND_UNKNOWN && !job->scaled;
	const struct estimate *e = foreseen ? &job->predicted : &job->estimate;
	candil_Progress progress = {.samples_done = job->samples_done,
				    .samples = job->render.samples,
				    .fraction = fraction_of(job, now),
				    .device_us = job->device_us,
				    .elapsed_us = now - job->asked_us,
				    .estimated_relmse = e->relmse,
				    .relmse_low = e->low,
				    .relmse_high = e->high,
				    .error_kind = e->kind};
	snprintf(progress.stage, sizeof progress.stage, "%s", stage_of(job));
	if (job->sweep)
		add_up_sweep(jobs, job->sweep, &progress);
	reply_message(job->session, MESSAGE_PROGRESS, job->request, candil_Progress_fields, &progress);
}

// When the client of a job is to be told that the worker is still at it; UINT64_MAX: it is not.
static uint64_t tick_us(const struct jobs *jobs, const struct job *job)
{
	const bool accepted = job->sweep ? job->sweep->accepted : job->accepted;
	const uint64_t next_us =
	    (job->sweep ? job->sweep->progress_us : job->progress_us) + job->render.progress_ms * 1000ull;
	uint64_t from_us = worker_quiet_us(jobs->worker);
	if (job->compiling) // beside the worker
		from_us = job->again_us;
	else if (job->state != JOB_BEGINNING && job->state != JOB_ACTIVE)
		from_us = UINT64_MAX;
	if (from_us == UINT64_MAX)
		return UINT64_MAX;
	from_us += accepted ? QUIET_US : QUIET_BEGIN_US;
	return from_us > next_us ? from_us : next_us;
}

static void wake_loop(void *owner)
{
	(void)owner; // the loop comes by, and with it jobs_dispatch
}

void jobs_tell_quiet(struct jobs *jobs)
{
	const uint64_t now = clock_us();
	uint64_t next_us = UINT64_MAX;
	for (unsigned i = 0; i < jobs->count; i++) {
		if (tick_us(jobs, jobs->job[i]) <= now)
			job_tell_progress(jobs, jobs->job[i]);
		const uint64_t tick = tick_us(jobs, jobs->job[i]);
		next_us = tick < next_us ? tick : next_us;
	}
	if (next_us < UINT64_MAX)
		loop_timer_set(jobs->worker->loop, &jobs->tick, next_us, wake_loop, jobs);
	else
		loop_timer_stop(jobs->worker->loop, &jobs->tick);
}

enum status jobs_add_frame(struct jobs *jobs, struct sweep *sweep, struct error *err)
{
	struct job *job;
	enum status status = STATUS_OK;
	// The place of an image that is sent is the sweep's to use again.
	if (sweep->next == 0 || sweep->jobs > 0)
		status = jobs_may_add(jobs, sweep->session, err);
	if (status == STATUS_OK)
		status = job_create(jobs, sweep->session, sweep->request, &sweep->subject, &job, err);
	if (status != STATUS_OK)
		return status;
	job->sweep = sweep;
	job->index = sweep->next++;
	job->turn = sweep->turn;
	sweep_frame(sweep, job->index, &job->render);
	job_set_deadline(job);
	sweep->jobs++;
	return STATUS_OK;
}

static bool is_tracing(const struct jobs *jobs, const struct sweep *sweep)
{
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i]->sweep == sweep && jobs->job[i]->state < JOB_FINISHED)
			return true;
	return false;
}

// Make a job of a sweep's next camera, if it is time. Fails only if the sweep has no other job.
static enum status advance_sweep(struct jobs *jobs, struct sweep *sweep, struct error *err)
{
	if (sweep->next == sweep_count(sweep) || sweep->jobs >= SWEEP_JOBS || is_tracing(jobs, sweep))
		return STATUS_OK;
	// If there is no place for it now, there will be one when the sweep's other job has ended.
	enum status status = jobs_add_frame(jobs, sweep, err);
	return sweep->jobs > 0 ? STATUS_OK : status;
}

void job_traced(struct jobs *jobs, struct job *job)
{
	struct error err;
	job->state = JOB_FINISHED;
	if (!job->sweep)
		return;
	job_tell_progress(jobs, job);
	advance_sweep(jobs, job->sweep, &err);
}

// Put a stage at the account's beginning or end. There is room: the worker leaves it (FRAME_STAGES_MAX).
static void put_stage(candil_Done *done, pb_size_t at, const char *name, uint64_t us)
{
	if (done->stages_count == MAX_STAGES)
		done->stages_count--;
	at = at < done->stages_count ? at : done->stages_count;
	memmove(&done->stages[at + 1], &done->stages[at], (done->stages_count - at) * sizeof *done->stages);
	done->stages_count++;
	done->stages[at] = (candil_Stage){.us = us};
	snprintf(done->stages[at].name, sizeof done->stages[at].name, "%s", name);
}

// What compiling took beside the worker is a part of what it took in all.
static void add_compiling(candil_Done *done, uint64_t us)
{
	pb_size_t i = 0;
	if (us == 0)
		return;
	done->cold_us += us;
	while (i < done->stages_count && strcmp(done->stages[i].name, "compile") != 0)
		i++;
	if (i < done->stages_count)
		done->stages[i].us += us;
	else
		put_stage(done, 0, "compile", us);
}

// Add the front's part to the worker's account of a job, whose stages are all time that the worker spent on it. So what is
// left between BEGIN and the image is the wait for the device, for room and for messages.
static void complete_account(struct job *job)
{
	candil_Done *done = &job->done;
	const uint64_t now = clock_us(), with_worker = job->encoded_us - job->again_us;
	uint64_t worked = 0;
	for (pb_size_t i = 0; i < done->stages_count; i++)
		worked += done->stages[i].us;
	put_stage(done, 0, "wait", with_worker > worked ? with_worker - worked : 0);
	if (job->again_us - job->begun_us > job->compiled_us)
		put_stage(done, 0, "lost", job->again_us - job->begun_us - job->compiled_us);
	add_compiling(done, job->compiled_us);
	put_stage(done, 0, "queue", job->begun_us - job->asked_us);
	put_stage(done, MAX_STAGES, "send", now - job->encoded_us);
	done->elapsed_us = now - job->asked_us;
	done->slices = job->slices;
	done->retries = job->retries;
	snprintf(done->reason, sizeof done->reason, "%s", job->late ? "time" : job->reached ? "error" : "samples");
}

static void tell_owner(const struct jobs *jobs, const struct job *job)
{
	const struct rendered frame = {.subject = &job->subject,
				       .render = &job->render,
				       .done = &job->done,
				       .work = &job->work,
				       .alone = !job->crowded && jobs->count == 1,
				       .slowed = jobs->worker->ready.software && jobs_compiled_since(jobs, job->again_us),
				       .worker = job->worker};
	// What was scaled tells nothing about a picture of that size.
	if (jobs->rendered && job->read_us > 0 && !job->scaled)
		jobs->rendered(jobs->owner, &frame);
}

static void finish_frame(struct jobs *jobs, struct job *job)
{
	struct sweep *sweep = job->sweep;
	struct error err;
	complete_account(job);
	jobs_learn_handover(jobs, job);
	tell_owner(jobs, job);
	sweep_add(sweep, &job->done);
	jobs->done++;
	job_log_end(job, "done");
	if (sweep->finished == sweep_count(sweep)) {
		sweep_close(sweep, clock_us());
		reply_message(sweep->session, MESSAGE_DONE, sweep->request, candil_Done_fields, &sweep->total);
		job_drop(jobs, job);
		return;
	}
	// The job goes before the next is made, for its place may be the only one in the table. It is taken from its sweep
	// first, which would go with it.
	job->sweep = NULL;
	sweep->jobs--;
	sweep->session->requests++; // job_drop takes it for a render's and counts down
	job_drop(jobs, job);
	if (advance_sweep(jobs, sweep, &err) == STATUS_OK)
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
	jobs_learn_handover(jobs, job);
	tell_owner(jobs, job);
	reply_message(job->session, MESSAGE_DONE, job->request, candil_Done_fields, &job->done);
	jobs->done++;
	job_log_end(job, "done");
	job_drop(jobs, job);
}
