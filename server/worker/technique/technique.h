// The seam between the worker's loop and a way to make a picture. One const table each; the loop calls in this order, on
// the device's thread alone, for every job:
//
//   begin (step | read)* end
//
// A technique owns what it makes in `begin` until `end`; the resident scene outlives the job.
#ifndef CANDIL_WORKER_TECHNIQUE_H
#define CANDIL_WORKER_TECHNIQUE_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "server/base/error.h"

struct devices; // worker/devices.h
struct resident_scene; // worker/resident.h
struct plan; // worker/plan.h
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
	const char *name; // "pt"

	// Device memory, in bytes, that a job of this plan takes beside its scene: asked before it begins.
	uint64_t (*bytes)(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan);

	// What to ask for instead of a job that takes more than `budget` bytes: the end of a sentence,
	// TECHNIQUE_ADVICE_BYTES at most. NULL: "render smaller".
	void (*advise)(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan,
		       uint64_t budget, char *advice);

	// Make everything that the plan asks for, and nothing else. The first use of a set of effects compiles.
	enum status (*begin)(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
			     struct technique_job **job, struct error *err);

	// Fill in the costs of the effects, if the plan asks for them: between begin and the first step. NULL: cannot.
	enum status (*time_effects)(struct technique_job *job, candil_EffectReport *reports, uint32_t count,
				    struct error *err);

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

// The technique of a plan; NULL: there is none of that number.
const struct technique *technique_find(candil_Technique technique);

#endif
