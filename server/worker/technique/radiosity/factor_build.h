// Form factors of a scene, made in slices and kept with it (scenes/shelf.h): they depend on places and, where light goes by
// mirrors or through masks, on materials, but on no light and on no camera. Device's thread only.
//
// Rows are made for those elements alone that some light can reach. Elements go by groups: a node of the scene has two, the
// fronts of its patches and their backs. Whoever knows lit elements wants their groups; the entries of a group's rows tell
// which groups it sees, and these are wanted in turn. So the inside of a closed body and the outside of a room cost nothing.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTOR_BUILD_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTOR_BUILD_H

#include "server/worker/plan/plan.h"
#include "server/worker/scenes/shelf.h"
#include "server/worker/technique/radiosity/element_buffers.h"
#include "server/worker/technique/radiosity/elements.h"
#include "server/worker/technique/radiosity/factors.h"
#include "server/worker/technique/radiosity/row_maker.h"

struct corners;
struct factor_moves; // factor_moves.h

// What they depend on beside the scene. Compared byte by byte: zero it before filling it in.
struct factor_options {
	struct patch_options cut;
	struct row_options rows;
	uint32_t effects; // bits 1 << candil_Effect, of those that matter to rays
};

// The factors of a scene.
struct factor_build {
	struct shelved shelved;
	struct factor_options options;
	struct scene_keys keys;
	struct device *device;
	struct elements elements;
	struct element_buffers buffers; // without surfaces
	void *vertices,
	    *triangles; // that the elements are of, where the scene is a variant, which may go before the factors
	struct factors factors;
	struct corners *corners; // of the elements, for whoever shows a solution
	uint32_t *group_first; // by node of the scene, and one more: its first patch
	uint32_t node_count;
	uint8_t *wanted; // by group, 2 · node + side: 1 waits for rows, or has them
	uint32_t *queue; // groups, in the order in which they were wanted
	uint32_t queued, done; // groups of the queue, and of those that have all their rows
	uint32_t next; // row within queue[done]
	uint8_t *followed; // by element: the groups that its row sees are wanted
	uint32_t *batch; // elements whose rows are begun
	const struct row_maker *batch_by; // by whom
	uint32_t batch_count; // 0: none are
	uint32_t batch_done, batch_next; // where `done` and `next` were before it
	uint32_t rows; // made
	uint32_t taken; // over from the scene as loaded, where nodes have moved
	struct factor_moves *moves; // NULL: nothing is taken over, or all that can be has been
};

// Hold the factors of a scene by these options, beginning new ones if there are none for the same places. Pair with
// factor_build_release. Fails as patches_init; STATUS_MEMORY, STATUS_DEVICE.
enum status factor_build_acquire(struct resident_scene *scene, struct device *device, const struct factor_options *options,
				 struct factor_build **build, struct error *err);
void factor_build_release(struct factor_build *build); // NULL is allowed

// Those that are there, which acquiring would hold; NULL: none. Good until the next call that may acquire or release some.
const struct factor_build *factor_build_find(struct resident_scene *scene, const struct factor_options *options);

// Want the rows of an element's group.
void factor_build_want(struct factor_build *build, uint32_t element);

// Make rows with `maker`, which must be of these elements and options, for about budget_us, at least one piece.
enum status factor_build_step(struct factor_build *build, struct row_maker *maker, uint32_t budget_us, struct error *err);

// Forget what this maker has begun, before it goes.
void factor_build_pause(struct factor_build *build, const struct row_maker *maker);

// Whether all that are wanted have their rows, and the share of the rows that do, 0…1.
bool factor_build_finished(const struct factor_build *build);
double factor_build_fraction(const struct factor_build *build);

// The group of an element; and of a group, below 2 · node_count, its elements: returns how many follow *first.
uint32_t factor_build_group(const struct factor_build *build, uint32_t element);
uint32_t factor_build_group_elements(const struct factor_build *build, uint32_t group, uint32_t *first);

// Whether an element has a row.
bool factor_build_has(const struct factor_build *build, uint32_t element);

#endif
