// The encoder: a thread that takes finished frames from the device's thread, encodes them, and sends each to the front as an
// IPC_IMAGE message with the file in a sealed memfd. A frame that is a file already is sent as it is. A worker has one. All
// functions are for the device's thread.
#ifndef CANDIL_WORKER_ENCODER_H
#define CANDIL_WORKER_ENCODER_H

#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/worker/image/codec.h"
#include "server/worker/image/frame.h"
#include "server/worker/image/verdict.h"

#define ENCODER_QUEUE_FRAMES 4u // waiting ones; one more is being encoded

struct encoder;

// A frame and what is to be made of it.
struct encoder_task {
	uint32_t job; // goes into the message's head
	bool final; // the job's last frame, no preview
	struct frame *frame; // the encoder's from encoder_submit on
	struct verdict_file file;
	struct verdict_about about;
	uint64_t submitted_us; // filled in by encoder_submit
};

// Start the thread. `socket`, the one to the front, stays the caller's and must outlive the encoder. `device`, the device's
// name for the reply, is copied and cut to fit. `open`, as codec_open, is called by the thread, once it is needed. *encoder
// is the caller's. STATUS_MEMORY; STATUS_INTERNAL if the thread cannot start.
enum status encoder_create(int socket, const char *device, codec_function *(*open)(struct error *err),
			   struct encoder **encoder, struct error *err);

// Open the codec if it is not, for a frame will come. Returns at once.
void encoder_prepare(struct encoder *encoder);

// Queue a frame. Blocks while ENCODER_QUEUE_FRAMES are queued, so that memory stays bounded. The encoder answers every frame
// by exactly one IPC_IMAGE, in the order of submission: with the file, or with an error.
void encoder_submit(struct encoder *encoder, const struct encoder_task *task);

// Encode and send what is queued, stop the thread, and free the encoder. NULL is allowed.
void encoder_destroy(struct encoder *encoder);

#endif
