// Compute pipelines, made at their first use and kept by the device. A shader with a set of specialization constants is
// compiled once, and again only if so many others were asked for since that it had to go. Device's thread only.
#ifndef CANDIL_WORKER_VK_PIPELINE_H
#define CANDIL_WORKER_VK_PIPELINE_H

#include <stddef.h>

#include "server/worker/vk/buffer.h"
#include "server/worker/vk/device.h"
#include "shaders/shared/bindings.h"

#define PIPELINE_TEXEL_BYTES 16u // of a texel of every texel buffer
#define PIPELINE_CONSTANTS_MAX 64u

// Specialization constants of a pipeline, in the order in which they were set. The same constants in another order count as
// different ones. Zeroed: none.
struct constants {
	uint32_t count;
	struct {
		uint32_t id, value;
	} of[PIPELINE_CONSTANTS_MAX];
};

// Add a constant. What is beyond PIPELINE_CONSTANTS_MAX is not kept, and pipeline_get then fails.
void constants_set(struct constants *constants, uint32_t id, uint32_t value);

// Add the effects of a plan (bits 1 << candil_Effect), one constant each: effects.glsl.
void constants_set_effects(struct constants *constants, uint32_t effects);

// A compute shader and what it binds: a static constant of whoever dispatches it. Its address and the constants are the key
// of a pipeline.
struct shader {
	const char *name; // for messages
	const uint32_t *code; // SPIR-V
	size_t bytes;
	uint32_t bindings; // storage buffers 0 … bindings - 1 of set 0; at most BIND_MOST
	uint32_t texels; // bits 1 << binding: those that are uniform texel buffers instead, of four 32-bit words a texel
	uint32_t push_bytes; // of push constants
};

// A compiled pipeline, for reading.
struct pipeline {
	struct pipeline *next;
	const struct shader *shader;
	struct constants constants;
	VkDescriptorSetLayout set_layout;
	VkPipelineLayout layout;
	VkPipeline handle;
	uint32_t users; // binding sets made for it
	uint64_t used; // device->pipeline_turn when it was last asked for
	uint64_t piece; // of the list of code
	bool warm; // it has run once: some drivers compile at the first dispatch
};

// The most pipelines that are kept, because requests can ask for very many, and one takes 3 MiB of a software driver.
// Beyond it the one unused for longest is destroyed, but never one that has a binding set. Made again it costs a fifth of a
// second: the driver has its code on disk.
#define PIPELINES_MAX 48u

// The pipeline of `shader` with these constants (NULL: none), compiled if it is not kept, which may take seconds. It is the
// device's: the next call may destroy it unless a binding set has been made for it. STATUS_INTERNAL if the shader has more
// bindings or constants than there is room for, or where device->code refuses to compile it now; STATUS_MEMORY,
// STATUS_DEVICE.
enum status pipeline_get(struct device *device, const struct shader *shader, const struct constants *constants,
			 struct pipeline **pipeline, struct error *err);

// The pipeline has run once, and so is compiled whatever the driver: device->code learns of it.
void pipeline_has_run(struct device *device, struct pipeline *pipeline);

// Wait until the device is idle and destroy all pipelines that it keeps. To be called before device_destroy, without any
// binding set left. A device whose opening failed half-way is allowed.
void pipeline_destroy_all(struct device *device);

// Buffers bound for one pipeline: its descriptor set. Its holder's, who finishes it. The buffers must outlive it.
struct binding_set {
	struct pipeline *pipeline; // kept while the set lives
	VkDescriptorPool pool;
	VkDescriptorSet set;
	VkBufferView views[BIND_TEXELS_MOST]; // of the texel buffers
};

// Bind `buffers`, by binding, as many as the shader has. Where one is NULL or has no handle, `filler` is bound, for a
// binding that the shader's specialization never reads. On failure (STATUS_MEMORY, STATUS_DEVICE) nothing is left.
enum status binding_set_init(struct binding_set *set, struct device *device, struct pipeline *pipeline,
			     const struct buffer *const *buffers, const struct buffer *filler, struct error *err);

// Free the set; its pipeline may then go. A zeroed one is fine.
void binding_set_finish(struct binding_set *set, struct device *device);

#endif
