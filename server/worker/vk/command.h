// Recording and running: the device has one command buffer, which is recorded from command_begin to command_finish.
// Device's thread only; recordings do not nest.
#ifndef CANDIL_WORKER_VK_COMMAND_H
#define CANDIL_WORKER_VK_COMMAND_H

#include "server/worker/vk/device.h"

// Start recording into device->commands. STATUS_MEMORY, STATUS_DEVICE.
enum status command_begin(struct device *device, struct error *err);

// Record a barrier: writes of shaders and transfers recorded before it are complete, and visible to shaders, transfers and
// the host, before what is recorded after it runs.
void command_barrier(struct device *device);

// Stop recording, run what was recorded, and wait until it is done. STATUS_MEMORY; STATUS_DEVICE, with device->lost set if
// the driver says that the device is lost.
enum status command_finish(struct device *device, struct error *err);

#endif
