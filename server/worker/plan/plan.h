// What a job will do, decided once by plan_make (make.h). A pass runs if the technique can and the request says on, or says
// nothing and the scene calls for it. Everything after reads the plan and asks nothing again.
//
// A plan is a value: it is copied, and copies may be changed (a technique that lights voxels asks for other effects than its
// picture). It holds what all techniques share; `settings` is the technique's own struct, which nobody else looks into.
#ifndef CANDIL_WORKER_PLAN_PLAN_H
#define CANDIL_WORKER_PLAN_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "protocol/limits.h"

struct resident_scene;

// Contrast of surroundings from which on light paths begin there. Measured: tests/bench/RESULTS.md.
#define PLAN_SKY_CONTRAST 16.0

// Room for a technique's settings; each asserts that its own fit.
#define PLAN_SETTINGS_BYTES 256u

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

// The picture around the scene.
struct plan_environment {
	struct resident_scene *scene; // that it is, held by the job; NULL: there is none, and the rest is 0
	uint32_t width, height;
	double turn; // of it about +Y, in revolutions, 0 … 1
	double scale; // W/(m² sr) of its unit
	double power; // luminance summed over all directions, scaled, W/m²
	double contrast; // as in struct blob_header
};

// The technique's own settings, whatever they are.
struct plan_settings {
	_Alignas(8) unsigned char bytes[PLAN_SETTINGS_BYTES];
};

struct plan {
	candil_Technique technique; // never AUTO
	uint32_t width, height;
	uint32_t samples; // of this job
	uint32_t first_sample;
	uint64_t seed;
	double target_error; // end where the estimated relMSE is at most this; 0: never
	bool deadline; // the front may end it any time after its first sample, so that comes first, and is told at once
	uint32_t depth; // scattering events at most
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
	struct plan_settings settings;
};

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
