// A scene's surfaces as voxels: exact, the same bits for the same triangles in any order, made in slices on the OpenGL
// device and kept with the resident scene for the jobs that come after. All variants of a scene keep theirs with it as it
// was loaded: those whose triangles and materials are the same, other lights in them or not, share them. What is kept and
// how it is read: shaders/shared/voxel.h and shaders/voxel/lookup.glsl. Device's thread only.
//
// Four passes over the work items of voxel_items.h. Mark: a bit for each (cell, layer) that a triangle overlaps. Count: how
// many entries, and where each is. Sum: every triangle clipped to its cells, its area, place and colours added in integers.
// Finish: from sums to means. The memory is that of the entries, whatever the resolution.
//
// Of an edited scene only what moved is voxelised: the sums of all that stays in place are kept with the base and merged.
// They are integers, so the result has the very bits that voxelising everything would have given.
//
//   voxels_acquire (voxels_step)* voxels_bind* voxels_release
#ifndef CANDIL_WORKER_TECHNIQUE_VOXELS_H
#define CANDIL_WORKER_TECHNIQUE_VOXELS_H

#include "server/worker/gl/buffer.h"
#include "server/worker/gl/timer.h"
#include "server/worker/plan/plan.h"
#include "server/worker/scenes/shelf.h"
#include "server/worker/technique/voxel/voxel_grid.h"
#include "server/worker/technique/voxel/voxel_ranges.h"

struct voxel_build; // technique/voxel/voxel_build.h

struct voxels {
	struct shelved shelved;
	struct gl_device *device;
	struct voxel_options options;
	uint32_t effects; // of the plan, those that materials' colours depend on
	uint64_t geometry, materials; // keys of the scene that it was made of; geometry is 0 with `fixed`

	// Sums of what an edit left in place, for the build of edited scenes alone.
	bool fixed;
	struct voxel_ranges ranges; // triangles in it
	uint32_t area_bits, emission_bits; // units of its sums

	struct voxel_grid grid;
	struct gl_buffer grid_block; // grid
	struct gl_buffer words;
	struct gl_buffer parts[VOXEL_PARTS]; // BIND_VOXEL_PLACE …; none if nothing is occupied
	struct gl_buffer cells; // BIND_VCT_CELLS, from the first volume over them (vct_volume.h) for those that come after
	uint32_t cell_count; // in it
	double thin; // 0…1: of the surface, what bounds walls that light leaks through; with `cells`
	struct voxel_build *build; // NULL: finished
};

// The voxels of a scene by these options, new ones begun if they are not there. Pair with voxels_release. STATUS_MEMORY if
// they cannot fit the budget, with the resolution that would.
enum status voxels_acquire(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
			   const struct voxel_options *options, struct voxels **voxels, struct error *err);

// Work on them for about budget_us, at least one indivisible piece. Returns at once if they are finished. Device time goes
// to the stage "voxelise"; `timer` may be NULL. On failure release them.
enum status voxels_step(struct voxels *voxels, struct gl_timer *timer, uint32_t budget_us, struct error *err);

static inline bool voxels_finished(const struct voxels *voxels)
{
	return !voxels->build;
}

// 0…1.
double voxels_fraction(const struct voxels *voxels);

// The job is done with them: the latest four that are finished stay with the scene for the next. NULL is allowed.
void voxels_release(struct voxels *voxels);

// Bind what is finished: the grid's uniform block and the storage blocks of shaders/voxel/lookup.glsl.
void voxels_bind(const struct voxels *voxels);

// Device memory that they hold now, without `cells`.
uint64_t voxels_bytes(const struct voxels *voxels);

// About what they will take, the memory needed only while they are made included: for technique.bytes.
uint64_t voxels_bytes_guess(const struct resident_scene *scene, const struct voxel_options *options);

#endif
