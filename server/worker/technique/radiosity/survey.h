// What figures and files of a finished solution need to know of its form factors: the rows that its light reaches, and a
// report on them (factors_check.h). The matrix is kept with the scene and may have more rows, which light of other requests
// reached, so what is told of it would depend on what was asked for before. Made in slices and kept with the solution.
// Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_SURVEY_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_SURVEY_H

#include "server/worker/technique/radiosity/solution.h"

struct survey;

// Begin. `report`: with the report. The solution, which is finished and held, gets what was found once the survey is over.
// STATUS_MEMORY.
enum status survey_create(struct solution *solution, bool report, struct survey **survey, struct error *err);
void survey_destroy(struct survey *survey); // NULL is allowed

// Work for about budget_us. STATUS_MEMORY, STATUS_DEVICE.
enum status survey_step(struct survey *survey, uint32_t budget_us, struct error *err);
bool survey_finished(const struct survey *survey);

// Add the report's figures to a frame's account, if there is one.
void survey_account(const struct solution *solution, struct frame *frame);

#endif
