// Losses of the device that the worker has: which devices are passed over, and what is told about it.
//
// LIMIT_DEVICE_LOSSES of them within LIMIT_DEVICE_LOSS_SECONDS, and the worker takes the next device of those that the
// options allow, until the daemon ends. Without another one it stays, and that is told.
//
// For the front's one thread. Times are of clock_us().
#ifndef CANDIL_FRONT_DEVICE_LOSSES_H
#define CANDIL_FRONT_DEVICE_LOSSES_H

#include <stdbool.h>
#include <stdint.h>

#include "server/base/ipc.h"

#define DEVICES_AVOIDED 15u // at most: the worker lists one more

struct device_losses {
	uint64_t at_us[LIMIT_DEVICE_LOSSES]; // of the device in use, the latest first; 0: none
	char avoided[DEVICES_AVOIDED][sizeof((struct ipc_ready *)0)->key];
	unsigned avoided_count;
	uint32_t total; // since the start, of all devices
	char name[sizeof((struct ipc_ready *)0)->device]; // of the device that had too many last; "": none had
	uint64_t told_us; // when it had them
	bool stays; // there was no other
};

// A device was lost: the one that `ready` tells of, the worker's. True: it has been lost so often that the next one is
// taken, if there is another.
bool device_losses_add(struct device_losses *losses, const struct ipc_ready *ready, uint64_t now_us);

// What replies are to tell, in a sentence; "": nothing. `device`: the worker's now.
void device_losses_note(const struct device_losses *losses, const char *device, uint64_t now_us, char note[LIMIT_TEXT + 1]);

#endif
