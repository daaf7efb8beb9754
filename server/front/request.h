// From a body to a request that can be trusted. Each function decodes and checks one message. After STATUS_OK every number
// is finite and within its limits, every string is clean, and the defaults are filled in. Failures, each with a sentence for
// the client: STATUS_BAD_MESSAGE (the bytes are no such message), STATUS_BAD_ARGUMENT, STATUS_LIMIT, STATUS_UNSUPPORTED,
// STATUS_SCENE_PATH. The functions have no state.
#ifndef CANDIL_FRONT_REQUEST_H
#define CANDIL_FRONT_REQUEST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "candil.pb.h"
#include "server/base/error.h"

enum status request_hello(const uint8_t *body, size_t bytes, candil_Hello *hello, struct error *err);
// `path` is one of plain components then, and metres_per_unit is set.
enum status request_load(const uint8_t *body, size_t bytes, candil_Load *load, struct error *err);
enum status request_unload(const uint8_t *body, size_t bytes, candil_Unload *unload, struct error *err);
enum status request_describe(const uint8_t *body, size_t bytes, candil_Describe *describe, struct error *err);
enum status request_render(const uint8_t *body, size_t bytes, candil_Render *render, struct error *err);
enum status request_quote(const uint8_t *body, size_t bytes, candil_Quote *quote, struct error *err);

// Whether the technique of a checked Render is to be chosen.
bool request_is_open(const candil_Render *render);

// `sweep` is large: keep it off the stack. Each of its cameras is checked as a Render's; render.camera must be absent.
enum status request_sweep(const uint8_t *body, size_t bytes, candil_Sweep *sweep, struct error *err);

// A message without rules of its own, such as Ping or one without fields: nothing of it is checked but that it is one.
// `fields` are nanopb's of `message`.
enum status request_decode(const uint8_t *body, size_t bytes, const pb_msgdesc_t *fields, void *message, struct error *err);

// The checks of a Render that has been decoded.
enum status request_check_render(candil_Render *render, struct error *err);

#endif
