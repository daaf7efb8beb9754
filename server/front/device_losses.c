#include "server/front/device_losses.h"

#include <stdio.h>
#include <string.h>

#define WITHIN_US (LIMIT_DEVICE_LOSS_SECONDS * 1000000ull)

bool device_losses_add(struct device_losses *l, const struct ipc_ready *ready, uint64_t now_us)
{
	const unsigned last = LIMIT_DEVICE_LOSSES - 1;
	l->total++;
	memmove(&l->at_us[1], &l->at_us[0], last * sizeof *l->at_us);
	l->at_us[0] = now_us;
	if (!l->at_us[last] || now_us - l->at_us[last] > WITHIN_US)
		return false;
	memset(l->at_us, 0, sizeof l->at_us);
	memcpy(l->name, ready->device, sizeof l->name);
	l->told_us = now_us;
	l->stays = ready->others == 0 || l->avoided_count == DEVICES_AVOIDED;
	if (!l->stays)
		memcpy(l->avoided[l->avoided_count++], ready->key, sizeof *l->avoided);
	return true;
}

void device_losses_note(const struct device_losses *l, const char *device, uint64_t now_us, char note[LIMIT_TEXT + 1])
{
	note[0] = 0;
	if (l->stays && now_us - l->told_us <= WITHIN_US)
		snprintf(note, LIMIT_TEXT + 1,
			 "%.80s was lost %u times within %u minutes, and no other device is there that may be used", l->name,
			 LIMIT_DEVICE_LOSSES, LIMIT_DEVICE_LOSS_SECONDS / 60);
	else if (l->name[0] && !l->stays)
		snprintf(note, LIMIT_TEXT + 1,
			 "%.80s was lost %u times within %u minutes: %.80s is used until candild starts anew", l->name,
			 LIMIT_DEVICE_LOSSES, LIMIT_DEVICE_LOSS_SECONDS / 60, device);
}
