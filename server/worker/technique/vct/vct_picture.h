// The passes of a picture for light between surfaces and the background's (deferred.h), over a volume: by cones at full or
// half resolution, or by rays whose light neighbours share. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_VCT_PICTURE_H
#define CANDIL_WORKER_TECHNIQUE_VCT_PICTURE_H

#include "server/worker/technique/deferred/deferred.h"
#include "server/worker/technique/direct/lighting.h"
#include "server/worker/technique/vct/vct_volume.h"

#define VCT_PICTURE_RAY_PASSES 4u // at most: some drivers end the loops of a pixel that has too many rays at once
#define VCT_PICTURE_RAYS 32u // of a pass; more only where there would be too many passes
#define VCT_PICTURE_PASSES (VCT_PICTURE_RAY_PASSES + 2u)

_Static_assert(VCT_PICTURE_PASSES + LIGHTING_PASSES_MAX <= DEFERRED_PASSES_MAX, "a picture has room for them");

// A pass and what it binds.
struct vct_picture_part {
	const struct vct_picture *picture;
	const struct gl_texture *from, *to; // irradiance that it reads and that it writes; NULL: none
	uint32_t rays[3]; // VCT_PIXEL_RAYS
};

// Zeroed: none. It must not move while its passes are in use.
struct vct_picture {
	const struct vct_volume *volume;
	struct gl_device *device;
	struct gl_texture irradiance, facets; // shaders/vct/half.glsl
	struct gl_texture shared, nearness; // with rays: irradiance that neighbours share; shaders/vct/vct_rays.comp.glsl
	struct vct_picture_part parts[VCT_PICTURE_PASSES];
};

// Make the textures that pictures of the plan need. STATUS_MEMORY, STATUS_DEVICE; finish it then, too.
enum status vct_picture_init(struct vct_picture *picture, struct gl_device *device, const struct plan *plan,
			     const struct vct_volume *volume, struct error *err);

// Append the passes behind `count` others; returns the new number.
uint32_t vct_picture_passes(struct vct_picture *picture, const struct plan *plan, struct deferred_pass *passes,
			    uint32_t count);

// Free it. A zeroed one is fine.
void vct_picture_finish(struct vct_picture *picture);

// Device memory of the textures, in bytes.
uint64_t vct_picture_bytes(const struct gl_device *device, const struct plan *plan);

#endif
