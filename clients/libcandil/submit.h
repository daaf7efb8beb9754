// Requests on their way out.
#ifndef CANDIL_LIBCANDIL_SUBMIT_H
#define CANDIL_LIBCANDIL_SUBMIT_H

#include <pb.h>

#include "clients/libcandil/client.h"

// Encode `message`, queue it behind its header and open a slot for its replies, which *request points to. `fd` (-1: none)
// goes along and is the client's own on success. `silent`: its end is no event. Fails with TOO_MANY_JOBS, INTERNAL (it
// cannot be encoded) and as connection_queue does.
candil_status submit_message(candil_client *client, enum message_type type, const pb_msgdesc_t *fields, const void *message,
			     int fd, bool silent, struct request **request, struct candil_error *error);

#endif
