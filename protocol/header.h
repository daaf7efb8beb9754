// The 16 bytes before every message, little-endian:
//
//    0       4     5     6       8            12           16
//   +-------+-----+-----+-------+------------+------------+
//   | magic | ver | typ | flags | length     | request id |  then `length` bytes of body
//   | CNDL  | u8  | u8  | u16   | u32        | u32        |
//   +-------+-----+-----+-------+------------+------------+
//
// The body is a Protocol Buffers message of candil.proto, but for FRAME_CHUNK: raw bytes.
// A client picks request ids; every reply carries the id of its request. Id 0 is for replies to no request in particular
// (a bad header has none that can be trusted).
#ifndef CANDIL_PROTOCOL_HEADER_H
#define CANDIL_PROTOCOL_HEADER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/status.h"

#define CANDIL_HEADER_BYTES 16u
#define CANDIL_MAGIC 0x4C444E43u // "CNDL" read as little-endian
#define CANDIL_VERSION 1u // of header and messages; the only one so far

// Requests, below 0x80. X(NAME, number, the reply that ends it); ERROR may end any. The body is the message of the same name
// (of LIST_SCENES: ListScenes).
#define CANDIL_REQUEST_LIST(X) \
	X(HELLO, 0x01, HELLO_REPLY) \
	X(PING, 0x02, PONG) \
	X(LOAD, 0x03, SCENE_INFO) \
	X(UNLOAD, 0x04, OK) \
	X(LIST_SCENES, 0x05, SCENE_LIST) \
	X(DESCRIBE, 0x06, SCENE_INFO) \
	X(RENDER, 0x07, DONE) /* after ACCEPTED, PROGRESS…, (IMAGE, FRAME_CHUNK…)… */ \
	X(CANCEL, 0x08, OK) /* the cancelled request gets ERROR cancelled */ \
	X(STATS, 0x09, STATS_REPLY) \
	X(SWEEP, 0x0A, DONE) /* as RENDER */ \
	X(QUOTE, 0x0B, QUOTE_REPLY)

// Replies, from 0x80 on. X(NAME, number). The body is the message of the same name, or the one beside it.
#define CANDIL_REPLY_LIST(X) \
	X(HELLO_REPLY, 0x81) \
	X(PONG, 0x82) /* Ping, the same payload */ \
	X(SCENE_INFO, 0x83) \
	X(OK, 0x84) \
	X(SCENE_LIST, 0x85) \
	X(ACCEPTED, 0x86) \
	X(PROGRESS, 0x87) \
	X(IMAGE, 0x88) /* ImageFrame */ \
	X(FRAME_CHUNK, 0x89) /* raw bytes */ \
	X(DONE, 0x8A) \
	X(STATS_REPLY, 0x8B) \
	X(QUOTE_REPLY, 0x8C) \
	X(ERROR, 0xFF) /* ends the request whose id it bears */

enum message_type {
#define X(name, number, ...) MESSAGE_##name = (number),
	CANDIL_REQUEST_LIST(X) CANDIL_REPLY_LIST(X)
#undef X
};

enum header_flags {
	HEADER_FLAG_FD = 1u << 0, // LOAD: one descriptor (the scene's folder) comes by SCM_RIGHTS with any byte of this
				  // header; one that comes with the body is too late
};

// Extra images of a Render, bits of its `aovs`.
enum aov {
	AOV_DEPTH = 1u << 0, // Z: metres along the view axis, +infinity where nothing is hit
	AOV_NORMAL = 1u << 1, // N.X N.Y N.Z: shading normal, world space
	AOV_ALBEDO = 1u << 2, // albedo.R albedo.G albedo.B
	AOV_ID = 1u << 3, // id: material index + 1, 0 where nothing is hit
	AOV_ALL = 0xF,
};

struct header {
	uint8_t version;
	uint8_t type; // enum message_type, or a value this side does not know
	uint16_t flags;
	uint32_t length; // of the body, bytes
	uint32_t request;
};

// Write `h` as 16 bytes.
void header_encode(const struct header *h, uint8_t out[CANDIL_HEADER_BYTES]);

// Read 16 bytes. STATUS_BAD_MAGIC if they are not ours, STATUS_BAD_VERSION for a version other than CANDIL_VERSION,
// STATUS_BAD_FLAGS for a flag that is not defined, STATUS_MESSAGE_TOO_LONG for a length above LIMIT_MESSAGE_BYTES.
// `out` is filled as far as it was read in every case but bad magic.
// After any failure the stream cannot be trusted: answer, then close.
enum status header_decode(const uint8_t in[CANDIL_HEADER_BYTES], struct header *out);

// "RENDER", or "unknown".
const char *message_type_name(uint8_t type);

// The reply that ends a request of that type, unless ERROR does; 0: the type is no request's.
uint8_t message_last_reply(uint8_t request);

// Whether the type is a reply's, and one that this side knows.
bool message_is_reply(uint8_t type);

#endif
