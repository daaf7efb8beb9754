// Internal to voxels.c: the build of voxels, which is a cursor over its passes. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_VOXEL_BUILD_H
#define CANDIL_WORKER_TECHNIQUE_VOXEL_BUILD_H

#include "server/worker/gl/program.h"
#include "server/worker/gl/scene.h"
#include "server/worker/technique/voxel/voxel_items.h"
#include "server/worker/technique/voxel/voxels.h"

#define VOXEL_ITEMS_CHUNK (512u * 1024u) // items that are on the device at once
#define VOXEL_AREA_BITS 22u // 2^bits is the square of a voxel's side at first: room for 1024 of them in a layer of a voxel
#define VOXEL_EMISSION_BITS 28u // 2^bits is the brightest emission at first: room for 16 side² of it

// The phases of a build, in their order.
enum voxel_phase {
	VOXEL_COMPILE,
	VOXEL_FIXED, // of an edited scene: until the sums of the triangles in place are there
	VOXEL_MARK,
	VOXEL_COUNT,
	VOXEL_MERGE, // add those sums to ours
	VOXEL_SUM,
	VOXEL_CHECK,
	VOXEL_FINISH,
	VOXEL_DONE
};

// Places in voxel_build.programs.
enum {
	VOXEL_PROGRAM_MARK,
	VOXEL_PROGRAM_COUNT,
	VOXEL_PROGRAM_PREFIX,
	VOXEL_PROGRAM_MERGE,
	VOXEL_PROGRAM_SUM,
	VOXEL_PROGRAM_FINISH,
	VOXEL_PROGRAMS
};

// A build. The voxels own it.
struct voxel_build {
	struct resident_scene *scene;
	struct voxels *fixed; // sums to merge, held during the build; NULL: everything is voxelised
	struct voxel_ranges ranges; // triangles to voxelise
	struct gl_scene *gl;
	struct gl_buffer job; // struct scene_params, for the scene's shaders
	struct gl_buffer items; // up to VOXEL_ITEMS_CHUNK
	struct voxel_item *host_items;
	struct gl_program *programs[VOXEL_PROGRAMS]; // held
	uint32_t compiled; // how many of them are
	uint64_t compile_us; // time that compiling took and that no stage of a timer has yet
	struct voxel_items stream;
	uint32_t chunk; // items on the device
	uint32_t chunk_at; // next of them
	bool chunk_is_all; // the chunk is the whole stream, and need not be made again for the next pass
	enum voxel_phase phase;
	uint32_t area_bits, emission_bits;
	double emission_max; // W/(m² sr), largest component of the scene's
	uint32_t word; // next of the pass over words
	double items_a_us, words_a_us; // measured speeds, items and words per microsecond; 0: not yet
};

// Begin the build of voxels whose grid and options are set: of all triangles; with `fixed`, of those that moved; if the
// voxels are `fixed` themselves, of those that did not move. The build takes over the hold of `fixed`. On failure
// (STATUS_MEMORY, STATUS_DEVICE) the caller destroys the build.
enum status voxel_build_create(struct voxels *voxels, struct resident_scene *scene, const struct plan *plan,
			       struct voxels *fixed, struct error *err);

// Free a build.
void voxel_build_destroy(struct voxel_build *build, struct gl_device *device);

// Do one indivisible piece that should take about budget_us. Fails as voxels_step.
enum status voxel_build_piece(struct voxels *voxels, uint32_t budget_us, struct error *err);

#endif
