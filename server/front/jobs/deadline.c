#include "server/front/jobs/deadline.h"

#include <math.h>

#include "server/base/clock.h"

#define LEARN 0.25 // weight of the latest image
#define SPREAD_FIRST 0.25 // of the first image's time, until there is another
#define SURPRISE 4.0 // spreads that an image may be late by: what is beyond is the machine's doing, and not learned
#define FIRST_US 0.01 // a byte, until there was an image to learn from
#define FIRST_US_PNG 0.05
#define FIRST_PART 0.5 // of the time that is left, at most, likewise
#define SHORTEST_US 1000u // of a slice
#define LATE_US (LIMIT_LATE_MS * 1000ull)
#define HANDOVER_MOST 4.0 // times that handing over may take what was foreseen, before the worker is taken to hang

void job_set_deadline(struct job *job)
{
	const uint64_t ms = job->render.deadline_ms;
	job->deadline_us = ms > 0 ? job->asked_us + ms * 1000 : UINT64_MAX;
	job->end_us = job->deadline_us;
}

static unsigned size_of(const struct job *job)
{
	const unsigned size = 63u - (unsigned)__builtin_clzll(image_estimate(&job->render));
	return size < HANDOVER_SIZES ? size : HANDOVER_SIZES - 1;
}

// The technique that it is rendered by.
static candil_Technique technique_of(const struct job *job)
{
	return job->render.technique ? job->render.technique : TECHNIQUE_OF_AUTO;
}

// What was learned of such images: by their technique, format and the logarithm of their bytes.
static const struct handover *learned(const struct jobs *jobs, const struct job *job)
{
	return jobs->handovers[technique_of(job)][job->render.format];
}

// Microseconds from READ to the last byte, from the nearest size that is known: a larger picture takes longer in proportion,
// a smaller one no longer.
// *guessed: none is.
static double handover_us(const struct jobs *jobs, const struct job *job, bool *guessed)
{
	const struct handover *known = learned(jobs, job);
	const unsigned size = size_of(job);
	*guessed = false;
	for (unsigned away = 0; away < HANDOVER_SIZES; away++) {
		if (away <= size && known[size - away].us > 0)
			return ldexp(known[size - away].us + known[size - away].spread, (int)away);
		if (size + away < HANDOVER_SIZES && known[size + away].us > 0)
			return known[size + away].us + known[size + away].spread;
	}
	*guessed = true;
	const double first_us = job->render.format == candil_Format_FORMAT_PNG ? FIRST_US_PNG : FIRST_US;
	return first_us * (double)image_estimate(&job->render);
}

void job_set_end(const struct jobs *jobs, struct job *job)
{
	const uint64_t now = clock_us();
	const double left = job->deadline_us > now ? (double)(job->deadline_us - now) : 0;
	bool guessed;
	double reserve = handover_us(jobs, job, &guessed);
	if (guessed)
		reserve = fmin(reserve, FIRST_PART * left);
	if (job->deadline_us < UINT64_MAX)
		job->end_us = left > reserve ? job->deadline_us - (uint64_t)reserve : 1; // 0 is no end
}

void jobs_learn_handover(struct jobs *jobs, const struct job *job)
{
	struct handover *h = &jobs->handovers[technique_of(job)][job->render.format][size_of(job)];
	// What was not read tells nothing, and what was scaled, which is less work to encode, little.
	if (job->read_us == 0 || (job->scaled && h->us > 0))
		return;
	const double made = (double)(job->encoded_us - job->read_us), sent = (double)(clock_us() - job->encoded_us);
	// A client that reads slowly is no reason to trace less for others.
	const double took = made + fmin(sent, made);
	if (!(h->us > 0)) {
		*h = (struct handover){.us = took, .spread = SPREAD_FIRST * took};
		return;
	}
	const double late = fmin(took - h->us, SURPRISE * h->spread);
	h->us += LEARN * late;
	h->spread += LEARN * (fabs(late) - h->spread);
}

// Microseconds until sampling has to end. Past that, what has no picture yet gets one as soon as can be, or the worker says
// that there will be none: short slices would only make it come later.
static uint64_t left_us(const struct job *job, uint64_t now)
{
	if (job->state != JOB_ACTIVE)
		return UINT64_MAX;
	if (job->end_us > now)
		return job->end_us - now;
	return job->ready ? 0 : UINT64_MAX;
}

