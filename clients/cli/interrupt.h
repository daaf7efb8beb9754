// Interrupts: Ctrl-C (SIGINT), SIGTERM and SIGHUP. They are taken only while the program waits, so that none is lost between
// a check and a wait. The second one ends the program at once.
#ifndef CANDIL_CLI_INTERRUPT_H
#define CANDIL_CLI_INTERRUPT_H

#include <poll.h>
#include <stdbool.h>

#include "clients/libcandil/candil.h"

// From interrupt_begin on the signals are held back, except in interrupt_wait, interrupt_pause and interrupt_poll.
// A reader that goes away (SIGPIPE) fails the write instead of ending the program. interrupt_end restores what was before.
void interrupt_begin(void);
void interrupt_end(void);

// Whether an interrupt has come since interrupt_begin.
bool interrupt_seen(void);

// Sleep for that long, or until an interrupt.
void interrupt_pause(long milliseconds);

// poll, which an interrupt ends, too: with EINTR.
int interrupt_poll(struct pollfd *fds, nfds_t count, long milliseconds);

// Wait for the client's next event. true: *event is filled in. false: the first interrupt came before it, or *status is not
// CANDIL_STATUS_OK and the connection is over.
bool interrupt_wait(candil_client *client, struct candil_event *event, candil_status *status, struct candil_error *error);

#endif
