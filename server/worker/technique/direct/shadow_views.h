// Which lights have shadow maps, and what each map sees. Host only; no device is asked.
//
// Directional: parallel, a box about the scene. Spot: perspective, as wide as its cone. Point, and a spot wider than
// SHADOW_WIDEST: the six faces of a cube about it; but from outside of the scene one map of what is seen of it, where that
// is no wider. Each reaches two texels further than it must, for the filter.
#ifndef CANDIL_WORKER_TECHNIQUE_SHADOW_VIEWS_H
#define CANDIL_WORKER_TECHNIQUE_SHADOW_VIEWS_H

#include "server/scene/blob.h"
#include "shaders/shared/shadow.h"

#define SHADOW_WIDEST 1.8 // tangent of the half angle of one perspective map, 61°
#define SHADOW_NEAREST 1e-6 // of the scene's diagonal: nothing nearer to a light than so throws a shadow

struct shadow_views {
	struct shadow_map maps[SHADOW_MAPS_MAX];
	uint32_t count;
	uint32_t *first; // for each light of the scene: as at BIND_SHADOW_LIGHTS
};

// Maps of `side` texels for the SHADOW_LIGHTS_MAX strongest lights. STATUS_MEMORY.
enum status shadow_views_init(struct shadow_views *views, const struct blob_view *scene, uint32_t side, struct error *err);
void shadow_views_finish(struct shadow_views *views); // a zeroed one is fine

// How many maps that makes.
uint32_t shadow_views_count(const struct blob_view *scene);

#endif
