// Jobs whose technique is chosen by a quote, and what a quote asks of the jobs (jobs_hold, jobs_decide, jobs_queue_us and
// others, in jobs.h).
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/names.h"
#include "server/base/clock.h"
#include "server/front/jobs/table.h"

uint32_t jobs_hold(struct jobs *jobs, const struct session *session, uint32_t request)
{
	struct job *job = jobs_find(jobs, session, request);
	if (!job || job->state != JOB_WAITING)
		return 0;
	job->undecided = true;
	return job->id;
}

static void take_choice(candil_Render *render, const candil_Choice *choice)
{
	render->technique = choice->technique;
	if (technique_traits(choice->technique) & TECHNIQUE_NOISE)
		return; // its end is that of the request
	render->samples = choice->samples;
	render->target_error = 0;
}

void jobs_decide(struct jobs *jobs, uint32_t id, candil_QuoteReply *reply)
{
	struct job *job = jobs_by_id(jobs, id);
	if (!job || !job->undecided) {
		free(reply);
		return;
	}
	job->undecided = false;
	job->quote = reply;
	if (reply)
		take_choice(&job->render, &reply->choice);
}

bool jobs_undecided(const struct jobs *jobs, uint32_t id)
{
	const struct job *job = jobs_by_id(jobs, id);
	return job && job->undecided;
}

uint64_t jobs_first_end_us(const struct jobs *jobs, uint32_t but)
{
	uint64_t first = UINT64_MAX;
	const uint64_t now = clock_us();
	for (unsigned i = 0; i < jobs->count; i++) {
		const struct job *job = jobs->job[i];
		// A finished one that is late waits for its client.
		const bool goes_on = job->state <= JOB_ACTIVE || (job->state < JOB_SENDING && job->deadline_us > now);
		if (job->id != but && goes_on && job->end_us < first)
			first = job->end_us;
	}
	return first;
}

double jobs_queue_us(const struct jobs *jobs, uint32_t but, double us, uint32_t *count)
{
	double all = 0;
	*count = 0;
	for (unsigned i = 0; i < jobs->count; i++) {
		const struct job *job = jobs->job[i];
		if (job->id == but || job->state > JOB_ACTIVE)
			continue;
		++*count;
		// Of a job that has not begun nothing is known.
		const double left = job->fraction > 0 ? (double)job->device_us * (1 - job->fraction) / job->fraction : us;
		all += schedule_delay_us(&job->turn, left, us);
	}
	return all;
}

uint64_t jobs_image_bytes(const candil_Render *render)
{
	return image_estimate(render);
}
