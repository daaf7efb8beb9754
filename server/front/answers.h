// What a worker says, held to what the front relies on: one that was taken over may have written any byte. Counts are within
// bounds, numbers that are told are finite; strings, which go to clients, are cleaned, and so are truths.
//
// For the front alone; any thread. False: it is nonsense.
#ifndef CANDIL_FRONT_ANSWERS_H
#define CANDIL_FRONT_ANSWERS_H

#include <stdbool.h>

#include "server/base/ipc.h"

void answer_ready_clean(struct ipc_ready *ready);
bool answer_begun_holds(struct ipc_begun *begun);
void answer_stepped_clean(struct ipc_stepped *stepped);
bool answer_piloted_holds(struct ipc_piloted *piloted);
bool answer_image_holds(struct ipc_image *image);

#endif
