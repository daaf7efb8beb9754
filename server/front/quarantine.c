#include "server/front/quarantine.h"

#include <stdio.h>
#include <string.h>

static unsigned find(const struct quarantine *q, const char *hash)
{
	unsigned i = hash[0] ? 0 : QUARANTINE_SCENES;
	while (i < QUARANTINE_SCENES && strcmp(q->scenes[i].hash, hash) != 0)
		i++;
	return i;
}

bool quarantine_knows(const struct quarantine *q, const struct suspects *s)
{
	return find(q, s->scene) < QUARANTINE_SCENES || find(q, s->environment) < QUARANTINE_SCENES;
}

static void blame(struct quarantine *q, const char *hash, const char *beside)
{
	unsigned i = find(q, hash);
	if (!hash[0])
		return;
	if (i == QUARANTINE_SCENES) {
		i = q->count++ % QUARANTINE_SCENES;
		q->scenes[i].losses = 0;
		q->scenes[i].beside_others = false;
		snprintf(q->scenes[i].hash, sizeof q->scenes[i].hash, "%s", hash);
		snprintf(q->scenes[i].beside, sizeof q->scenes[i].beside, "%s", beside);
	}
	q->scenes[i].losses++;
	q->scenes[i].beside_others |= strcmp(q->scenes[i].beside, beside) != 0;
}

void quarantine_blame(struct quarantine *q, const struct suspects *s)
{
	blame(q, s->scene, s->environment);
	blame(q, s->environment, s->scene);
}

static enum status check(const struct quarantine *q, const char *hash, const char *beside, const char *what,
			 struct error *err)
{
	const unsigned i = find(q, hash);
	if (i == QUARANTINE_SCENES || q->scenes[i].losses < LIMIT_SCENE_LOSSES)
		return STATUS_OK;
	const bool own = q->scenes[i].beside_others || !q->scenes[i].beside[0];
	if (!own && strcmp(q->scenes[i].beside, beside) != 0)
		return STATUS_OK;
	return error_set(err, STATUS_SCENE_QUARANTINED,
			 "%s quarantined, for %u workers crashed or hung over %s: leave out what of it is unusual and load "
			 "it anew, or restart candild after an update of the driver",
			 own ? what : "the scene and the picture around it are, together,", q->scenes[i].losses,
			 own ? "it" : "them");
}

enum status quarantine_check(const struct quarantine *q, const struct suspects *s, struct error *err)
{
	const enum status status = check(q, s->scene, s->environment, "the scene is", err);
	return status == STATUS_OK ? check(q, s->environment, s->scene, "the picture around the scene is", err) : status;
}
