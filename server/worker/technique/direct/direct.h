// What the camera sees and the light that comes straight from its sources: a deferred renderer's picture, on OpenGL. The
// baseline that everything with bounces is measured against.
#ifndef CANDIL_WORKER_DIRECT_H
#define CANDIL_WORKER_DIRECT_H

#include "server/worker/technique/technique.h"

extern const struct technique technique_direct;

// For techniques whose settings begin with struct direct_settings: the side of shadow maps with which a plan's job would
// take no more than `budget` bytes, as the end of a sentence (struct technique's advise); nothing is written where there is
// none. `bytes`: struct technique's. `maps`: whether the job has shadow maps at all.
void direct_advise_map(uint64_t (*bytes)(const struct devices *devices, const struct resident_scene *scene,
					 const struct plan *plan),
		       bool maps, const struct devices *devices, const struct resident_scene *scene, const struct plan *plan,
		       uint64_t budget, char *advice);

#endif
