#include "server/worker/trace/trace.h"

// Whether the device can bind all of the tree as texel buffers.
static bool trace_fits(const struct device *d, const struct resident_scene *scene)
{
	const uint64_t most = (uint64_t)d->limits.maxTexelBufferElements * PIPELINE_TEXEL_BYTES;
	return resident_buffer(scene, BIND_NODES)->bytes <= most &&
	       resident_buffer(scene, BIND_LEAF_TRIANGLES)->bytes <= most;
}

struct trace trace_choose(const struct device *d, const struct resident_scene *scene, enum trace_way wish)
{
	const bool wanted = wish == TRACE_PACKET || (wish == TRACE_AUTO && d->info.software);
	return (struct trace){.packet = wanted && d->info.packets && trace_fits(d, scene), .lanes = d->info.subgroup};
}

void trace_set_constants(const struct trace *trace, struct constants *constants)
{
	constants_set(constants, SPEC_PACKET, trace->packet);
	constants_set(constants, SPEC_WIDTH, trace->lanes);
}

void trace_fill_buffers(const struct resident_scene *scene, const struct buffer **buffers)
{
	for (uint32_t i = 0; i < BIND_SCENE_COUNT; i++)
		buffers[i] = resident_buffer(scene, i);
	buffers[BIND_NODE_TEXELS] = buffers[BIND_NODES];
	buffers[BIND_LEAF_TEXELS] = buffers[BIND_LEAF_TRIANGLES];
}
