#include "server/front/quotes/known.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "protocol/names.h"
#include "server/base/log.h"
#include "server/base/stage.h"
#include "server/front/quotes/key.h"

struct quote_key quote_known_key(const struct quote_known *known, const struct rendered *f, candil_Technique technique)
{
	const struct quote_model *m = known->model;
	const struct subject_hashes of = subject_hashes_of(f->subject);
	struct quote_key key = quote_key_of(f->render, technique, &of, known->worker->ready.device);
	// Until a worker has said what it runs on, that is taken for what the newest record is of.
	if (!known->worker->ready.device[0] && m->count > 0)
		key.where = m->records[(m->oldest + m->count - 1) % LIMIT_QUOTE_RECORDS].key.where;
	return key;
}

static bool has_warm(const struct quote_known *known, uint64_t what)
{
	for (uint32_t i = 0; i < QUOTE_WARM && i < known->warm_count; i++)
		if (known->warm[i] == what)
			return true;
	return false;
}

// What is made once for a scene, and the programs.
struct warmth {
	uint64_t setup, programs;
};

static struct warmth warmth_of(const struct rendered *f, const struct quote_key *key)
{
	return (struct warmth){.setup = quote_warmth_of(key, quote_made_of(f->subject)),
			       .programs = quote_warmth_of(key, quote_facts_of(f->subject))};
}

bool quote_known_warm(const struct quote_known *known, const struct rendered *f, const struct quote_key *key)
{
	const struct warmth w = warmth_of(f, key);
	return has_warm(known, w.setup) && has_warm(known, w.programs);
}

static void set_warm(struct quote_known *known, const struct rendered *f, candil_Technique technique,
		     const struct quote_key *key)
{
	const struct warmth w = warmth_of(f, key);
	known->begun = known->warm_count > 0 ? known->begun | 1u << technique : 1u << technique;
	if (!has_warm(known, w.setup))
		known->warm[known->warm_count++ % QUOTE_WARM] = w.setup;
	if (!has_warm(known, w.programs))
		known->warm[known->warm_count++ % QUOTE_WARM] = w.programs;
}

// Whether a time of compiling is one. Little of it where it was expected tells of a driver that keeps programs on its disk
// if the worker had none of the technique, else of programs that were there, of other options say: another worker has none.
static bool tells_cold(const struct quote_known *known, const struct quote_query *q, double us)
{
	const bool begun = known->warm_count > 0 && known->begun >> q->technique & 1u;
	return us > STAGE_COLD_US || (q->cold && !begun);
}

bool quote_known_lost(const struct quote_known *known, const struct rendered *f, const struct quote_key *key)
{
	const uint64_t what = warmth_of(f, key).setup;
	for (uint32_t i = 0; i < QUOTE_LOST && i < known->lost_count; i++)
		if (known->lost[i] == what)
			return true;
	return false;
}

void quote_known_bar(struct quote_known *known, const struct rendered *f, candil_Technique technique)
{
	const struct quote_key key = quote_known_key(known, f, technique);
	if (!quote_known_lost(known, f, &key))
		known->lost[known->lost_count++ % QUOTE_LOST] = warmth_of(f, &key).setup;
}

// What is taken for the work of a technique that has some, as long as no worker has told: anything.
static const struct work anything = {
    .picture = 1,
    .left = {[WORK_CUT] = 8e3, [WORK_LIGHT] = 1e5, [WORK_ROWS] = 4e6, [WORK_SOLVE] = 2e6},
    .doubt = {[WORK_CUT] = 2, [WORK_LIGHT] = 2, [WORK_ROWS] = 2, [WORK_SOLVE] = 2},
};

// What was told last of such a request's work.
static const struct work *known_work(const struct quote_known *known, uint64_t what)
{
	for (uint32_t i = 0; known->works_of == known->worker->starts && i < QUOTE_WORKS && i < known->work_count; i++)
		if (known->works[i].what == what)
			return &known->works[i].work;
	return &anything;
}

static void keep_work(struct quote_known *known, uint64_t what, const struct work *work)
{
	uint32_t at = 0;
	// What was tried out is known better than what is counted.
	if (!work->told || (work->told == WORK_COUNTED && known_work(known, what)->told == WORK_TRIED))
		return;
	known->work_count = known->works_of == known->worker->starts ? known->work_count : 0;
	known->works_of = known->worker->starts;
	while (at < QUOTE_WORKS && at < known->work_count && known->works[at].what != what)
		at++;
	if (at == QUOTE_WORKS || at == known->work_count)
		at = known->work_count++ % QUOTE_WORKS;
	known->works[at] = (struct quote_work){what, *work};
}

