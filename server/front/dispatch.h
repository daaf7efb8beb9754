// A client's message and what is done about it.
#ifndef CANDIL_FRONT_DISPATCH_H
#define CANDIL_FRONT_DISPATCH_H

#include "server/front/session.h"

struct service;

// Answer one message, or start what will answer it.
void dispatch_message(struct service *service, struct session *session, const struct header *header, const uint8_t *body);

#endif
