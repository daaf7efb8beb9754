// The runs of a plan: their ids, and their order.
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/study.h"
#include "clients/libcandil/message.h"
#include "protocol/asked.h"

static void hash_word(void *user, const char *key, const char *text)
{
	uint64_t *hash = user;
	*hash = study_hash(study_hash(*hash, key), text);
}

void study_make_run(struct study *study, enum study_kind kind, uint32_t view, uint32_t point, uint64_t seed,
		    struct study_run *run)
{
	static candil_Render message; // static because it is large
	struct candil_option options[STUDY_SETTINGS_MAX];
	struct candil_error error;
	char about[512];
	*run = (struct study_run){.kind = kind, .view = view, .point = point, .seed = seed};
	study_request(study, run, options);
	const struct candil_render_request *r = &study->job.options.request;
	snprintf(about, sizeof(about), "2 %s %s %s %s %" PRIu32 " %" PRIu32 " %d %.17g", study->server, study->vulkan,
		 study->job.target.info.hash, study->job.target.picture.hash, r->width, r->height, (int)kind,
		 r->target_error);
	uint64_t hash = study_hash(0xcbf29ce484222325u, about);
	memset(&message, 0, sizeof(message));
	// What cannot be asked for the daemon refuses as well, and the run fails.
	if (message_write_render(r, &message, &error) == CANDIL_STATUS_OK)
		asked_words(&message, hash_word, &hash);
	else
		for (size_t i = 0; i < r->option_count; i++)
			hash = study_hash(study_hash(hash, options[i].name), options[i].value);
	snprintf(run->id, sizeof(run->id), "%s-%s-%016" PRIx64, study_kind_name(kind),
		 technique_name((unsigned)r->technique), hash);
}

// SplitMix64 (Steele, Lea, Flood 2014): the order of the runs is the same wherever the study is made.
static uint64_t next_random(uint64_t *state)
{
	uint64_t z = *state += 0x9e3779b97f4a7c15u;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return z ^ z >> 31;
}

static void shuffle(uint32_t *order, uint32_t count, uint64_t *state)
{
	for (uint32_t i = count; i > 1; i--) {
		const uint32_t j = (uint32_t)(next_random(state) % i), kept = order[i - 1];
		order[i - 1] = order[j];
		order[j] = kept;
	}
}

static bool put_run(struct study *study, enum study_kind kind, uint32_t view, uint32_t point, uint64_t seed)
{
	if (study->run_count == STUDY_RUNS_MAX)
		return false;
	study_make_run(study, kind, view, point, seed, &study->runs[study->run_count]);
	study_find_run(study, &study->runs[study->run_count++]);
	return true;
}

// Put the runs of one point in one view that belong to a turn.
static bool put_turn(struct study *study, uint32_t view, uint32_t point, uint32_t turn)
{
	const struct study_point *p = &study->plan.points[point];
	const uint32_t seeds = study_seeds_of(&study->plan, p);
	if (study_has_noise(p->technique))
		return turn >= seeds || put_run(study, p->kind, view, point, turn + 1);
	if (turn > 0 || !study_is_first(&study->plan, point))
		return true;
	// What the scene keeps for a series is made by its first run and used by those right after, its counts of samples by
	// turns.
	bool good = put_run(study, STUDY_COLD, view, point, 0), more = true;
	for (uint32_t seed = 1; good && more; seed++) {
		more = false;
		for (uint32_t i = point; good && i < study->plan.point_count; i++) {
			const struct study_point *q = &study->plan.points[i];
			if (!study_is_series(p, q) || seed > study_seeds_of(&study->plan, q))
				continue;
			more = true;
			good = put_run(study, q->kind, view, i, seed);
		}
	}
	return good;
}

// Put the cold runs of points with noise: one for all numbers of samples, the first that is listed.
static bool put_cold(struct study *study, uint32_t point)
{
	return !study_has_noise(study->plan.points[point].technique) || !study_is_first(&study->plan, point) ||
	       put_run(study, STUDY_COLD, 0, point, 0);
}

bool study_list_runs(struct study *study)
{
	const struct study_plan *plan = &study->plan;
	const uint32_t cells = plan->view_count * plan->point_count;
	uint64_t state = STUDY_REFERENCE_SEED;
	uint32_t turns = 0;
	free(study->runs);
	study->run_count = 0;
	study->runs = calloc(STUDY_RUNS_MAX, sizeof(*study->runs));
	uint32_t *order = calloc((size_t)cells + 1, sizeof(*order));
	bool good = study->runs && order;
	for (uint32_t i = 0; i < plan->point_count; i++)
		memset(plan->points[i].times, 0, sizeof(plan->points[i].times));
	for (uint32_t i = 0; good && i < plan->point_count; i++)
		good = put_cold(study, i);
	for (uint32_t v = 0; good && plan->reference && v < plan->view_count; v++)
		good = put_run(study, STUDY_REFERENCE, v, 0, plan->reference_seed);
	for (uint32_t i = 0; good && i < plan->point_count; i++) {
		const uint32_t seeds = study_seeds_of(plan, &plan->points[i]);
		turns = seeds > turns ? seeds : turns;
	}
	for (uint32_t turn = 0; good && turn < turns; turn++) {
		for (uint32_t i = 0; i < cells; i++)
			order[i] = i;
		shuffle(order, cells, &state);
		for (uint32_t i = 0; good && i < cells; i++)
			good = put_turn(study, order[i] / plan->point_count, order[i] % plan->point_count, turn);
	}
	free(order);
	return good;
}
