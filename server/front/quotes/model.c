#include "server/front/quotes/model.h"

#include <math.h>
#include <string.h>

_Static_assert(QUOTE_SOLVE - QUOTE_CUT == (int)WORK_PARTS - 1, "each part of a work is one of a record");

#define NORMAL_90 1.645
#define STRETCH_RATE 0.2
#define STRETCH_LEAST 0.5
#define STRETCH_MOST 4.0
#define AGE_LEAST 1e-3 // weight below which a record does not count any more
#define OCTAVE 0.04 // deviation that each octave of pixels or samples between a record and a request adds
#define EDGES_MOST 0.9 // of an error, that are taken to lie at edges
#define COARSE 0.15 // the same of a pilot's error, with each octave of pixels
#define EDGES \
	0.4 // the same of an error without noise, with each octave of samples: by as much as it is one of edges it falls
#define BELIEF 4.0 // frames that what is assumed of a group counts as
#define DRIFT_BELIEF 8.0 // octaves squared, of the drift
#define MEMORY 64.0 // frames after which older ones count half
#define WIDTH_MOST 20.0 // of a logarithm
#define DRIFT_MOST 1.0 // of a logarithm, with one octave
#define CLUSTERS 256u // of records that are one scene or one view, the latest
#define CLUSTERS_HEARD 64u // of them on one part
#define CLUSTER_SLOTS 1024u // a power of two
#define CLUSTER_AGE 0.9 // weight of a cluster's record over that of its next newer one

// What is assumed until frames tell: of a part, a guess for a processor and for a GPU, its deviation, the deviations of the
// groups, the drift with each octave of pixels and of samples. Nothing is derived: the numbers were set by hand to what
// tests/bench/bench_quote.py showed of its scenes on two cores of a processor, and those for a GPU are guesses.
static const struct assumed {
	double processor, gpu, deviation;
	double group[QUOTE_GROUPS];
	double drift_pixels, drift_samples;
} assumed[QUOTE_PARTS] = {
    [QUOTE_FIXED] = {1e3, 1e3, 0.7, {0.15, 0.3, 0.3, 0.4}, 0.1, 0.05},
    [QUOTE_PIXEL] = {0.15, 0.02, 1.0, {0.1, 0.3, 0.2, 0.3}, 0, 0.1},
    [QUOTE_SAMPLE] = {3, 0.01, 1.5, {0.05, 0.12, 0.3, 0.7}, 0, 0},
    [QUOTE_ENCODE] = {0.02, 0.02, 0.7, {0.08, 0.3, 0.15, 0.3}, -0.05, 0},
    [QUOTE_SETUP] = {2e4, 1e4, 1.5, {0.3, 0.3, 0.5, 1.2}, 0, 0},
    [QUOTE_CUT] = {4, 2, 1.2, {0.3, 0.3, 0.4, 0.6}, 0, 0},
    [QUOTE_LIGHT] = {0.5, 0.01, 1.2, {0.15, 0.2, 0.3, 0.6}, 0, 0},
    [QUOTE_ROWS] = {0.5, 0.01, 1.2, {0.12, 0.15, 0.25, 0.6}, 0, 0},
    [QUOTE_SOLVE] = {0.05, 0.005, 1.2, {0.2, 0.3, 0.35, 0.6}, 0, 0},
    [QUOTE_COLD] = {2e6, 5e5, 1.0, {0.3, 0.3, 0.4, 0.5}, 0, 0},
    [QUOTE_ERROR] = {0.3, 0.3, 1.3, {0.05, 0.25, 0.5, 1.1}, -0.02, -0.05},
};

// Weight of a record, or of a cluster of them, over that of the next newer one of its group: of other scenes, many are to be
// heard.
static const double ages[QUOTE_GROUPS] = {0.8, 0.8, 0.9, 0.98};

static double least_of(enum quote_part part)
{
	return part == QUOTE_ERROR                          ? 1e-12
	       : part == QUOTE_COLD                         ? 1e3
	       : part == QUOTE_FIXED || part == QUOTE_SETUP ? 10
							    : 1e-6;
}

