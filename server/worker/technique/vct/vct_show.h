// Looking at the voxels themselves instead of the scene (vct.show): what a ray meets first of them, or a slice, cell by
// cell. What is shown is made, and no more: albedo needs no light. Device's thread only.
//
//   vct_show_create (vct_show_step)* [deferred passes: vct_show_pass] vct_show_figures vct_show_destroy
#ifndef CANDIL_WORKER_TECHNIQUE_VCT_SHOW_H
#define CANDIL_WORKER_TECHNIQUE_VCT_SHOW_H

#include "server/worker/technique/deferred/deferred.h"
#include "server/worker/technique/vct/vct_volume.h"

struct vct_show;

// `options` are those of the scene's own picture: what both need is made once. STATUS_BAD_ARGUMENT for a level or a slice
// that the grid does not have, and for a slice that has more cells than the image has pixels.
enum status vct_show_create(struct resident_scene *scene, struct gl_device *device, const struct plan *plan,
			    const struct vct_volume_options *options, struct vct_show **show, struct error *err);
void vct_show_destroy(struct vct_show *show); // NULL is allowed

// Make what is shown, for about budget_us.
enum status vct_show_step(struct vct_show *show, struct gl_timer *timer, uint32_t budget_us, struct error *err);
bool vct_show_finished(const struct vct_show *show);
double vct_show_fraction(const struct vct_show *show); // 0…1

// The one pass of the picture. `show` must outlive it.
void vct_show_pass(struct vct_show *show, struct deferred_pass *pass);

// All figures, occupancy among them, and the stage "count" that this took.
enum status vct_show_figures(const struct vct_show *show, struct frame *frame, struct error *err);

// Device memory of what is shown, before it is made.
uint64_t vct_show_bytes_guess(const struct resident_scene *scene, const struct plan *plan,
			      const struct vct_volume_options *options);

#endif
