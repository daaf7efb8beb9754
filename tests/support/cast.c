#include "tests/support/cast.h"

#include <math.h>
#include <string.h>

#include "server/worker/trace/trace.h"
#include "server/worker/vk/command.h"
#include "shaders/cast_comp.h"

// A driver may end loops after some 65,000 rounds of an invocation; one ray each leaves far more than any walk takes.
#define RAYS_PER_DISPATCH (1u << 18)

static const struct shader cast_shader = {.name = "cast",
					  .code = shader_cast_comp,
					  .bytes = sizeof shader_cast_comp,
					  .bindings = BIND_TRACE_COUNT,
					  .texels = TRACE_TEXELS,
					  .push_bytes = 12};

enum status cast_init(struct cast *c, struct device *d, struct resident_scene *scene, const struct cast_ray *rays,
		      uint32_t count, bool packet, struct error *err)
{
	struct constants constants = {0};
	constants_set_effects(&constants, 0);
	trace_set_constants(&(struct trace){.packet = packet, .lanes = d->info.subgroup}, &constants);
	memset(c, 0, sizeof *c);
	c->device = d;
	c->count = count;
	enum status s = resident_upload(scene, d, TRACE_BINDINGS, err);
	if (s == STATUS_OK)
		s = pipeline_get(d, &cast_shader, &constants, &c->pipeline, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&c->rays, d, rays, count * sizeof *rays, err);
	if (s == STATUS_OK)
		s = buffer_init(&c->hits, d, count * sizeof(struct cast_hit), BUFFER_DEVICE, err);
	if (s == STATUS_OK) {
		const struct buffer *buffers[BIND_MOST] = {NULL};
		trace_fill_buffers(scene, buffers);
		buffers[BIND_RAYS] = &c->rays;
		buffers[BIND_HITS] = &c->hits;
		s = binding_set_init(&c->bindings, d, c->pipeline, buffers, &c->rays, err);
	}
	if (s != STATUS_OK)
		cast_finish(c);
	return s;
}

void cast_finish(struct cast *c)
{
	binding_set_finish(&c->bindings, c->device);
	buffer_finish(&c->rays, c->device);
	buffer_finish(&c->hits, c->device);
}

enum status cast_run(struct cast *c, bool any, struct error *err)
{
	struct device *d = c->device;
	enum status s = command_begin(d, err);
	if (s != STATUS_OK)
		return s;
	vkCmdBindPipeline(d->commands, VK_PIPELINE_BIND_POINT_COMPUTE, c->pipeline->handle);
	vkCmdBindDescriptorSets(d->commands, VK_PIPELINE_BIND_POINT_COMPUTE, c->pipeline->layout, 0, 1, &c->bindings.set, 0,
				NULL);
	for (uint32_t first = 0; first < c->count; first += RAYS_PER_DISPATCH) {
		const uint32_t left = c->count - first, n = left < RAYS_PER_DISPATCH ? left : RAYS_PER_DISPATCH;
		const uint32_t push[3] = {first, n, any};
		vkCmdPushConstants(d->commands, c->pipeline->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, push);
		vkCmdDispatch(d->commands, (n + 63) / 64, 1, 1);
	}
	command_barrier(d);
	return command_finish(d, err);
}

enum status cast_read(const struct cast *c, struct cast_hit *hits, struct error *err)
{
	return buffer_read(&c->hits, c->device, 0, c->count * sizeof *hits, hits, err);
}

RTCScene cast_judge(RTCDevice device, const struct blob_header *b)
{
	const struct triangle *triangles = blob_section(b, BLOB_TRIANGLES);
	const struct vertex *vertices = blob_section(b, BLOB_VERTICES);
	RTCScene scene = rtcNewScene(device);
	rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
	RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
	float *v =
	    rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, blob_count(b, BLOB_VERTICES));
	unsigned *ix =
	    rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, blob_count(b, BLOB_TRIANGLES));
	for (uint32_t i = 0; i < blob_count(b, BLOB_VERTICES); i++)
		memcpy(v + 3 * i, vertices[i].position, 12);
	for (uint32_t i = 0; i < blob_count(b, BLOB_TRIANGLES); i++)
		memcpy(ix + 3 * i, triangles[i].vertex, 12);
	rtcCommitGeometry(g);
	rtcAttachGeometry(scene, g);
	rtcReleaseGeometry(g);
	rtcCommitScene(scene);
	return scene;
}

struct RTCRayHit cast_judge_hit(RTCScene scene, const struct cast_ray *r)
{
	struct RTCIntersectContext context;
	rtcInitIntersectContext(&context);
	struct RTCRayHit h = {.ray = {.org_x = r->origin[0],
				      .org_y = r->origin[1],
				      .org_z = r->origin[2],
				      .dir_x = r->direction[0],
				      .dir_y = r->direction[1],
				      .dir_z = r->direction[2],
				      .tfar = INFINITY,
				      .mask = ~0u}};
	h.hit.geomID = RTC_INVALID_GEOMETRY_ID;
	rtcIntersect1(scene, &context, &h);
	return h;
}
