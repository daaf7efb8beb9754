// A scene's light in voxels: the irradiance of every entry of `voxels`, and the directional pyramid of radiance and coverage
// over them. A volume is made in slices and kept on a shelf of the scene (shelf.h), as are those of its variants. If only
// the camera changes, nothing is made again; if lights change, all but the voxels; if nodes move, everything, but of the
// voxels only those of triangles that moved. Device's thread only.
//
// The stages, in this order: compile every program that is needed and run it over nothing; voxelise; light every entry, with
// shadow rays; make the pyramid. Then, for the background's light and for every bounce but the first, gather irradiance by
// cones from every entry, and make the pyramid again. By rays it is gathered without a pyramid, which is then made last, if
// anything reads it.
//
//   vct_volume_acquire (vct_volume_step)* vct_volume_bind* vct_volume_release
#ifndef CANDIL_WORKER_TECHNIQUE_VCT_VOLUME_H
#define CANDIL_WORKER_TECHNIQUE_VCT_VOLUME_H

#include "server/worker/gl/program.h"
#include "server/worker/gl/texture.h"
#include "server/worker/technique/common/sky_map.h"
#include "server/worker/technique/direct/shadow_maps.h"
#include "server/worker/technique/vct/vct_landed.h"
#include "server/worker/technique/vct/vct_options.h"
#include "server/worker/technique/voxel/voxels.h"
#include "shaders/shared/vct.h"

// Everything that the volume's content depends on, beside the scene. Compared by bytes, so what is not used must be zero.
struct vct_volume_options {
	struct voxel_options voxels;
	uint32_t effects; // of the plan
	uint32_t bounces; // of light between surfaces; 0: direct light alone
	uint32_t cones; // diffuse ones: 6, 9, 16 or 32
	uint32_t rays; // of each side of an entry, in the bounces; 0: cones
	uint32_t unmarched; // 1: with rays, nobody reads the pyramid, and none is made
	uint32_t points; // direct.samples: shadow rays from an entry to emissive triangles
	uint32_t shadows; // 1: lights throw shadows
	uint32_t map_side; // texels of the shadow maps; 0: none
	uint32_t pyramid, cover, own, lambert, volume_shadows; // as in struct vct_settings
	uint32_t emission; // 1: emission is in the pyramid, and no shadow rays go to emissive triangles
	struct vct_marching marching; // reach 0: no limit
	float background[3]; // radiance, W/(m² sr)
	float sky_turn, sky_scale; // as in struct scene_params
	uint64_t sky; // id of the environment's scene; 0: none
};

// The volume of one scene by one set of options. Its shelf owns it; jobs hold it.
struct vct_volume {
	struct shelved shelved;
	struct scene_keys keys; // of the scene that it was made from
	struct vct_volume_options options;
	struct gl_device *device;
	const struct sky_map *sky; // of options.sky, while a job holds the volume; NULL: none
	struct resident_scene *scene; // only while it is made; afterwards others with the same keys share it
	struct voxels *voxels; // held
	struct vct_params params;
	struct gl_buffer params_block; // struct vct_params
	struct gl_buffer cells; // BIND_VCT_CELLS, until the voxels have it: occupied cells of the pyramid's finest level
	struct gl_buffer direct, total; // BIND_VCT_DIRECT, BIND_VCT_TOTAL
	struct gl_buffer sent; // with rays, while entries gather: what they look up, the total before
	struct vct_landed landed; // with rays: what they look up
	struct gl_buffer job; // struct scene_params, for the lights
	struct gl_texture pyramid;
	struct gl_texture shares; // with VCT_SHADOWS_VOLUME: VCT_SHARES_UNIT
	struct shadow_maps *maps; // held until the light stage is over; NULL: none are wanted
	struct gl_defines light_defines, cone_defines; // of the light stage, and of the gather stage
	struct gl_defines ray_defines; // of the gather stage by rays
	uint32_t bindings; // of the scene, that the light stage reads, and the gather stage by rays
	float emission_most; // emitted radiance of the brightest surface, W/(m² sr)
	// Where its making stands.
	uint32_t stage; // enum vct_stage
	uint32_t compiled; // number of stages whose programs are
	uint32_t level; // of the pyramid, next
	bool lit; // the light stage is over
	uint32_t gathers; // done
	uint32_t gathers_wanted; // in all
	bool gathers_first; // gather before `direct` is in the pyramid, so that light which only cones bring has as many
			    // bounces
	uint64_t next_item; // of the stage
	double item_us[9]; // measured time of an item, by stage; 0: not yet
};

// Hold the volume of a scene by these options, beginning a new one if there is none for the same triangles, materials and
// lights. Pair with vct_volume_release. STATUS_MEMORY if it does not fit: the sentence names the resolution that does.
// STATUS_DEVICE, STATUS_INTERNAL.
enum status vct_volume_acquire(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
			       const struct vct_volume_options *options, struct vct_volume **volume, struct error *err);

// Work on it for about budget_us, at least one piece. Device time goes to stages of `timer`. STATUS_MEMORY, STATUS_DEVICE,
// STATUS_INTERNAL, STATUS_TRAVERSAL_CUT (the driver ended the loops of an entry's rays early): then release it, or make room
// and call again after STATUS_MEMORY.
enum status vct_volume_step(struct vct_volume *volume, struct gl_timer *timer, uint32_t budget_us, struct error *err);

// Whether its making is over, and the share of it that is done, 0…1.
bool vct_volume_finished(const struct vct_volume *volume);
double vct_volume_fraction(const struct vct_volume *volume);

// Add the macros of vct/cone.glsl, for programs that include it.
void vct_define(struct gl_defines *defines, const struct vct_volume_options *options);

// Bind parameters and pyramid for vct/cone.glsl.
void vct_volume_bind(const struct vct_volume *volume);

// Let go of it. The latest two that are finished stay with the scene. NULL is allowed.
void vct_volume_release(struct vct_volume *volume);

// An estimate of the device memory that it will take, in bytes, with its voxels.
uint64_t vct_volume_bytes_guess(const struct resident_scene *scene, const struct vct_volume_options *options);

#endif
