// Replies: encode, queue on the session. A reply to a session that has ended goes nowhere.
#ifndef CANDIL_FRONT_REPLY_H
#define CANDIL_FRONT_REPLY_H

#include <pb.h>
#include <stdint.h>

#include "protocol/header.h"
#include "server/base/error.h"

struct session;

// `message` is the nanopb struct that `fields` describes.
void reply_message(struct session *session, enum message_type type, uint32_t request, const pb_msgdesc_t *fields,
		   const void *message);

// Ends the request: Error with the code, its name and the sentence.
void reply_error(struct session *session, uint32_t request, const struct error *err);

void reply_ok(struct session *session, uint32_t request);

#endif
