// What each effect of the path tracer costs. Its passes are one kernel, so a cost is measured by difference: a probe of the
// picture is traced with the job's effects and with one of them the other way round, in turns.
//
// It is a measurement: it has the noise of the two times that it is the difference of, so a cost may come out below zero;
// costs of effects that share work (textures and alpha masks) do not add up to the whole; and the picture without an effect
// has other paths, whose time counts too. Shares are of processor time where the device is software.
#ifndef CANDIL_WORKER_TECHNIQUE_PT_EFFECTS_H
#define CANDIL_WORKER_TECHNIQUE_PT_EFFECTS_H

#include "server/worker/technique/technique.h"

// Fill in cost_us, microseconds of the whole job, and share, of the job's time: of the effects that run and, if the plan
// says EFFECT_TIMES_ALL, of those that are left out (what they would add). Before the first step; forgets what has been
// summed. Device's thread; compiles a pipeline an effect, and takes some tenths of a second for each on a software device;
// after some seconds the rest stays unknown.
enum status pt_time_effects(struct technique_job *job, candil_EffectReport *reports, uint32_t count, struct error *err);

#endif
