// The 16 bytes before every message, little-endian:
//
//    0       4     5     6       8            12           16
//   +-------+-----+-----+-------+------------+------------+
//   | magic | ver | typ | flags | length     | request id |  then `length` bytes of body
//   | CNDL  | u8  | u8  | u16   | u32        | u32        |
//   +-------+-----+-----+-------+------------+------------+
//
// The body is a Protocol Buffers message of candil.proto (the table below names it), but for FRAME_CHUNK: raw bytes.
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

// Requests are below 0x80, replies from 0x80 on.
enum message_type {
	MESSAGE_HELLO = 0x01, // Hello        -> HELLO_REPLY
	MESSAGE_PING = 0x02, // Ping         -> PONG
	MESSAGE_LOAD = 0x03, // Load         -> SCENE_INFO
	MESSAGE_UNLOAD = 0x04, // Unload       -> OK
	MESSAGE_LIST_SCENES = 0x05, // ListScenes   -> SCENE_LIST
	MESSAGE_DESCRIBE = 0x06, // Describe     -> SCENE_INFO
	MESSAGE_RENDER = 0x07, // Render       -> ACCEPTED, PROGRESS…, (IMAGE, FRAME_CHUNK…)…, DONE
	MESSAGE_CANCEL = 0x08, // Cancel       -> OK; the cancelled request gets ERROR cancelled
	MESSAGE_STATS = 0x09, // Stats        -> STATS_REPLY
	MESSAGE_SWEEP = 0x0A, // Sweep        -> ACCEPTED, PROGRESS…, (IMAGE, FRAME_CHUNK…)…, DONE

	MESSAGE_HELLO_REPLY = 0x81,
	MESSAGE_PONG = 0x82, // Ping, the same payload
	MESSAGE_SCENE_INFO = 0x83,
	MESSAGE_OK = 0x84, // Ok
	MESSAGE_SCENE_LIST = 0x85,
	MESSAGE_ACCEPTED = 0x86,
	MESSAGE_PROGRESS = 0x87,
	MESSAGE_IMAGE = 0x88, // ImageFrame
	MESSAGE_FRAME_CHUNK = 0x89, // raw bytes
	MESSAGE_DONE = 0x8A,
	MESSAGE_STATS_REPLY = 0x8B,
	MESSAGE_ERROR = 0xFF, // Error; ends the request whose id it bears
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

#endif
