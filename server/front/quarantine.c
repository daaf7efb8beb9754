#include "server/front/quarantine.h"

#include <stdio.h>
#include <string.h>

static const char *const names[PARTS] = {
    [PART_SCENE] = "the scene", [PART_ENVIRONMENT] = "the picture around the scene", [PART_IMPORTED] = "the imported file"};

static unsigned find(const struct quarantine *q, const struct subject_hashes *s)
{
	unsigned i = 0;
	while (i < QUARANTINE_CASES && (q->cases[i].losses == 0 || memcmp(&q->cases[i].of, s, sizeof *s) != 0))
		i++;
	return i;
}

// The part that a hash has in a case; PARTS: none. "" has none.
static unsigned part_of(const struct quarantine_case *c, const char *hash)
{
	unsigned k = hash[0] && c->losses > 0 ? 0 : PARTS;
	while (k < PARTS && strcmp(c->of.part[k], hash) != 0)
		k++;
	return k;
}

static bool is_guilty(const struct quarantine *q, const char *hash)
{
	for (unsigned i = 0; i < QUARANTINE_CASES; i++) {
		const unsigned k = part_of(&q->cases[i], hash);
		if (k < PARTS && q->cases[i].guilty[k])
			return true;
	}
	return false;
}

// What was beside a part in a case. *alone: nothing. False: something guilty by itself was.
static bool take_others(const struct quarantine *q, const struct quarantine_case *c, unsigned part,
			struct subject_hashes *others, bool *alone)
{
	*others = c->of;
	*alone = true;
	memset(others->part[part], 0, sizeof others->part[part]);
	for (unsigned k = 0; k < PARTS; k++) {
		*alone = *alone && !others->part[k][0];
		if (is_guilty(q, others->part[k]))
			return false;
	}
	return true;
}

// The losses that may be its fault: not those beside what is guilty by itself. *own: not all were beside the same others.
static unsigned count_losses(const struct quarantine *q, const char *hash, bool *own)
{
	struct subject_hashes others, last = {0};
	unsigned losses = 0;
	*own = false;
	for (unsigned i = 0; i < QUARANTINE_CASES; i++) {
		const struct quarantine_case *c = &q->cases[i];
		const unsigned part = part_of(c, hash);
		bool alone;
		if (part == PARTS || !take_others(q, c, part, &others, &alone))
			continue;
		*own |= alone || (losses > 0 && memcmp(&last, &others, sizeof last) != 0);
		last = others;
		losses += c->losses;
	}
	return losses;
}

static bool judge(struct quarantine *q, const char *hash)
{
	bool own;
	const bool guilty = hash[0] && count_losses(q, hash, &own) >= LIMIT_SCENE_LOSSES && own;
	for (unsigned i = 0; i < QUARANTINE_CASES; i++) {
		const unsigned k = part_of(&q->cases[i], hash);
		if (k < PARTS)
			q->cases[i].guilty[k] = guilty;
	}
	return guilty;
}

// Where it is guilty, what was beside it may not be, after all.
static void judge_with_others(struct quarantine *q, const char *hash)
{
	if (!judge(q, hash))
		return;
	for (unsigned i = 0; i < QUARANTINE_CASES; i++) {
		const unsigned part = part_of(&q->cases[i], hash);
		for (unsigned k = 0; part < PARTS && k < PARTS; k++)
			if (k != part)
				judge(q, q->cases[i].of.part[k]);
	}
}

bool quarantine_knows(const struct quarantine *q, const char *scene)
{
	for (unsigned i = 0; i < QUARANTINE_CASES; i++)
		if (part_of(&q->cases[i], scene) < PARTS)
			return true;
	return false;
}

// Hashes that can be compared byte by byte, each of them once. False: there is none.
static bool tidy(const struct subject_hashes *suspects, struct subject_hashes *s)
{
	bool some = false;
	memset(s, 0, sizeof *s);
	for (unsigned k = 0; k < PARTS; k++) {
		bool known = false;
		for (unsigned i = 0; i < k; i++)
			known = known || !strcmp(s->part[i], suspects->part[k]);
		if (!known)
			snprintf(s->part[k], sizeof s->part[k], "%s", suspects->part[k]);
		some = some || s->part[k][0];
	}
	return some;
}

void quarantine_blame(struct quarantine *q, const struct subject_hashes *suspects)
{
	struct subject_hashes s;
	if (!tidy(suspects, &s))
		return;
	unsigned i = find(q, &s);
	if (i == QUARANTINE_CASES) {
		struct quarantine_case c = {.of = s};
		for (unsigned k = 0; k < PARTS; k++)
			c.guilty[k] = is_guilty(q, s.part[k]);
		i = q->count++ % QUARANTINE_CASES;
		q->cases[i] = c;
	}
	q->cases[i].losses++;
	for (unsigned k = 0; k < PARTS; k++)
		judge_with_others(q, s.part[k]);
}

static enum status refuse(const char *what, unsigned losses, const char *whom, struct error *err)
{
	return error_set(err, STATUS_SCENE_QUARANTINED,
			 "%s quarantined, for %u workers crashed or hung over %s: leave out what of it is unusual and load "
			 "it anew, or restart candild after an update of the driver",
			 what, losses, whom);
}

enum status quarantine_check(const struct quarantine *q, const struct subject_hashes *suspects, struct error *err)
{
	struct subject_hashes s;
	char what[128];
	bool own;
	if (!tidy(suspects, &s))
		return STATUS_OK;
	for (unsigned k = 0; k < PARTS; k++)
		if (is_guilty(q, s.part[k])) {
			snprintf(what, sizeof what, "%s is", names[k]);
			return refuse(what, count_losses(q, s.part[k], &own), "it", err);
		}
	const unsigned i = find(q, &s);
	if (i < QUARANTINE_CASES && q->cases[i].losses >= LIMIT_SCENE_LOSSES)
		return refuse("the scene and what goes with it are, together,", q->cases[i].losses, "them", err);
	return STATUS_OK;
}
