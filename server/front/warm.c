#include "server/front/warm.h"

#include <pb_encode.h>
#include <stdio.h>
#include <string.h>

#include "protocol/names.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/front/dispatch.h"
#include "server/front/state.h"

#define WARM_SIDE 512u // pixels, as of a request that says nothing: for other sizes a software driver may compile again

// ---- a channel to nobody ---------------------------------------------------------------------------------------------

static enum status nobody_watch(struct channel *channel, loop_ready *ready, void *owner, struct error *err)
{
	(void)channel, (void)ready, (void)owner, (void)err;
	return STATUS_OK;
}

static void nobody_want(struct channel *channel, uint32_t events)
{
	(void)channel, (void)events;
}

static enum channel_result nobody_read(struct channel *channel, void *buffer, size_t room, size_t *bytes,
				       struct channel_fds *fds)
{
	(void)channel, (void)buffer, (void)room;
	*bytes = 0;
	if (fds)
		fds->count = 0;
	return CHANNEL_ENDED;
}

// A technique that cannot is told by an ERROR; the rest is of no interest.
static enum channel_result nobody_write(struct channel *channel, const void *data, size_t bytes, size_t *written)
{
	(void)channel, (void)data;
	*written = bytes;
	return CHANNEL_DONE;
}

static void nobody_end(struct channel *channel)
{
	(void)channel;
}

static bool nobody_allowed(const struct channel *channel)
{
	(void)channel;
	return true;
}

static const struct channel_kind nobody = {.watch = nobody_watch,
					   .want = nobody_want,
					   .read = nobody_read,
					   .write = nobody_write,
					   .end = nobody_end,
					   .peer_allowed = nobody_allowed,
					   .close = nobody_end};

// ---- the pictures ----------------------------------------------------------------------------------------------------

static void ask(struct service *service, const char *scene, candil_Technique technique, uint32_t request)
{
	candil_Render render = {.technique = technique, .width = WARM_SIDE, .height = WARM_SIDE, .samples = 1};
	uint8_t body[LIMIT_MESSAGE_BYTES];
	pb_ostream_t stream = pb_ostream_from_buffer(body, sizeof body);
	snprintf(render.scene, sizeof render.scene, "%s", scene);
	if (!pb_encode(&stream, candil_Render_fields, &render))
		return;
	const struct header header = {.type = MESSAGE_RENDER, .length = (uint32_t)stream.bytes_written, .request = request};
	dispatch_message(service, service->warming, &header, body);
}

// Ask for the next scene's, one scene at a time: a session has a number of places. False: there is none left.
static bool ask_next(struct service *service)
{
	const struct options *o = service->options;
	while (service->warm_next < o->scene_count && !o->scenes[service->warm_next].warm)
		service->warm_next++;
	if (service->warm_next == o->scene_count)
		return false;
	for (unsigned t = 0; t < TECHNIQUE_COUNT; t++)
		if (t != candil_Technique_TECHNIQUE_AUTO && technique_traits(t) & TECHNIQUE_RENDERS)
			ask(service, o->scenes[service->warm_next].name, (candil_Technique)t, t + 1);
	service->warm_next++;
	return true;
}

enum status warm_begin(struct service *service, struct error *err)
{
	struct channel channel = {.kind = &nobody, .loop = service->loop, .fd = -1};
	enum status status = session_create(&service->sessions, &channel, &service->warming, err);
	service->warms = status == STATUS_OK;
	if (service->warms)
		session_open(service->warming);
	return status;
}

bool warm_is_done(struct service *service)
{
	if (!service->warms || (service->warming && (service->warming->requests > 0 || ask_next(service))))
		return false;
	service->warms = false;
	if (service->warming) // it may have died for want of memory
		session_close(service->warming);
	log_line(LOG_INFO, "warm after %llu ms: %llu pictures, %llu failed",
		 (unsigned long long)(clock_us() - service->started_us) / 1000, (unsigned long long)service->jobs.done,
		 (unsigned long long)service->jobs.failed);
	return true;
}
