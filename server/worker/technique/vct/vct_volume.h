// A scene's light in voxels: the irradiance of every entry of `voxels` and the directional pyramid over them, made in slices
// and kept with the scene as it was loaded, those of its variants too. A change of camera makes nothing again; a change of
// lights all but the voxels; a change of what moves all, though of the voxels those alone that moved. Device's thread only.
//
// Stages, in this order: compile (every program that is needed, run over nothing), voxelise, light (shadow rays from every
// entry), pyramid; then, for the background's light and every bounce but the first, gather (cones from every entry) and
// pyramid again.
//
//   vct_volume_acquire (vct_volume_step)* vct_volume_bind* vct_volume_release
#ifndef CANDIL_WORKER_TECHNIQUE_VCT_VOLUME_H
#define CANDIL_WORKER_TECHNIQUE_VCT_VOLUME_H

#include "server/worker/gl/program.h"
#include "server/worker/gl/texture.h"
#include "server/worker/technique/common/sky_map.h"
#include "server/worker/technique/direct/shadow_maps.h"
#include "server/worker/technique/vct/vct_options.h"
#include "server/worker/technique/voxel/voxels.h"
#include "shaders/shared/vct.h"

// All that the volume's content depends on, beside the scene. Compared by bytes: zero what is not used.
struct vct_volume_options {
	struct voxel_options voxels;
	uint32_t effects; // of the plan
	uint32_t bounces; // 0: lights alone, which the volume is not needed for
	uint32_t cones; // diffuse: 6, 9, 16 or 32
	uint32_t points; // direct.samples, for shadow rays to emissive triangles
	uint32_t shadows; // 1: lights throw them
	uint32_t map_side; // texels of the shadow maps; 0: none
	uint32_t pyramid, cover, own, lambert, volume_shadows; // as in struct vct_settings
	uint32_t emission; // 1: surfaces' emission is in the pyramid, and nobody aims at emissive triangles
	struct vct_marching marching; // reach 0: no end
	float background[3];
	float sky_turn, sky_scale; // as in struct scene_params
	uint64_t sky; // id of the scene that is the picture around it; 0: none
};

struct vct_volume {
	struct shelved shelved;
	struct scene_keys keys; // of the scene that it was made of
	struct vct_volume_options options;
	struct gl_device *device;
	const struct sky_map *sky; // of options.sky, while a job has it; NULL: none
	struct resident_scene *scene; // while it is made: others with the same keys share it afterwards
	struct voxels *voxels;
	struct vct_params params;
	struct gl_buffer params_block; // struct vct_params
	struct gl_buffer cells; // BIND_VCT_CELLS, until the voxels have it: occupied cells of the pyramid's finest level
	struct gl_buffer direct, total; // BIND_VCT_DIRECT, BIND_VCT_TOTAL
	struct gl_buffer job; // struct scene_params, for the lights
	struct gl_texture pyramid;
	struct gl_texture shares; // with VCT_SHADOWS_VOLUME: VCT_SHARES_UNIT
	struct shadow_maps *maps; // until the lights have been through; NULL: none are wanted
	struct gl_defines light_defines, cone_defines;
	uint32_t bindings; // of the scene, that the lights' program reads
	float emission_most; // radiance of the brightest surface, W/(m² sr)
	// Where its making stands.
	uint32_t stage; // enum vct_stage
	uint32_t compiled; // stages whose programs are
	uint32_t level; // of the pyramid
	bool lit; // the lights have been through
	uint32_t gathers; // done
	uint32_t gathers_wanted;
	bool gathers_first; // what cones alone bring, before `direct` is in the pyramid: every light has as many bounces
	uint64_t next_item; // of the stage
	double item_us[9]; // measured, by stage; 0: not yet
};

// The volume of a scene by these options, a new one begun if there is none of the same triangles, materials and lights. Pair
// with vct_volume_release. STATUS_MEMORY if it cannot fit, with the resolution that would.
enum status vct_volume_acquire(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
			       const struct vct_volume_options *options, struct vct_volume **volume, struct error *err);

// Work for about budget_us. Device time goes to stages of `timer`. On failure release it.
enum status vct_volume_step(struct vct_volume *volume, struct gl_timer *timer, uint32_t budget_us, struct error *err);
bool vct_volume_finished(const struct vct_volume *volume);
double vct_volume_fraction(const struct vct_volume *volume); // 0…1

// Whether shadows by this enum vct_shadows come out of the voxels.
bool vct_shadows_in_volume(uint32_t shadows);

// The macros of vct/cone.glsl and what includes it.
void vct_define(struct gl_defines *defines, const struct vct_volume_options *options);

// Bind parameters and pyramid for vct/cone.glsl.
void vct_volume_bind(const struct vct_volume *volume);

// NULL is allowed. The latest two that are finished stay.
void vct_volume_release(struct vct_volume *volume);

// About the device memory that it will take, voxels included.
uint64_t vct_volume_bytes_guess(const struct resident_scene *scene, const struct vct_volume_options *options);

#endif
