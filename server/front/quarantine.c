#include "server/front/quarantine.h"

#include <stdio.h>
#include <string.h>

static unsigned find(const struct quarantine *q, const struct suspects *s)
{
	unsigned i = 0;
	while (i < QUARANTINE_PAIRS && (q->pairs[i].losses == 0 || strcmp(q->pairs[i].hashes[0], s->scene) != 0 ||
					strcmp(q->pairs[i].hashes[1], s->environment) != 0))
		i++;
	return i;
}

static bool is_guilty(const struct quarantine *q, const char *hash)
{
	for (unsigned i = 0; i < QUARANTINE_PAIRS; i++)
		for (unsigned k = 0; k < 2; k++)
			if (q->pairs[i].guilty[k] && !strcmp(q->pairs[i].hashes[k], hash))
				return true;
	return false;
}

// The losses that may be its fault: not those beside what is guilty by itself. *own: not all were beside the same other.
static unsigned count_losses(const struct quarantine *q, const char *hash, bool *own)
{
	const char *last = NULL;
	unsigned losses = 0;
	*own = false;
	for (unsigned i = 0; i < QUARANTINE_PAIRS; i++)
		for (unsigned k = 0; k < 2; k++) {
			const char *other = q->pairs[i].hashes[1 - k];
			if (q->pairs[i].losses == 0 || strcmp(q->pairs[i].hashes[k], hash) != 0 || is_guilty(q, other))
				continue;
			*own |= !other[0] || (last && strcmp(last, other) != 0);
			last = other;
			losses += q->pairs[i].losses;
		}
	return losses;
}

static bool judge(struct quarantine *q, const char *hash)
{
	bool own;
	const bool guilty = hash[0] && count_losses(q, hash, &own) >= LIMIT_SCENE_LOSSES && own;
	for (unsigned i = 0; i < QUARANTINE_PAIRS; i++)
		for (unsigned k = 0; k < 2; k++)
			if (!strcmp(q->pairs[i].hashes[k], hash))
				q->pairs[i].guilty[k] = guilty;
	return guilty;
}

// Where it is guilty, what was beside it may not be, after all.
static void judge_with_others(struct quarantine *q, const char *hash)
{
	if (!judge(q, hash))
		return;
	for (unsigned i = 0; i < QUARANTINE_PAIRS; i++)
		for (unsigned k = 0; k < 2; k++)
			if (!strcmp(q->pairs[i].hashes[k], hash))
				judge(q, q->pairs[i].hashes[1 - k]);
}

bool quarantine_knows(const struct quarantine *q, const char *scene)
{
	for (unsigned i = 0; i < QUARANTINE_PAIRS; i++)
		for (unsigned k = 0; k < 2; k++)
			if (scene[0] && !strcmp(q->pairs[i].hashes[k], scene))
				return true;
	return false;
}

void quarantine_blame(struct quarantine *q, const struct suspects *suspects)
{
	struct suspects s = *suspects;
	if (!strcmp(s.scene, s.environment))
		s.environment[0] = 0;
	if (!s.scene[0] && !s.environment[0])
		return;
	unsigned i = find(q, &s);
	if (i == QUARANTINE_PAIRS) {
		i = q->count++ % QUARANTINE_PAIRS;
		q->pairs[i].losses = 0;
		q->pairs[i].guilty[0] = is_guilty(q, s.scene);
		q->pairs[i].guilty[1] = is_guilty(q, s.environment);
		snprintf(q->pairs[i].hashes[0], sizeof q->pairs[i].hashes[0], "%s", s.scene);
		snprintf(q->pairs[i].hashes[1], sizeof q->pairs[i].hashes[1], "%s", s.environment);
	}
	q->pairs[i].losses++;
	judge_with_others(q, s.scene);
	judge_with_others(q, s.environment);
}

static enum status refuse(const char *what, unsigned losses, const char *whom, struct error *err)
{
	return error_set(err, STATUS_SCENE_QUARANTINED,
			 "%s quarantined, for %u workers crashed or hung over %s: leave out what of it is unusual and load "
			 "it anew, or restart candild after an update of the driver",
			 what, losses, whom);
}

enum status quarantine_check(const struct quarantine *q, const struct suspects *s, struct error *err)
{
	bool own;
	const unsigned pair = find(q, s);
	if (is_guilty(q, s->scene))
		return refuse("the scene is", count_losses(q, s->scene, &own), "it", err);
	if (is_guilty(q, s->environment))
		return refuse("the picture around the scene is", count_losses(q, s->environment, &own), "it", err);
	if (pair < QUARANTINE_PAIRS && q->pairs[pair].losses >= LIMIT_SCENE_LOSSES)
		return refuse("the scene and the picture around it are, together,", q->pairs[pair].losses, "them", err);
	return STATUS_OK;
}
