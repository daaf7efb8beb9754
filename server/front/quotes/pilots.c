#include "server/front/quotes/pilots.h"

#include "protocol/names.h"
#include "server/base/clock.h"
#include "server/front/peer.h"
#include "server/front/quotes/choose.h"
#include "server/front/session.h"

#define PILOT_US 150000u // of work of each technique, if nobody asks for a pilot
#define PILOT_LEAST_US 20000u // of a deadline's share: less tells nothing
#define PILOT_ROOM 4u // times its work that a technique may take in all
#define PILOT_EXTRA_US 100000u // beside the work
#define PILOT_COLD_US 10000000u // for what is to be compiled and built

static uint32_t bit(candil_Technique technique)
{
	return 1u << technique;
}

static void set_limit(struct quote *quote, bool warm)
{
	const uint64_t count = (uint64_t)__builtin_popcount(quote->techniques);
	const uint64_t work_us = count * quote->budget_us + quote->try_us;
	const uint64_t us = PILOT_EXTRA_US + (warm || work_us == 0 ? 0 : PILOT_COLD_US) + PILOT_ROOM * work_us;
	const uint64_t most = LIMIT_PROBE_SECONDS * 1000000ull;
	quote->limit_us = (uint32_t)(us < most ? us : most);
}

// A job's deadline is not to be missed because of a pilot, which ends within a share of what is left until then. Half of
// that is for work.
static void keep_deadline(struct quote *quote)
{
	const uint64_t count = (uint64_t)__builtin_popcount(quote->techniques), now = clock_us();
	const uint64_t end_us = quote->asked_us + quote->render.deadline_ms * 1000ull;
	const uint64_t share_us = end_us > now ? (end_us - now) / PILOT_DEADLINE_SHARE : 0;
	if (share_us < PILOT_LEAST_US)
		quote->budget_us = quote->told = 0;
	if (share_us < quote->limit_us)
		quote->limit_us = (uint32_t)share_us;
	if (count == 0 || quote->budget_us == 0)
		return;
	if (quote->limit_us / (2 * count) < quote->budget_us)
		quote->budget_us = (uint32_t)(quote->limit_us / (2 * count));
}

// Does the worker have to be asked whether it can render this at all?
static bool is_doubtful(const struct quotes *quotes, const struct quote *quote, candil_Technique technique)
{
	const struct rendered f = quote_frame(quote);
	const struct quote_key key = quote_known_key(&quotes->known, &f, technique);
	return !quote->job && !quote->barred && quote_count_view(quotes->known.model, &key, QUOTE_SAMPLE) == 0;
}

// Of which techniques is the work that is left to be told, and is some of it to be tried out? Of one that the client left
// open it matters only where its error is known: else it is not chosen. In a hurry it is counted alone.
static void plan_work(const struct quotes *quotes, struct quote *quote, bool hurried)
{
	const struct rendered f = quote_frame(quote);
	quote->told = quote->try_us = 0;
	for (unsigned t = 0; t < TECHNIQUE_COUNT; t++) {
		const struct quote_key key = quote_known_key(&quotes->known, &f, (candil_Technique)t);
		if (!(technique_traits(t) & TECHNIQUE_PATCHES) || !quote_can(&quote->render, (candil_Technique)t) ||
		    quote_known_lost(&quotes->known, &f, &key))
			continue;
		const bool asked = t == quote->render.technique || quote->techniques >> t & 1u;
		if (!asked && quote_count_light(quotes->known.model, &key, QUOTE_ERROR) == 0)
			continue;
		quote->told |= 1u << t;
		if (!hurried && (quote->pilot_ms > 0 || quote_count_light(quotes->known.model, &key, QUOTE_ROWS) == 0))
			quote->try_us = quote->pilot_ms > 0 ? quote->pilot_ms * 1000 : PILOT_US;
	}
}

