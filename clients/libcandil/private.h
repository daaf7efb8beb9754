// Inside libcandil. What arrives stays in one fixed buffer until candil_next_event takes it apart, so a daemon that talks
// more than its client listens fills that buffer and then its own socket: nothing here grows but the one image that each
// render is receiving, and its size is bounded by what was asked for.
#ifndef CANDIL_LIBCANDIL_PRIVATE_H
#define CANDIL_LIBCANDIL_PRIVATE_H

#include "candil.pb.h"
#include "clients/libcandil/candil.h"
#include "protocol/header.h"
#include "protocol/limits.h"

#define OPEN_REQUESTS 64u // that a caller can have; as many slots again for their cancels
#define IN_BYTES (4u * (CANDIL_HEADER_BYTES + LIMIT_MESSAGE_BYTES))
#define OUT_BYTES_MAX (1024u * 1024u) // unsent requests
#define OUT_FDS_MAX 16u
#define HELLO_TIMEOUT_MS 10000

// The image that a render is receiving.
struct assembly {
	bool receiving;
	candil_ImageFrame frame;
	uint8_t *data;
	size_t filled, capacity;
};

struct request {
	uint32_t id; // 0: the slot is free
	uint8_t type; // enum message_type
	bool silent; // a cancel or the hello: its end is no event
	bool cancelled; // a cancel has been sent
	uint32_t width, height; // of a render
	enum candil_format format;
	uint32_t images, finished; // final images that are due, that have come
	struct assembly image;
};

struct candil_client {
	int fd;
	uint32_t timeout_ms;
	uint32_t last_id;
	struct request requests[2u * OPEN_REQUESTS];

	uint8_t in[IN_BYTES];
	size_t in_start, in_end; // what has arrived and was not taken
	bool eof; // nothing more will arrive

	uint8_t *out;
	size_t out_start, out_end, out_capacity;
	struct {
		size_t at; // goes along with the byte at this place of `out`
		int fd;
	} out_fds[OUT_FDS_MAX];
	uint32_t out_fd_count;

	struct candil_error broken; // why the connection is over; code OK while it is not
	uint8_t *event_image; // bytes of the last IMAGE event
	bool greeted;
	struct candil_server server;
};

// ---- client.c ----
// Fill `error` (may be NULL) and return `code`.
candil_status client_fail(struct candil_error *error, candil_status code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
// End the connection for this reason, unless it is over already.
void client_break(candil_client *client, candil_status code, const char *format, ...) __attribute__((format(printf, 3, 4)));
// Append to the unsent bytes. `fd` (-1: none) goes along with the first byte and is owned by the client on success.
candil_status client_queue(candil_client *client, const void *bytes, size_t count, int fd, struct candil_error *error);
// Wait until the socket is ready, then candil_process. The timeout counts from the last byte. STATUS_IO on timeout.
candil_status client_wait(candil_client *client, int timeout_ms, struct candil_error *error);

// ---- request.c ----
struct request *request_find(candil_client *client, uint32_t id);
void request_close(struct request *request);
bool request_any_open(const candil_client *client);
// Encode `message`, queue it behind its header and open a slot for its replies.
candil_status request_submit(candil_client *client, enum message_type type, const pb_msgdesc_t *fields, const void *message,
			     int fd, bool silent, struct request **request, struct candil_error *error);

// ---- message.c ----
// Decode the body of a reply into the event. false: the bytes are no such message.
bool message_read_event(uint8_t type, const uint8_t *body, size_t bytes, struct candil_event *event);
bool message_read_image(const uint8_t *body, size_t bytes, candil_ImageFrame *frame);
bool message_read_server(const uint8_t *body, size_t bytes, struct candil_server *server);
// Fill in messages; BAD_ARGUMENT for strings that are missing or too long.
candil_status message_write_load(const struct candil_load_request *request, candil_Load *load, struct candil_error *error);
candil_status message_write_render(const struct candil_render_request *request, candil_Render *render,
				   struct candil_error *error);
candil_status message_write_sweep(const struct candil_render_request *request, const struct candil_camera *cameras,
				  size_t count, candil_Sweep *sweep, struct candil_error *error);
candil_status message_write_name(const char *name, char *out, size_t capacity, struct candil_error *error);

// ---- text.c ----
// Copy a string of the daemon's: always terminated, valid UTF-8, without control characters (a terminal may show it).
void text_copy(char *out, size_t capacity, const char *in);

#endif
