// An encoded image on its way to a client: announced, then sent in chunks as the connection takes them. It stays in the
// memfd that the encoder made; no more than a chunk of it is ever ours.
#ifndef CANDIL_FRONT_JOBS_IMAGE_H
#define CANDIL_FRONT_JOBS_IMAGE_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "server/front/jobs/room.h"

struct session;

struct image {
	struct room_place place; // from before it is asked for until it is gone: kept by jobs
	int fd; // sealed memfd of frame.bytes bytes; -1: none
	candil_ImageFrame frame;
	bool announced;
	uint64_t sent;
};

// An upper bound, near enough, of an encoded image's bytes.
uint64_t image_estimate(const candil_Render *render);

void image_init(struct image *image);

// Take over the memfd. There must be none.
void image_set(struct image *image, int fd, const candil_ImageFrame *frame);

bool image_waits(const struct image *image);

// Queue the announcement or the next chunk if there is room. True if something was queued. *broken: it cannot be read.
bool image_pump(struct image *image, struct session *session, uint32_t request, bool *broken);

// All is queued.
bool image_is_sent(const struct image *image);

// The place stays.
void image_close(struct image *image);

#endif