bool pilot_plan(const struct quotes *quotes, struct quote *quote)
{
	bool noisy_unknown = false, clear_unknown = false, all_warm = true;
	uint32_t noisy = 0, clear = 0;
	const bool hurried = quote_is_hurried(quote);
	const struct rendered f = quote_frame(quote);
	const candil_Technique own = quote->render.technique ? quote->render.technique : TECHNIQUE_OF_AUTO;
	for (unsigned t = 0; t < TECHNIQUE_COUNT; t++) {
		const candil_Technique technique = (candil_Technique)t;
		if (!quote_can(&quote->render, technique))
			continue;
		const struct quote_key key = quote_known_key(&quotes->known, &f, technique);
		const bool warm = quote_known_warm(&quotes->known, &f, &key);
		const bool unknown = quote_count_view(quotes->known.model, &key, QUOTE_ERROR) == 0;
		if (quote_known_lost(&quotes->known, &f, &key)) {
			quote->barred = true;
			continue;
		}
		if (technique_traits(t) & TECHNIQUE_NOISE) {
			if (hurried && !warm)
				continue;
			noisy |= bit(technique);
			noisy_unknown |= unknown;
		} else if (quote->pilot_ms > 0 || warm) {
			clear |= bit(technique);
			clear_unknown |= unknown;
		}
		all_warm = all_warm && warm;
	}
	// The bias of a technique is seen beside a reference, whose options are its own.
	if (clear != 0 && noisy == 0 && !hurried && !quote->barred) {
		noisy = bit(TECHNIQUE_OF_AUTO);
		all_warm = false;
	}
	if (noisy == 0)
		clear_unknown = false;
	quote->techniques = clear_unknown || quote->pilot_ms > 0 ? noisy | clear : noisy_unknown ? noisy : 0;
	quote->budget_us = quote->techniques == 0 ? 0 : quote->pilot_ms > 0 ? quote->pilot_ms * 1000 : PILOT_US;
	plan_work(quotes, quote, hurried);
	set_limit(quote, all_warm);
	if (hurried)
		keep_deadline(quote);
	if (quote->budget_us == 0)
		quote->techniques = 0;
	return quote->techniques != 0 || quote->told != 0 || is_doubtful(quotes, quote, own);
}

static struct quote *next_pilot(const struct quotes *quotes)
{
	for (struct quote *q = quotes->first; q; q = q->next)
		if (q->started && !q->piloted && !q->compiling && q->session && subject_is_ready(&q->subject) &&
		    clock_us() <= q->send_by_us && jobs_first_end_us(quotes->jobs, q->job) > clock_us() + q->limit_us)
			return q;
	return NULL;
}

static void send_pilot(struct quotes *quotes, struct quote *quote)
{
	quotes->out = quote->id;
	quotes->out_since_us = clock_us();
	quotes->jobs->pilot_out = true;
	struct ipc_pilot pilot = {.head = {.job = quote->id},
				  .techniques = quote->techniques,
				  .told = quote->told,
				  .budget_us = quote->budget_us,
				  .try_us = quote->try_us,
				  .limit_us = quote->limit_us,
				  .compile = quote->compiled || quotes->worker->options->private_fd >= 0,
				  .render = quote->render};
	subject_ids(&quote->subject, pilot.parts);
	worker_pilot(quotes->worker, &pilot);
}

void pilot_compile_first(struct quote *quote, const struct ipc_piloted *piloted)
{
	quote->compiled = quote->code == piloted->cold;
	quote->compiling = !quote->compiled;
	quote->code = piloted->cold;
	quote->code_technique = (candil_Technique)piloted->cold_technique;
}

// Code that pilots wait for is compiled by a process of its own, as that of jobs.
static void compile_for_pilots(struct quotes *quotes)
{
	for (struct quote *q = quotes->first; q; q = q->next) {
		candil_Render render = q->render;
		render.technique = q->code_technique;
		if (!q->compiling)
			continue;
		if (q->compiled && !jobs_compiling(quotes->jobs, q->code))
			q->compiling = q->compiled = false;
		else if (!q->compiled && q->session)
			q->compiled =
			    jobs_compile(quotes->jobs, q->session->peer->id, q->code, &q->subject, &render, q->budget_us);
	}
}

void pilots_end(struct quotes *quotes)
{
	quotes->ending = quotes->ending || worker_pilot_end(quotes->worker);
}

// A job that has come since may have to leave the device before the pilot does.
static void make_way(struct quotes *quotes)
{
	const struct quote *quote = quote_by_id(quotes, quotes->out);
	if (quote && jobs_first_end_us(quotes->jobs, quote->job) < quotes->out_since_us + quote->limit_us)
		pilots_end(quotes);
}

void pilots_dispatch(struct quotes *quotes)
{
	struct jobs *jobs = quotes->jobs;
	compile_for_pilots(quotes);
	if (quotes->out) {
		make_way(quotes);
		return;
	}
	struct quote *quote = quotes->worker->state == WORKER_READY ? next_pilot(quotes) : NULL;
	if (!jobs_want_device(jobs))
		quotes->owed_us = jobs->device_us;
	jobs->piloting = quote && jobs->device_us >= quotes->owed_us;
	if (jobs->piloting && !jobs->stepping && !jobs->beginning)
		send_pilot(quotes, quote);
}

void pilots_back(struct quotes *quotes)
{
	if (quotes->out)
		quotes->owed_us = quotes->jobs->device_us + (clock_us() - quotes->out_since_us);
	quotes->out = 0;
	quotes->ending = false;
	quotes->jobs->piloting = quotes->jobs->pilot_out = false;
}
