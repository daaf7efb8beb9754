// An encoded image on its way to a client: announced, then sent in chunks as the session takes them. It stays in the memfd
// that the encoder made; no more than a chunk of it is ever in the front's memory.
//
// For the files of this folder alone, and for the front's one thread. Nothing fails but the reading in image_pump.
#ifndef CANDIL_FRONT_JOBS_IMAGE_H
#define CANDIL_FRONT_JOBS_IMAGE_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "server/base/estimate.h"
#include "server/front/jobs/room.h"

struct session;

struct image {
	struct room_place place; // from before it is asked for until it is gone; kept by table.c and images.c
	int fd; // owned: sealed memfd of frame.bytes bytes; -1: none
	candil_ImageFrame frame;
	struct estimate estimate; // of its error, when it was asked for
	bool announced;
	uint64_t sent; // bytes
};

// Bytes that the encoded image of a request takes, at most or nearly so: the place for it is taken before it is encoded.
uint64_t image_estimate(const candil_Render *render);

// There is none, and it has no place.
void image_init(struct image *image);

// Was it made of other pixels than it has?
bool image_is_scaled(const candil_ImageFrame *frame);

// Take over the memfd of an image that is to be sent. There must be none. The place and the
// estimate stay.
void image_set(struct image *image, int fd, const candil_ImageFrame *frame);

// Is there an image?
bool image_waits(const struct image *image);

// Queue the announcement or the next chunk of an image that waits, if the session has room for it. True if something was
// queued. *broken: the memfd cannot be read, and nothing was queued.
bool image_pump(struct image *image, struct session *session, uint32_t request, bool *broken);

// Is all of it queued?
bool image_is_sent(const struct image *image);

// Close the memfd, if there is one. The place stays.
void image_close(struct image *image);

#endif