struct work quote_known_told(struct quote_known *known, const struct rendered *f, candil_Technique technique,
			     const struct work *work)
{
	const struct quote_key key = quote_known_key(known, f, technique);
	const uint64_t what = warmth_of(f, &key).setup;
	if (!work->told)
		return *work;
	keep_work(known, what, work);
	return *known_work(known, what);
}

struct quote_query quote_known_query(const struct quote_known *known, const struct rendered *f, candil_Technique technique,
				     uint32_t samples, const struct work *work)
{
	const struct quote_key key = quote_known_key(known, f, technique);
	const struct warmth w = warmth_of(f, &key);
	struct quote_query q = {.key = key,
				.technique = technique,
				.software = known->worker->ready.software,
				.pixels = (double)f->render->width * f->render->height,
				.samples = samples,
				.picture = 1,
				.bytes = (double)jobs_image_bytes(f->render),
				.setup = !has_warm(known, w.setup),
				.cold = !has_warm(known, w.programs)};
	if (!(technique_traits(technique) & TECHNIQUE_PATCHES))
		return q;
	if (!work || !work->told)
		work = known_work(known, w.setup);
	q.key.rows = work->way_of_rows;
	q.key.picture = work->way_of_pictures;
	q.picture = work->picture;
	memcpy(q.work, work->left, sizeof q.work);
	memcpy(q.doubt, work->doubt, sizeof q.doubt);
	return q;
}

static uint64_t wall_us(void)
{
	struct timespec t;
	clock_gettime(CLOCK_REALTIME, &t);
	return (uint64_t)t.tv_sec * 1000000u + (uint64_t)t.tv_nsec / 1000u;
}

static uint64_t next_stamp(struct quote_known *known)
{
	const uint64_t now = wall_us();
	known->stamp = now > known->stamp ? now : known->stamp + 1;
	return known->stamp;
}

static void set_error(struct quote_record *r, const struct estimate *e, double times)
{
	if (!(e->relmse >= 0) || !(e->low >= 0))
		return;
	if (!(e->relmse > 0)) {
		// A picture that is rightly black has the least error that a record can tell.
		quote_set_part(r, QUOTE_ERROR, 0);
		r->spread = 0.02f;
		return;
	}
	// Where there is no upper end the lower one still says that the error is not small: as far above, and no less than
	// three times.
	const double low = fmax(e->low, e->relmse / 10), high = e->high > 0 ? e->high : e->relmse * fmax(e->relmse / low, 3);
	// If few pixels of few have most of the error, its likeliest value is that of those that have missed them: the ends
	// know how far it is to either side. A frame is larger, and is what is to be foretold.
	const bool few = r->pilot && technique_traits(r->technique) & TECHNIQUE_NOISE;
	quote_set_part(r, QUOTE_ERROR, (few ? sqrt(low * high) : e->relmse) * times);
	r->spread = (float)fmin(fmax(log(fmax(high / low, 1)) / (2 * 1.645), 0.02), 5);
}

// Sums over a frame's stages, by their kind.
struct account {
	double us[STAGE_ENCODE + 1];
	double all;
};

static struct account add_up(const candil_Done *done)
{
	struct account a = {0};
	double sent = 0;
	for (pb_size_t i = 0; i < done->stages_count; i++) {
		a.us[stage_kind(done->stages[i].name)] += (double)done->stages[i].us;
		a.all += (double)done->stages[i].us;
		sent += strcmp(done->stages[i].name, "send") == 0 ? (double)done->stages[i].us : 0;
	}
	// A client that reads slowly is no property of the picture: it is waited for as for a queue.
	const double waited = fmax(2 * sent - a.us[STAGE_ENCODE], 0);
	a.us[STAGE_ENCODE] -= waited;
	a.us[STAGE_QUEUE] += waited;
	return a;
}

// The parts of work that was made.
static void set_work(struct quote_record *r, const struct work *work)
{
	for (int part = 0; part < WORK_PARTS; part++)
		if (work->made[part] > 0 && work->us[part] > 0)
			quote_set_part(r, (enum quote_part)(QUOTE_CUT + part), work->us[part] / work->made[part]);
}

// A file that is no picture tells of the work before it alone.
static void learn_file(struct quote_known *known, const struct quote_query *q, const struct rendered *f)
{
	struct quote_record r = {
	    .key = q->key, .stamp = next_stamp(known), .technique = q->technique, .pixels = 1, .samples = 1};
	if (f->work && !f->slowed)
		set_work(&r, f->work);
	if (r.known == 0)
		return;
	quote_learn(known->model, &r, q, 0);
	quote_store_mark(&known->store);
}