void quote_set_part(struct quote_record *record, enum quote_part part, double value)
{
	record->known &= ~(1u << part);
	if (!isfinite(value) || value < 0)
		return;
	record->known |= 1u << part;
	record->part[part] = (float)log(fmax(value, least_of(part)));
}

static bool has_noise(uint32_t technique)
{
	return technique_traits(technique) & TECHNIQUE_NOISE;
}

static bool knows(const struct quote_record *r, enum quote_part part)
{
	return r->known >> part & 1u;
}

static const struct quote_record *newest(const struct quote_model *m, uint32_t back)
{
	return &m->records[(m->oldest + m->count - 1 - back) % LIMIT_QUOTE_RECORDS];
}

static const struct quote_habits *find_habits(const struct quote_model *m, uint64_t where)
{
	for (unsigned i = 0; i < LIMIT_QUOTE_DEVICES; i++)
		if (where != 0 && m->habits[i].where == where)
			return &m->habits[i];
	return NULL;
}

// When the device's newest record came; 0: it has none.
static uint64_t last_seen(const struct quote_model *m, uint64_t where)
{
	for (uint32_t i = 0; i < m->count; i++)
		if (newest(m, i)->key.where == where)
			return newest(m, i)->stamp;
	return 0;
}

struct quote_habits *quote_make_habits(struct quote_model *m, uint64_t where)
{
	struct quote_habits *h = m->habits;
	for (unsigned i = 0; i < LIMIT_QUOTE_DEVICES; i++)
		if (m->habits[i].where == where)
			return &m->habits[i];
	for (unsigned i = 1; i < LIMIT_QUOTE_DEVICES && h->where != 0; i++)
		if (m->habits[i].where == 0 || last_seen(m, m->habits[i].where) < last_seen(m, h->where))
			h = &m->habits[i];
	*h = (struct quote_habits){.where = where};
	return h;
}

// ---- prediction ------------------------------------------------------------------------------------------------------

// What a part changes by with each octave: least squares, held to what is assumed (ridge regression).
static void drift_of(const struct quote_habit *h, enum quote_part part, double *pixels, double *samples)
{
	const struct assumed *a = &assumed[part];
	const double pp = h ? h->pp + DRIFT_BELIEF : 1, ss = h ? h->ss + DRIFT_BELIEF : 1, ps = h ? h->ps : 0;
	const double p = h ? h->p + DRIFT_BELIEF * a->drift_pixels : a->drift_pixels;
	const double s = h ? h->s + DRIFT_BELIEF * a->drift_samples : a->drift_samples;
	const double determinant = pp * ss - ps * ps; // above 0, by the beliefs
	*pixels = fmax(fmin((p * ss - s * ps) / determinant, DRIFT_MOST), -DRIFT_MOST);
	*samples = fmax(fmin((s * pp - p * ps) / determinant, DRIFT_MOST), -DRIFT_MOST);
}

// What frames have lain beside a group's word in the mean, and the variance about that.
static void group_of(const struct quote_habit *h, enum quote_part part, enum quote_group g, double *shift, double *variance)
{
	const double believed = assumed[part].group[g] * assumed[part].group[g];
	*shift = 0;
	*variance = believed;
	if (!h)
		return;
	// Of frames and of what lies further away the mean is no bias that would go on, but of pilots it is.
	if (g == QUOTE_PILOTS)
		*shift = h->sum[g] / (h->count[g] + 2);
	const double squares = h->squares[g] - 2 * *shift * h->sum[g] + h->count[g] * *shift * *shift;
	*variance = (BELIEF * believed + fmax(squares, 0)) / (BELIEF + h->count[g]);
}

static bool same_view(const struct quote_key *a, const struct quote_key *b)
{
	return a->scene == b->scene && a->look == b->look && a->view == b->view;
}

static bool same_light(const struct quote_key *a, const struct quote_key *b)
{
	return a->scene == b->scene && a->look == b->look && a->light == b->light;
}

