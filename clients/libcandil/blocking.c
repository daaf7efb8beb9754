// The blocking calls: each submits a request and waits for the event that ends it.
#include <string.h>
#include <time.h>

#include "clients/libcandil/client.h"
#include "clients/libcandil/error.h"

// Before every call: `given` says whether the pointers are there that `which` names.
static candil_status refuse(const candil_client *client, bool given, const char *which, struct candil_error *error)
{
	const candil_status status = error_if_missing(given, which, error);
	if (status != CANDIL_STATUS_OK || !request_any_audible(&client->requests))
		return status;
	return error_set(error, CANDIL_STATUS_BAD_ARGUMENT,
			 "submitted requests are open on this connection; take their events first or use another one");
}

// Wait for the next event of the one open request. An ERROR event becomes the result.
static candil_status wait_event(candil_client *client, struct candil_event *event, struct candil_error *error)
{
	int timeout_ms = client->timeout_ms == 0 ? -1 : client->timeout_ms > INT32_MAX ? INT32_MAX : (int)client->timeout_ms;
	while (!candil_next_event(client, event)) {
		candil_status status = client_wait(client, timeout_ms, error);
		if (status != CANDIL_STATUS_OK)
			return status;
	}
	if (event->kind == CANDIL_EVENT_ERROR)
		return error_set(error, event->u.error.code, "%s", event->u.error.text);
	return CANDIL_STATUS_OK;
}

candil_status candil_ping(candil_client *client, uint64_t *microseconds, struct candil_error *error)
{
	static const char payload[] = "candil";
	struct candil_event event;
	struct timespec from, to;
	uint32_t id;
	candil_status status = refuse(client, client, "the client", error);
	clock_gettime(CLOCK_MONOTONIC, &from);
	if (status == CANDIL_STATUS_OK)
		status = candil_submit_ping(client, payload, sizeof(payload), &id, error);
	if (status == CANDIL_STATUS_OK)
		status = wait_event(client, &event, error);
	if (status != CANDIL_STATUS_OK)
		return status;
	clock_gettime(CLOCK_MONOTONIC, &to);
	if (event.u.pong.bytes != sizeof(payload) || memcmp(event.u.pong.payload, payload, sizeof(payload)) != 0)
		return error_set(error, CANDIL_STATUS_IO, "the daemon answered a ping with other bytes");
	if (microseconds)
		*microseconds = (uint64_t)((to.tv_sec - from.tv_sec) * 1000000 + (to.tv_nsec - from.tv_nsec) / 1000);
	return CANDIL_STATUS_OK;
}

candil_status candil_load(candil_client *client, const struct candil_load_request *request, struct candil_scene_info *info,
			  struct candil_error *error)
{
	struct candil_event event;
	uint32_t id;
	candil_status status = refuse(client, client && request, "the client or the request", error);
	if (status == CANDIL_STATUS_OK)
		status = candil_submit_load(client, request, &id, error);
	if (status == CANDIL_STATUS_OK)
		status = wait_event(client, &event, error);
	if (status == CANDIL_STATUS_OK && info)
		*info = event.u.scene;
	return status;
}

candil_status candil_load_file(candil_client *client, const char *name, const char *file, struct candil_scene_info *info,
			       struct candil_error *error)
{
	const struct candil_load_request request = {.name = name, .file = file};
	return candil_load(client, &request, info, error);
}

candil_status candil_unload(candil_client *client, const char *name, struct candil_error *error)
{
	struct candil_event event;
	uint32_t id;
	candil_status status = refuse(client, client && name, "the client or the name", error);
	if (status == CANDIL_STATUS_OK)
		status = candil_submit_unload(client, name, &id, error);
	if (status == CANDIL_STATUS_OK)
		status = wait_event(client, &event, error);
	return status;
}

candil_status candil_scenes(candil_client *client, struct candil_scene_list *list, struct candil_error *error)
{
	struct candil_event event;
	uint32_t id;
	candil_status status = refuse(client, client && list, "the client or the list", error);
	if (status == CANDIL_STATUS_OK)
		status = candil_submit_scenes(client, &id, error);
	if (status == CANDIL_STATUS_OK)
		status = wait_event(client, &event, error);
	if (status == CANDIL_STATUS_OK)
		*list = event.u.scenes;
	return status;
}

candil_status candil_describe(candil_client *client, const char *name, struct candil_scene_info *info,
			      struct candil_error *error)
{
	struct candil_event event;
	uint32_t id;
	candil_status status = refuse(client, client && name && info, "the client, the name or the info", error);
	if (status == CANDIL_STATUS_OK)
		status = candil_submit_describe(client, name, &id, error);
	if (status == CANDIL_STATUS_OK)
		status = wait_event(client, &event, error);
	if (status == CANDIL_STATUS_OK)
		*info = event.u.scene;
	return status;
}

candil_status candil_stats(candil_client *client, struct candil_stats *stats, struct candil_error *error)
{
	struct candil_event event;
	uint32_t id;
	candil_status status = refuse(client, client && stats, "the client or the stats", error);
	if (status == CANDIL_STATUS_OK)
		status = candil_submit_stats(client, &id, error);
	if (status == CANDIL_STATUS_OK)
		status = wait_event(client, &event, error);
	if (status == CANDIL_STATUS_OK)
		*stats = event.u.stats;
	return status;
}

