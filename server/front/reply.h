// Replies: encode a message and queue it on the session. For the front's one thread (loop.h).
//
// None of these fails as far as the caller is concerned. A reply to a session that has ended goes nowhere, and a session
// without memory for it dies (session.h). Nothing of what is passed is kept.
#ifndef CANDIL_FRONT_REPLY_H
#define CANDIL_FRONT_REPLY_H

#include <pb.h>
#include <stdint.h>

#include "protocol/header.h"
#include "server/base/error.h"

struct session;

// Queue a message of `type` to the request `request` (0: to none). `message` is the nanopb struct that `fields` describes;
// its strings must be clean (protocol/text.h). One that cannot be encoded becomes ERROR `internal`.
void reply_message(struct session *session, enum message_type type, uint32_t request, const pb_msgdesc_t *fields,
		   const void *message);

// Queue ERROR with the code of `err`, its name and its sentence, which is cleaned. For the client this ends the request.
void reply_error(struct session *session, uint32_t request, const struct error *err);

// Queue OK.
void reply_ok(struct session *session, uint32_t request);

#endif
