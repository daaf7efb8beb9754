// Design note. Ways are predicted on a grid of samples, which is enough to see what beats what: the checkpoints where a
// technique ends by its error, else powers of two, between which the samples that fit a time are then found. What is on the
// front of Pareto is beaten by no other way in both time and error.
#include "server/front/quotes/choose.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/names.h"
#include "server/base/checkpoint.h"

#define WAYS 128u
#define CLEAR_MOST 16u // of a technique without noise, whose samples smooth edges alone
#define STEP 1.25 // a neighbour on the front differs by so much at least, in time or in error

struct ways {
	struct quote_way way[WAYS]; // the front of Pareto, once it is made: by time
	unsigned count;
};

static bool has_noise(candil_Technique technique)
{
	return technique_traits(technique) & TECHNIQUE_NOISE;
}

bool quote_can(const candil_Render *r, candil_Technique technique)
{
	const unsigned traits = technique_traits(technique);
	if (!(traits & TECHNIQUE_RENDERS) || technique == candil_Technique_TECHNIQUE_AUTO)
		return false;
	const bool lens = r->lens.radius > 0 || r->lens.projection == candil_Projection_PROJECTION_PANORAMA ||
			  r->filter != candil_Filter_FILTER_BOX;
	if (lens && !(traits & TECHNIQUE_LENS))
		return false;
	const bool open = r->technique == candil_Technique_TECHNIQUE_AUTO;
	if (!open && technique != r->technique)
		return false;
	// Samples by index are asked for to be merged with others of the same noise.
	if (open && r->first_sample > 0 && !(traits & TECHNIQUE_NOISE))
		return false;
	for (pb_size_t i = 0; i < r->options_count; i++)
		if (!technique_takes(technique, r->options[i].name))
			return false;
	return true;
}

// What is not known may be anything.
static double error_of(const struct quote_way *way)
{
	return way->said.error.relmse < 0 ? INFINITY : way->said.error.relmse;
}

// ---- the ways --------------------------------------------------------------------------------------------------------

// When a picture is there whose work takes so long.
static double end_of(const struct quote_ask *ask, const struct quote_way *way, double us)
{
	return us + (ask->queue_us ? ask->queue_us(ask->user, us) : 0) + (ask->count_cold ? way->said.cold_us : 0);
}

static double time_of(const struct quote_ask *ask, const struct quote_way *way)
{
	return end_of(ask, way, way->said.us);
}

static double sure_time_of(const struct quote_ask *ask, const struct quote_way *way)
{
	return end_of(ask, way, way->sure_us);
}

// What has noise ends at a deadline by itself, with what is there; but its first sample, and what has none, is not cut
// short.
static bool is_late(const struct quote_ask *ask, const struct quote_way *way)
{
	const double most = ask->render->deadline_ms * 1000.0;
	return most > 0 && (time_of(ask, way) > most || sure_time_of(ask, way) > most);
}

static void add_way(struct ways *ways, const struct quote_way *way)
{
	if (ways->count < WAYS)
		ways->way[ways->count++] = *way;
}

// Predict a way again, with other samples.
static void predict(const struct quote_ask *ask, uint32_t samples, struct quote_way *way)
{
	way->samples = samples;
	ask->predict(ask->user, way);
	if (samples == 1 || !has_noise(way->technique))
		way->sure_us = way->said.us_high;
}

static uint32_t samples_most(const struct quote_ask *ask, candil_Technique technique)
{
	const candil_Render *r = ask->render;
	const uint64_t pixels = (uint64_t)r->width * r->height, limit = LIMIT_SAMPLES_TIMES_PIXELS / pixels;
	uint64_t most = has_noise(technique) ? QUOTE_OPEN_SAMPLES : CLEAR_MOST;
	if (ask->samples_given)
		most = r->samples;
	if (most > limit)
		most = limit;
	const uint32_t left = LIMIT_SAMPLES - r->first_sample;
	return most < left ? (uint32_t)most : left;
}

// Whether a technique ends by its own measure of its error, at a checkpoint.
static bool ends_by_error(const struct quote_ask *ask, candil_Technique technique)
{
	return ask->render->target_error > 0 && has_noise(technique);
}