// Is it made once for a scene, whatever the view?
static bool is_work(enum quote_part part)
{
	return part >= QUOTE_CUT && part <= QUOTE_SOLVE;
}

static bool has_work(uint32_t technique)
{
	return technique_traits(technique) & TECHNIQUE_PATCHES;
}

// Does a record that knows a part tell anything of it? Rows that are made another way cost something else altogether.
static bool tells(const struct quote_record *r, const struct quote_key *key, enum quote_part part)
{
	if (!knows(r, part))
		return false;
	if (part == QUOTE_ROWS)
		return r->key.rows == key->rows;
	return part != QUOTE_ERROR || !has_work(r->technique) || same_light(&r->key, key);
}

// Pictures that are made another way are as far as those of another scene.
static enum quote_group group_in(const struct quote_record *r, const struct quote_key *key, enum quote_part part)
{
	if ((part == QUOTE_PIXEL || part == QUOTE_SAMPLE) && r->key.picture != key->picture)
		return QUOTE_OTHERS;
	if (is_work(part) ? same_light(&r->key, key) : same_view(&r->key, key))
		return r->pilot ? QUOTE_PILOTS : QUOTE_FRAMES;
	return r->key.scene == key->scene ? QUOTE_SCENE : QUOTE_OTHERS;
}

// Weighted sums over records.
struct sums {
	double weight, mean, spread;
	double own; // of the inverse of the weight, the part that a record has measured
};

static void add_to(struct sums *sums, double weight, double mean, double spread)
{
	sums->weight += weight;
	sums->mean += weight * mean;
	sums->spread += weight * spread;
}

// What the groups say of one part of a request.
struct said {
	double weight[QUOTE_GROUPS]; // 0: nothing
	double mean[QUOTE_GROUPS];
	double spread[QUOTE_GROUPS]; // of one frame's error of that size about its mean
	double own[QUOTE_GROUPS]; // the part of the mean's variance that records have measured
};

// Records of one scene, or of one view of the request's scene, which speak once: sixty frames of one are no sixty scenes.
struct cluster {
	uint64_t id;
	enum quote_group group;
	double age[QUOTE_PARTS];
	struct sums sums[QUOTE_PARTS];
};

struct clusters {
	struct cluster at[CLUSTERS];
	unsigned count;
	uint16_t slot[CLUSTER_SLOTS]; // of `at`, from 1; open addressing
	uint16_t order[QUOTE_PARTS][CLUSTERS_HEARD]; // of `at`: those that know a part, by their newest record that does
	unsigned heard[QUOTE_PARTS];
};

// NULL: of the newest there are enough.
static struct cluster *cluster_of(struct clusters *c, const struct quote_record *r, enum quote_group group)
{
	const uint64_t id = group == QUOTE_OTHERS ? r->key.scene : r->key.look ^ r->key.view * 0x9e3779b97f4a7c15u;
	uint32_t slot = (uint32_t)(id >> 32 ^ id) % CLUSTER_SLOTS;
	for (; c->slot[slot] > 0; slot = (slot + 1) % CLUSTER_SLOTS) {
		struct cluster *known = &c->at[c->slot[slot] - 1];
		if (known->id == id && known->group == group)
			return known;
	}
	if (c->count == CLUSTERS)
		return NULL;
	c->at[c->count] = (struct cluster){.id = id, .group = group};
	c->slot[slot] = (uint16_t)(c->count + 1);
	return &c->at[c->count++];
}

// Whether a cluster is heard on a part: with its first record that knows it, it is, unless of the newest there are enough.
static bool joins(struct clusters *c, struct cluster *cluster, enum quote_part part)
{
	if (cluster->age[part] > 0)
		return true;
	if (c->heard[part] == CLUSTERS_HEARD)
		return false;
	cluster->age[part] = 1;
	c->order[part][c->heard[part]++] = (uint16_t)(cluster - c->at);
	return true;
}

