// Scenes that ended workers, by content: the hash of a scene's blob. One that ended LIMIT_SCENE_LOSSES of them is
// quarantined until the daemon ends: neither its name nor a new load of the same content may have another worker.
//
// For the front's one thread. A blob's hash is as its loader told, so it may be any text.
#ifndef CANDIL_FRONT_QUARANTINE_H
#define CANDIL_FRONT_QUARANTINE_H

#include <stdbool.h>

#include "candil.pb.h"
#include "server/base/error.h"

#define QUARANTINE_SCENES 64u // that are remembered, the latest

// Zeroed: none.
struct quarantine {
	struct {
		char hash[sizeof((candil_SceneInfo *)0)->hash];
		unsigned losses;
	} scenes[QUARANTINE_SCENES];
	unsigned count; // ever
};

// Workers that the scene ended.
unsigned quarantine_losses(const struct quarantine *quarantine, const char *hash);

// It ended one more. Returns how many that makes. A scene without a hash is not remembered.
unsigned quarantine_blame(struct quarantine *quarantine, const char *hash);

// STATUS_SCENE_QUARANTINED, with what to do, if the scene is quarantined.
enum status quarantine_check(const struct quarantine *quarantine, const char *hash, struct error *err);

#endif
