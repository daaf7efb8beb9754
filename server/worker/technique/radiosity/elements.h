// Elements of radiosity: the two sides of every patch, and the arrays by which shaders find them (shared/radiosity.h).
// Element i is the front of patch i, element i + patches.count its back. Host only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_ELEMENTS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_ELEMENTS_H

#include <stdbool.h>

#include "server/worker/technique/radiosity/patches.h"
#include "shaders/shared/radiosity.h"

// All elements of a scene, as their arrays in host memory, which are uploaded as they are.
struct elements {
	struct patches patches;
	uint32_t count; // 2 · patches.count
	struct radiosity_face *faces; // by face: patches.faces.count
	uint32_t *triangles; // by triangle: its word
	uint32_t triangle_count;
	struct radiosity_patch *shapes; // by patch
	uint32_t made; // of `shapes`
};

// Memory that elements_init needs for a scene of so many triangles and patches, in bytes, at most.
uint64_t elements_bytes(uint32_t triangles, uint32_t patches);

// Cut a scene and make its arrays. The view's sections must outlive the elements, which elements_finish frees. Fails as
// patches_init; `elements` is empty then.
enum status elements_init(struct elements *elements, const struct blob_view *scene, const struct patch_options *options,
			  struct error *err);

// The same in slices: begin, which works on faces alone, and make the shapes of as many more patches until `made` is their
// number.
enum status elements_begin(struct elements *elements, const struct blob_view *scene, const struct patch_options *options,
			   struct error *err);
void elements_make(struct elements *elements, uint32_t patches);

// Free them. Elements that are all zero are fine.
void elements_finish(struct elements *elements);

// The corners of a patch, 3 or 4, in world space: metres, counter-clockwise seen from its front. `origin`: the scene's.
// Returns their number.
uint32_t elements_corners(const struct elements *elements, uint32_t patch, const double origin[3], double world[4][3]);

// Their number alone.
uint32_t elements_corner_count(const struct elements *elements, uint32_t patch);

// The element at barycentrics uv (of corners 1 and 2) of a triangle, as shaders/radiosity/element.glsl finds it; NONE: the
// triangle has no area.
uint32_t elements_at(const struct elements *elements, uint32_t triangle, const double uv[2], bool front);

#endif