// What is asked of the records: some parts of a request.
struct hearing {
	const struct quote_query *query;
	unsigned parts; // bits 1 << enum quote_part
	double black; // an error below it is one of a black picture
	double drift[QUOTE_PARTS][2];
	double age[QUOTE_PARTS][QUOTE_GROUPS];
	struct sums sums[QUOTE_PARTS][QUOTE_GROUPS];
	struct clusters clusters;
};

// A record's word on each part that it knows, carried to the request, goes to its group, or to its cluster.
static void hear(struct hearing *h, const struct quote_record *r)
{
	const struct quote_query *q = h->query;
	const double pixels = log2(q->pixels / r->pixels), samples = log2(q->samples / r->samples);
	for (int p = 0; p < QUOTE_PARTS; p++) {
		const enum quote_part part = (enum quote_part)p;
		if (!(h->parts >> p & 1u) || !tells(r, &q->key, part))
			continue;
		const enum quote_group g = group_in(r, &q->key, part);
		struct cluster *cluster = g >= QUOTE_SCENE ? cluster_of(&h->clusters, r, g) : NULL;
		if (g >= QUOTE_SCENE && !cluster)
			continue;
		const bool error = part == QUOTE_ERROR;
		// A view that is black tells nothing of one that is not.
		if (cluster && error && (double)r->part[part] < h->black)
			continue;
		if (cluster && !joins(&h->clusters, cluster, part))
			continue;
		double *age = cluster ? &cluster->age[part] : &h->age[part][g];
		if (*age < AGE_LEAST)
			continue;
		const double own = error ? (double)r->spread : OCTAVE;
		// The larger a pixel, the more may be in it that one path in many sees.
		const double coarse = error && r->pilot ? COARSE : OCTAVE;
		const double edges = error && !has_noise(r->technique) ? EDGES : OCTAVE;
		const double variance =
		    own * own + coarse * coarse * pixels * pixels + edges * edges * samples * samples + 1e-6;
		struct sums *sums = cluster ? &cluster->sums[part] : &h->sums[part][g];
		sums->own += *age / variance * (error ? own * own / variance : 0);
		const double share = error ? (double)r->edges : 0;
		// Of those a larger picture has fewer, and their jitter falls as 1 / N.
		const double left = sqrt(r->pixels / q->pixels) * r->samples / q->samples;
		const double fewer = log(1 + fmin(share, EDGES_MOST) * (left - 1));
		add_to(sums, *age / variance,
		       (double)r->part[part] + h->drift[part][0] * pixels + h->drift[part][1] * samples + fewer,
		       error ? (double)r->spread * sqrt(r->pixels / q->pixels) : 0);
		*age *= cluster ? CLUSTER_AGE : ages[g];
	}
}

static void conclude(struct hearing *h, enum quote_part part, struct said *said)
{
	struct sums *sums = h->sums[part];
	*said = (struct said){0};
	// In the order of their newest records.
	for (unsigned i = 0; i < h->clusters.heard[part]; i++) {
		const struct cluster *c = &h->clusters.at[h->clusters.order[part][i]];
		const struct sums *of = &c->sums[part];
		const double apart = assumed[part].group[c->group], w = of->weight;
		double *age = &h->age[part][c->group];
		add_to(&sums[c->group], *age / (1 / w + apart * apart), of->mean / w, of->spread / w);
		said->weight[c->group] += *age * w; // how far clusters are apart is in the group's variance
		*age *= ages[c->group];
	}
	for (int g = 0; g < QUOTE_GROUPS; g++) {
		said->weight[g] = g >= QUOTE_SCENE ? said->weight[g] : sums[g].weight;
		said->mean[g] = sums[g].weight > 0 ? sums[g].mean / sums[g].weight : 0;
		said->spread[g] = sums[g].weight > 0 ? sums[g].spread / sums[g].weight : 0;
		// How far other scenes and views are apart is far more than what each has measured.
		said->own[g] = g < QUOTE_SCENE && sums[g].weight > 0 ? sums[g].own / (sums[g].weight * sums[g].weight) : 0;
	}
}

