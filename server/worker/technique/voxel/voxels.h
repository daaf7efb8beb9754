// A scene's surfaces as voxels, made in slices on the OpenGL device and kept on a shelf of the scene (shelf.h) for later
// jobs. Voxelisation is exact: the same triangles give the same bits in any order. Variants of a scene with the same
// triangles and materials share their voxels, whatever their lights. What is kept, and how shaders read it:
// shaders/shared/voxel.h and shaders/voxel/lookup.glsl. Device's thread only.
//
// There are four passes over the work items of voxel_items.h. Mark sets a bit for each (cell, layer) that a triangle
// overlaps. Count finds how many entries there are, and where each is. Sum clips every triangle to its cells and adds its
// area, place and colours as integers. Finish turns sums into means. Memory grows with the entries, not with the resolution.
//
// Of an edited scene only the triangles that moved are voxelised. The sums of all others are kept with the base, and merged.
// They are integers, so the result has the same bits as if everything had been voxelised.
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

// The voxels of one scene by one set of options. Their shelf owns them; jobs and volumes hold them.
struct voxels {
	struct shelved shelved;
	struct gl_device *device;
	struct voxel_options options;
	uint32_t effects; // of the plan's, those on which materials' colours depend
	uint64_t geometry, materials; // keys of the scene that they were made from; geometry is 0 with `fixed`

	// Set: no voxels but sums of the triangles that an edit leaves in place, for building edited scenes.
	bool fixed;
	struct voxel_ranges ranges; // with `fixed`: those triangles
	uint32_t area_bits, emission_bits; // with `fixed`: the units of the sums

	struct voxel_grid grid;
	struct gl_buffer grid_block; // `grid`, as a uniform block
	struct gl_buffer words; // the bits of the grid, and where entries are
	struct gl_buffer parts[VOXEL_PARTS]; // BIND_VOXEL_PLACE and those after it; none if nothing is occupied
	struct gl_buffer
	    cells; // BIND_VCT_CELLS: made by the first volume over these voxels (vct_volume.h) for those after it
	uint32_t cell_count; // in `cells`
	double thin; // share of the surface, 0…1, that bounds walls so thin that light leaks through; known with `cells`
	struct voxel_build *build; // NULL: finished
};

// Hold the voxels of a scene by these options, beginning new ones if they are not there. Pair with voxels_release.
// STATUS_MEMORY if they do not fit the budget: the sentence names the resolution that does. STATUS_DEVICE.
enum status voxels_acquire(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
			   const struct voxel_options *options, struct voxels **voxels, struct error *err);

// Work on them for about budget_us, at least one indivisible piece; return at once if they are finished. Device time goes to
// the timer's stage "voxelise"; `timer` may be NULL. STATUS_MEMORY, STATUS_DEVICE, STATUS_INTERNAL: then release them, or
// make room and call again after STATUS_MEMORY.
enum status voxels_step(struct voxels *voxels, struct gl_timer *timer, uint32_t budget_us, struct error *err);

// Whether their making is over.
static inline bool voxels_finished(const struct voxels *voxels)
{
	return !voxels->build;
}

// The share of their making that is done, 0…1.
double voxels_fraction(const struct voxels *voxels);

// Let go of them. The latest four that are finished stay with the scene. NULL is allowed.
void voxels_release(struct voxels *voxels);

// Bind finished voxels: the grid's uniform block and the storage blocks of shaders/voxel/lookup.glsl.
void voxels_bind(const struct voxels *voxels);

// Device memory that they take now, in bytes, without `cells`.
uint64_t voxels_bytes(const struct voxels *voxels);

// An estimate of the device memory that they will take, in bytes, with what is needed only while they are made: for struct
// technique's `bytes`.
uint64_t voxels_bytes_guess(const struct resident_scene *scene, const struct voxel_options *options);

#endif
