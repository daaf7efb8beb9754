// What is done about a client's message. For the front's one thread (loop.h).
#ifndef CANDIL_FRONT_DISPATCH_H
#define CANDIL_FRONT_DISPATCH_H

#include "server/front/session.h"

struct service;

// Answer one message, or start what will answer it later. `header` and `body` (header->length bytes) stay the caller's. What
// is wrong with the message is answered, too; before a good hello it also closes the session.
void dispatch_message(struct service *service, struct session *session, const struct header *header, const uint8_t *body);

#endif
