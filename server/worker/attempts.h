// Attempts at a job's picture. Without a deadline there is one, of the size that was asked for.
//
// Under a deadline the first is of a tile's pixels, spread over the whole picture. It takes about as long as a tile does, so
// there is something to show in time whatever the scene costs; and it tells what a picture of any size takes, which the
// picture's first tiles do not. From it each further attempt has as many more pixels as there is time for, up to those that
// were asked for. Pictures of fewer pixels are scaled up. Where the request wants its pixels or nothing (`whole`), there is
// one attempt here, too.
//
// Device's thread only. Functions that return enum status fill `err` on failure.
#ifndef CANDIL_WORKER_ATTEMPTS_H
#define CANDIL_WORKER_ATTEMPTS_H

#include "server/worker/image/frame.h"
#include "server/worker/plan/forecast.h"
#include "server/worker/plan/plan.h"
#include "server/worker/technique/technique.h"

// What a job has of them.
struct attempts {
	const struct technique *technique;
	struct devices *devices;
	struct resident_scene *scene;
	const struct plan *plan; // as asked
	struct technique_job *work; // the attempt under way; NULL: it is to be begun, by the next step
	struct size {
		uint32_t width, height; // pixels
	} size; // of that attempt
	bool has_sample; // it has a sample of every pixel
	bool is_last; // no other comes after it
	uint64_t spent_us; // on it
	struct {
		double pixels, us; // how many it had, and what a sample of them took; 0: there was none
	} before; // the attempt before it
	struct forecast forecasts[PLAN_FORECASTS]; // the technique's, from one attempt to the next
	double fraction; // of the work on the picture, 0…1
	struct frame *sure; // owned: what the attempt before it came to, while it has no sample itself; NULL: nothing
	struct frame_stage stages[FRAME_STAGES_MAX]; // what attempts took that are shown by none
	uint32_t stage_count;
};

// No attempt is begun. What the arguments point at must outlive `attempts`, and stay where it is.
void attempts_init(struct attempts *attempts, const struct technique *technique, struct devices *devices,
		   struct resident_scene *scene, const struct plan *plan);

// Begin the first one, as technique.h's `begin`: after STATUS_MEMORY it can be called again.
enum status attempts_begin(struct attempts *attempts, struct error *err);

// technique.h's `time_effects`. Under a deadline it tells shares alone.
enum status attempts_time_effects(struct attempts *attempts, candil_EffectReport *reports, uint32_t count,
				  struct error *err);

// technique.h's `step`. `late` may come before there is anything to read: the deadline has come while what is made of the
// scene was not there yet, or some pixel had no sample and the request wants all. Of what is scaled no error is known.
enum status attempts_step(struct attempts *attempts, uint32_t budget_us, struct step_result *result, struct error *err);

// Is there a picture to read? And has it fewer pixels than were asked for, to be scaled up?
bool attempts_ready(const struct attempts *attempts);
bool attempts_scaled(const struct attempts *attempts);

// technique.h's `read`: a picture of the size that was asked for, whatever it was made of (frame->made_width and
// made_height). There must be one. One that is of an earlier attempt can be read once.
enum status attempts_read(struct attempts *attempts, struct frame **frame, struct error *err);

// Free what is held. Zeroed is allowed.
void attempts_end(struct attempts *attempts);

#endif
