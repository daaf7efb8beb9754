#include "server/front/quotes/quotes.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/header.h"
#include "protocol/names.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/front/quotes/choose.h"
#include "server/front/quotes/pilots.h"
#include "server/front/reply.h"
#include "server/front/session.h"
#include "server/front/share.h"

#define WORK_TOLD 0.1 // share of the time from which on it is told that so much is made once
#define QUOTE_PATIENCE_MS 900u // from a quote's arrival, or its scene's, to its answer

// ---- the answer ------------------------------------------------------------------------------------------------------

struct asking {
	struct quotes *quotes;
	const struct quote *quote;
};

static void predict_way(void *user, struct quote_way *way)
{
	const struct asking *a = user;
	const struct rendered f = quote_frame(a->quote);
	const struct quote_query q =
	    quote_known_query(&a->quotes->known, &f, way->technique, way->samples, &a->quote->work[way->technique]);
	way->said = quote_predict(a->quotes->known.model, &q);
}

static double queue_us(void *user, double us)
{
	const struct asking *a = user;
	uint32_t jobs;
	return jobs_queue_us(a->quotes->jobs, a->quote->session, a->quote->job, us, &jobs);
}

static void __attribute__((format(printf, 2, 3))) add_note(candil_QuoteReply *reply, const char *format, ...)
{
	va_list args;
	if (reply->notes_count == sizeof reply->notes / sizeof *reply->notes)
		return;
	va_start(args, format);
	vsnprintf(reply->notes[reply->notes_count++], sizeof *reply->notes, format, args);
	va_end(args);
}

static void add_notes(const struct quotes *quotes, const struct quote *quote, const struct quote_way *way,
		      candil_QuoteReply *reply)
{
	const struct quote_prediction *said = &way->said;
	const bool untold = technique_traits(way->technique) & TECHNIQUE_PATCHES && !quote->work[way->technique].told;
	if (said->records == 0)
		add_note(reply, "nothing is known of this scene yet: this is a guess from %s",
			 quotes->known.model->count > 0 ? "other scenes" : "nothing but the size");
	else if ((quote->budget_us > 0 || untold) && !quote->piloted)
		add_note(reply, "the pilot is not back yet, so the interval is wide: ask again in a while");
	if (said->work_us > WORK_TOLD * said->us && !untold)
		add_note(reply, "%.2g s of it are made once and kept with the scene, for any camera", said->work_us / 1e6);
	if (said->error.relmse < 0)
		add_note(reply,
			 "how wrong it is with these options and this light is not known: --pilot looks, if what it has to "
			 "make first does not take long");
	if (quote->barred)
		add_note(reply, "the worker was lost with a pilot of this, so none is made");
	if (reply->cold_ms > 0)
		add_note(reply, "the first frame takes about %.1f s more, to compile its programs", reply->cold_ms / 1000);
	if (reply->jobs > 0)
		add_note(reply,
			 "the time is that of an idle device; with the %u other job%s as they are now add about %.0f ms",
			 reply->jobs, reply->jobs == 1 ? "" : "s", reply->queue_ms);
}

static void make_reply(struct quotes *quotes, const struct quote *quote, candil_QuoteReply *reply)
{
	struct asking asking = {.quotes = quotes, .quote = quote};
	candil_Render render = quote->render;
	const uint64_t gone_ms = quote->job ? (clock_us() - quote->asked_us) / 1000 : 0;
	const bool noisy = technique_traits(render.technique) & TECHNIQUE_NOISE;
	if (render.deadline_ms > 0)
		render.deadline_ms = render.deadline_ms > gone_ms + 1 ? render.deadline_ms - (uint32_t)gone_ms : 1;
	const struct rendered asked = quote_frame(quote);
	const struct quote_ask ask = {.render = &render,
				      .refused = quote_known_refused(&quotes->known, &asked),
				      .samples_given = render.samples != (noisy ? QUOTE_OPEN_SAMPLES : 1),
				      .count_cold = quote->job != 0,
				      .queue_us = quote->job ? queue_us : NULL,
				      .user = &asking,
				      .predict = predict_way};
	quote_choose(&ask, reply);
	struct quote_way way = {.technique = reply->choice.technique, .samples = reply->choice.samples};
	predict_way(&asking, &way);
	reply->queue_ms = jobs_queue_us(quotes->jobs, quote->session, quote->job, way.said.us, &reply->jobs) / 1000;
	reply->cold_ms = way.said.cold_us / 1000;
	reply->records = way.said.records;
	const bool tried = quote->told >> way.technique & 1u && quote->try_us > 0 && way.said.error.relmse < 0;
	snprintf(reply->from, sizeof reply->from, "%s",
		 quote->piloted && (way.said.nearest[1] == QUOTE_PILOTS || tried) ? "pilot" : "model");
	add_notes(quotes, quote, &way, reply);
}

