// Ctrl-C and SIGTERM, taken only while waiting, so that none is lost between a check and a wait. The second one ends the
// program at once.
#ifndef CANDIL_CLI_INTERRUPT_H
#define CANDIL_CLI_INTERRUPT_H

#include <stdbool.h>

#include "clients/libcandil/candil.h"

// From now on the two signals are held back but in interrupt_wait. interrupt_end: as they were before.
void interrupt_begin(void);
void interrupt_end(void);

bool interrupt_seen(void);

// Sleep for so long, or until an interrupt.
void interrupt_pause(long milliseconds);

// Wait for the client's next event. true: it is filled in. false: an interrupt came first (only the first one is reported
// that way), or *status is not OK: the connection is over.
bool interrupt_wait(candil_client *client, struct candil_event *event, candil_status *status, struct candil_error *error);

#endif
