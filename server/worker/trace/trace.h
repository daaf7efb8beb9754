// The one way to trace rays on Vulkan: which traversal of a scene's BVH a device uses, and which buffers and specialization
// constants a pipeline that traces rays needs for it. Shaders trace through shaders/trace/traverse.glsl and do not know
// which traversal runs. Device's thread only. Nothing here fails or allocates.
//
// There are two traversals. Single: each lane walks the tree by itself. Packet: the lanes of a subgroup walk it together
// with one stack, which is faster where lanes are the elements of a CPU's vector. Both find the same hits, so a picture's
// bits do not depend on the traversal.
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

// What a request may wish for (pt.traversal). AUTO: packet on software devices, single on others.
enum trace_way { TRACE_AUTO, TRACE_SINGLE, TRACE_PACKET };

// Bindings (bits 1 << BIND_…) of the resident scene that every pass which traces needs, on Vulkan and on OpenGL.
#define TRACE_BINDINGS (1u << BIND_NODES | 1u << BIND_LEAF_TRIANGLES)

// Texel buffers of such a pass on Vulkan: goes into struct shader's `texels`.
#define TRACE_TEXELS (1u << BIND_NODE_TEXELS | 1u << BIND_LEAF_TEXELS)

// A traversal that was chosen. A value: copied freely.
struct trace {
	bool packet; // false: single
	uint32_t lanes; // of the device's subgroups
};

// Choose the traversal for a device and a scene whose TRACE_BINDINGS have been uploaded. A wish for packets is not granted
// where the device has no subgroups of a fitting width or the tree is larger than its largest texel buffer.
struct trace trace_choose(const struct device *device, const struct resident_scene *scene, enum trace_way wish);

// Add the two specialization constants that make the shader this traversal: SPEC_PACKET and SPEC_WIDTH.
void trace_set_constants(const struct trace *trace, struct constants *constants);

// Fill in the scene's buffers for binding_set_init, by binding, the tree a second time as texel buffers. `buffers` has
// BIND_MOST places; those of other bindings are left as they are. The buffers stay the scene's.
void trace_fill_buffers(const struct resident_scene *scene, const struct buffer **buffers);

#endif
