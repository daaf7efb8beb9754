// Takes what has arrived apart, message by message, and puts images together from their chunks. Nothing of it can be
// trusted: a reply that its request cannot have ends the connection, and a reply to no open request is passed over.
#include <stdlib.h>
#include <string.h>

#include "clients/libcandil/client.h"
#include "clients/libcandil/message.h"
#include "protocol/limits.h"
#include "protocol/names.h"

// The most that an image file of these dimensions can have: the colour and every AOV as floats are 44 bytes a pixel, and a
// file has headers.
static uint64_t image_bytes_max(const struct request *request)
{
	if (!format_is_picture((unsigned)request->format))
		return LIMIT_PATCH_FILE_BYTES;
	return (uint64_t)request->width * request->height * 64u + (4u << 20);
}

static void protocol_error(candil_client *client, const struct header *header, const char *what)
{
	connection_break(&client->connection, CANDIL_STATUS_IO,
			 "the daemon broke the protocol: %s (%s, %u bytes, request %u)", what,
			 message_type_name(header->type), header->length, header->request);
}

// Whether a request of this type may get that reply.
static bool reply_fits(uint8_t request, uint8_t reply)
{
	const uint8_t last = message_last_reply(request);
	if (reply == MESSAGE_ERROR || reply == last)
		return true;
	// What DONE ends comes in pieces.
	return last == MESSAGE_DONE && (reply == MESSAGE_ACCEPTED || reply == MESSAGE_PROGRESS || reply == MESSAGE_IMAGE ||
					reply == MESSAGE_FRAME_CHUNK);
}

static void image_begin(candil_client *client, struct request *request, const struct header *header, const uint8_t *body)
{
	struct assembly *image = &request->image;
	candil_ImageFrame frame = candil_ImageFrame_init_zero;
	if (!message_read_image(body, header->length, &frame))
		protocol_error(client, header, "the message cannot be decoded");
	else if (image->receiving || request->finished == request->images || frame.index != request->finished)
		protocol_error(client, header, "an image begins out of turn");
	else if (frame.width != request->width || frame.height != request->height ||
		 (int)frame.format != (int)request->format)
		protocol_error(client, header, "an image of another size or format than was asked for");
	else if (frame.bytes == 0 || frame.bytes > image_bytes_max(request))
		protocol_error(client, header, "an image of an impossible length");
	if (client->connection.broken.code != CANDIL_STATUS_OK)
		return;
	image->frame = frame;
	image->receiving = true;
	image->filled = 0;
}

// Make room for what has arrived, not for what was announced: a daemon may announce more than it sends.
static bool image_reserve(struct assembly *image, size_t needed)
{
	if (needed <= image->capacity)
		return true;
	size_t capacity = image->capacity ? image->capacity : 64u * 1024u;
	while (capacity < needed)
		capacity *= 2;
	if (capacity > image->frame.bytes)
		capacity = (size_t)image->frame.bytes;
	uint8_t *bigger = realloc(image->data, capacity);
	if (!bigger)
		return false;
	image->data = bigger;
	image->capacity = capacity;
	return true;
}

// Add a chunk. true: the image is whole, and the event is filled in.
static bool image_append(candil_client *client, struct request *request, const struct header *header, const uint8_t *body,
			 struct candil_event *event)
{
	struct assembly *image = &request->image;
	if (!image->receiving || header->length > image->frame.bytes - image->filled) {
		protocol_error(client, header, "more image bytes than were announced");
		return false;
	}
	if (!image_reserve(image, image->filled + header->length)) {
		connection_break(&client->connection, CANDIL_STATUS_MEMORY,
				 "out of memory for an image of %llu bytes: free some, or raise a limit (ulimit -v)",
				 (unsigned long long)image->frame.bytes);
		return false;
	}
	if (header->length > 0)
		memcpy(image->data + image->filled, body, header->length);
	image->filled += header->length;
	if (image->filled < image->frame.bytes)
		return false;
	event->kind = CANDIL_EVENT_IMAGE;
	event->ends_request = false;
	event->u.image = (struct candil_image){
	    .data = image->data,
	    .bytes = image->filled,
	    .format = (enum candil_format)image->frame.format,
	    .width = image->frame.width,
	    .height = image->frame.height,
	    .made_width = image->frame.made_width,
	    .made_height = image->frame.made_height,
	    .samples = image->frame.samples,
	    .final = image->frame.final,
	    .index = image->frame.index,
	    .verdict = message_read_verdict(&image->frame.verdict),
	};
	client->event_image = image->data;
	request->finished += image->frame.final;
	image->data = NULL;
	image->filled = image->capacity = 0;
	image->receiving = false;
	return true;
}

