// What each effect of the path tracer costs. All effects are in one kernel, so a cost is measured as a difference: a probe
// of the picture is traced in turns with the job's effects and with one of them switched.
//
// A cost has the noise of the two times of which it is the difference, so it may come out negative. The costs of effects
// that share work, such as textures and alpha masks, do not add up to the whole. The picture without an effect has other
// paths, and their time counts too. Where the device is software, shares are of processor time.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_EFFECTS_H
#define CANDIL_WORKER_TECHNIQUE_PT_EFFECTS_H

#include "server/worker/technique/technique.h"

// struct technique's `time_effects`. Fill in cost_us (microseconds of the whole job) and share (of the job's time) of the
// effects that are simulated and, if the plan says EFFECT_TIMES_ALL, of those that are left out: what they would add. To be
// called before the first step, because it forgets what has been summed. It compiles a pipeline for each effect, and takes
// some tenths of a second for each on a software device. After some seconds the costs of the rest stay unknown. Fails as
// pt_job_pipeline and command_finish.
enum status pt_time_effects(struct technique_job *job, candil_EffectReport *reports, uint32_t count, struct error *err);

#endif
