#include "server/front/jobs/jobs.h"

#include "server/base/clock.h"
#include "server/front/jobs/compile.h"
#include "server/front/jobs/deadline.h"
#include "server/front/jobs/device.h"
#include "server/front/jobs/images.h"
#include "server/front/jobs/progress.h"
#include "server/front/jobs/sweep.h"
#include "server/front/jobs/table.h"
#include "server/front/session.h"

void jobs_init(struct jobs *jobs, struct worker *worker, uint32_t slice_ms, unsigned most_images)
{
	*jobs = (struct jobs){.worker = worker, .slice_us = slice_ms * 1000u, .most_images = most_images};
	for (unsigned i = 0; i < LIMIT_COMPILERS; i++)
		compiler_init(&jobs->compilers[i], worker, jobs_compiled, jobs);
}

void jobs_finish(struct jobs *jobs)
{
	loop_timer_stop(jobs->worker->loop, &jobs->deadline);
	loop_timer_stop(jobs->worker->loop, &jobs->tick);
	for (unsigned i = 0; i < LIMIT_COMPILERS; i++)
		compiler_stop(&jobs->compilers[i]);
	jobs_clear(jobs);
}

enum status jobs_add(struct jobs *jobs, struct session *session, uint32_t request, const struct subject *subject,
		     const candil_Render *render, struct error *err)
{
	struct job *job;
	enum status status = jobs_may_add(jobs, session, err);
	if (status == STATUS_OK)
		status = job_create(jobs, session, request, subject, &job, err);
	if (status != STATUS_OK)
		return status;
	job->render = *render;
	job_set_deadline(job);
	session->requests++;
	return STATUS_OK;
}

enum status jobs_add_sweep(struct jobs *jobs, struct session *session, uint32_t request, const struct subject *subject,
			   candil_Sweep *message, struct error *err)
{
	struct sweep *sweep = sweep_create(session, request, subject, message);
	if (!sweep)
		return error_set(err, STATUS_MEMORY, "no memory for a sweep");
	enum status status = jobs_add_frame(jobs, sweep, err);
	if (status != STATUS_OK) {
		sweep->message = NULL; // stays the caller's
		sweep_destroy(sweep);
		return status;
	}
	session->requests++;
	return STATUS_OK;
}

// End a job without the worker: with the last intermediate picture, if there is one, else with an error. What the worker
// still answers about it is not heard.
static void end_without_worker(struct jobs *jobs, struct job *job)
{
	if (!job_send_last(jobs, job))
		jobs_fail_late(jobs, job);
}

// End the jobs whose deadline has come: one that is being traced, with the picture that it has; one of which the worker has
// none, or does not answer, without it.
static void end_late(struct jobs *jobs)
{
	const uint64_t now = clock_us();
	// Backwards, and with an eye on the count: a job that fails takes the other jobs of its sweep along.
	for (unsigned i = jobs->count; i-- > 0;) {
		struct job *job = i < jobs->count ? jobs->job[i] : NULL;
		if (!job)
			continue;
		if (job_is_given_up(jobs, job, now)) {
			end_without_worker(jobs, job);
		} else if (job_is_late(jobs, job, now)) {
			job->late = true;
			job_traced(jobs, job);
		}
	}
}

// A job that would have begun by now but for a quote or a pilot begins after it, whatever its deadline is.
static void spare_held(struct jobs *jobs)
{
	for (unsigned i = 0; i < jobs->count && jobs->worker->state == WORKER_READY; i++) {
		struct job *job = jobs->job[i];
		if (job->state == JOB_WAITING && subject_is_ready(&job->subject) && !job->compiling &&
		    !job->short_of_memory && (jobs->piloting || job->undecided))
			job->spared = true;
	}
}

static void give_orders(struct jobs *jobs)
{
	// A pilot has the device to itself, so that its times are its own, and a worker that it ends is no job's fault.
	if (jobs->piloting)
		for (unsigned i = 0; i < jobs->count; i++)
			jobs->job[i]->crowded = true; // its wait is not its own
	jobs_read_finished(jobs);
	if (jobs->piloting)
		return;
	jobs_compile_next(jobs);
	jobs_step_next(jobs);
	jobs_begin_next(jobs);
}

void jobs_dispatch(struct jobs *jobs)
{
	spare_held(jobs);
	end_late(jobs);
	if (jobs->worker->state == WORKER_READY)
		give_orders(jobs);
	// Both look at what the worker owes by now.
	jobs_tell_quiet(jobs);
	jobs_set_deadline_timer(jobs);
}