// Ask the records of all `parts` at once: there may be thousands, and an answer has dozens of predictions.
static void ask(const struct quote_model *m, const struct quote_habits *habits, const struct quote_query *q, unsigned parts,
		struct said said[QUOTE_PARTS])
{
	struct hearing h = {.query = q, .parts = parts, .black = log(2 * least_of(QUOTE_ERROR))};
	for (int part = 0; part < QUOTE_PARTS; part++) {
		drift_of(habits ? &habits->habit[q->technique][part] : NULL, (enum quote_part)part, &h.drift[part][0],
			 &h.drift[part][1]);
		for (int g = 0; g < QUOTE_GROUPS; g++)
			h.age[part][g] = 1;
	}
	for (uint32_t i = 0; i < m->count; i++) {
		const struct quote_record *r = newest(m, i);
		if (r->key.where == q->key.where && r->technique == q->technique && (r->known & parts) != 0)
			hear(&h, r);
	}
	for (int part = 0; part < QUOTE_PARTS; part++)
		conclude(&h, (enum quote_part)part, &said[part]);
}

// The logarithm of a part, and its variance.
struct guess {
	double mean, variance;
	double own; // of the variance: what records have measured of themselves
	enum quote_group nearest; // that knows; QUOTE_GROUPS: none
	double spread; // of one frame's error
};

// Take in the word of a group that is further away. If it is far off what nearer ones say, this request is not like what it
// is about: it counts by that distance, not by how far its members mostly are.
static void take_in(struct guess *guess, double mean, double variance, double own)
{
	const double off = mean - guess->mean;
	if (guess->variance > 0)
		variance = fmax(variance, off * off - guess->variance);
	const double share = guess->variance > 0 ? guess->variance / (guess->variance + variance) : 1;
	guess->mean += share * off;
	guess->variance = share * variance;
	guess->own = (1 - share) * (1 - share) * guess->own + share * share * own;
}

static struct guess guess_part(const struct said *said, const struct quote_habits *habits, const struct quote_query *q,
			       enum quote_part part)
{
	const struct quote_habit *h = habits ? &habits->habit[q->technique][part] : NULL;
	const struct assumed *a = &assumed[part];
	struct guess out = {.nearest = QUOTE_GROUPS};
	struct sums spread = {0};
	for (int g = 0; g < QUOTE_GROUPS; g++) {
		double shift, variance;
		if (said->weight[g] <= 0)
			continue;
		group_of(h, part, (enum quote_group)g, &shift, &variance);
		// How far pilots lay beside frames, mostly of scenes that they saw well, says little of one that they did
		// not.
		shift *= a->group[g] * a->group[g] / (a->group[g] * a->group[g] + said->own[g]);
		variance += 1 / said->weight[g];
		take_in(&out, said->mean[g] + shift, variance, said->own[g]);
		add_to(&spread, 1 / variance, 0, said->spread[g]);
		out.nearest = out.nearest == QUOTE_GROUPS ? (enum quote_group)g : out.nearest;
	}
	take_in(&out, log(q->software ? a->processor : a->gpu), a->deviation * a->deviation, 0);
	out.spread = spread.weight > 0 ? spread.spread / spread.weight : 0;
	return out;
}

// How far the ends of an interval are from its middle, as a factor. What frames teach of scenes that are easy does not make
// one sure whose own record says that it is not: of `own` variance a stretch takes nothing away.
static double width_of(const struct quote_habits *h, uint32_t technique, int which, enum quote_group nearest,
		       double variance, double own)
{
	const double learned = h ? h->stretch[technique][which][nearest] : 0, stretch = learned > 0 ? learned : 1;
	const double all = stretch * stretch * variance + fmax(stretch * stretch, 1) * own;
	return exp(fmin(NORMAL_90 * sqrt(all), WIDTH_MOST));
}