static void quote_destroy(struct quotes *quotes, struct quote *quote)
{
	for (struct quote **at = &quotes->first; *at; at = &(*at)->next)
		if (*at == quote) {
			*at = quote->next;
			break;
		}
	quotes->count--;
	if (quotes->out == quote->id)
		quotes->out = 0;
	loop_timer_stop(quotes->worker->loop, &quote->timer);
	subject_release(&quote->subject);
	free(quote);
}

// Nobody waits for it any more. While its pilot is out it stays, for the sake of the model.
static void quote_leave(struct quotes *quotes, struct quote *quote)
{
	// A job that is let go would wait for it.
	if (quotes->out == quote->id && quote->job)
		pilots_end(quotes);
	if (quote->session && !quote->job)
		quote->session->requests--;
	quote->session = NULL;
	quote->job = 0;
	loop_timer_stop(quotes->worker->loop, &quote->timer);
	if (quotes->out != quote->id)
		quote_destroy(quotes, quote);
}

static void quote_fail(struct quotes *quotes, struct quote *quote, const struct error *err)
{
	if (quote->job)
		jobs_decide(quotes->jobs, quote->job, NULL);
	else if (quote->session && err)
		reply_error(quote->session, quote->request, err);
	if (quotes->out == quote->id)
		pilots_end(quotes);
	quote_leave(quotes, quote);
}

static void quote_answer(struct quotes *quotes, struct quote *quote)
{
	if (!quote->session)
		return;
	candil_QuoteReply *reply = calloc(1, sizeof *reply);
	struct error err;
	if (!reply) {
		error_set(&err, STATUS_MEMORY, "no memory for an answer");
		quote_fail(quotes, quote, &err);
		return;
	}
	make_reply(quotes, quote, reply);
	log_line(LOG_DEBUG, "quote %u: %s", quote->id, reply->why);
	if (quote->job) {
		jobs_decide(quotes->jobs, quote->job, reply);
	} else {
		reply_message(quote->session, MESSAGE_QUOTE_REPLY, quote->request, candil_QuoteReply_fields, reply);
		free(reply);
	}
	quote_leave(quotes, quote);
}

static void answer_due(void *owner)
{
	struct quote *quote = owner;
	quote_answer(quote->owner, quote);
}

// ---- its life --------------------------------------------------------------------------------------------------------

// Under what a device is known shows when a worker is ready; without one that ever will be, the answer is a guess.
static bool knows_device(const struct worker *worker)
{
	return worker->state == WORKER_READY || worker->ready.device[0] || worker->failed_starts > 0;
}

// The scene is there, but not yet the worker. A job waits for that itself, and who asks for a pilot waits for it.
static void quote_wait(struct quotes *quotes, struct quote *quote)
{
	if (quote->loaded_us > 0)
		return;
	quote->loaded_us = clock_us();
	if (!quote->job && quote->pilot_ms == 0)
		loop_timer_set(quotes->worker->loop, &quote->timer, quote->loaded_us + QUOTE_PATIENCE_MS * 1000ull,
			       answer_due, quote);
}

// The scene is there, and the worker.
static void quote_start(struct quotes *quotes, struct quote *quote)
{
	quote->started = true;
	if (!pilot_plan(quotes, quote) || quotes->worker->failed_starts > 0) {
		quote_answer(quotes, quote);
		return;
	}
	uint64_t due_us =
	    (quote->loaded_us > 0 && !quote->job ? quote->loaded_us : clock_us()) + QUOTE_PATIENCE_MS * 1000ull;
	quote->send_by_us = UINT64_MAX;
	// Who asks for a pilot waits for it, but not for ever: jobs with deadlines may leave no room for one.
	if (quote->pilot_ms > 0)
		due_us += 3ull * quote->limit_us;
	if (quote_is_hurried(quote)) {
		due_us = clock_us() + 2ull * quote->limit_us;
		quote->send_by_us = due_us - quote->limit_us;
	}
	loop_timer_set(quotes->worker->loop, &quote->timer, due_us, answer_due, quote);
}

