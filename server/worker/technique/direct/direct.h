// The technique `direct`: what the camera sees, lit by direct light alone, by a deferred renderer on OpenGL. It is the
// baseline for techniques with bounces.
#ifndef CANDIL_WORKER_DIRECT_H
#define CANDIL_WORKER_DIRECT_H

#include "server/worker/technique/technique.h"

// Its table.
extern const struct technique technique_direct;

// struct technique's `advise` for techniques whose settings begin with struct direct_settings: the side of shadow maps with
// which a job of this plan would take at most `budget` bytes. Leaves `advice` as it is if no side is small enough. `bytes`:
// the technique's. `maps`: whether the job has shadow maps at all.
void direct_advise_map(uint64_t (*bytes)(const struct devices *devices, struct resident_scene *scene,
					 const struct plan *plan),
		       bool maps, const struct devices *devices, struct resident_scene *scene, const struct plan *plan,
		       uint64_t budget, char *advice);

#endif
