// Rows of form factors for benchmarks: a scene cut into elements, and rows of it by several methods with what they cost.
// Device's thread only. Every function ends the program where something fails.
#ifndef CANDIL_TESTS_BENCH_RADIOSITY_ROWS_H
#define CANDIL_TESTS_BENCH_RADIOSITY_ROWS_H

#include "server/worker/devices.h"
#include "server/worker/technique/radiosity/hemicube.h"
#include "server/worker/technique/radiosity/rays.h"
#include "tests/support/load_scene.h"

// A scene, cut, with the elements whose rows are made: some of the fronts, or all.
struct row_subject {
	struct devices *devices;
	struct resident_scene scene;
	struct loaded_scene loaded;
	struct elements elements;
	struct element_buffers buffers;
	struct radiosity_surface *surfaces; // by element
	uint32_t *list; // ascending, evenly over all fronts, and so over the scene's nodes
	uint32_t rows;
	struct rays *rays; // of row_subject_cast; NULL: none
	uint32_t per_row; // of its rays
};

enum row_kind { ROW_RAYS, ROW_HEMICUBE };

// How rows are made.
struct row_method {
	const char *name;
	enum row_kind kind;
	uint32_t size; // pixels of a face's side, or rays
	uint32_t origins; // of hemicubes; 1: the barycentre
	bool barycentre; // of rays
	bool middles; // of hemicubes
	enum hemicube_mirrors mirrors; // of hemicubes; of rays, whether it is not HEMICUBE_MIRRORS_OFF
	uint32_t bounces;
};

// What rows cost, from when all was ready to when they were in the matrix.
struct row_cost {
	double processor_us, wall_us; // of all rows; the processors' of all threads
};

// Load a file, cut it by the edge, and make its surfaces. `rows` 0: those of all fronts.
void row_subject_init(struct row_subject *subject, struct devices *devices, const char *loader, const char *file,
		      double edge, uint32_t rows);
void row_subject_finish(struct row_subject *subject);

// Make `rays` anew, by other options, for code without any effect.
void row_subject_cast(struct row_subject *subject, const struct rays_options *options);

// Samples that a method takes of an element: rays, or pixels of the same number, three squares of a face.
double row_samples(const struct row_method *method);

// Make the rows into `factors`, which is begun here and is the caller's to finish.
struct row_cost row_make(struct row_subject *subject, const struct row_method *method, struct factors *factors);

// The same into an array of rows × elements.count, which the caller frees.
struct row_cost row_dense(struct row_subject *subject, const struct row_method *method, float **rows);

// What rows are off a control, each relative to the control's sum: Σ_j |F_ij - C_ij| / Σ_j C_ij.
struct row_error {
	double mean, most; // of the rows
};
struct row_error row_error_of(const struct row_subject *subject, const float *rows, const float *control);

// End the program, unless the status is good.
void row_need(enum status status, const struct error *err);

#endif
