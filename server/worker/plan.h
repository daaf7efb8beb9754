// What a job will do, decided once and here. A pass runs if the technique can and the request says on, or says nothing and
// the scene calls for it. Everything after reads the plan and asks nothing again.
#ifndef CANDIL_WORKER_PLAN_H
#define CANDIL_WORKER_PLAN_H

#include "candil.pb.h"
#include "server/base/error.h"
#include "server/scene/blob.h"

struct resident_scene;

#define PLAN_DEPTH_DEFAULT 8u
#define PLAN_POINTS_DEFAULT 2u
#define PLAN_MAP_DEFAULT 1024u
#define PLAN_MAP_LEAST 256u
#define PLAN_SAMPLES_DEFAULT 64u

// Contrast of surroundings from which on light paths begin there. Measured: tests/bench/RESULTS.md.
#define PLAN_SKY_CONTRAST 16.0
#define PLAN_BATCH_MOST 256u

struct plan_camera {
	double eye[3]; // metres, world space
	double forward[3]; // unit
	double right[3]; // half the image plane's width: at distance 1, or in metres if orthographic
	double up[3]; // half its height, likewise
	bool orthographic;
	bool panorama; // right and up are unit
	double lens_radius; // metres; 0: a pinhole
	double focus; // metres along `forward` to what is sharp
};

enum plan_shadows { DIRECT_SHADOWS_RAYS, DIRECT_SHADOWS_NONE, DIRECT_SHADOWS_MAP };
enum plan_grid { VCT_GRID_FITTED, VCT_GRID_CUBE };
enum plan_emitters { VCT_EMITTERS_POINTS, VCT_EMITTERS_CONES };
enum plan_volume_shadows { VCT_SHADOWS_RAYS, VCT_SHADOWS_MARCH, VCT_SHADOWS_CONES, VCT_SHADOWS_VOLUME, VCT_SHADOWS_MAP };
enum plan_detail { VCT_DETAIL_HALF, VCT_DETAIL_FULL }; // cones for every second pixel of every second row, or for all
enum plan_effect_times { EFFECT_TIMES_OFF, EFFECT_TIMES_ON, EFFECT_TIMES_ALL };
enum plan_hemisphere { HEMISPHERE_COSINE, HEMISPHERE_UNIFORM };
enum plan_light_tree { LIGHT_TREE_AUTO, LIGHT_TREE_ON, LIGHT_TREE_OFF };
enum plan_roulette { ROULETTE_ON, ROULETTE_OFF };
enum plan_traversal { TRAVERSAL_AUTO, TRAVERSAL_SINGLE, TRAVERSAL_PACKET };

// The picture around the scene.
struct plan_environment {
	struct resident_scene *scene; // that it is, held by the job; NULL: there is none, and the rest is 0
	uint32_t width, height;
	double turn; // of it about +Y, in revolutions, 0 … 1
	double scale; // W/(m² sr) of its unit
	double power; // luminance summed over all directions, scaled, W/m²
	double contrast; // as in struct blob_header
};

struct plan {
	candil_Technique technique;
	uint32_t width, height;
	uint32_t samples; // of this job
	uint32_t first_sample;
	uint64_t seed;
	double target_error; // end where the estimated relMSE is at most this; 0: never
	bool deadline; // the front may end it any time after its first sample, so that comes first, and is told at once
	uint32_t depth; // scattering events at most
	uint32_t segment; // pt: events in one dispatch at most; 0: as the device bears
	uint32_t batch; // pt: samples in one dispatch; 0: as pays
	uint32_t effect_times; // pt: enum plan_effect_times: measure what each effect costs, first
	uint32_t traversal; // pt: enum plan_traversal
	uint32_t sampler; // pt: SAMPLER_…
	uint32_t hemisphere; // pt: enum plan_hemisphere, of diffuse directions
	uint32_t lamps; // pt: how light of surfaces is found, LAMPS_BY_… of shaders/shared/bindings.h
	uint32_t light_tree; // pt: enum plan_light_tree
	uint32_t roulette; // pt: enum plan_roulette
	float clamp; // pt: of a sample's largest component, W/(m² sr); 0: none
	uint32_t direct_points; // direct: on lamps, for a pixel's sample
	uint32_t direct_shadows; // direct: enum plan_shadows
	uint32_t direct_map; // texels of a shadow map's side
	uint32_t direct_rows; // of pixels that are worked on at once; 0: as many as the device binds
	uint32_t vct_voxels; // 0: textures, the one kind there is
	uint32_t vct_resolution; // voxels along the scene's longest axis, a power of two
	uint32_t vct_bounces; // of light between surfaces, 0…
	uint32_t vct_cones; // diffuse cones at least; 0: by the resolution
	uint32_t vct_grid; // enum plan_grid
	uint32_t vct_emitters; // enum plan_emitters
	uint32_t vct_detail; // enum plan_detail
	uint32_t vct_pyramid; // 1: isotropic, one value a cell
	uint32_t vct_cover; // 1: opacities multiply, else coverage adds up
	uint32_t vct_own; // 1: the plane that a cone starts from stays in its way
	uint32_t vct_lambert; // 1: voxels are lit about the axes, weighted
	uint32_t vct_shadows; // enum plan_volume_shadows
	float vct_shadow_aperture; // of a shadow cone, degrees
	float vct_distance; // metres along a cone at most; 0: no end
	float vct_ambient; // radiance from everywhere, W/(m² sr), dimmed by surfaces near by; 0: none
	float vct_ao; // 1/m: how soon they are no longer near
	float vct_step; // from sample to sample, of the cone's breadth
	float vct_start; // from a surface to the first sample, cells of the pyramid's finest level
	float vct_dither; // of the start
	uint32_t vct_show; // VCT_SHOW_… of shaders/shared/vct_show.h: the voxels in the picture's place
	uint32_t vct_level; // of them: 0 the voxels, n level n - 1 of the pyramid
	uint32_t vct_axis; // of a slice: 0 x, 1 y, 2 z
	uint32_t vct_slice; // its cell along that axis; NONE: the camera's view
	uint32_t effects; // bits 1 << candil_Effect: what runs
	uint32_t aovs; // AOV_*
	struct plan_camera camera;
	candil_Filter filter;
	float background[3]; // W/(m² sr); black where an environment is
	struct plan_environment environment;
	candil_Format format;
	candil_View view;
	double exposure_ev;
	candil_EffectReport reports[LIMIT_EFFECTS];
	uint32_t report_count;
};

// Plan a request over a scene, and the surroundings that it names (NULL: none), whose resident scene is left to be filled
// in. STATUS_BAD_ARGUMENT for an option or a camera that does not exist or cannot be, and for surroundings that are none.
enum status plan_make(const candil_Render *request, const struct blob_view *scene, const struct blob_header *environment,
		      struct plan *plan, struct error *err);

// Whether the picture around the scene is seen and gives light.
static inline bool plan_has_sky(const struct plan *plan)
{
	return plan->environment.power > 0 && plan->effects >> candil_Effect_EFFECT_ENVIRONMENT & 1u;
}

// Whether that is uneven enough that light paths find what polished surfaces make of it better than chance does.
static inline bool plan_sky_casts(const struct plan *plan)
{
	return plan_has_sky(plan) && plan->environment.contrast >= PLAN_SKY_CONTRAST;
}

static inline bool plan_has(const struct plan *plan, candil_Effect effect)
{
	return plan->effects >> effect & 1u;
}

#endif
