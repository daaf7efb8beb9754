// Recording and waiting: the device's one command buffer, from begin to finish.
#ifndef CANDIL_WORKER_VK_COMMAND_H
#define CANDIL_WORKER_VK_COMMAND_H

#include "server/worker/vk/device.h"

// Start recording into device->commands.
enum status command_begin(struct device *device, struct error *err);

// What was recorded before is complete, and visible to shaders, transfers and the host, before what comes after.
void command_barrier(struct device *device);

// Stop recording, run, wait. STATUS_DEVICE if the device was lost.
enum status command_finish(struct device *device, struct error *err);

#endif