static void add_technique(struct ways *ways, const struct quote_ask *ask, candil_Technique technique)
{
	const uint32_t most = samples_most(ask, technique);
	struct quote_way way = {.technique = technique};
	predict(ask, 1, &way);
	bool by_error = ends_by_error(ask, technique);
	if (by_error) {
		predict(ask, CHECKPOINT_FIRST, &way);
		by_error = !is_late(ask, &way); // else the deadline ends it before
	}
	// What has no noise gains little from two samples over one.
	for (uint32_t n = by_error ? CHECKPOINT_FIRST : 1; n < most;
	     n = by_error ? checkpoint_after(n) : n * (has_noise(technique) ? 2 : 4)) {
		predict(ask, n, &way);
		add_way(ways, &way);
	}
	predict(ask, most, &way);
	add_way(ways, &way);
}

static int by_time(const void *a, const void *b)
{
	const struct quote_way *x = a, *y = b;
	if (x->said.us < y->said.us || x->said.us > y->said.us)
		return x->said.us < y->said.us ? -1 : 1;
	return error_of(x) < error_of(y) ? -1 : error_of(x) > error_of(y);
}

static void keep_front(struct ways *ways)
{
	unsigned kept = 0;
	qsort(ways->way, ways->count, sizeof *ways->way, by_time);
	for (unsigned i = 0; i < ways->count; i++)
		if (kept == 0 || error_of(&ways->way[i]) < error_of(&ways->way[kept - 1]))
			ways->way[kept++] = ways->way[i];
	ways->count = kept;
}

// ---- the choice ------------------------------------------------------------------------------------------------------

static bool fits(const struct quote_ask *ask, const struct quote_way *way)
{
	const candil_Render *r = ask->render;
	if (is_late(ask, way))
		return false;
	// What can be measured goes on until the measure's upper end is low enough. Of what cannot the upper end counts:
	// nothing would mend it.
	const double error = has_noise(way->technique) ? way->said.measured_high : way->said.error.high;
	return !(r->target_error > 0) || (isfinite(error_of(way)) && error <= r->target_error);
}

// Is `a` nearer to what is asked than `b`?
static bool is_better(const struct quote_ask *ask, const struct quote_way *a, const struct quote_way *b)
{
	const bool a_fits = fits(ask, a), b_fits = fits(ask, b);
	const bool a_late = is_late(ask, a), b_late = is_late(ask, b);
	if (a_fits != b_fits)
		return a_fits;
	if (a_late != b_late)
		return b_late;
	if (a_late)
		return fmax(time_of(ask, a), sure_time_of(ask, a)) < fmax(time_of(ask, b), sure_time_of(ask, b));
	// In time: the least time within an error, else the least error.
	if (a_fits && ask->render->target_error > 0)
		return time_of(ask, a) < time_of(ask, b);
	return error_of(a) < error_of(b);
}

// Of a way that the deadline ends: the samples that are likely to be there by then.
static void refine(const struct quote_ask *ask, struct quote_way *way)
{
	uint32_t low = way->samples, high = samples_most(ask, way->technique);
	struct quote_way tried = *way;
	while (low < high) {
		predict(ask, high - (high - low) / 2, &tried);
		if (time_of(ask, &tried) <= ask->render->deadline_ms * 1000.0) {
			*way = tried;
			low = tried.samples;
		} else {
			high = tried.samples - 1;
		}
	}
	// Unless it ends by its error before.
	for (uint32_t n = CHECKPOINT_FIRST; ends_by_error(ask, way->technique) && n < way->samples;
	     n = checkpoint_after(n)) {
		predict(ask, n, &tried);
		if (tried.said.measured_high <= ask->render->target_error)
			*way = tried;
	}
}

static void tell(const struct quote_way *way, candil_Choice *out)
{
	*out = (candil_Choice){.technique = way->technique,
			       .samples = way->samples,
			       .time_ms = way->said.us / 1000,
			       .time_ms_low = way->said.us_low / 1000,
			       .time_ms_high = way->said.us_high / 1000,
			       .relmse = way->said.error.relmse,
			       .relmse_low = way->said.error.low,
			       .relmse_high = way->said.error.high};
}

static const char *s_of(uint32_t count)
{
	return count == 1 ? "" : "s";
}