// What the frame's job has made was left before it.
static struct work work_before(const struct work *work)
{
	struct work before = work ? *work : (struct work){0};
	memcpy(before.left, before.made, sizeof before.left);
	memset(before.doubt, 0, sizeof before.doubt);
	return before;
}

static void learn_frame(void *owner, const struct rendered *f)
{
	struct quote_known *known = owner;
	const candil_Technique technique = f->render->technique ? f->render->technique : TECHNIQUE_OF_AUTO;
	const candil_Done *done = f->done;
	// A worker that is gone by now took along what was warm, and another's warmth is none of this frame's.
	if (done->samples == 0 || done->retries > 0 || f->worker != known->worker->starts)
		return;
	const struct work work = work_before(f->work);
	const struct quote_query q = quote_known_query(known, f, technique, done->samples, &work);
	if (!format_is_picture(f->render->format)) {
		learn_file(known, &q, f);
		return;
	}
	const struct account a = add_up(done);
	struct quote_record r = {.key = q.key,
				 .stamp = next_stamp(known),
				 .technique = technique,
				 .pixels = (uint32_t)q.pixels,
				 .samples = done->samples};
	const bool cold = a.us[STAGE_COLD] > STAGE_COLD_US;
	const double fixed = a.us[STAGE_FIXED] + fmax((double)done->elapsed_us - a.all, 0);
	// Times of a frame that had to share its processors with a compiler are nobody else's.
	if (q.setup && !f->slowed)
		quote_set_part(&r, QUOTE_SETUP, fmax(a.us[STAGE_SETUP] - work_us(&work), 0));
	if (!f->slowed)
		set_work(&r, &work);
	if (tells_cold(known, &q, a.us[STAGE_COLD]) && !f->slowed)
		quote_set_part(&r, QUOTE_COLD, a.us[STAGE_COLD]);
	if (!cold && !f->slowed) {
		quote_set_part(&r, QUOTE_PIXEL, a.us[STAGE_PIXEL] / q.pixels);
		quote_set_part(&r, QUOTE_SAMPLE, a.us[STAGE_SAMPLE] / (q.pixels * done->samples * q.picture));
		if (f->alone)
			quote_set_part(&r, QUOTE_FIXED, fixed);
	}
	if (!f->slowed)
		quote_set_part(&r, QUOTE_ENCODE, a.us[STAGE_ENCODE] / q.bytes);
	const struct estimate e = {
	    .relmse = done->estimated_relmse, .low = done->relmse_low, .high = done->relmse_high, .kind = done->error_kind};
	if (e.kind == candil_ErrorKind_ERROR_KIND_MEASURED && technique_traits(technique) & TECHNIQUE_NOISE)
		set_error(&r, &e, done->samples);
	set_warm(known, f, technique, &q.key);
	if (f->work)
		keep_work(known, warmth_of(f, &q.key).setup, f->work);
	quote_learn(known->model, &r, &q, cold || f->slowed || !f->alone ? 0 : (double)done->elapsed_us - a.us[STAGE_QUEUE]);
	quote_store_mark(&known->store);
}

// Of a technique that cannot tell its error: known are the settings' errors in some view of this scene.
static struct estimate predict_error(void *owner, const struct rendered *f)
{
	const struct quote_known *known = owner;
	const struct quote_query q = quote_known_query(known, f, f->render->technique, f->render->samples, NULL);
	if (quote_count_look(known->model, &q.key, QUOTE_ERROR) == 0)
		return ESTIMATE_UNKNOWN;
	return quote_predict(known->model, &q).error;
}

// Of a pilot's technique without noise, as a record of its own: of other pixels and samples than those of its times.
static void keep_bias(struct quote_known *known, const struct quote_record *times, const struct pilot_bias *bias)
{
	struct quote_record r = *times;
	if (bias->pixels == 0 || bias->samples == 0)
		return;
	r.known = 0;
	r.pixels = bias->pixels;
	r.samples = bias->samples;
	r.edges = (float)bias->edges;
	r.stamp = next_stamp(known);
	set_error(&r, &bias->error, 1);
	log_line(LOG_DEBUG, "%s, %u pixels, %u samples: bias %.3g (%.3g … %.3g)", technique_name(r.technique), r.pixels,
		 r.samples, bias->error.relmse, bias->error.low, bias->error.high);
	// Without anything that it knows it would be a refusal.
	if (r.known != 0)
		quote_learn(known->model, &r, NULL, 0);
}