struct quote_prediction quote_predict(const struct quote_model *m, const struct quote_query *q)
{
	const struct quote_habits *habits = find_habits(m, q->key.where);
	double times[QUOTE_COLD] = {[QUOTE_FIXED] = 1,
				    [QUOTE_PIXEL] = q->pixels,
				    [QUOTE_SAMPLE] = q->pixels * q->samples * (q->picture > 0 ? q->picture : 1),
				    [QUOTE_ENCODE] = q->bytes,
				    [QUOTE_SETUP] = q->setup ? 1 : 0};
	struct quote_prediction out = {.records = quote_count_scene(m, &q->key)};
	struct said said[QUOTE_PARTS];
	unsigned parts = 1u << QUOTE_ERROR | (q->cold ? 1u << QUOTE_COLD : 0);
	double variance = 0;
	for (int part = 0; part < WORK_PARTS; part++)
		times[QUOTE_CUT + part] = q->work[part];
	for (int part = 0; part < QUOTE_COLD; part++)
		parts |= times[part] > 0 ? 1u << part : 0;
	ask(m, habits, q, parts, said);
	for (int part = 0; part < QUOTE_COLD; part++) {
		if (times[part] <= 0)
			continue;
		const struct guess g = guess_part(&said[part], habits, q, (enum quote_part)part);
		const double us = exp(g.mean) * times[part];
		const double doubt = is_work((enum quote_part)part) ? q->doubt[part - QUOTE_CUT] : 0;
		out.us += us;
		out.work_us += is_work((enum quote_part)part) ? us : 0;
		variance += us * us * (g.variance + doubt * doubt);
		if (part == QUOTE_SAMPLE)
			out.nearest[0] = g.nearest;
	}
	const double time_width = width_of(habits, q->technique, 0, out.nearest[0], variance / (out.us * out.us), 0);
	out.us_low = out.us / time_width;
	out.us_high = out.us * time_width;
	if (q->cold)
		out.cold_us = exp(guess_part(&said[QUOTE_COLD], habits, q, QUOTE_COLD).mean);
	const struct guess e = guess_part(&said[QUOTE_ERROR], habits, q, QUOTE_ERROR);
	// One picture by noise is better or worse than the next, as far as its pixels are few.
	const double luck = has_noise(q->technique) ? fmin(e.spread, 1) : 0;
	out.nearest[1] = e.nearest;
	out.measured_high = -1;
	out.error = ESTIMATE_UNKNOWN;
	if (has_work(q->technique) && e.nearest == QUOTE_GROUPS)
		return out;
	const double width = width_of(habits, q->technique, 1, e.nearest, fmax(e.variance - e.own, 0), e.own + luck * luck);
	out.error.kind = candil_ErrorKind_ERROR_KIND_PREDICTED;
	out.error.relmse = exp(e.mean) / (has_noise(q->technique) ? q->samples : 1);
	out.error.low = out.error.relmse / width;
	out.error.high = out.error.relmse * width;
	out.measured_high = out.error.relmse * exp(NORMAL_90 * fmin(e.spread, 1));
	return out;
}

// ---- learning --------------------------------------------------------------------------------------------------------

static void learn_drift(const struct quote_model *m, struct quote_habit *h, const struct quote_record *r,
			enum quote_part part)
{
	unsigned pairs = 0;
	for (uint32_t i = 0; i < m->count && pairs < 4; i++) {
		const struct quote_record *old = newest(m, i);
		if (old->pilot || old->key.where != r->key.where || !same_view(&old->key, &r->key) || !knows(old, part))
			continue;
		const double pixels = log2((double)r->pixels / old->pixels),
			     samples = log2((double)r->samples / old->samples);
		if (fabs(pixels) < 0.5 && fabs(samples) < 0.5)
			continue;
		const double change = (double)r->part[part] - (double)old->part[part];
		h->pp += pixels * pixels;
		h->ps += pixels * samples;
		h->ss += samples * samples;
		h->p += pixels * change;
		h->s += samples * change;
		pairs++;
	}
	if (h->pp + h->ss <= 16 * MEMORY)
		return;
	h->pp /= 2;
	h->ps /= 2;
	h->ss /= 2;
	h->p /= 2;
	h->s /= 2;
}