// Why nothing fits.
static void say_unmet(const struct quote_ask *ask, const struct quote_way *w, candil_QuoteReply *reply)
{
	const candil_Render *r = ask->render;
	char because[128];
	if (is_late(ask, w)) {
		const bool surely = time_of(ask, w) > r->deadline_ms * 1000.0;
		const uint32_t samples = surely || !has_noise(w->technique) ? w->samples : 1;
		const char *takes = samples == 1 ? "takes" : "take";
		snprintf(because, sizeof because, "%u sample%s of %u x %u pixels %s %.3g ms%s", samples, s_of(samples),
			 r->width, r->height, surely ? takes : "may take",
			 (surely ? time_of(ask, w) : sure_time_of(ask, w)) / 1000,
			 ask->count_cold && w->said.cold_us > 0 ? ", with programs to be compiled first" : "");
	} else if (!isfinite(error_of(w)))
		snprintf(because, sizeof because, "its error is not known");
	else if (r->deadline_ms > 0)
		snprintf(because, sizeof because, "in that time the error is about %.3g", w->said.error.relmse);
	else if (has_noise(w->technique))
		snprintf(because, sizeof because, "%u samples, the most of a request, leave an error of %.3g", w->samples,
			 w->said.error.relmse);
	else
		snprintf(because, sizeof because, "its error stays at about %.3g, whatever the samples",
			 w->said.error.relmse);
	snprintf(reply->why, sizeof reply->why, "cannot be met: nearest is %s with %u sample%s, because %s",
		 technique_name(w->technique), w->samples, s_of(w->samples), because);
}

static void say_why(const struct quote_ask *ask, const struct quote_way *w, candil_QuoteReply *reply)
{
	const candil_Render *r = ask->render;
	const char *name = technique_name(w->technique);
	const bool open = r->technique == candil_Technique_TECHNIQUE_AUTO;
	if (!reply->met)
		say_unmet(ask, w, reply);
	else if (r->target_error > 0)
		snprintf(reply->why, sizeof reply->why, "%s with %u sample%s takes the least time for an error of %.3g%s",
			 name, w->samples, s_of(w->samples), r->target_error, open ? ", of all techniques" : "");
	else if (r->deadline_ms > 0)
		snprintf(reply->why, sizeof reply->why, "%s with %u sample%s has the least error within %u ms%s", name,
			 w->samples, s_of(w->samples), r->deadline_ms, open ? ", of all techniques" : "");
	else
		snprintf(reply->why, sizeof reply->why, "%s with %u sample%s, as asked", name, w->samples, s_of(w->samples));
}

// The neighbours of the choice on the front.
static void tell_neighbours(const struct ways *ways, const struct quote_way *chosen, candil_QuoteReply *reply)
{
	const double us = chosen->said.us, error = error_of(chosen);
	reply->has_cheaper = reply->has_better = false;
	for (unsigned i = 0; i < ways->count; i++) {
		const struct quote_way *w = &ways->way[i];
		if (w->said.us * STEP <= us && error_of(w) > error && isfinite(error_of(w))) {
			reply->has_cheaper = true;
			tell(w, &reply->cheaper);
		}
		if (!reply->has_better && error_of(w) * STEP <= error && isfinite(error_of(w)) && w->said.us > us) {
			reply->has_better = true;
			tell(w, &reply->better);
		}
	}
}

// Those that cannot, unless the client named one, or no other is left.
static uint32_t left_out(const struct quote_ask *ask)
{
	if (ask->render->technique != candil_Technique_TECHNIQUE_AUTO)
		return 0;
	for (unsigned t = 0; t < TECHNIQUE_COUNT; t++)
		if (quote_can(ask->render, (candil_Technique)t) && !(ask->refused >> t & 1u))
			return ask->refused;
	return 0;
}

void quote_choose(const struct quote_ask *ask, candil_QuoteReply *reply)
{
	struct ways ways = {0};
	struct quote_way chosen;
	const candil_Render *r = ask->render;
	for (unsigned t = 0; t < TECHNIQUE_COUNT; t++)
		if (quote_can(r, (candil_Technique)t) && !(left_out(ask) >> t & 1u))
			add_technique(&ways, ask, (candil_Technique)t);
	if (r->target_error > 0 || r->deadline_ms > 0) {
		chosen = ways.way[0];
		for (unsigned i = 1; i < ways.count; i++)
			if (is_better(ask, &ways.way[i], &chosen))
				chosen = ways.way[i];
		if (r->deadline_ms > 0 && has_noise(chosen.technique))
			refine(ask, &chosen);
	} else {
		chosen = (struct quote_way){.technique = r->technique ? r->technique : TECHNIQUE_OF_AUTO};
		predict(ask, r->samples, &chosen);
	}
	keep_front(&ways);
	reply->met = fits(ask, &chosen);
	reply->has_choice = true;
	tell(&chosen, &reply->choice);
	say_why(ask, &chosen, reply);
	tell_neighbours(&ways, &chosen, reply);
}
