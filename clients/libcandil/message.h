// Between the generated messages and the plain structures of candil_types.h.
#ifndef CANDIL_LIBCANDIL_MESSAGE_H
#define CANDIL_LIBCANDIL_MESSAGE_H

#include "candil.pb.h"
#include "clients/libcandil/candil.h"

// Decode the body of a reply into the event, all but its id. false: the bytes are no message of that type.
bool message_read_event(uint8_t type, const uint8_t *body, size_t bytes, struct candil_event *event);
bool message_read_image(const uint8_t *body, size_t bytes, candil_ImageFrame *frame);
struct candil_verdict message_read_verdict(const candil_Verdict *from); // each share brought within 0 to 1
bool message_read_server(const uint8_t *body, size_t bytes, struct candil_server *server);

// Fill in a message, which must be all default. Fails with BAD_ARGUMENT (a string is missing or too long) and LIMIT (a list
// is too long).
candil_status message_write_load(const struct candil_load_request *request, candil_Load *load, struct candil_error *error);
candil_status message_write_render(const struct candil_render_request *request, candil_Render *render,
				   struct candil_error *error);
candil_status message_write_sweep(const struct candil_render_request *request, const struct candil_camera *cameras,
				  size_t count, candil_Sweep *sweep, struct candil_error *error);
candil_status message_write_name(const char *name, char *out, size_t capacity, struct candil_error *error);

#endif
