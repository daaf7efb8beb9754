// Which lights have shadow maps, and what each map sees. Host only, any thread.
//
// A directional light has a parallel view of a box about the scene. A spot has a perspective view as wide as its cone. A
// point light, and a spot wider than SHADOW_WIDEST, has the six faces of a cube about it; from outside of the scene it has
// one view of the scene's bounds instead, if that is no wider. Each view reaches two texels further than it must, for the
// filter.
#ifndef CANDIL_WORKER_TECHNIQUE_SHADOW_VIEWS_H
#define CANDIL_WORKER_TECHNIQUE_SHADOW_VIEWS_H

#include "server/scene/blob.h"
#include "shaders/shared/shadow.h"

#define SHADOW_WIDEST 1.8 // tangent of the half angle of one perspective map, 61°
#define SHADOW_NEAREST 1e-6 // share of the scene's diagonal: what is nearer to a light than this throws no shadow

// The views of a scene's lights.
struct shadow_views {
	struct shadow_map maps[SHADOW_MAPS_MAX];
	uint32_t count; // of the maps
	uint32_t *first; // for each light of the scene, as at BIND_SHADOW_LIGHTS; owned
};

// Make the views of maps of `side` texels for the SHADOW_LIGHTS_MAX strongest lights. STATUS_MEMORY.
enum status shadow_views_init(struct shadow_views *views, const struct blob_view *scene, uint32_t side, struct error *err);

// Free them. A zeroed one is fine.
void shadow_views_finish(struct shadow_views *views);

// How many maps shadow_views_init would make for a scene.
uint32_t shadow_views_count(const struct blob_view *scene);

#endif
