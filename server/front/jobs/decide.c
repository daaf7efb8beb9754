// Jobs whose technique is chosen by a quote, and what a quote asks of the jobs (jobs_hold, jobs_decide, jobs_queue_us and
// others, in jobs.h).
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/names.h"
#include "server/base/clock.h"
#include "server/front/jobs/table.h"
#include "server/front/session.h"

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

// Device time that a job is likely to take yet. Of one that has not begun nothing is known.
static double left_us(const struct job *job, double otherwise)
{
	return job->fraction > 0 ? (double)job->device_us * (1 - job->fraction) / job->fraction : otherwise;
}

// The jobs of one peer that will have the device, but for job `but`, taken together.
struct queue {
	struct turn turn;
	double left_us, delay_us; // delay_us: what they add to work of the same peer
	uint32_t count;
};

static struct queue queue_of(const struct jobs *jobs, const struct peer *peer, uint32_t but, double us)
{
	struct queue q = {0};
	for (unsigned i = 0; i < jobs->count; i++) {
		const struct job *job = jobs->job[i];
		if (job->id == but || job->state > JOB_ACTIVE || job->session->peer != peer)
			continue;
		const double left = left_us(job, us);
		q.count++;
		q.left_us += left;
		q.delay_us += schedule_delay_us(&job->turn, left, us);
		schedule_charge(&q.turn, job->turn.attained_us);
	}
	return q;
}

double jobs_queue_us(const struct jobs *jobs, const struct session *session, uint32_t but, double us, uint32_t *count)
{
	const struct queue own = queue_of(jobs, session ? session->peer : NULL, but, us);
	double all = own.delay_us;
	*count = own.count;
	for (const struct peer *p = session ? session->table->peers : NULL; p; p = p->next) {
		if (p == session->peer)
			continue;
		const struct queue q = queue_of(jobs, p, but, us);
		*count += q.count;
		all += schedule_delay_us(&q.turn, q.left_us, us + own.delay_us);
	}
	return all;
}

uint64_t jobs_image_bytes(const candil_Render *render)
{
	return image_estimate(render);
}
