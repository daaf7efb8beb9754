// Compute pipelines, made on first use and kept: a shader module with its specialization constants is made once, and again
// only if so many others were asked for since that it had to go.
#ifndef CANDIL_WORKER_VK_PIPELINE_H
#define CANDIL_WORKER_VK_PIPELINE_H

#include <stddef.h>

#include "server/worker/vk/buffer.h"
#include "server/worker/vk/device.h"
#include "shaders/shared/bindings.h"

#define PIPELINE_TEXEL_BYTES 16u
#define PIPELINE_CONSTANTS_MAX 64u

// Specialization constants of a pipeline, in the order in which they were set. Equal ones in another order are others.
struct constants {
	uint32_t count;
	struct {
		uint32_t id, value;
	} of[PIPELINE_CONSTANTS_MAX];
};

// Add one. More than PIPELINE_CONSTANTS_MAX are not kept, and pipeline_get refuses them.
void constants_set(struct constants *constants, uint32_t id, uint32_t value);

// Add the effects of a plan (bits 1 << effect), a constant each: effects.glsl.
void constants_set_effects(struct constants *constants, uint32_t effects);

struct shader {
	const char *name; // unique: the key with the constants
	const uint32_t *code; // SPIR-V
	size_t bytes;
	uint32_t bindings; // storage buffers 0 … bindings - 1 of set 0; at most BIND_MOST
	uint32_t texels; // bits 1 << binding: those that are uniform texel buffers instead, four 32-bit words a texel
	uint32_t push_bytes; // of push constants
};

struct pipeline {
	struct pipeline *next;
	const struct shader *shader;
	struct constants constants;
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

// The pipeline of `shader` with these constants; NULL: none. Owned by the device: it may be gone after the next call unless
// a binding set has been made for it. STATUS_INTERNAL for a shader that has more bindings or constants than there is room
// for.
enum status pipeline_get(struct device *device, const struct shader *shader, const struct constants *constants,
			 struct pipeline **pipeline, struct error *err);

// Wait until the device is idle and destroy all that it keeps, before the device itself. No binding set may be left. A
// device that could not be opened is allowed.
void pipeline_destroy_all(struct device *device);

// `buffers`, as many as the shader has bindings, by their number. A NULL handle binds `filler` instead: a buffer that the
// shader's specialization never touches.
struct binding_set {
	struct pipeline *pipeline; // kept for as long
	VkDescriptorPool pool;
	VkDescriptorSet set;
	VkBufferView views[BIND_TEXELS_MOST]; // of the texel buffers
};
enum status binding_set_init(struct binding_set *set, struct device *device, struct pipeline *pipeline,
			     const struct buffer *const *buffers, const struct buffer *filler, struct error *err);
void binding_set_finish(struct binding_set *set, struct device *device);

#endif