candil_status candil_ask_quote(candil_client *client, const struct candil_render_request *request, uint32_t pilot_ms,
			       struct candil_quote *quote, struct candil_error *error)
{
	struct candil_event event;
	uint32_t id;
	candil_status status = refuse(client, client && request && quote, "the client, the request or the quote", error);
	if (status == CANDIL_STATUS_OK)
		status = candil_submit_quote(client, request, pilot_ms, &id, error);
	if (status == CANDIL_STATUS_OK)
		status = wait_event(client, &event, error);
	if (status == CANDIL_STATUS_OK)
		*quote = event.u.quote;
	return status;
}

void candil_render_request_init(struct candil_render_request *request)
{
	if (!request)
		return;
	memset(request, 0, sizeof(*request));
	request->width = request->height = 512;
	request->samples = 64;
	request->format = CANDIL_FORMAT_EXR_FLOAT;
}

// Take one event of a render and call the caller's function. false: the caller wants the render cancelled.
static bool render_event(candil_client *client, const struct candil_event *event, const struct candil_callbacks *callbacks,
			 struct candil_render_result *result)
{
	int verdict = 0;
	switch (event->kind) {
	case CANDIL_EVENT_ACCEPTED:
		result->accepted = event->u.accepted;
		if (callbacks && callbacks->accepted)
			verdict = callbacks->accepted(callbacks->user, &event->u.accepted);
		break;
	case CANDIL_EVENT_PROGRESS:
		if (callbacks && callbacks->progress)
			verdict = callbacks->progress(callbacks->user, &event->u.progress);
		break;
	case CANDIL_EVENT_IMAGE:
		if (event->u.image.final) {
			candil_keep_image(client, &event->u.image);
			result->image = event->u.image;
		} else if (callbacks && callbacks->image) {
			verdict = callbacks->image(callbacks->user, &event->u.image);
		}
		break;
	case CANDIL_EVENT_DONE:
		result->done = event->u.done;
		break;
	default:
		break;
	}
	return verdict == 0;
}

candil_status candil_render(candil_client *client, const struct candil_render_request *request,
			    const struct candil_callbacks *callbacks, struct candil_render_result *result,
			    struct candil_error *error)
{
	struct candil_event event = {0};
	bool cancelled = false;
	uint32_t id;
	if (result)
		memset(result, 0, sizeof(*result));
	candil_status status = refuse(client, client && request && result, "the client, the request or the result", error);
	if (status == CANDIL_STATUS_OK)
		status = candil_submit_render(client, request, &id, error);
	while (status == CANDIL_STATUS_OK && !event.ends_request) {
		status = wait_event(client, &event, error);
		if (status == CANDIL_STATUS_OK && !render_event(client, &event, callbacks, result) && !cancelled) {
			cancelled = true;
			status = candil_cancel(client, id, error);
		}
	}
	// If the render was quicker than its cancel, to the caller it is cancelled all the same.
	if (status == CANDIL_STATUS_OK && cancelled)
		status = error_set(error, CANDIL_STATUS_CANCELLED, "the render was cancelled by its caller");
	if (status != CANDIL_STATUS_OK && result) {
		candil_free(result->image.data);
		result->image = (struct candil_image){0};
	}
	return status;
}

// The same for a sweep. Every image goes to the caller's function and stays the client's.
static bool sweep_event(const struct candil_event *event, const struct candil_callbacks *callbacks,
			struct candil_sweep_result *result)
{
	int verdict = 0;
	if (event->kind == CANDIL_EVENT_ACCEPTED) {
		result->accepted = event->u.accepted;
		if (callbacks && callbacks->accepted)
			verdict = callbacks->accepted(callbacks->user, &event->u.accepted);
	} else if (event->kind == CANDIL_EVENT_PROGRESS && callbacks && callbacks->progress) {
		verdict = callbacks->progress(callbacks->user, &event->u.progress);
	} else if (event->kind == CANDIL_EVENT_IMAGE && callbacks && callbacks->image) {
		verdict = callbacks->image(callbacks->user, &event->u.image);
	} else if (event->kind == CANDIL_EVENT_DONE) {
		result->done = event->u.done;
	}
	return verdict == 0;
}

candil_status candil_sweep(candil_client *client, const struct candil_render_request *request,
			   const struct candil_camera *cameras, size_t count, const struct candil_callbacks *callbacks,
			   struct candil_sweep_result *result, struct candil_error *error)
{
	struct candil_event event = {0};
	bool cancelled = false;
	uint32_t id;
	if (result)
		memset(result, 0, sizeof(*result));
	candil_status status = refuse(client, client && request && cameras && result,
				      "the client, the request, the cameras or the result", error);
	if (status == CANDIL_STATUS_OK)
		status = candil_submit_sweep(client, request, cameras, count, &id, error);
	while (status == CANDIL_STATUS_OK && !event.ends_request) {
		status = wait_event(client, &event, error);
		// A caller who has cancelled is called no more.
		if (status == CANDIL_STATUS_OK && !cancelled && !sweep_event(&event, callbacks, result)) {
			cancelled = true;
			if (!event.ends_request)
				status = candil_cancel(client, id, error);
		}
	}
	if (status == CANDIL_STATUS_OK && cancelled)
		status = error_set(error, CANDIL_STATUS_CANCELLED, "the sweep was cancelled by its caller");
	return status;
}
