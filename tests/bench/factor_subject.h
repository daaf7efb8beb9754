// A scene, cut into patches, of which some rows of form factors are made: for benchmarks. Whatever fails ends the program.
#ifndef CANDIL_TESTS_FACTOR_SUBJECT_H
#define CANDIL_TESTS_FACTOR_SUBJECT_H

#include "server/worker/technique/radiosity/rays.h"
#include "tests/support/load_scene.h"

#define FACTOR_ROWS 256u // spread evenly over the fronts of all patches

struct factor_subject {
	struct device *device;
	struct resident_scene scene;
	struct loaded_scene loaded;
	struct elements elements;
	struct element_buffers buffers;
	struct rays *rays;
	uint32_t list[FACTOR_ROWS];
	uint32_t per_row;
};

// End the program, with what is wrong, unless nothing is.
void factor_must(enum status s, const struct error *err);

// `edge`: of patches, in metres.
void factor_subject_init(struct factor_subject *subject, struct device *device, const char *loader, const char *file,
			 double edge, const struct rays_options *options);
void factor_subject_finish(struct factor_subject *subject);

// Make rows by other options from now on.
void factor_subject_change(struct factor_subject *subject, const struct rays_options *options);

#endif