uint32_t job_slice_us(const struct jobs *jobs, const struct job *job)
{
	const uint64_t now = clock_us();
	uint64_t left = left_us(job, now);
	for (unsigned i = 0; i < jobs->count; i++) {
		const struct job *other = jobs->job[i];
		// To others one that is past its end is in a hurry in either case.
		const uint64_t others = other == job || other->state != JOB_ACTIVE ? UINT64_MAX
					: other->end_us > now                      ? other->end_us - now
										   : 0;
		left = others < left ? others : left;
	}
	if (left >= jobs->slice_us)
		return jobs->slice_us;
	return left > SHORTEST_US ? (uint32_t)left : SHORTEST_US;
}

bool job_is_late(const struct jobs *jobs, const struct job *job, uint64_t now)
{
	return job->deadline_us < UINT64_MAX && job->ready && jobs->stepping != job->id && left_us(job, now) < SHORTEST_US;
}

static uint64_t later(uint64_t a, uint64_t b)
{
	return a > b ? a : b;
}

// When a job is given up, as far as can be said now; UINT64_MAX: it is not.
static uint64_t give_up_us(const struct jobs *jobs, const struct job *job)
{
	const uint64_t quiet_us = worker_quiet_us(jobs->worker);
	bool guessed;
	const uint64_t patience_us = quiet_us < UINT64_MAX ? quiet_us + LATE_US : UINT64_MAX;
	if (job->deadline_us == UINT64_MAX)
		return UINT64_MAX;
	switch (job->state) {
	case JOB_WAITING:
	case JOB_BEGINNING:
		return job->spared && !job->compiling ? later(job->deadline_us, patience_us) : job->deadline_us;
	case JOB_ACTIVE:
		// With a picture, and between two slices, job_is_late ends it.
		return job->ready && jobs->stepping != job->id ? UINT64_MAX : later(job->deadline_us, patience_us);
	case JOB_READING:
		// Large pictures take the encoder long, and nothing is heard meanwhile.
		return later(job->deadline_us,
			     job->read_us + LATE_US + (uint64_t)(HANDOVER_MOST * handover_us(jobs, job, &guessed)));
	case JOB_FINISHED: // waits for its client, or for others'
	case JOB_SENDING:
		break;
	}
	return UINT64_MAX;
}

bool job_is_given_up(const struct jobs *jobs, const struct job *job, uint64_t now)
{
	return now >= give_up_us(jobs, job);
}

static const char *why_given_up(const struct job *job)
{
	if (job->state == JOB_WAITING && !job->compiling)
		return "the job could not be begun: allow more time, or ask when less is under way";
	if (job->render.whole && job->state == JOB_ACTIVE && !job->ready)
		return "not every pixel could have a sample: allow more time, leave out `whole` for a picture of fewer "
		       "pixels, or render once without a deadline, so that what is made of the scene is there";
	if (!job->ready)
		return "there could be no picture: allow more time, or have its code compiled and what is made of the scene "
		       "there before (candild --warm, or once without a deadline)";
	return "the worker has not given the picture that it has: it is slow or hangs, ask when less is under way";
}

void jobs_fail_late(struct jobs *jobs, struct job *job)
{
	struct error err;
	error_set(&err, STATUS_DEADLINE, "within the deadline of %u ms %s", job->render.deadline_ms, why_given_up(job));
	jobs_fail(jobs, job, &err);
}

static void wake_loop(void *owner)
{
	(void)owner; // the loop comes by, and with it jobs_dispatch
}

void jobs_set_deadline_timer(struct jobs *jobs)
{
	uint64_t next = UINT64_MAX;
	for (unsigned i = 0; i < jobs->count; i++) {
		const uint64_t end_us = give_up_us(jobs, jobs->job[i]);
		next = end_us < next ? end_us : next;
	}
	if (next < UINT64_MAX)
		loop_timer_set(jobs->worker->loop, &jobs->deadline, next, wake_loop, jobs);
	else
		loop_timer_stop(jobs->worker->loop, &jobs->deadline);
}