void quotes_dispatch(struct quotes *quotes)
{
	for (struct quote *q = quotes->first, *next; q; q = next) {
		next = q->next;
		if (q->job && !jobs_undecided(quotes->jobs, q->job))
			quote_leave(quotes, q);
		else if (q->started || !q->session || !subject_is_ready(&q->subject))
			continue;
		else if (knows_device(quotes->worker))
			quote_start(quotes, q);
		else
			quote_wait(quotes, q);
	}
	pilots_dispatch(quotes);
}

void quotes_piloted(struct quotes *quotes, uint32_t id, const struct ipc_piloted *piloted)
{
	struct quote *quote = quote_by_id(quotes, id);
	const bool cut = piloted->cut != 0;
	pilots_back(quotes);
	if (!quote)
		return;
	if (piloted->cold && quote->session) {
		pilot_compile_first(quote, piloted);
		return;
	}
	quote->piloted = !cut;
	const struct rendered f = quote_frame(quote);
	for (unsigned t = 0; t < TECHNIQUE_COUNT && piloted->error.code == STATUS_OK; t++) {
		const struct pilot_result *r = &piloted->results[t];
		quote->work[t] = quote_known_told(&quotes->known, &f, (candil_Technique)t, &r->work);
		if ((r->pixels > 0 || r->refused || r->work.told) && technique_traits(t) & TECHNIQUE_RENDERS)
			quote_known_pilot(&quotes->known, &f, (candil_Technique)t, r);
	}
	if (!quote->session)
		quote_destroy(quotes, quote);
	else if (piloted->error.code != STATUS_OK && !quote->job)
		quote_fail(quotes, quote, &piloted->error);
	else if (!cut)
		quote_answer(quotes, quote);
}

// It may be what the worker died of.
static void quote_bar(struct quotes *quotes, struct quote *quote)
{
	const struct rendered f = quote_frame(quote);
	log_line(LOG_WARNING, "the worker was lost with a pilot of %s: no other is made of it",
		 f.subject->part[PART_SCENE]->info.name);
	for (unsigned t = 0; t < TECHNIQUE_COUNT; t++) {
		const bool own = t == (quote->render.technique ? quote->render.technique : TECHNIQUE_OF_AUTO);
		if (quote->techniques ? quote->techniques >> t & 1u : own)
			quote_known_bar(&quotes->known, &f, (candil_Technique)t);
	}
	quote->piloted = quote->barred = true;
}

bool quotes_worked_on(const struct quotes *quotes, struct subject_hashes *suspects)
{
	const struct quote *quote = quote_by_id(quotes, quotes->out);
	if (quote)
		*suspects = subject_hashes_of(&quote->subject);
	return quote != NULL;
}

void quotes_worker_lost(struct quotes *quotes, bool hopeless)
{
	struct quote *quote = quote_by_id(quotes, quotes->out);
	pilots_back(quotes);
	quotes->known.warm_count = 0;
	if (quote) {
		quote_bar(quotes, quote);
		if (quote->session)
			quote_answer(quotes, quote);
		else
			quote_destroy(quotes, quote);
	}
	for (struct quote *q = quotes->first, *next; hopeless && q; q = next) {
		next = q->next;
		if (q->started)
			quote_answer(quotes, q);
	}
}

// ---- coming and going ------------------------------------------------------------------------------------------------

