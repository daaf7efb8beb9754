// What goes with a picture beside its pixels: the words in its file, the account of its time, and what the verdict on it
// must know. On the device's thread; nothing here fails.
#ifndef CANDIL_WORKER_CAPTION_H
#define CANDIL_WORKER_CAPTION_H

#include <stdbool.h>
#include <stdint.h>

#include "server/worker/image/verdict.h"

struct devices;
struct frame;
struct job;

// Add the words for the file: how the frame of a job came to be, and what was asked for.
void caption_metadata(const struct devices *devices, const struct job *job, struct frame *frame);

// Add the stages that the technique does not know of the time that was spent on its job, of which `read_us` on this frame.
// What has no name in the end is told, too.
void caption_stages(struct job *job, uint64_t read_us, bool final, struct frame *frame);

// What the verdict on a job's picture must know of its scene and plan.
struct verdict_about caption_about(const struct job *job);

#endif
