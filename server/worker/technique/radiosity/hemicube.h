// Rows of form factors by hemicubes (Cohen and Greenberg 1985, "The hemi-cube"): what an element sees is drawn onto five
// faces about points of it, triangle by triangle, and the shares of the pixels (hemicube_table.h) are summed up by the
// element that each sees. OpenGL; device's thread only. Of the scene, a face is given what may be at the middle of one
// of its pixels (hemicube_clusters.h), and the faces of all hemicubes of a pass are drawn together, by layers. The sums are
// of integers, on the device; only the entries of a row go through the host, to a matrix that is Vulkan's.
//
// A row's sum, with what escaped and what was cut off, is 1 but for the rounding of floats. An entry is off by what pixels
// on outlines have, and by the few points that a patch has: for near elements take more. Where triangles are seen edge-on,
// at outlines of bodies of many small ones, a pixel may see the back of one: some 3e-6 of a row. Nothing is cut off by a
// near plane: depth is inverse, and the nearest plane that is drawn is 2⁻⁵⁰ of the scene's size away. A row's bits depend on
// the scene, the options and the device alone, not on the batch that it is made in. Of blended surfaces those are there
// whose alpha is a half or more.
//
// With mirrors, factors are extended (Sillion and Puech 1989) as those by rays are (rays.h): the share of a pixel counts for
// the mirror that it sees, and what the mirror reflects of it for what the mirror shows there. So rows may sum up to more
// than 1. Reflectance is the luminance of radiosity_surface.mirror. What the limit of bounces leaves is told as `cut`. By
// portals, mirrors that lie in one plane are looked into together, and each plane that is seen costs a picture of its own;
// rays cost the same whatever the planes. A scene without mirrors has no buffers, programs or passes for them.
//
// Example: all rows of elements `e` of a resident scene
//	struct hemicube *h;
//	const struct hemicube_options options = {.pixels = 64, .origins = 4};
//	if ((s = hemicube_create(gl, scene, plan, e, &options, &h, err)) != STATUS_OK)
//		return s;
//	for (uint32_t i = 0; s == STATUS_OK && i < e->count; i += n) {
//		uint32_t n = hemicube_batch(h, budget_us), list[n];
//		…
//		s = hemicube_rows(h, list, n, factors, err);
//	}
//	hemicube_destroy(h);
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_HEMICUBE_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_HEMICUBE_H

#include "server/worker/gl/device.h"
#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/radiosity/elements.h"
#include "server/worker/technique/radiosity/factors.h"
#include "server/worker/technique/radiosity/hemicube_table.h"

#define HEMICUBE_ORIGINS_MOST 1024u
#define HEMICUBE_BOUNCES_MOST 64u // at mirrors, by rays
#define HEMICUBE_PORTALS_MOST 10u // and by portals

// How light goes on at mirrors.
enum hemicube_mirrors {
	HEMICUBE_MIRRORS_OFF,
	HEMICUBE_MIRRORS_PORTAL, // what a mirror shows is drawn within its pixels, as its mirror image sees it
	HEMICUBE_MIRRORS_HYBRID, // from each of its pixels a ray goes on
};

// How rows are made.
struct hemicube_options {
	uint32_t pixels; // of a face's side: even, HEMICUBE_PIXELS_LEAST … HEMICUBE_PIXELS_MOST
	uint32_t origins; // points of a patch: 1 … HEMICUBE_ORIGINS_MOST; one is its barycentre
	enum hemicube_mirrors mirrors;
	uint32_t bounces; // at mirrors, at most: 0 … HEMICUBE_BOUNCES_MOST, or HEMICUBE_PORTALS_MOST by portals
	bool middles; // shares of pixels are products of their middles and areas, as papers print them: rows sum up to more
		      // than 1
};

struct hemicube;

// Device memory that hemicube_create takes for so many triangles and patches, in bytes, at most.
uint64_t hemicube_bytes(uint32_t triangles, uint32_t patches, const struct hemicube_options *options);

// Make ready: upload what of the scene it needs, and make the programs. Effects of the plan other than those of alpha are
// left out. The elements must outlive it.
// STATUS_BAD_ARGUMENT: options out of their ranges; STATUS_MEMORY; STATUS_DEVICE, also of a device whose vertex shaders
// choose no layer and viewport. *hemicube is NULL then.
enum status hemicube_create(struct gl_device *device, struct resident_scene *scene, const struct plan *plan,
			    const struct elements *elements, const struct hemicube_options *options,
			    struct hemicube **hemicube, struct error *err);

// Say what elements reflect, by element: once, before the first rows, where mirrors are not off. If some do, this makes what
// it takes to follow their light, and needs compilation. STATUS_MEMORY, STATUS_DEVICE.
enum status hemicube_reflect(struct hemicube *hemicube, const struct radiosity_surface *surfaces, struct error *err);

// Free it. NULL is allowed.
void hemicube_destroy(struct hemicube *hemicube);

// Make a row and forget it, because some drivers compile at the first run. Not needed. STATUS_MEMORY, STATUS_DEVICE.
enum status hemicube_compile(struct hemicube *hemicube, struct error *err);

// How many rows to ask for next, 1 or more, so that they take about budget_us by what those before them took.
uint32_t hemicube_batch(const struct hemicube *hemicube, double budget_us);

// Make the rows of `count` elements, at most what hemicube_batch gives for any budget, and put them into `factors`.
// STATUS_MEMORY, STATUS_DEVICE, and as factors_put_row; STATUS_TRAVERSAL_CUT: the driver ended a loop of a ray. Some of the
// rows may have been put then.
enum status hemicube_rows(struct hemicube *hemicube, const uint32_t *elements, uint32_t count, struct factors *factors,
			  struct error *err);

#endif
