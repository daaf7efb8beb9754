// The one door to rays: how a device walks a scene's tree, and what a Vulkan pipeline that traces rays has to bind and to be
// told for it. Shaders go through shaders/trace/traverse.glsl and know nothing of the way. Device's thread only.
//
// Ways: single, each lane walks for itself; packet, the lanes of a subgroup share one stack, which pays where a lane is a
// part of a CPU's vector. Both find the same hits: a picture's bits do not depend on the way.
//
// Example: a pipeline of a shader that traces through `scene`, from resident_acquire, on `device`
//	struct constants constants = {0};
//	const struct buffer *buffers[BIND_MOST] = {NULL};
//	struct error err;
//	assert(resident_upload(scene, device, TRACE_BINDINGS, &err) == STATUS_OK);
//	const struct trace trace = trace_choose(device, scene, TRACE_AUTO);
//	trace_set_constants(&trace, &constants);
//	trace_fill_buffers(scene, buffers);
//	assert(constants.count == 2 && buffers[BIND_NODES]->handle);
//	assert(buffers[BIND_NODE_TEXELS] == buffers[BIND_NODES]);
#ifndef CANDIL_WORKER_TRACE_TRACE_H
#define CANDIL_WORKER_TRACE_TRACE_H

#include "server/worker/scenes/resident.h"
#include "server/worker/vk/pipeline.h"

enum trace_way { TRACE_AUTO, TRACE_SINGLE, TRACE_PACKET };

// Bindings (bits 1 << BIND_…) that a pass which traces needs of the resident scene, whatever the way and the API.
#define TRACE_BINDINGS (1u << BIND_NODES | 1u << BIND_LEAF_TRIANGLES)

// Of struct shader's `texels`.
#define TRACE_TEXELS (1u << BIND_NODE_TEXELS | 1u << BIND_LEAF_TEXELS)

struct trace {
	bool packet;
	uint32_t lanes; // of a packet
};

// The way for a device and a scene whose TRACE_BINDINGS are on it. A wish that the device or the size of the tree does not
// allow is not granted.
struct trace trace_choose(const struct device *device, const struct resident_scene *scene, enum trace_way wish);

// The shader's variant: two constants.
void trace_set_constants(const struct trace *trace, struct constants *constants);

// All that is the scene's, and the tree once more as texels: for binding_set_init, the rest is the caller's. `buffers` has
// BIND_MOST places.
void trace_fill_buffers(const struct resident_scene *scene, const struct buffer **buffers);

#endif
