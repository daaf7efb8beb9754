// A report on the form factors of a finished solution (factors_check.h): of the rows that its light reaches, for the matrix
// is kept with the scene and may have more, which light of other requests reached. Made in slices and kept with the
// solution. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_SURVEY_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_SURVEY_H

#include "server/worker/technique/radiosity/solution.h"

struct survey;

// Begin. The solution, which is finished and held, gets the report once the survey is over. STATUS_MEMORY.
enum status survey_create(struct solution *solution, struct survey **survey, struct error *err);
void survey_destroy(struct survey *survey); // NULL is allowed

// Work for about budget_us. STATUS_MEMORY, STATUS_DEVICE.
enum status survey_step(struct survey *survey, uint32_t budget_us, struct error *err);
bool survey_finished(const struct survey *survey);

// Add the report's figures to a frame's account, if there is one.
void survey_account(const struct solution *solution, struct frame *frame);

#endif
