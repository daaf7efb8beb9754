// What ended workers, by content: the hashes of blobs, a scene's and that of the picture around it. What ended
// LIMIT_SCENE_LOSSES of them is quarantined until the daemon ends: neither its name nor a new load of the same content may
// have another worker.
//
// A scene and the picture around it are both under suspicion, for none can tell which of them it was. Where all losses of
// one were beside the same other, only the two together are quarantined; a loss beside something else, or alone, tells that
// it is this one's fault. Then it is quarantined by itself, and those losses count for nothing against what was beside it.
//
// For the front's one thread. A blob's hash is as its loader told, so it may be any text.
#ifndef CANDIL_FRONT_QUARANTINE_H
#define CANDIL_FRONT_QUARANTINE_H

#include <stdbool.h>

#include "candil.pb.h"
#include "server/base/error.h"

#define QUARANTINE_PAIRS 64u // that are remembered, the latest

// What a worker works on: hashes; "": there is none.
struct suspects {
	char scene[sizeof((candil_SceneInfo *)0)->hash], environment[sizeof((candil_SceneInfo *)0)->hash];
};

// Zeroed: none.
struct quarantine {
	struct {
		char hashes[2][sizeof((candil_SceneInfo *)0)->hash]; // of a scene and what was around it; "": nothing
		bool guilty[2]; // by itself: the same wherever the hash is
		unsigned losses; // 0: there is no such pair
	} pairs[QUARANTINE_PAIRS];
	unsigned count; // ever
};

// Has a scene of this hash ended a worker, whatever was around it?
bool quarantine_knows(const struct quarantine *quarantine, const char *scene);

// They ended one more. What has no hash is not remembered.
void quarantine_blame(struct quarantine *quarantine, const struct suspects *suspects);

// STATUS_SCENE_QUARANTINED, with what to do, if one of them is quarantined, or both together are.
enum status quarantine_check(const struct quarantine *quarantine, const struct suspects *suspects, struct error *err);

#endif
