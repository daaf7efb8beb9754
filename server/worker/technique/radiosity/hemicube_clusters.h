// The triangles of a scene by what the faces of hemicubes may see of them: clusters of a few, groups of clusters, groups of
// those. A face sees nothing of what lies out of its pyramid, nor of what lies between the middles of its pixels. Most of a
// large scene does when pixels are few, and to tell so by boxes costs less than to draw it. Host only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_HEMICUBE_CLUSTERS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_HEMICUBE_CLUSTERS_H

#include "server/worker/scenes/resident.h"
#include "server/worker/technique/radiosity/hemicube_origin.h"

#define HEMICUBE_LEVELS_MOST 12u // of groups

// Metres: its middle, and half of its sides.
struct hemicube_box {
	double at[3], reach[3];
};

// Triangles [first, end), all with masks or all without.
struct hemicube_cluster {
	uint32_t first, end;
	bool cut;
};

// A cluster, and bits of the faces that may see it: of the top, then of the sides +x, −x, +y and −y.
struct hemicube_seen {
	uint32_t cluster, faces;
};

// All clusters of a scene.
struct hemicube_clusters {
	struct hemicube_cluster *list;
	struct hemicube_box *boxes[HEMICUBE_LEVELS_MOST]; // of clusters, of groups of them, and so on
	uint32_t counts[HEMICUBE_LEVELS_MOST]; // of boxes; of the last level one
	uint32_t levels;
};

// Cut the scene into clusters of at most so many triangles. Those have masks whose materials have some of `mask_flags`
// (MATERIAL_…). hemicube_clusters_finish frees them. STATUS_MEMORY; they may be finished then, too.
enum status hemicube_clusters_init(struct hemicube_clusters *clusters, const struct resident_scene *scene,
				   uint32_t triangles, uint32_t mask_flags, struct error *err);

// Free them. Clusters that are all zero are fine.
void hemicube_clusters_finish(struct hemicube_clusters *clusters);

// List the clusters that some of `faces` may see about this origin, in their order, faces having `pixels` pixels a side.
// `seen` has room for all. What it leaves out has no pixel, also where a rasteriser moves corners by up to 1/128 of one.
// Returns how many there are.
uint32_t hemicube_clusters_find(const struct hemicube_clusters *clusters, const struct hemicube_origin *origin,
				uint32_t pixels, uint32_t faces, struct hemicube_seen *seen);

#endif
