// A daemon that the test plays itself: it writes replies into the other end of the library's socket pair, before the library
// reads. Request ids count up from the hello, which is 1. Every helper fails the running test where something goes wrong.
#ifndef CANDIL_TESTS_CLI_FAKE_SERVER_H
#define CANDIL_TESTS_CLI_FAKE_SERVER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "candil.pb.h"
#include "clients/libcandil/candil.h"
#include "protocol/header.h"
#include "protocol/limits.h"

struct fake {
	int peer; // -1 once the test has closed it
	candil_client *client;
};

// Bytes as they are.
void put(int fd, const void *bytes, size_t count);
// Write header and body to `out`; returns their length.
size_t frame(uint8_t *out, enum message_type type, uint32_t id, const void *body, size_t bytes);
void put_raw(int fd, enum message_type type, uint32_t id, const void *body, size_t bytes);
size_t encode(uint8_t *out, size_t capacity, const pb_msgdesc_t *fields, const void *message);
void put_message(int fd, enum message_type type, uint32_t id, const pb_msgdesc_t *fields, const void *message);
void put_error(int fd, uint32_t id, uint32_t code, const char *text);
// The announcement of a square image.
void put_image(int fd, uint32_t id, uint32_t side, uint64_t bytes, bool final);
void put_done(int fd, uint32_t id);
// Drop what the client sent; returns how many bytes that was.
size_t drain(int fd);
// A client that has shaken hands.
struct fake start(void);
void stop(struct fake *f);
uint32_t submit_render(candil_client *client, uint32_t side);
// The next event, which must be there or arrive with what was sent already.
struct candil_event expect(struct fake *f, enum candil_event_kind kind, uint32_t id);
// A pattern that repeats late.
void fill(uint8_t *bytes, size_t count, unsigned seed);

#endif