static enum status quote_create(struct quotes *quotes, struct session *session, uint32_t request,
				const struct subject *subject, const candil_Render *render, struct quote **out,
				struct error *err)
{
	unsigned own = 0;
	for (const struct quote *q = quotes->first; q; q = q->next)
		own += q->session && q->session->peer == session->peer;
	if (!share_allows(own, 1, LIMIT_QUOTES - quotes->count))
		return error_set(err, STATUS_TOO_MANY_JOBS,
				 "the daemon has %u quotes under way, %u of this process: ask again later", quotes->count,
				 own);
	struct quote *quote = calloc(1, sizeof *quote), **end = &quotes->first;
	if (!quote)
		return error_set(err, STATUS_MEMORY, "no memory for a quote");
	do
		quotes->last_id++;
	while (quotes->last_id == 0 || quote_by_id(quotes, quotes->last_id));
	*quote = (struct quote){.id = quotes->last_id,
				.session = session,
				.request = request,
				.subject = *subject,
				.render = *render,
				.asked_us = clock_us(),
				.owner = quotes};
	subject_hold(subject);
	while (*end)
		end = &(*end)->next;
	*end = quote;
	quotes->count++;
	*out = quote;
	return STATUS_OK;
}

static bool some_can(const candil_Render *render)
{
	for (unsigned t = 0; t < TECHNIQUE_COUNT; t++)
		if (quote_can(render, (candil_Technique)t))
			return true;
	return false;
}

enum status quotes_add(struct quotes *quotes, struct session *session, uint32_t request, const struct subject *subject,
		       const candil_Quote *question, struct error *err)
{
	struct quote *quote;
	char known[64];
	if (!some_can(&question->render)) {
		technique_list(TECHNIQUE_RENDERS, "or", known, sizeof known);
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "no technique takes all of these options: name one with them, of %s", known);
	}
	const enum status status = quote_create(quotes, session, request, subject, &question->render, &quote, err);
	if (status != STATUS_OK)
		return status;
	quote->pilot_ms = question->pilot_ms;
	session->requests++;
	return STATUS_OK;
}

void quotes_choose(struct quotes *quotes, struct session *session, uint32_t request, const struct subject *subject,
		   const candil_Render *render)
{
	struct quote *quote;
	struct error err;
	if (!some_can(render) || quote_create(quotes, session, request, subject, render, &quote, &err) != STATUS_OK)
		return;
	quote->job = jobs_hold(quotes->jobs, session, request);
	if (!quote->job)
		quote_destroy(quotes, quote);
}

static struct quote *find_asked(const struct quotes *quotes, const struct session *session, uint32_t request)
{
	for (struct quote *q = quotes->first; q; q = q->next)
		if (q->session == session && q->request == request && !q->job)
			return q;
	return NULL;
}

bool quotes_find(const struct quotes *quotes, const struct session *session, uint32_t request)
{
	return find_asked(quotes, session, request) != NULL;
}

void quotes_cancel(struct quotes *quotes, const struct session *session, uint32_t request, const struct error *err)
{
	quote_fail(quotes, find_asked(quotes, session, request), err);
}

void quotes_drop_session(struct quotes *quotes, const struct session *session)
{
	for (struct quote *q = quotes->first, *next; q; q = next) {
		next = q->next;
		if (q->session == session)
			quote_fail(quotes, q, NULL);
	}
}

void quotes_fail_scene(struct quotes *quotes, const struct scene *scene, const struct error *err)
{
	for (struct quote *q = quotes->first, *next; q; q = next) {
		next = q->next;
		if (q->session && subject_has(&q->subject, scene))
			quote_fail(quotes, q, err);
	}
}

void quotes_fail_quarantined(struct quotes *quotes, const struct quarantine *quarantine)
{
	for (struct quote *q = quotes->first, *next; q; q = next) {
		const struct subject_hashes suspects = subject_hashes_of(&q->subject);
		struct error err;
		next = q->next;
		if (q->session && quarantine_check(quarantine, &suspects, &err) != STATUS_OK)
			quote_fail(quotes, q, &err);
	}
}

void quotes_fail_all(struct quotes *quotes, const struct error *err)
{
	quotes->out = 0; // nobody learns of a pilot any more
	while (quotes->first)
		quote_fail(quotes, quotes->first, err);
}

enum status quotes_init(struct quotes *quotes, struct jobs *jobs, struct worker *worker, const char *state,
			struct error *err)
{
	*quotes = (struct quotes){.jobs = jobs, .worker = worker};
	return quote_known_init(&quotes->known, jobs, worker, state, err);
}

void quotes_finish(struct quotes *quotes)
{
	while (quotes->first)
		quote_destroy(quotes, quotes->first);
	quote_known_finish(&quotes->known);
}
