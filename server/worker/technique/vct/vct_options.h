// The options of voxel cone tracing: README says what each does.
#ifndef CANDIL_WORKER_VCT_OPTIONS_H
#define CANDIL_WORKER_VCT_OPTIONS_H

#include "server/worker/technique/direct/direct_options.h"
#include "shaders/shared/vct.h"

enum vct_grid { VCT_GRID_FITTED, VCT_GRID_CUBE };
enum vct_emitters { VCT_EMITTERS_POINTS, VCT_EMITTERS_CONES };
enum vct_shadows { VCT_SHADOWS_RAYS, VCT_SHADOWS_MARCH, VCT_SHADOWS_CONES, VCT_SHADOWS_VOLUME, VCT_SHADOWS_MAP };
enum vct_detail { VCT_DETAIL_HALF, VCT_DETAIL_FULL }; // cones for every second pixel of every second row, or for all

struct vct_settings {
	struct direct_settings direct; // first: direct_settings() reads them
	uint32_t voxels; // 0: textures, the one kind there is
	uint32_t resolution; // voxels along the scene's longest axis, a power of two
	uint32_t bounces; // of light between surfaces, 0…
	uint32_t cones; // diffuse cones at least; 0: by the resolution
	uint32_t grid; // enum vct_grid
	uint32_t emitters; // enum vct_emitters
	uint32_t detail; // enum vct_detail
	uint32_t pyramid; // 1: isotropic, one value a cell
	uint32_t cover; // 1: opacities multiply, else coverage adds up
	uint32_t own; // 1: the plane that a cone starts from stays in its way
	uint32_t lambert; // 1: voxels are lit about the axes, weighted
	uint32_t shadows; // enum vct_shadows
	float shadow_aperture; // of a shadow cone, degrees
	struct vct_marching marching; // shadow_tangent unused
	uint32_t show; // VCT_SHOW_… of shaders/shared/vct_show.h: the voxels in the picture's place
	uint32_t level; // of them: 0 the voxels, n level n - 1 of the pyramid
	uint32_t axis; // of a slice: 0 x, 1 y, 2 z
	uint32_t slice; // its cell along that axis; NONE: the camera's view
};

extern const struct option_table vct_options[];

void vct_options_default(void *settings);
enum status vct_options_check(const struct plan *plan, struct error *err);

// Of a plan of this technique; the second of one that may be changed.
static inline const struct vct_settings *vct_settings(const struct plan *plan)
{
	return (const struct vct_settings *)&plan->settings;
}

static inline struct vct_settings *vct_settings_of(struct plan *plan)
{
	return (struct vct_settings *)&plan->settings;
}

#endif