static void take_hello(candil_client *client, struct request *request, const struct header *header, const uint8_t *body)
{
	if (!message_read_server(body, header->length, &client->server))
		protocol_error(client, header, "the message cannot be decoded");
	else if (client->server.version != CANDIL_VERSION)
		connection_break(&client->connection, CANDIL_STATUS_BAD_VERSION,
				 "the daemon speaks version %u, this library %u", client->server.version, CANDIL_VERSION);
	else
		client->greeted = true;
	request_close(request);
}

// Take one reply to an open request. true: the event is filled in.
static bool take_reply(candil_client *client, struct request *request, const struct header *header, const uint8_t *body,
		       struct candil_event *event)
{
	event->id = header->request;
	if (!reply_fits(request->type, header->type)) {
		protocol_error(client, header, "a reply that does not fit its request");
		return false;
	}
	if (header->type == MESSAGE_HELLO_REPLY) {
		take_hello(client, request, header, body);
		return false;
	}
	if (header->type == MESSAGE_IMAGE) {
		image_begin(client, request, header, body);
		return false;
	}
	if (header->type == MESSAGE_FRAME_CHUNK)
		return image_append(client, request, header, body, event);
	if (!message_read_event(header->type, body, header->length, event)) {
		protocol_error(client, header, "the message cannot be decoded");
		return false;
	}
	if (header->type == MESSAGE_DONE && request->finished < request->images) {
		protocol_error(client, header, "a render or sweep ends without all its images");
		return false;
	}
	bool silent = request->silent;
	if (request->type == MESSAGE_HELLO)
		connection_break(&client->connection, event->u.error.code, "%s", event->u.error.text);
	if (event->ends_request)
		request_close(request);
	return !silent;
}

// Take an error under id 0, which belongs to no request: the daemon is about to close the connection.
static void take_farewell(candil_client *client, const struct header *header, const uint8_t *body,
			  struct candil_event *event)
{
	if (message_read_event(MESSAGE_ERROR, body, header->length, event))
		connection_break(&client->connection, event->u.error.code, "%s", event->u.error.text);
	else
		protocol_error(client, header, "the message cannot be decoded");
}

// Once the connection is over, every open request ends with an ERROR event that says why. false: none is open that the
// caller made.
static bool next_failure(candil_client *client, struct candil_event *event)
{
	struct request *request;
	while ((request = request_any(&client->requests))) {
		const bool silent = request->silent;
		event->kind = CANDIL_EVENT_ERROR;
		event->id = request->id;
		event->ends_request = true;
		event->u.error = client->connection.broken;
		request_close(request);
		if (!silent)
			return true;
	}
	return false;
}

bool candil_next_event(candil_client *client, struct candil_event *event)
{
	if (!client || !event)
		return false;
	free(client->event_image);
	client->event_image = NULL;
	memset(event, 0, sizeof(*event));
	struct header header;
	const uint8_t *body;
	while (connection_next(&client->connection, &header, &body)) {
		struct request *request = request_find(&client->requests, header.request);
		if (request && message_is_reply(header.type)) {
			if (take_reply(client, request, &header, body, event))
				return true;
		} else if (header.type == MESSAGE_ERROR && header.request == 0) {
			take_farewell(client, &header, body, event);
		}
	}
	return client->connection.broken.code != CANDIL_STATUS_OK && next_failure(client, event);
}

void candil_keep_image(candil_client *client, const struct candil_image *image)
{
	if (client && image && client->event_image == image->data)
		client->event_image = NULL;
}

void candil_free(const void *data)
{
	free((void *)(uintptr_t)data);
}
