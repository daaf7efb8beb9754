// Pictures of the voxels themselves instead of the scene (vct.show): the first cell that each ray meets, or a slice, cell by
// cell. Only what is shown is made: albedo, for instance, needs no light. Device's thread only.
//
//   vct_show_create (vct_show_step)* [deferred passes: vct_show_pass] vct_show_figures vct_show_destroy
#ifndef CANDIL_WORKER_TECHNIQUE_VCT_SHOW_H
#define CANDIL_WORKER_TECHNIQUE_VCT_SHOW_H

#include "server/worker/technique/deferred/deferred.h"
#include "server/worker/technique/vct/vct_volume.h"

struct vct_show;

// Begin to make what is shown. `options` are those of the scene's own picture, so that what both need is made once. *show is
// the caller's. STATUS_BAD_ARGUMENT for a level or a slice that the grid does not have, and for a slice of more cells than
// the image has pixels; failures of voxels_acquire and vct_volume_acquire.
enum status vct_show_create(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
			    const struct vct_volume_options *options, struct vct_show **show, struct error *err);

// Free it, and let go of the voxels and the volume. NULL is allowed.
void vct_show_destroy(struct vct_show *show);

// Make what is shown, for about budget_us. Fails as voxels_step and vct_volume_step.
enum status vct_show_step(struct vct_show *show, struct gl_timer *timer, uint32_t budget_us, struct error *err);

// Whether that is done, and the share of it that is, 0…1.
bool vct_show_finished(const struct vct_show *show);
double vct_show_fraction(const struct vct_show *show);

// Fill in the one pass of the picture. `show` must outlive it.
void vct_show_pass(struct vct_show *show, struct deferred_pass *pass);

// Add all figures to the frame, with occupancy, and the time that counting took as the stage "count". Fails as
// vct_figures_occupied.
enum status vct_show_figures(const struct vct_show *show, struct frame *frame, struct error *err);

// An estimate of the device memory of what is shown, in bytes.
uint64_t vct_show_bytes_guess(const struct resident_scene *scene, const struct plan *plan,
			      const struct vct_volume_options *options);

#endif
