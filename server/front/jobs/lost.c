#include "server/front/jobs/lost.h"

#include "server/front/jobs/table.h"

void job_begin_again(struct jobs *jobs, struct job *job)
{
	if (job->preview_due)
		job_release_image(jobs, job, &job->preview);
	if (job->state == JOB_READING)
		job_release_image(jobs, job, &job->final);
	job->preview_due = false;
	job->preview_samples = 0;
	job->samples_done = 0;
	job->ready = job->scaled = false;
	job->fraction = 0;
	job->estimate = ESTIMATE_UNKNOWN;
	job->late = job->reached = false;
	job->short_of_memory = job->spared = false;
	job->state = JOB_WAITING;
}

static bool was_with_worker(const struct job *job)
{
	return job_on_device(job) || job->state == JOB_READING;
}

static uint32_t suspect(const struct jobs *jobs)
{
	if (jobs->stepping && (!jobs->beginning || jobs->begin_behind_step))
		return jobs->stepping;
	return jobs->beginning ? jobs->beginning : jobs->held;
}

// Blame one job for the loss: the one whose order was being carried out, else the one that had the device last, else the
// oldest that the worker had. It may be the wrong one. But each loss with work under way blames one job, so no job can kill
// workers for ever. Nobody is blamed for an order of a job that has gone meanwhile, because of its deadline for instance:
// that one kills no other.
static void blame(struct jobs *jobs, const char *how)
{
	struct job *job = jobs_by_id(jobs, suspect(jobs));
	if (!job && (jobs->stepping || jobs->beginning))
		return;
	if (!job || !was_with_worker(job))
		for (unsigned i = 0; i < jobs->count && !(job && was_with_worker(job)); i++)
			job = jobs->job[i];
	if (!job || !was_with_worker(job) || ++job->blames <= LIMIT_JOB_RETRIES)
		return;
	struct error err;
	error_set(&err, STATUS_WORKER_LOST, "the worker was lost %u times while it worked on this job (%s)", job->blames,
		  how);
	jobs_fail(jobs, job, &err);
}

struct subject_hashes jobs_worked_on(const struct jobs *jobs)
{
	if (jobs->stepping && (!jobs->beginning || jobs->begin_behind_step))
		return jobs->stepped_over;
	if (jobs->beginning)
		return jobs->begun_over;
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i]->state == JOB_READING)
			return subject_hashes_of(&jobs->job[i]->subject);
	return (struct subject_hashes){0};
}

void jobs_worker_lost(struct jobs *jobs, const struct worker_loss *loss)
{
	// While a pilot is out no job is worked on.
	if (!jobs->pilot_out)
		blame(jobs, loss->how);
	jobs->stepping = 0;
	jobs->beginning = 0;
	jobs->held = 0;
	for (unsigned i = 0; i < jobs->count; i++)
		if (was_with_worker(jobs->job[i])) {
			job_begin_again(jobs, jobs->job[i]);
			jobs->job[i]->retries++;
		}
	// No job holds memory of the device any more, so no job's end would ever wake those that lack some.
	jobs_let_others_try(jobs);
	if (!loss->hopeless)
		return;
	struct error err;
	error_set(&err, STATUS_WORKER_LOST, "the worker does not start (%s): see the daemon's log", loss->how);
	for (unsigned i = jobs->count; i-- > 0;)
		if (i < jobs->count && jobs->job[i]->state == JOB_WAITING)
			jobs_fail(jobs, jobs->job[i], &err);
}
