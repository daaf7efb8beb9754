// The seam between the worker and its techniques. A technique is one way to make a picture: a const table of functions, in a
// folder of its own; techniques.c lists the tables. A job calls a table in this order, on the device's thread alone:
//
//   plan_make: defaults, (options), check, depth, cannot and simulates, settle      no device is touched
//   serve:     bytes, begin, time_effects, notes, (step | read)*, end
//
// A technique owns its options with their defaults, the list of what it cannot do, and what `begin` makes, until `end`. The
// resident scene outlives the job. Functions that return enum status fill `err` on failure; STATUS_DEVICE from any of them
// that gets a job or `devices` means that the device failed. To add a technique: its folder, a line in protocol/names.h and
// in candil.proto, techniques.c, README.
//
// Example: what can be asked of every technique without a device
//	for (uint32_t i = 0; i < technique_count(); i++) {
//		const struct technique *t = technique_at(i);
//		struct plan plan = {.technique = t->number};
//		t->defaults(&plan.settings);
//		assert(technique_find(t->number) == t && t->depth(&plan) > 0);
//	}
//	assert(technique_find(candil_Technique_TECHNIQUE_AUTO)->number == (candil_Technique)TECHNIQUE_OF_AUTO);
//
// Example: a whole job over `scene`, which resident_acquire gave us
//	candil_Render request = {.technique = candil_Technique_TECHNIQUE_PT, .width = 8, .height = 8, .samples = 2};
//	struct plan plan;
//	struct error err;
//	assert(plan_make(&request, &scene->view, NULL, NULL, &plan, &err) == STATUS_OK);
//
//	const struct technique *t = technique_find(plan.technique);
//	struct technique_job *job;
//	assert(t->begin(devices, scene, &plan, &job, &err) == STATUS_OK);
//	struct step_result result;
//	do {
//		result = STEP_RESULT_NOTHING;
//		assert(t->step(job, 50000, &result, &err) == STATUS_OK);
//	} while (!result.finished);
//
//	struct frame *frame;
//	assert(t->read(job, &frame, &err) == STATUS_OK && frame->samples == 2);
//	frame_destroy(frame);
//	t->end(job);
#ifndef CANDIL_WORKER_TECHNIQUE_H
#define CANDIL_WORKER_TECHNIQUE_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "server/base/error.h"
#include "server/base/estimate.h"
#include "server/worker/plan/needs.h"
#include "server/worker/plan/option.h"

struct devices; // worker/devices.h
struct resident_scene; // worker/scenes/resident.h
struct plan; // worker/plan/plan.h
struct frame; // worker/image/frame.h
struct work; // base/work.h
struct technique_job; // the technique's own, opaque to the loop

// Bytes of `advise`'s sentence, its end included.
#define TECHNIQUE_ADVICE_BYTES 96u

// Where a job stands after a step.
struct step_result {
	uint32_t samples_done; // complete samples of every pixel
	bool finished; // no step is left to do
	bool reached; // finished, because the upper end of the error fell to plan->target_error
	bool late; // no more work fits before plan->end_us
	bool drawing; // what is made of the scene is there, and work on the picture has begun
	double sample_us; // work that a sample of every pixel takes, by those so far; 0: not known
	struct estimate estimate; // of the picture so far
	double fraction; // of all the job's work, 0…1
};

// A step that has done nothing, with an unknown error.
#define STEP_RESULT_NOTHING ((struct step_result){.estimate = ESTIMATE_UNKNOWN})

// The table. A function that may be NULL says what NULL means.
struct technique {
	candil_Technique number; // protocol/names.h has its name

	// ---- planning ----

	// The options that it takes: option tables that fill in plan->settings, ended by one without rules.
	const struct option_table *options;

	// Fill in the settings of a request without options. `settings` is plan->settings: PLAN_SETTINGS_BYTES, zeroed.
	void (*defaults)(void *settings);

	// Refuse options that contradict each other: STATUS_BAD_ARGUMENT. plan->settings holds all of them; of the rest of
	// the plan only what is copied from the request is set. NULL: any combination is fine.
	enum status (*check)(const struct plan *plan, struct error *err);

	// What options need of others to do anything, ended by one without an option. What is given in vain is told in a
	// note. NULL: every option does something.
	const struct option_need *needs;

	// The most scattering events of a path from camera to light, by the settings. 1: direct light alone.
	uint32_t (*depth)(const struct plan *plan);

