#include "server/front/reply.h"

#include <pb_encode.h>
#include <stdio.h>

#include "candil.pb.h"
#include "protocol/text.h"
#include "server/base/log.h"
#include "server/front/session.h"

#define REPLY_BYTES (32u * 1024u)

_Static_assert(candil_SceneInfo_size <= REPLY_BYTES, "the longest reply fits the buffer");
_Static_assert(candil_SceneList_size <= REPLY_BYTES, "the longest reply fits the buffer");
_Static_assert(candil_Accepted_size <= REPLY_BYTES, "the longest reply fits the buffer");
_Static_assert(candil_QuoteReply_size <= REPLY_BYTES, "the longest reply fits the buffer");
_Static_assert(candil_Done_size <= REPLY_BYTES, "the longest reply fits the buffer");
_Static_assert(REPLY_BYTES <= LIMIT_MESSAGE_BYTES, "no reply is longer than a message may be");

void reply_message(struct session *session, enum message_type type, uint32_t request, const pb_msgdesc_t *fields,
		   const void *message)
{
	uint8_t body[REPLY_BYTES];
	pb_ostream_t stream = pb_ostream_from_buffer(body, sizeof body);
	if (pb_encode(&stream, fields, message)) {
		session_send(session, (uint8_t)type, request, body, (uint32_t)stream.bytes_written);
		return;
	}
	log_line(LOG_ERROR, "cannot encode %s: %s", message_type_name((uint8_t)type), PB_GET_ERROR(&stream));
	struct error err;
	error_set(&err, STATUS_INTERNAL, "the reply could not be encoded");
	reply_error(session, request, &err);
}

void reply_error(struct session *session, uint32_t request, const struct error *err)
{
	candil_Error message = {.code = err->code};
	snprintf(message.name, sizeof message.name, "%s", status_name(err->code));
	snprintf(message.message, sizeof message.message, "%s", err->text);
	text_clean(message.message, sizeof message.message);
	uint8_t body[candil_Error_size];
	pb_ostream_t stream = pb_ostream_from_buffer(body, sizeof body);
	if (pb_encode(&stream, candil_Error_fields, &message))
		session_send(session, MESSAGE_ERROR, request, body, (uint32_t)stream.bytes_written);
}

void reply_ok(struct session *session, uint32_t request)
{
	session_send(session, MESSAGE_OK, request, NULL, 0);
}