// One that is far off, of a machine that was busy say, is not to spoil all that was learned.
static double beside_most(enum quote_part part, int group)
{
	return 3 * assumed[part].group[group] + 0.3;
}

// The nearest that a frame before this one, which knew the part, was to it: FRAMES of its view, SCENE, else OTHERS.
static enum quote_group nearest_frame(const struct quote_model *m, const struct quote_record *r, enum quote_part part)
{
	enum quote_group nearest = QUOTE_OTHERS;
	for (uint32_t i = 0; i < m->count && nearest != QUOTE_FRAMES; i++) {
		const struct quote_record *old = newest(m, i);
		if (old->pilot || old->key.where != r->key.where || old->technique != r->technique ||
		    !tells(old, &r->key, part))
			continue;
		const enum quote_group g = group_in(old, &r->key, part);
		nearest = g < nearest ? g : nearest;
	}
	return nearest;
}

static void learn_groups(const struct quote_model *m, const struct said *said, struct quote_habit *h,
			 const struct quote_record *r, enum quote_part part)
{
	const enum quote_group before = nearest_frame(m, r, part);
	for (int g = 0; g < QUOTE_GROUPS; g++) {
		// Of how far scenes are apart the first frame of one tells, and all others tell the same again; so of views.
		if (said->weight[g] <= 0 || (g == QUOTE_OTHERS && before != QUOTE_OTHERS) ||
		    (g != QUOTE_FRAMES && before == QUOTE_FRAMES))
			continue;
		const double most = beside_most(part, g);
		const double beside = fmax(fmin((double)r->part[part] - said->mean[g], most), -most);
		h->count[g] += 1;
		h->sum[g] += beside;
		h->squares[g] += beside * beside;
		if (h->count[g] < MEMORY)
			continue;
		h->count[g] /= 2;
		h->sum[g] /= 2;
		h->squares[g] /= 2;
	}
}

static void learn_stretch(double *stretch, double out, double low, double high)
{
	const bool outside = out < low || out > high;
	const double now = (*stretch > 0 ? *stretch : 1) * exp(STRETCH_RATE * ((outside ? 1 : 0) - 0.1));
	*stretch = fmin(fmax(now, STRETCH_LEAST), STRETCH_MOST);
}

void quote_learn(struct quote_model *m, const struct quote_record *r, const struct quote_query *q, double us)
{
	if (q) {
		const struct quote_prediction said = quote_predict(m, q);
		struct quote_habits *h = quote_make_habits(m, r->key.where);
		if (us > 0)
			learn_stretch(&h->stretch[r->technique][0][said.nearest[0]], us, said.us_low, said.us_high);
		if (knows(r, QUOTE_ERROR) && has_noise(r->technique))
			learn_stretch(&h->stretch[r->technique][1][said.nearest[1]],
				      exp((double)r->part[QUOTE_ERROR]) / r->samples, said.error.low, said.error.high);
		struct said told[QUOTE_PARTS];
		struct quote_habit *habit = h->habit[r->technique];
		for (int part = 0; part < QUOTE_PARTS; part++)
			if (knows(r, (enum quote_part)part))
				learn_drift(m, &habit[part], r, (enum quote_part)part);
		ask(m, h, q, r->known, told);
		for (int part = 0; part < QUOTE_PARTS; part++)
			if (knows(r, (enum quote_part)part))
				learn_groups(m, &told[part], &habit[part], r, (enum quote_part)part);
	}
	quote_keep(m, r);
}

void quote_keep(struct quote_model *m, const struct quote_record *record)
{
	if (m->count < LIMIT_QUOTE_RECORDS) {
		m->records[(m->oldest + m->count++) % LIMIT_QUOTE_RECORDS] = *record;
		return;
	}
	m->records[m->oldest] = *record;
	m->oldest = (m->oldest + 1) % LIMIT_QUOTE_RECORDS;
}