	// What it can simulate: bits 1 << candil_Effect. An effect that is not among them is drawn as if it were switched
	// off, and the reply names the techniques that can.
	uint32_t effects;

	// The files that are no pictures and that it can make instead: bits 1 << candil_Format. A job whose plan->format is
	// one of them makes it in its steps, within LIMIT_PATCH_FILE_BYTES or STATUS_LIMIT, with what to ask for, and `read`
	// gives a frame of it (frame_create_file), once, at the end.
	uint32_t files;

	// Why it cannot simulate an effect by this plan: a static sentence without a full stop. NULL: `effects` decides. If
	// the function is NULL, `effects` always decides.
	const char *(*cannot)(const struct plan *plan, candil_Effect effect);

	// Why it simulates an effect, where the words of names.h do not fit: a static sentence without a full stop. NULL:
	// the words of names.h. If the function is NULL, they fit every effect.
	const char *(*simulates)(const struct plan *plan, candil_Effect effect);

	// A background is seen by the camera, and lights no surface, unless it is default light.
	bool sky_is_seen_alone;

	// On a software driver its code is another for pictures whose sides are powers of two, or whose halves are
	// (server/base/side.h).
	bool sides_are_code;

	// Change plan->effects once all of them are decided. `allowed`: bits 1 << candil_Effect of those that the request
	// does not switch off. NULL: nothing to change.
	void (*settle)(struct plan *plan, uint32_t allowed);

	// ---- a job ----

	// An estimate of the device memory that a job of this plan takes beside its scene, in bytes. Asked before `begin`,
	// and more than once: what takes long to find out is kept with the scene (resident_derive).
	uint64_t (*bytes)(const struct devices *devices, struct resident_scene *scene, const struct plan *plan);

	// What to ask for in place of a job that takes more than `budget` bytes: the end of a sentence, in
	// TECHNIQUE_ADVICE_BYTES. `advice` holds "render smaller" before the call, which may stay. NULL: it stays.
	void (*advise)(const struct devices *devices, struct resident_scene *scene, const struct plan *plan, uint64_t budget,
		       char *advice);

	// Tell in *work what is still to be made once for the scene before a picture of this plan, and what its pictures'
	// times depend on. With a budget some of it is tried out for about so long, beside compiling: what that took is
	// told, and nothing of it is kept. Asked without a job. NULL: there is no such work, or nothing is known of it.
	enum status (*foresee)(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
			       uint32_t budget_us, struct work *work, struct error *err);

	// Make everything that the plan asks for, and nothing else. *job is the caller's, who frees it with `end`. The first
	// use of a set of effects compiles shaders, which may take seconds. On failure nothing is left. After STATUS_MEMORY
	// the caller makes room, if it can, and calls again.
	enum status (*begin)(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
			     struct technique_job **job, struct error *err);

	// Measure what the effects cost and fill it into their `reports`, if the settings ask for it. Called between `begin`
	// and the first step. NULL: it cannot measure.
	enum status (*time_effects)(struct technique_job *job, candil_EffectReport *reports, uint32_t count,
				    struct error *err);

	// Add to accepted->notes, by technique_note, what of the scene and the plan may surprise. NULL: nothing does.
	void (*notes)(const struct resident_scene *scene, const struct plan *plan, candil_Accepted *accepted);

	// Work for about budget_us of device time, at least one indivisible piece. Each call continues where the last one
	// stopped. *result is STEP_RESULT_NOTHING before the call; what is known is filled in. After STATUS_MEMORY the
	// caller may make room and call again.
	enum status (*step)(struct technique_job *job, uint32_t budget_us, struct step_result *result, struct error *err);

	// Make a frame in host memory of the samples so far, or if not all pixels have one, of those that do
	// (frame->ahead). *frame is the caller's, who frees it with frame_destroy. The
	// job can go on afterwards: a preview is a read before the end.
	enum status (*read)(struct technique_job *job, struct frame **frame, struct error *err);

	// Free the job, finished or not. NULL is allowed.
	void (*end)(struct technique_job *job);
};

// The number of techniques of this worker.
uint32_t technique_count(void);

// The technique at place `i`, which is below the count, in the order in which sentences name them.
const struct technique *technique_at(uint32_t i);

// The technique of a number; for AUTO, the one that it stands for. NULL: this worker has none of that number.
const struct technique *technique_find(candil_Technique number);

#endif
