#include "server/front/jobs/device.h"

#include <string.h>

#include "protocol/header.h"
#include "protocol/names.h"
#include "server/base/clock.h"
#include "server/front/jobs/compile.h"
#include "server/front/jobs/deadline.h"
#include "server/front/jobs/images.h"
#include "server/front/jobs/lost.h"
#include "server/front/jobs/progress.h"
#include "server/front/jobs/sweep.h"
#include "server/front/jobs/table.h"
#include "server/front/jobs/warnings.h"
#include "server/front/reply.h"
#include "server/front/session.h"

// A job refused so often for want of memory lets no younger one begin before it.
#define MEMORY_PATIENCE 4u

static bool device_busy(const struct jobs *jobs, const struct job *but)
{
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i] != but && job_on_device(jobs->job[i]))
			return true;
	return false;
}

static void count_on_device(const struct jobs *jobs)
{
	for (unsigned i = 0; i < jobs->count; i++)
		jobs->job[i]->session->peer->on_device = 0;
	for (unsigned i = 0; i < jobs->count; i++)
		jobs->job[i]->session->peer->on_device += job_on_device(jobs->job[i]);
}

// The oldest one of the peer that has the fewest on the device.
static struct job *next_to_begin(const struct jobs *jobs)
{
	struct job *next = NULL;
	count_on_device(jobs);
	for (unsigned i = 0; i < jobs->count; i++) {
		struct job *job = jobs->job[i];
		if (job->state != JOB_WAITING || job->undecided || job->compiling || !subject_is_ready(&job->subject))
			continue;
		if (!job->short_of_memory && (!next || job->session->peer->on_device < next->session->peer->on_device))
			next = job;
		if (job->short_of_memory && job->refusals >= MEMORY_PATIENCE)
			break;
	}
	return next;
}

bool jobs_want_device(const struct jobs *jobs)
{
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i]->state == JOB_BEGINNING || jobs->job[i]->state == JOB_ACTIVE)
			return true;
	return next_to_begin(jobs) != NULL;
}

// Has the worker been told to compile what the job needs? In a daemon of one client nobody else waits for that.
static bool may_compile(const struct jobs *jobs, const struct job *job)
{
	return job->compile || jobs->worker->options->private_fd >= 0;
}

void jobs_begin_next(struct jobs *jobs)
{
	struct job *job = jobs->beginning ? NULL : next_to_begin(jobs);
	if (!job)
		return;
	job->state = JOB_BEGINNING;
	job->again_us = clock_us();
	if (job->cold_us)
		job->compiled_us += job->again_us - job->cold_us;
	job->cold_us = 0;
	job->worker = jobs->worker->starts;
	const struct rendered frame = {.subject = &job->subject, .render = &job->render};
	if (jobs->predict && !(technique_traits(job->render.technique) & TECHNIQUE_NOISE))
		job->predicted = jobs->predict(jobs->owner, &frame);
	job_set_end(jobs, job);
	if (!job->begun_us)
		job->begun_us = job->again_us;
	jobs->beginning = job->id;
	jobs->begun_over = subject_hashes_of(&job->subject);
	jobs->begin_behind_step = jobs->stepping != 0;
	worker_begin(jobs->worker, job->id, &job->subject, &job->render, job->end_us, may_compile(jobs, job));
}

void jobs_step_next(struct jobs *jobs)
{
	struct job *active[LIMIT_JOBS];
	struct candidate candidates[LIMIT_JOBS];
	size_t count = 0;
	// No STEP is sent while a BEGIN is outstanding: the new job, which may be a small one, would wait for one more slice
	// of a large one. Since jobs_step_next comes before jobs_begin_next in each dispatch, BEGIN and STEP take turns, and
	// neither holds up the other.
	if (jobs->stepping || jobs->beginning)
		return;
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i]->state == JOB_ACTIVE) {
			active[count] = jobs->job[i];
			candidates[count++] = (struct candidate){&jobs->job[i]->turn, &jobs->job[i]->session->peer->turn};
		}
	if (count == 0)
		return;
	struct job *job = active[schedule_pick(candidates, count, &jobs->turns)];
	for (size_t i = 0; i < count; i++)
		active[i]->crowded |= count > 1;
	jobs->stepping = job->id;
	jobs->stepped_over = subject_hashes_of(&job->subject);
	jobs->held = job->id;
	jobs->step_sent_us = clock_us();
	worker_step(jobs->worker, job->id, job_slice_us(jobs, job));
}

static void add_device_note(const struct jobs *jobs, candil_Accepted *answer)
{
	char note[LIMIT_TEXT + 1];
	worker_device_note(jobs->worker, note);
	if (note[0] && answer->notes_count < LIMIT_NOTES)
		answer->notes_count++;
	if (note[0])
		memcpy(answer->notes[answer->notes_count - 1], note, sizeof note);
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
		if (!*accepted) {
			candil_Accepted answer = begun->accepted;
			answer.has_quote = job->quote != NULL;
			if (job->quote)
				answer.quote = *job->quote;
			warnings_fill(job, &answer);
			add_device_note(jobs, &answer);
			reply_message(job->session, MESSAGE_ACCEPTED, job->request, candil_Accepted_fields, &answer);
		}
		*accepted = true;
		return;
	}
	// No END is sent: the worker has no job whose BEGIN failed.
	job->state = JOB_WAITING;
	if (begun->cold && !may_compile(jobs, job)) {
		job_compile_first(job, begun->cold);
		return;
	}
	if (begun->error.code == STATUS_MEMORY && device_busy(jobs, job)) {
		job->short_of_memory = true;
		job->refusals++;
		return;
	}
	jobs_fail(jobs, job, &begun->error);
}

// An active job cannot go on now. It gives back what it has of the device and will begin again, under another number,
// because a preview of its first attempt may still come.
static void give_back(struct jobs *jobs, struct job *job)
{
	worker_end(jobs->worker, job->id);
	jobs_let_others_try(jobs);
	job_begin_again(jobs, job);
	job->id = jobs_new_id(jobs);
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
	job->ready = stepped->ready != 0;
	job->scaled = stepped->scaled != 0;
	job->fraction = stepped->fraction;
	job->estimate = stepped->estimate;
	job->reached = stepped->reached != 0;
	jobs->device_us += device_us;
	schedule_charge(&job->turn, device_us);
	if (job->sweep) {
		job->sweep->turn = job->turn;
		job->sweep->device_us += device_us;
	}
	if (stepped->error.code == STATUS_MEMORY && device_busy(jobs, job)) {
		// Other jobs have it now: it begins again after one of them has ended.
		give_back(jobs, job);
		job->short_of_memory = true;
		job->refusals++;
		return;
	}
	if (stepped->cold && !may_compile(jobs, job)) {
		give_back(jobs, job);
		job_compile_first(job, stepped->cold);
		return;
	}
	if (stepped->error.code != STATUS_OK) {
		jobs_fail(jobs, job, &stepped->error);
		return;
	}
	job->late = stepped->late != 0;
	// An attempt that was lost with its worker may have come further.
	if (job->late && job->samples_done == 0 && job_send_last(jobs, job))
		return;
	if (job->late && !job->ready) {
		jobs_fail_late(jobs, job);
		return;
	}
	if (stepped->finished || job->late) {
		job_traced(jobs, job);
		return;
	}
	job_tell_progress(jobs, job);
	job_ask_preview(jobs, job, stepped->samples_done);
}
