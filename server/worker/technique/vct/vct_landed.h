// What rays look up in the voxels where they land (shaders/vct/landed.glsl), as texel buffers, and the table by which an
// environment's directions are chosen. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_VCT_LANDED_H
#define CANDIL_WORKER_TECHNIQUE_VCT_LANDED_H

#include "server/worker/gl/texels.h"
#include "server/worker/technique/common/sky_table.h"
#include "server/worker/technique/voxel/voxels.h"

#define VCT_LANDED_VIEWS 5u

// Zeroed: none.
struct vct_landed {
	struct gl_texels views[VCT_LANDED_VIEWS]; // of others' buffers
	struct gl_texels none_words, none_uints, none_floats; // bound before there are voxels, so that programs are compiled
	const struct sky_table *sky; // of the environment's scene, while a job holds that; NULL: there is none
};

// Make what can be bound before there are voxels in the grid. Nothing is to be freed after a failure: STATUS_MEMORY,
// STATUS_DEVICE.
enum status vct_landed_init(struct vct_landed *landed, struct gl_device *device, const struct voxel_grid *grid,
			    struct error *err);

// View finished voxels with entries, and the irradiance of their sides: BIND_VCT_TOTAL's layout. The buffers must outlive
// the views, which replace those before. Fails alike.
enum status vct_landed_view(struct vct_landed *landed, const struct voxels *voxels, const struct gl_buffer *sent,
			    struct error *err);

// Bind the voxels' grid, the texel buffers and the table.
void vct_landed_bind(const struct vct_landed *landed, const struct voxels *voxels);

// Free it. A zeroed one is fine.
void vct_landed_finish(struct vct_landed *landed);

#endif
