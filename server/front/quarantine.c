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

unsigned quarantine_losses(const struct quarantine *q, const char *hash)
{
	const unsigned i = find(q, hash);
	return i < QUARANTINE_SCENES ? q->scenes[i].losses : 0;
}

unsigned quarantine_blame(struct quarantine *q, const char *hash)
{
	unsigned i = find(q, hash);
	if (!hash[0])
		return 0;
	if (i == QUARANTINE_SCENES) {
		i = q->count++ % QUARANTINE_SCENES;
		q->scenes[i].losses = 0;
		snprintf(q->scenes[i].hash, sizeof q->scenes[i].hash, "%s", hash);
	}
	return ++q->scenes[i].losses;
}

enum status quarantine_check(const struct quarantine *q, const char *hash, struct error *err)
{
	const unsigned losses = quarantine_losses(q, hash);
	if (losses < LIMIT_SCENE_LOSSES)
		return STATUS_OK;
	return error_set(
	    err, STATUS_SCENE_QUARANTINED,
	    "the scene is quarantined, for %u workers crashed or hung over it: leave out what of it is unusual and "
	    "load it anew, or restart candild after an update of the driver",
	    losses);
}
