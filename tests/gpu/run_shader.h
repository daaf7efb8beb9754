// A compute shader by itself: one input and one output buffer at bindings 0 and 1, push constants, a count of workgroups.
#ifndef CANDIL_TESTS_RUN_SHADER_H
#define CANDIL_TESTS_RUN_SHADER_H

#include "server/worker/vk/command.h"
#include "server/worker/vk/pipeline.h"

struct shader_run {
	struct device *device;
	struct pipeline *pipeline;
	struct binding_set bindings;
	struct buffer in, out;
};

// Open the default device and make the pipeline. `shader` must bind two buffers. Exit status 77 of the program is the
// caller's matter when this returns STATUS_DEVICE.
enum status shader_run_init(struct shader_run *run, const struct shader *shader, const void *in, uint64_t in_bytes,
			    uint64_t out_bytes, struct error *err);
enum status shader_run_dispatch(struct shader_run *run, const void *push, uint32_t push_bytes, uint32_t groups,
				struct error *err);
void shader_run_finish(struct shader_run *run);

#endif
