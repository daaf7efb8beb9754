#include "server/front/jobs/deadline.h"

#include "server/base/clock.h"

#define LEARN 0.5 // weight of the latest image
#define SHORTEST_US 1000u // of a slice

void job_set_deadline(struct job *job)
{
	const uint64_t ms = job->render.deadline_ms;
	job->deadline_us = ms > 0 ? job->asked_us + ms * 1000 : UINT64_MAX;
}

static uint64_t encoding_us(const struct jobs *jobs, const struct job *job)
{
	return (uint64_t)(jobs->encode_us * (double)image_estimate(&job->render));
}

// Microseconds until tracing should end.
static uint64_t left_us(const struct jobs *jobs, const struct job *job)
{
	const uint64_t end = clock_us() + encoding_us(jobs, job);
	return job->deadline_us > end ? job->deadline_us - end : 0;
}

void jobs_learn_encoding(struct jobs *jobs, const struct job *job)
{
	const double took = (double)(clock_us() - job->read_us) / (double)image_estimate(&job->render);
	jobs->encode_us += LEARN * (took - jobs->encode_us);
}

uint32_t job_slice_us(const struct jobs *jobs, const struct job *job)
{
	const uint64_t left = left_us(jobs, job);
	// The first sample is taken whatever the deadline is. Short slices would only make it take longer.
	if (job->samples_done == 0)
		return jobs->slice_us;
	if (left >= jobs->slice_us)
		return jobs->slice_us;
	return left > SHORTEST_US ? (uint32_t)left : SHORTEST_US;
}

bool job_is_late(const struct jobs *jobs, const struct job *job, uint64_t now)
{
	if (job->deadline_us == UINT64_MAX)
		return false;
	if (job->state == JOB_WAITING)
		return now >= job->deadline_us;
	return job->state == JOB_ACTIVE && job->samples_done > 0 && jobs->stepping != job->id && left_us(jobs, job) == 0;
}

void job_fail_late(struct jobs *jobs, struct job *job)
{
	struct error err;
	error_set(
	    &err, STATUS_DEADLINE,
	    "the deadline of %u ms passed before the job could be begun: allow more time, or ask when less is under way",
	    job->render.deadline_ms);
	jobs_fail(jobs, job, &err);
}

static void wake_loop(void *owner)
{
	(void)owner; // the loop comes by, and with it jobs_dispatch
}

void jobs_set_deadline_timer(struct jobs *jobs)
{
	uint64_t next = UINT64_MAX;
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i]->state == JOB_WAITING && jobs->job[i]->deadline_us < next)
			next = jobs->job[i]->deadline_us;
	if (next < UINT64_MAX)
		loop_timer_set(jobs->worker->loop, &jobs->deadline, next, wake_loop, jobs);
	else
		loop_timer_stop(jobs->worker->loop, &jobs->deadline);
}
