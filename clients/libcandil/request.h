// The requests of one connection that wait for their replies.
#ifndef CANDIL_LIBCANDIL_REQUEST_H
#define CANDIL_LIBCANDIL_REQUEST_H

#include "candil.pb.h"
#include "clients/libcandil/candil.h"
#include "protocol/header.h"

#define REQUEST_OPEN_MAX 64u // that a caller can have; as many slots again for their cancels

// The image that a render is receiving. Its bytes grow with what has arrived, and are bounded by what was asked for.
struct assembly {
	bool receiving;
	candil_ImageFrame frame;
	uint8_t *data; // the request's own
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

struct request_table {
	struct request slots[2u * REQUEST_OPEN_MAX];
	uint32_t last_id;
};

// The open request of that id; NULL: there is none.
struct request *request_find(struct request_table *table, uint32_t id);

// Any open request; NULL: there is none.
struct request *request_any(struct request_table *table);

// Whether a request is open whose end is an event.
bool request_any_audible(const struct request_table *table);

// A free slot; NULL: as many requests are open as one caller can have.
struct request *request_slot(struct request_table *table, bool silent);

// An id that is not 0 and not in use.
uint32_t request_new_id(struct request_table *table);

// Fill a free slot.
void request_open(struct request *slot, uint32_t id, uint8_t type, bool silent);

// Free the slot and the image that it was receiving.
void request_close(struct request *request);

// Free every slot.
void request_close_all(struct request_table *table);

#endif
