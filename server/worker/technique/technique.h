// The seam between the worker and a way to make a picture. One const table each, in a folder of its own; techniques.c lists
// them. A job goes through a table in this order, on the device's thread alone:
//
//   plan_make: defaults, (options), check, depth, cannot and simulates, settle      no device is touched
//   serve:     bytes, begin, time_effects, notes, (step | read)*, end
//
// A technique owns its options with their defaults, what it cannot do, and what it makes in `begin` until `end`; the
// resident scene outlives the job. To add one: its folder, a line in protocol/names.h and candil.proto, techniques.c, the
// build's lists of files, README.
//
// Example: what can be asked of every technique without a device
//	for (uint32_t i = 0; i < technique_count(); i++) {
//		const struct technique *t = technique_at(i);
//		struct plan plan = {.technique = t->number};
//		t->defaults(plan.settings);
//		assert(technique_find(t->number) == t && t->depth(&plan) > 0);
//	}
//	assert(technique_find(candil_Technique_TECHNIQUE_AUTO)->number == (candil_Technique)TECHNIQUE_OF_AUTO);
//
// Example: a whole job over `scene`, which resident_acquire gave us
//	candil_Render request = {.technique = candil_Technique_TECHNIQUE_PT, .width = 8, .height = 8, .samples = 2};
//	struct plan plan;
//	struct error err;
//	assert(plan_make(&request, &scene->view, NULL, &plan, &err) == STATUS_OK);
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
#include "server/worker/plan/option.h"

struct devices; // worker/devices.h
struct resident_scene; // worker/scenes/resident.h
struct plan; // worker/plan/plan.h
struct frame; // worker/image/frame.h
struct technique_job; // the technique's own, opaque to the loop

#define TECHNIQUE_ADVICE_BYTES 96u

struct step_result {
	uint32_t samples_done; // complete samples of every pixel
	bool finished;
	bool reached; // it ended at its target error
	double estimated_relmse; // negative: unknown
	double fraction; // of all the job's work, 0…1
};

// Nothing is done, and the error is unknown.
#define STEP_RESULT_NOTHING ((struct step_result){.estimated_relmse = -1})

struct technique {
	candil_Technique number; // protocol/names.h has its name

	// ---- planning ----

	// The options that it takes, ended by a table without rules; they fill in plan->settings.
	const struct option_table *options;

	// Fill in the settings of a request without options. `settings` is zeroed, PLAN_SETTINGS_BYTES long.
	void (*defaults)(void *settings);

	// Whether what all options say together can be. STATUS_BAD_ARGUMENT if not. NULL: always.
	enum status (*check)(const struct plan *plan, struct error *err);

	// Scattering events of a path at most, by the settings: 1 is light straight from its source.
	uint32_t (*depth)(const struct plan *plan);

	// Why it cannot do an effect: a sentence without a full stop, static; "": as if the effect were switched off, and
	// others can; NULL: it can. A function that is NULL: it can do all.
	const char *(*cannot)(const struct plan *plan, candil_Effect effect);

	// Why it simulates an effect that is called for, where names.h does not say it right. NULL, or returning NULL: it
	// does.
	const char *(*simulates)(const struct plan *plan, candil_Effect effect);

	// A last word on plan->effects. `allowed`: bits of the effects that the request does not switch off. NULL: none.
	void (*settle)(struct plan *plan, uint32_t allowed);

	// ---- a job ----

	// Device memory, in bytes, that a job of this plan takes beside its scene: asked before it begins.
	uint64_t (*bytes)(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan);

	// What to ask for instead of a job that takes more than `budget` bytes: the end of a sentence, of
	// TECHNIQUE_ADVICE_BYTES at most. `advice` comes as "render smaller" and may stay so. NULL: it does.
	void (*advise)(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan,
		       uint64_t budget, char *advice);

	// Make everything that the plan asks for, and nothing else. The first use of a set of effects compiles. On failure
	// nothing is left; STATUS_MEMORY: it is called again if room can be made.
	enum status (*begin)(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
			     struct technique_job **job, struct error *err);

	// Fill in the costs of the effects, if the settings ask for them: between begin and the first step. NULL: cannot.
	enum status (*time_effects)(struct technique_job *job, candil_EffectReport *reports, uint32_t count,
				    struct error *err);

	// Add sentences to accepted->notes, on what of the scene and the plan may surprise: technique_note. NULL: nothing.
	void (*notes)(const struct resident_scene *scene, const struct plan *plan, candil_Accepted *accepted);

	// Work for about budget_us of device time, at least one indivisible piece. Calls continue where the last one
	// stopped. *result comes as STEP_RESULT_NOTHING; what is known is filled in. After STATUS_MEMORY too, if more of it
	// has become free.
	enum status (*step)(struct technique_job *job, uint32_t budget_us, struct step_result *result, struct error *err);

	// Copy what has been accumulated into `frame` (host memory, made by this call, freed by the caller with
	// frame_destroy). The job can go on afterwards: a preview is a read before the end.
	enum status (*read)(struct technique_job *job, struct frame **frame, struct error *err);

	// Free the job. NULL is allowed.
	void (*end)(struct technique_job *job);
};

// The techniques of this worker, in the order in which sentences name them. `i` is below the count.
uint32_t technique_count(void);
const struct technique *technique_at(uint32_t i);

// The technique of a number, AUTO's what it stands for; NULL: this worker has none of that number.
const struct technique *technique_find(candil_Technique number);

#endif
