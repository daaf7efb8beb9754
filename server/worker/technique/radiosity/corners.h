// Values for display at the corners of elements, so that what is shown between them has no seams: four for each element, of
// a triangle the fourth as the third.
//
// Elements whose surfaces go on smoothly in a corner (corner_links.h) have one value there, the mean of their irradiances.
// Irradiance does not depend on what a surface is made of, so materials do not matter. The weights are the angles of the
// elements at the corner: they are the shares that the elements have of a small disc about it, whatever their sizes, so that
// a mean stays the same if one of them is cut further away (Thürmer and Wüthrich 1998, "Computing vertex normals from
// polygonal facets"). At the border of a smooth surface, as along a crease, a mean would be one of places that are all on
// one side: there the value is extrapolated from the elements about the corner and their neighbours (corner_fit.h). Where a
// corner lies on the side of a larger element, it has what that interpolates there from its own two corners instead: (1 - t)
// a + t b. An element that no light can reach (`reached` is 0) has 0 and gives nothing.
//
// Of two elements of which each has a corner on the other's side, as where one edge is cut in 2 and in 3, the longer one
// decides, and the shorter meets it in its corners: between them they differ by the second difference of the values.
//
// Example: `scene` is a view of a blob
//	struct elements elements;
//	struct corners *corners;
//	struct error err;
//	assert(elements_init(&elements, scene, &(struct patch_options){.edge = 0.1}, &err) == STATUS_OK);
//	assert(corners_create(&elements, &corners, &err) == STATUS_OK);
//	while (!corners_finished(corners))
//		assert(corners_step(corners, 10000, &err) == STATUS_OK);
//	float *irradiance = calloc(elements.count, 3 * sizeof *irradiance); // of a dark scene; else of solver_read
//	float *values = malloc(elements.count * 12 * sizeof *values);
//	struct corner_values *making;
//	assert(corner_values_create(corners, irradiance, NULL, values, &making, &err) == STATUS_OK);
//	while (!corner_values_finished(making))
//		corner_values_step(making, 10000);
//	corner_values_destroy(making);
//	printf("%g W/m²\n", values[0]);
//	free(values);
//	free(irradiance);
//	corners_destroy(corners);
//	elements_finish(&elements);
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_CORNERS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_CORNERS_H

#include "server/worker/technique/radiosity/elements.h"

// Which corners belong together. It depends on the elements alone, so that it serves all solutions of a scene. Host only;
// one thread at a time.
struct corners;

// Memory for so many patches, in bytes, at most, and while it is made.
uint64_t corners_bytes(uint32_t patches);

// Begin. The elements must outlive the corners. STATUS_MEMORY. corners_destroy frees it; NULL is fine.
enum status corners_create(const struct elements *elements, struct corners **corners, struct error *err);
void corners_destroy(struct corners *corners);

// Work for about budget_us, at least one piece. What comes out
// does not depend on the budgets. Where corners lie beside more sides than in any mesh that is made of surfaces, some of
// them are left out, and seams remain. STATUS_MEMORY.
enum status corners_step(struct corners *corners, uint32_t budget_us, struct error *err);

// How far it is.
bool corners_finished(const struct corners *corners);
double corners_progress(const struct corners *corners); // 0…1

#endif
