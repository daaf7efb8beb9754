// What can go wrong, one number each: on the wire (Error.code), in the server and in the client library.
// Numbers are for ever; new ones go to the end of their group.
#ifndef CANDIL_PROTOCOL_STATUS_H
#define CANDIL_PROTOCOL_STATUS_H

#include <stdbool.h>

// X(NAME, number, "name-on-the-wire")
#define CANDIL_STATUS_LIST(X) \
	X(OK, 0, "ok") \
	/* 1…19: the stream itself is broken; the connection is closed after the error */ \
	X(BAD_MAGIC, 1, "bad-magic") \
	X(BAD_VERSION, 2, "bad-version") \
	X(BAD_FLAGS, 3, "bad-flags") \
	X(MESSAGE_TOO_LONG, 4, "message-too-long") \
	X(HELLO_FIRST, 5, "hello-first") \
	X(NOT_ALLOWED, 6, "not-allowed") \
	X(TOO_MANY_CONNECTIONS, 7, "too-many-connections") \
	/* 20…39: this message is wrong; the connection goes on */ \
	X(UNKNOWN_TYPE, 20, "unknown-type") \
	X(BAD_MESSAGE, 21, "bad-message") \
	X(BAD_ARGUMENT, 22, "bad-argument") \
	X(LIMIT, 23, "limit") \
	X(DUPLICATE_REQUEST, 24, "duplicate-request") \
	X(TOO_MANY_JOBS, 25, "too-many-jobs") \
	X(NO_SUCH_REQUEST, 26, "no-such-request") \
	X(UNSUPPORTED, 27, "unsupported") \
	/* 40…59: scenes */ \
	X(SCENE_NOT_FOUND, 40, "scene-not-found") \
	X(SCENE_FILE, 41, "scene-file") \
	X(SCENE_PATH, 42, "scene-path") \
	X(SCENE_INVALID, 43, "scene-invalid") \
	X(SCENE_UNSUPPORTED, 44, "scene-unsupported") \
	X(SCENE_LIMIT, 45, "scene-limit") \
	X(LOADER_LOST, 46, "loader-lost") \
	X(TOO_MANY_SCENES, 47, "too-many-scenes") \
	X(SCENE_QUARANTINED, 48, "scene-quarantined") \
	/* 60…79: the job */ \
	X(CANCELLED, 60, "cancelled") \
	X(DEADLINE, 61, "deadline") \
	X(MEMORY, 62, "memory") \
	X(DEVICE, 63, "device") \
	X(WORKER_LOST, 64, "worker-lost") \
	X(TRAVERSAL_CUT, 65, "traversal-cut") \
	X(ENCODE, 66, "encode") \
	/* 80…: this side */ \
	X(INTERNAL, 80, "internal") \
	X(SHUTTING_DOWN, 81, "shutting-down") \
	X(CONNECT, 82, "connect") \
	X(IO, 83, "io")

enum status {
#define X(name, number, wire) STATUS_##name = (number),
	CANDIL_STATUS_LIST(X)
#undef X
};

// The stable name on the wire; "unknown" for a number that is none of ours.
const char *status_name(unsigned code);

// Whether a number is one of ours.
bool status_is_known(unsigned code);

#endif
