// A plan: what a job will do, decided once by plan_make (make.h). An effect is simulated if the technique can and either the
// request switches it on, or the request says nothing and the scene calls for it. What runs later reads the plan alone.
//
// A plan is a value: it is copied, and copies may be changed (a technique that lights voxels wants other effects for them
// than for its picture). It holds what all techniques share. `settings` holds the technique's own struct, which no one else
// reads. Host only, any thread.
#ifndef CANDIL_WORKER_PLAN_PLAN_H
#define CANDIL_WORKER_PLAN_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "protocol/limits.h"

struct forecast; // forecast.h
struct resident_scene;

// From this contrast of the surroundings on, light paths begin there. Measured: tests/bench/RESULTS.md.
#define PLAN_SKY_CONTRAST 16.0

// Share of the time until the end that a piece of work is sized to: some tiles take several times what was forecast for them
// (forecast.h), four times here.
#define PLAN_PIECE 0.25

// The most passes of a technique that are forecast on their own.
#define PLAN_FORECASTS 12u

// Bytes for a technique's settings. Each technique asserts that its own fit.
#define PLAN_SETTINGS_BYTES 256u

// Where rays begin and go to: a pinhole, an orthographic camera or a panorama, with a lens if lens_radius > 0.
struct plan_camera {
	double eye[3]; // metres, world space
	double forward[3]; // unit
	double right[3]; // to the right, half the image plane's width long: of the plane at distance 1, or metres if
			 // orthographic
	double up[3]; // upwards, half its height long, likewise
	bool orthographic;
	bool panorama; // right and up are unit
	double lens_radius; // metres; 0: a pinhole
	double focus; // metres along `forward` to the plane in focus
};

// The environment: a picture of all directions around the scene.
struct plan_environment {
	struct resident_scene *scene; // the picture, held by the job; NULL: there is none, and the rest is 0
	uint32_t width, height; // texels
	double turn; // its rotation about +Y, in revolutions, 0 … 1
	double scale; // radiance of one of the file's units, W/(m² sr)
	double power; // scaled luminance, integrated over all directions, W/m²
	double contrast; // as in struct blob_header
};

// A file of a radiosity solution, or of form factors, that is taken in place of being made.
struct plan_imported {
	struct resident_scene *scene; // the file, held by the job; NULL: there is none, and the rest is 0
	uint64_t hash[2]; // of its content
	uint32_t elements; // sides of patches
	uint32_t entries; // of form factors
	bool factors; // it holds form factors; false: a solution
};

// The technique's own settings, whatever they are.
struct plan_settings {
	_Alignas(8) unsigned char bytes[PLAN_SETTINGS_BYTES];
};

// The plan of one job.
struct plan {
	candil_Technique technique; // never AUTO
	uint32_t width, height; // pixels
	uint32_t samples; // of a pixel, in this job
	uint32_t first_sample; // index of the first of them
	uint64_t seed;
	double target_error; // end once the estimated relMSE is at most this; 0: never
	bool deadline; // the job may be ended any time after its first sample, which is done and reported first
	uint64_t end_us; // clock_us() by which sampling has to end; 0: no matter when
	bool first_sure; // its first sample is finished whatever end_us is
	struct forecast *forecasts; // PLAN_FORECASTS: what attempts at this picture know of the technique's passes, one
				    // after the other; NULL: there is one attempt
	bool whole; // by then the picture has a sample of every pixel that was asked for, or there is none
	uint32_t depth; // the most scattering events of a path
	uint32_t effects; // bits 1 << candil_Effect of those that are simulated
	uint32_t aovs; // AOV_*
	struct plan_camera camera;
	candil_Filter filter;
	float background[3]; // radiance, W/(m² sr); black where there is an environment
	struct plan_environment environment;
	struct plan_imported imported;
	bool default_light; // the background is the neutral sky that default light is
	candil_Format format;
	candil_View view;
	double exposure_ev;
	candil_EffectReport reports[LIMIT_EFFECTS];
	uint32_t report_count;
	struct plan_settings settings;
};

// Whether the background is a colour that is not black, simulated or not.
static inline bool plan_has_colour(const struct plan *plan)
{
	return plan->background[0] > 0 || plan->background[1] > 0 || plan->background[2] > 0;
}

// Whether there is an environment that is seen and gives light.
static inline bool plan_has_sky(const struct plan *plan)
{
	return plan->environment.power > 0 && plan->effects >> candil_Effect_EFFECT_ENVIRONMENT & 1u;
}

// Whether there is one so uneven that light paths find its caustics better than chance does.
static inline bool plan_sky_casts(const struct plan *plan)
{
	return plan_has_sky(plan) && plan->environment.contrast >= PLAN_SKY_CONTRAST;
}

// Whether an effect is simulated.
static inline bool plan_has(const struct plan *plan, candil_Effect effect)
{
	return plan->effects >> effect & 1u;
}

// Whether what takes `us` microseconds ends in time if it begins at `now`, clock_us().
static inline bool plan_fits(const struct plan *plan, uint64_t now, double us)
{
	return plan->end_us == 0 || (double)now + us <= (double)plan->end_us;
}

// How much of the `us` microseconds that a slice has left its next piece is to take: near the end a part of them, since no
// forecast is exact and what it is wrong by is the less, the less is left.
static inline double plan_piece_us(const struct plan *plan, uint64_t now, double us)
{
	const double left = plan->end_us > now ? (double)(plan->end_us - now) : 0;
	return plan->end_us == 0 || PLAN_PIECE * left > us ? us : PLAN_PIECE * left;
}

#endif
