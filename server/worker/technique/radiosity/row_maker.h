// Makes rows of form factors by the way that is asked for: rays (rays.h), hemicubes (hemicube.h) or contour integrals
// (analytic.h); or takes them from a file (imported.h). Device's thread only.
//
//   row_maker_create, row_maker_compile, (row_maker_begin, row_maker_step until done)*, row_maker_destroy
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_ROW_MAKER_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_ROW_MAKER_H

#include "server/worker/technique/radiosity/factors.h"
#include "server/worker/technique/radiosity/patch_pass.h"

struct gl_device;

// The words of radiosity.factors, and the way of a file that is imported.
enum row_way { ROWS_BY_HEMISPHERE, ROWS_BY_HEMICUBE, ROWS_BY_CONTOUR, ROWS_IMPORTED };

// How rows are made. Compared byte by byte: zero it before filling it in.
struct row_options {
	uint32_t way; // enum row_way
	uint32_t rays; // of a row by rays; between a pair that is partly hidden, by contour integrals
	uint32_t pixels, origins; // of hemicubes
	uint32_t mirrors; // whether light goes on by mirrors
	uint32_t bounces; // by mirrors, at most
	uint32_t portals; // of hemicubes: they look into mirrors; else rays go on from their pixels
};

struct row_maker;

// Make ready. What `of` names must outlive it, and so must `surfaces`, by element, which hemicubes with mirrors read when
// the first rows are made. `gl` is asked for hemicubes alone. Fails as rays_create, hemicube_create and analytic_create;
// *maker is NULL then.
enum status row_maker_create(const struct patch_scene *of, const struct row_options *options,
			     const struct radiosity_surface *surfaces, struct device *device, struct gl_device *gl,
			     struct row_maker **maker, struct error *err);
void row_maker_destroy(struct row_maker *maker); // NULL is allowed

// Compile its code, unless that has been done.
enum status row_maker_compile(struct row_maker *maker, struct error *err);

// How many rows to begin with, 1 or more, so that they take about budget_us by what those before them took.
uint32_t row_maker_batch(const struct row_maker *maker, double budget_us);

// Begin the rows of `count` elements, which must stay where they are until the rows are done.
void row_maker_begin(struct row_maker *maker, const uint32_t *elements, uint32_t count);

// Work on them for about budget_us, at least one piece; a batch of rays or hemicubes is one. *done: all of them are in
// `factors`. After a failure some may be.
enum status row_maker_step(struct row_maker *maker, uint32_t budget_us, struct factors *factors, bool *done,
			   struct error *err);

// How large a scene is.
struct row_scene {
	uint32_t triangles, vertices, faces, patches;
};

// Device memory of it for such a scene, in bytes, at most.
uint64_t row_maker_bytes(const struct row_scene *scene, const struct row_options *options);

#endif