// ---- what there is ---------------------------------------------------------------------------------------------------

uint32_t quote_count_scene(const struct quote_model *m, const struct quote_key *key)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < m->count; i++)
		count += m->records[i].key.where == key->where && m->records[i].key.scene == key->scene &&
			 m->records[i].known != 0;
	return count;
}

uint32_t quote_count_look(const struct quote_model *m, const struct quote_key *key, enum quote_part part)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < m->count; i++) {
		const struct quote_key *k = &m->records[i].key;
		count +=
		    k->where == key->where && k->scene == key->scene && k->look == key->look && knows(&m->records[i], part);
	}
	return count;
}

uint32_t quote_count_light(const struct quote_model *m, const struct quote_key *key, enum quote_part part)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < m->count; i++)
		count += m->records[i].key.where == key->where && same_light(&m->records[i].key, key) &&
			 knows(&m->records[i], part);
	return count;
}

uint32_t quote_count_view(const struct quote_model *m, const struct quote_key *key, enum quote_part part)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < m->count; i++)
		count += m->records[i].key.where == key->where && same_view(&m->records[i].key, key) &&
			 (m->records[i].pilot || knows(&m->records[i], part));
	return count;
}

bool quote_refused(const struct quote_model *m, const struct quote_key *key)
{
	for (uint32_t i = 0; i < m->count; i++) {
		const struct quote_record *r = newest(m, i);
		if (r->key.where == key->where && r->key.scene == key->scene && r->key.look == key->look)
			return r->pilot && r->known == 0;
	}
	return false;
}

bool quote_record_holds(const struct quote_record *r)
{
	if (!(technique_traits(r->technique) & TECHNIQUE_RENDERS) || r->technique >= TECHNIQUE_COUNT || r->pilot > 1 ||
	    !(r->edges >= 0 && r->edges <= 1) || r->pixels == 0 || r->pixels > LIMIT_PIXELS || r->samples == 0 ||
	    r->samples > LIMIT_SAMPLES || r->known >> QUOTE_PARTS || !(r->spread >= 0 && r->spread <= 100))
		return false;
	for (int part = 0; part < QUOTE_PARTS; part++)
		if (!(fabs((double)r->part[part]) <= 100))
			return false;
	return true;
}

static bool is_sum(double x, double least)
{
	return x >= least && x <= 1e6;
}

// Sums of numbers none of which is beyond `most`: by Cauchy and Schwarz the squares are no less than the mean's.
static bool are_sums(double count, double sum, double squares, double most)
{
	return is_sum(count, 0) && fabs(sum) <= most * count * (1 + 1e-9) && is_sum(squares, 0) &&
	       squares <= most * most * count * (1 + 1e-9) && sum * sum <= squares * count * (1 + 1e-9);
}

bool quote_habits_hold(const struct quote_habits *habits)
{
	for (int t = 0; t < TECHNIQUE_COUNT; t++)
		for (int part = 0; part < QUOTE_PARTS; part++) {
			const struct quote_habit *h = &habits->habit[t][part];
			// Normal equations have a determinant that is not below 0.
			bool good = is_sum(h->pp, 0) && is_sum(h->ss, 0) && h->ps * h->ps <= h->pp * h->ss * (1 + 1e-9) &&
				    is_sum(h->p, -1e6) && is_sum(h->s, -1e6);
			for (int g = 0; g < QUOTE_GROUPS; g++)
				good = good && are_sums(h->count[g], h->sum[g], h->squares[g],
							beside_most((enum quote_part)part, g));
			if (!good)
				return false;
		}
	for (int t = 0; t < TECHNIQUE_COUNT; t++)
		for (int i = 0; i < 2; i++)
			for (int g = 0; g <= QUOTE_GROUPS; g++)
				if (!(habits->stretch[t][i][g] >= 0 && habits->stretch[t][i][g] <= STRETCH_MOST))
					return false;
	return true;
}
