// The options of voxel cone tracing. README says what each does. Host only, any thread.
#ifndef CANDIL_WORKER_VCT_OPTIONS_H
#define CANDIL_WORKER_VCT_OPTIONS_H

#include "server/worker/technique/direct/direct_options.h"
#include "shaders/shared/vct.h"

// The words of vct.gather, vct.grid, vct.emitters, vct.shadows and vct.detail.
enum vct_grid { VCT_GRID_FITTED, VCT_GRID_CUBE };
enum vct_emitters { VCT_EMITTERS_POINTS, VCT_EMITTERS_CONES };
enum vct_shadows { VCT_SHADOWS_RAYS, VCT_SHADOWS_MARCH, VCT_SHADOWS_CONES, VCT_SHADOWS_VOLUME, VCT_SHADOWS_MAP };
enum vct_gather { VCT_GATHER_BY_CONES, VCT_GATHER_BY_RAYS };
enum vct_detail {
	VCT_DETAIL_HALF,
	VCT_DETAIL_FULL
}; // light of its own for every second pixel of every second row, or for all

// The values of the options.
struct vct_settings {
	struct direct_settings direct; // first: direct_settings() reads them
	uint32_t voxels; // 0: textures, the only kind so far
	uint32_t resolution; // voxels along the scene's longest axis, a power of two
	uint32_t bounces; // of light between surfaces, 0…
	uint32_t cones; // the least number of diffuse cones; 0: by the resolution
	uint32_t gather; // enum vct_gather: how diffuse light is found
	uint32_t rays; // of a pixel that traces
	uint32_t grid; // enum vct_grid
	uint32_t emitters; // enum vct_emitters
	uint32_t detail; // enum vct_detail
	uint32_t pyramid; // 1: isotropic, one value a cell
	uint32_t cover; // 1: transparencies along a cone multiply; 0: coverage adds up
	uint32_t own; // 1: a cone is occluded by the plane that it starts from, too
	uint32_t lambert; // 1: voxels are lit about the axes, weighted
	uint32_t shadows; // enum vct_shadows
	float shadow_aperture; // of a shadow cone, degrees
	struct vct_marching marching; // as the shaders have it, but `step` in the cone's breadth; shadow_tangent unused
	uint32_t show; // VCT_SHOW_… of shaders/shared/vct_show.h: what to show of the voxels in place of the scene
	uint32_t level; // to show: 0 the voxels, n level n - 1 of the pyramid
	uint32_t axis; // of a slice: 0 x, 1 y, 2 z
	uint32_t slice; // its cell along that axis; NONE: the camera's view
};

// struct technique's `options`, `needs`, `defaults` and `check`.
extern const struct option_table vct_options[];
extern const struct option_need vct_needs[];
void vct_options_default(void *settings);
enum status vct_options_check(const struct plan *plan, struct error *err);

// Whether anything reads the pyramid.
bool vct_options_march(const struct plan *plan);

// Whether shadows found this way, an enum vct_shadows, come from the voxels.
bool vct_shadows_in_volume(uint32_t way);

// The settings in a plan of this technique.
static inline const struct vct_settings *vct_settings(const struct plan *plan)
{
	return (const struct vct_settings *)&plan->settings;
}

// The same, to be changed.
static inline struct vct_settings *vct_settings_of(struct plan *plan)
{
	return (struct vct_settings *)&plan->settings;
}

#endif
