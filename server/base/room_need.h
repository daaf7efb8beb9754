// Refusals for want of address space (room.h), with what a process of ours has been seen to take: without them it would
// crash in a library that takes memory for granted, and the device, the driver or the scene would get the blame.
#ifndef CANDIL_BASE_ROOM_NEED_H
#define CANDIL_BASE_ROOM_NEED_H

#include <stdint.h>

#include "server/base/error.h"

// Measured with Mesa's drivers; what others take is not known. Each thread of a software driver has a stack and an arena of
// malloc's.
#define ROOM_DRIVERS_BYTES (448ull << 20) // all drivers of Vulkan linked, and their devices listed
#define ROOM_DEVICE_BYTES (768ull << 20) // then a software device, the codec and a first picture
#define ROOM_DEVICE_THREAD_BYTES (64ull << 20) // more for each processor that this process may use
#define ROOM_DEVICE_THREADS 32u // at most
#define ROOM_GL_BYTES (512ull << 20) // OpenGL beside it
#define ROOM_WORK_BYTES (256ull << 20) // a driver's compiler, beside what a job has on the device

// STATUS_MEMORY, with a sentence that says what to do, if so many bytes are not left for `what`.
enum status room_need(uint64_t bytes, const char *what, struct error *err);

// The same for a software device.
enum status room_need_device(struct error *err);

#endif
