// What ended workers, by content: the hashes of blobs, a scene's and those of what goes with it. What
// ended LIMIT_SCENE_LOSSES of them is quarantined until the daemon ends: neither its name nor a new load of the same content
// may have another worker.
//
// All parts of a subject are under suspicion, for none can tell which of them it was. Where all losses of one were beside
// the same others, only they together are quarantined; a loss beside something else, or alone, tells that it is this one's
// fault. Then it is quarantined by itself, and those losses count for nothing against what was beside it.
//
// For the front's one thread. A blob's hash is as its loader told, so it may be any text.
#ifndef CANDIL_FRONT_QUARANTINE_H
#define CANDIL_FRONT_QUARANTINE_H

#include <stdbool.h>

#include "candil.pb.h"
#include "server/base/error.h"
#include "server/front/subject.h"

#define QUARANTINE_CASES 64u // that are remembered, the latest

// Zeroed: none.
struct quarantine {
	struct quarantine_case {
		struct subject_hashes of;
		bool guilty[PARTS]; // by itself: the same wherever the hash is
		unsigned losses; // 0: there is no such case
	} cases[QUARANTINE_CASES];
	unsigned count; // ever
};

// Has a scene of this hash ended a worker, whatever was around it?
bool quarantine_knows(const struct quarantine *quarantine, const char *scene);

// They ended one more. What has no hash is not remembered.
void quarantine_blame(struct quarantine *quarantine, const struct subject_hashes *suspects);

// STATUS_SCENE_QUARANTINED, with what to do, if one of them is quarantined, or all together are.
enum status quarantine_check(const struct quarantine *quarantine, const struct subject_hashes *suspects, struct error *err);

#endif
