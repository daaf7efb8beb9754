// The planes of a scene's mirrors: elements that reflect and lie in one plane, whatever their faces, are seen as one mirror.
// Host only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_HEMICUBE_PLANES_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_HEMICUBE_PLANES_H

#include "server/worker/technique/radiosity/hemicube_origin.h"
#include "shaders/shared/hemicube.h"

// A plane, both of whose sides may be mirrors.
struct hemicube_plane {
	double normal[3]; // unit, to either side
	double offset; // metres: normal · p of its points
	double at[3]; // one of its points
	double radius; // metres, about that point: of the faces that are in it
	double error; // metres: how far off it rounding may put what is in it
};

// All planes of a scene, and by element what the shaders need.
struct hemicube_planes {
	struct hemicube_plane *list;
	uint32_t count; // 0: there are no mirrors
	struct hemicube_mirror *mirrors; // by element
};

// Find them; `surfaces` are by element. hemicube_planes_finish frees them. STATUS_MEMORY; `planes` is empty then.
enum status hemicube_planes_init(struct hemicube_planes *planes, const struct elements *elements,
				 const struct radiosity_surface *surfaces, struct error *err);

// Free them. Planes that are all zero are fine.
void hemicube_planes_finish(struct hemicube_planes *planes);

#endif