static void log_work(const char *name, const struct work *w)
{
	log_line(LOG_DEBUG,
		 "work of %s: %.0f elements, %.3g rays, %.3g of rows, %.3g entries left; %.3f, %.3f, %.4f, %.4f us of each",
		 name, w->left[WORK_CUT], w->left[WORK_LIGHT], w->left[WORK_ROWS], w->left[WORK_SOLVE],
		 w->us[WORK_CUT] / fmax(w->made[WORK_CUT], 1), w->us[WORK_LIGHT] / fmax(w->made[WORK_LIGHT], 1),
		 w->us[WORK_ROWS] / fmax(w->made[WORK_ROWS], 1), w->us[WORK_SOLVE] / fmax(w->made[WORK_SOLVE], 1));
}

void quote_known_pilot(struct quote_known *known, const struct rendered *f, candil_Technique technique,
		       const struct pilot_result *p)
{
	const char *name = f->subject->part[PART_SCENE]->info.name;
	const bool seen = p->pixels > 0 && p->samples > 0;
	const struct quote_query q = quote_known_query(known, f, technique, seen ? p->samples : 1, &p->work);
	struct quote_record r = {.key = q.key,
				 .stamp = next_stamp(known),
				 .technique = technique,
				 .pilot = 1,
				 .pixels = seen ? p->pixels : 1,
				 .samples = seen ? p->samples : 1};
	if (p->work.told)
		log_work(name, &p->work);
	if (!p->slowed)
		set_work(&r, &p->work);
	if (!seen && p->work.told && !p->refused) {
		// Without a part it would be a refusal.
		if (r.known != 0)
			quote_learn(known->model, &r, NULL, 0);
		quote_store_mark(&known->store);
		return;
	}
	if (!seen) {
		r.known = 0;
		log_line(LOG_DEBUG, "pilot of %s: %s cannot", name, technique_name(technique));
		quote_keep(known->model, &r);
		return;
	}
	if (q.setup)
		quote_set_part(&r, QUOTE_SETUP, p->setup_us);
	if (tells_cold(known, &q, p->cold_us))
		quote_set_part(&r, QUOTE_COLD, p->cold_us);
	if (!p->slowed) {
		quote_set_part(&r, QUOTE_PIXEL, p->pixel_us / p->pixels);
		quote_set_part(&r, QUOTE_SAMPLE, p->sample_us / ((double)p->pixels * p->samples * q.picture));
	}
	const bool noisy = technique_traits(technique) & TECHNIQUE_NOISE;
	set_error(&r, &p->error, noisy ? p->samples : 1);
	log_line(LOG_DEBUG,
		 "pilot of %s: %s, %u pixels, %u samples: %.0f us cold, %.0f setup, %.4f a pixel, %.4f a sample; "
		 "error %.3g (%.3g … %.3g)",
		 name, technique_name(technique), p->pixels, p->samples, p->cold_us, p->setup_us, p->pixel_us / p->pixels,
		 p->sample_us / ((double)p->pixels * p->samples), p->error.relmse, p->error.low, p->error.high);
	set_warm(known, f, technique, &q.key);
	quote_learn(known->model, &r, NULL, 0);
	for (unsigned i = 0; i < sizeof p->bias / sizeof *p->bias; i++)
		keep_bias(known, &r, &p->bias[i]);
	quote_store_mark(&known->store);
}

uint32_t quote_known_refused(const struct quote_known *known, const struct rendered *f)
{
	uint32_t refused = 0;
	for (unsigned t = 0; t < TECHNIQUE_COUNT; t++) {
		const struct quote_key key = quote_known_key(known, f, (candil_Technique)t);
		refused |= quote_refused(known->model, &key) ? 1u << t : 0;
	}
	return refused;
}

enum status quote_known_init(struct quote_known *known, struct jobs *jobs, const struct worker *worker, const char *state,
			     struct error *err)
{
	*known = (struct quote_known){.worker = worker, .model = calloc(1, sizeof *known->model)};
	if (!known->model)
		return error_set(err, STATUS_MEMORY, "no memory for what is known of times and errors");
	quote_store_open(&known->store, state, worker->loop, known->model);
	jobs->rendered = learn_frame;
	jobs->predict = predict_error;
	jobs->owner = known;
	return STATUS_OK;
}

void quote_known_finish(struct quote_known *known)
{
	if (!known->model)
		return;
	quote_store_close(&known->store);
	free(known->model);
	known->model = NULL;
}
