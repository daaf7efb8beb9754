// Values of a light at corners (corners.h), made in slices. Host only, any thread; several may be made of the same corners.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_CORNER_VALUES_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_CORNER_VALUES_H

#include "server/worker/technique/radiosity/corners.h"

struct corner_values;

// Begin, once the corners are finished. `out` gets 4 times 3 floats for each element, from 3 floats for each element in
// `irradiance`. `reached` is a byte for each element, or NULL: light reaches all. All of them must outlive it.
// STATUS_MEMORY.
enum status corner_values_create(const struct corners *corners, const float *irradiance, const uint8_t *reached, float *out,
				 struct corner_values **values, struct error *err);
void corner_values_destroy(struct corner_values *values); // NULL is allowed

// Work for about budget_us, at least one piece. What comes out does not depend on the budgets.
void corner_values_step(struct corner_values *values, uint32_t budget_us);
bool corner_values_finished(const struct corner_values *values);

#endif
