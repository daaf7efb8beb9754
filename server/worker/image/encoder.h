// The encoder's thread: takes finished frames off the device's thread, encodes them and sends each to the front as an
// IPC_IMAGE message with the file in a sealed memfd. One a worker.
#ifndef CANDIL_WORKER_ENCODER_H
#define CANDIL_WORKER_ENCODER_H

#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/worker/image/codec.h"
#include "server/worker/image/frame.h"

#define ENCODER_QUEUE_FRAMES 4u // waiting ones; one more is being encoded

struct encoder;

struct encoder_task {
	uint32_t job; // goes into the message's head
	bool final;
	struct frame *frame; // the encoder's from encoder_submit on
	enum codec_format format;
	enum codec_view view; // of a PNG
	double exposure_ev; // of a PNG
};

// Start the thread. `socket` (the line to the front) stays the caller's and must outlive the encoder; `device` is copied,
// cut to fit. STATUS_MEMORY or STATUS_INTERNAL if it cannot start.
enum status encoder_create(int socket, const char *device, struct encoder **encoder, struct error *err);

// Queue a frame; waits while ENCODER_QUEUE_FRAMES are queued, so that memory stays bounded. Every submitted frame is
// answered by exactly one IPC_IMAGE, in the order of submission: with the file, or with an error. From the device's thread.
void encoder_submit(struct encoder *encoder, const struct encoder_task *task);

// Finish what is queued, stop the thread, free. NULL is allowed.
void encoder_destroy(struct encoder *encoder);

#endif
