// Compute pipelines, made on first use and kept: a shader module with its specialization constants is made once, and again
// only if so many others were asked for since that it had to go.
#ifndef CANDIL_WORKER_VK_PIPELINE_H
#define CANDIL_WORKER_VK_PIPELINE_H

#include <stddef.h>

#include "server/worker/vk/buffer.h"
#include "server/worker/vk/device.h"

#define PIPELINE_BINDINGS_MAX 26u
#define PIPELINE_TEXELS_MAX 3u
#define PIPELINE_TEXEL_BYTES 16u
#define PIPELINE_CONSTANTS_MAX 32u

struct shader {
	const char *name; // unique: the key with the constants
	const uint32_t *code; // SPIR-V
	size_t bytes;
	uint32_t bindings; // storage buffers 0 … bindings - 1 of set 0
	uint32_t texels; // bits 1 << binding: those that are uniform texel buffers instead, four 32-bit words a texel
	uint32_t push_bytes; // of push constants
};

struct pipeline {
	struct pipeline *next;
	const struct shader *shader;
	uint32_t constants[PIPELINE_CONSTANTS_MAX];
	uint32_t constant_count;
	VkDescriptorSetLayout set_layout;
	VkPipelineLayout layout;
	VkPipeline handle;
	uint32_t users; // binding sets for it
	uint64_t used; // when it was last asked for, in turns of the device
	bool warm; // has run once: drivers compile at the first dispatch
};

// Pipelines of different constants that are kept; beyond that the one unused for longest goes, for requests can ask for very
// many. None goes that has a binding set.
#define PIPELINES_MAX 192u

// The pipeline of `shader` with specialization constants 0 … count - 1. Owned by the device: it may be gone after the next
// call unless a binding set has been made for it.
enum status pipeline_get(struct device *device, const struct shader *shader, const uint32_t *constants, uint32_t count,
			 struct pipeline **pipeline, struct error *err);
void pipeline_destroy_all(struct device *device);

// Buffers for a pipeline, in the order of its bindings. A NULL handle binds `filler` instead: a buffer that the shader's
// specialization never touches.
struct binding_set {
	struct pipeline *pipeline; // kept for as long
	VkDescriptorPool pool;
	VkDescriptorSet set;
	VkBufferView views[PIPELINE_TEXELS_MAX]; // of the texel buffers
};
enum status binding_set_init(struct binding_set *set, struct device *device, struct pipeline *pipeline,
			     const struct buffer *const *buffers, const struct buffer *filler, struct error *err);
void binding_set_finish(struct binding_set *set, struct device *device);

#endif
