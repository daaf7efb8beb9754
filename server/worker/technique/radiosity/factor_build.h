// Form factors of a scene, made in slices and kept with it (scenes/shelf.h): they depend on places and, where light goes by
// mirrors or through masks, on materials, but on no light and on no camera. Device's thread only.
//
// Rows are made for those elements alone that some light can reach: who wants them brings a walk (reach.h), which finds the
// elements along with their rows. Jobs with other lights share rows, and each has a walk of its own.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTOR_BUILD_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTOR_BUILD_H

#include "server/worker/plan/plan.h"
#include "server/worker/scenes/shelf.h"
#include "server/worker/technique/radiosity/element_buffers.h"
#include "server/worker/technique/radiosity/elements.h"
#include "server/worker/technique/radiosity/factors.h"
#include "server/worker/technique/radiosity/reach.h"
#include "server/worker/technique/radiosity/row_maker.h"

struct corners;
struct factor_moves; // factor_moves.h

// What they depend on beside the scene. Compared byte by byte: zero it before filling it in.
struct factor_options {
	struct patch_options cut;
	struct row_options rows;
	uint32_t effects; // bits 1 << candil_Effect, of those that matter to rays
	uint64_t imported[2]; // hash of the file that rows are taken from; 0: they are made
};

// The factors of a scene.
struct factor_build {
	struct shelved shelved;
	struct factor_options options;
	struct scene_keys keys;
	struct device *device;
	struct elements elements;
	struct element_buffers buffers; // without surfaces
	uint32_t sent; // of the patches, to the buffers
	bool covered; // the buffers tell what is covered of them (surfaces.h)
	void *vertices,
	    *triangles; // that the elements are of, where the scene is a variant, which may go before the factors
	struct factors factors;
	struct corners *corners; // of the elements, for whoever shows a solution
	struct element_groups groups;
	uint32_t *batch; // elements whose rows are begun
	struct row_maker *batch_by; // by whom
	uint32_t batch_count; // 0: none are
	bool partial; // rows were made since a job had all that it wanted
	uint32_t rows; // made
	uint32_t taken; // over from the scene as loaded, where nodes have moved
	struct factor_moves *moves; // NULL: nothing is taken over, or all that can be has been
};

// Hold the factors of a scene by these options, beginning new ones if there are none for the same places: its faces are
// found, and its patches counted. Pair with
// factor_build_release. Fails as patches_init; STATUS_MEMORY, STATUS_DEVICE.
enum status factor_build_acquire(struct resident_scene *scene, struct device *device, const struct factor_options *options,
				 struct factor_build **build, struct error *err);
void factor_build_release(struct factor_build *build); // NULL is allowed

// Those that are there, which acquiring would hold; NULL: none. Good until the next call that may acquire or release some.
const struct factor_build *factor_build_find(struct resident_scene *scene, const struct factor_options *options);

// Make its patches for about budget_us, at least some, until it is ready: before any pass over them runs. STATUS_MEMORY,
// STATUS_DEVICE.
enum status factor_build_prepare(struct factor_build *build, uint32_t budget_us, struct error *err);
bool factor_build_ready(const struct factor_build *build);

// Make the rows that a walk lacks, with `maker`, which must be of these elements and options, and go on with the walk, for
// about budget_us, at least one piece. What another job's maker has begun is gone on with first. It is over when the walk
// has ended. Fails as row_maker_step, reach_follow and factor_moves_step.
enum status factor_build_step(struct factor_build *build, struct reach *reach, struct row_maker *maker, uint32_t budget_us,
			      struct error *err);

// Forget what this maker has begun, before it goes.
void factor_build_pause(struct factor_build *build, const struct row_maker *maker);

// Whether some job had all rows that it wanted, and none is in the midst of others.
bool factor_build_finished(const struct factor_build *build);

#endif
