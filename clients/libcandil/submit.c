#include "clients/libcandil/submit.h"

#include <errno.h>
#include <fcntl.h>
#include <pb_encode.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "clients/libcandil/error.h"
#include "clients/libcandil/message.h"

candil_status submit_message(candil_client *client, enum message_type type, const pb_msgdesc_t *fields, const void *message,
			     int fd, bool silent, struct request **request, struct candil_error *error)
{
	struct request *slot = request_slot(&client->requests, silent);
	if (!slot)
		return error_set(error, CANDIL_STATUS_TOO_MANY_JOBS, "%u requests are open; wait until one has ended",
				 REQUEST_OPEN_MAX);
	size_t size;
	if (!pb_get_encoded_size(&size, fields, message) || size > LIMIT_MESSAGE_BYTES)
		return error_set(error, CANDIL_STATUS_INTERNAL, "cannot encode %s", message_type_name((uint8_t)type));
	uint8_t *bytes = malloc(CANDIL_HEADER_BYTES + size);
	if (!bytes)
		return error_set(error, CANDIL_STATUS_MEMORY, "out of memory for a request");
	struct header header = {
	    .version = CANDIL_VERSION,
	    .type = (uint8_t)type,
	    .flags = fd >= 0 ? HEADER_FLAG_FD : 0,
	    .length = (uint32_t)size,
	    .request = request_new_id(&client->requests),
	};
	header_encode(&header, bytes);
	pb_ostream_t stream = pb_ostream_from_buffer(bytes + CANDIL_HEADER_BYTES, size);
	candil_status status;
	if (pb_encode(&stream, fields, message))
		status = connection_queue(&client->connection, bytes, CANDIL_HEADER_BYTES + size, fd, error);
	else
		status = error_set(error, CANDIL_STATUS_INTERNAL, "cannot encode %s: %s", message_type_name((uint8_t)type),
				   PB_GET_ERROR(&stream));
	free(bytes);
	if (status != CANDIL_STATUS_OK)
		return status;
	request_open(slot, header.request, header.type, silent);
	*request = slot;
	return CANDIL_STATUS_OK;
}

// Before every public call: no id yet, and `given` says whether the pointers are there that `which` names beside the id.
static candil_status begin(bool given, const char *which, uint32_t *id, struct candil_error *error)
{
	if (id)
		*id = 0;
	return error_if_missing(given && id, which, error);
}

// submit_message for the public calls that send no descriptor.
static candil_status submit_plain(candil_client *client, enum message_type type, const pb_msgdesc_t *fields,
				  const void *message, uint32_t *id, struct candil_error *error)
{
	struct request *request = NULL;
	candil_status status = submit_message(client, type, fields, message, -1, false, &request, error);
	*id = request ? request->id : 0;
	return status;
}

candil_status candil_submit_ping(candil_client *client, const void *payload, size_t bytes, uint32_t *id,
				 struct candil_error *error)
{
	candil_Ping ping = candil_Ping_init_zero;
	candil_status status = begin(client && (payload || bytes == 0), "the client, the payload or the id", id, error);
	if (status != CANDIL_STATUS_OK)
		return status;
	if (bytes > sizeof(ping.payload.bytes))
		return error_set(error, CANDIL_STATUS_BAD_ARGUMENT, "a ping carries at most %zu bytes",
				 sizeof(ping.payload.bytes));
	if (bytes > 0)
		memcpy(ping.payload.bytes, payload, bytes);
	ping.payload.size = (pb_size_t)bytes;
	return submit_plain(client, MESSAGE_PING, candil_Ping_fields, &ping, id, error);
}

// Open the folder of `file`, and write the name that the file has in it to `name`. Links are followed first, because the
// daemon opens only what does not lead out of the folder.
static candil_status open_folder(const char *file, char *name, size_t capacity, int *fd, struct candil_error *error)
{
	struct stat about;
	char *path = realpath(file, NULL);
	if (!path || stat(path, &about) != 0 || access(path, R_OK) != 0) {
		candil_status status =
		    error_set(error, CANDIL_STATUS_SCENE_FILE, "cannot read %s: %s", file, strerror(errno));
		free(path);
		return status;
	}
	candil_status status = CANDIL_STATUS_OK;
	char *slash = strrchr(path, '/');
	if (!S_ISREG(about.st_mode)) {
		status = error_set(error, CANDIL_STATUS_SCENE_FILE, "%s is not a file", file);
	} else if (strlen(slash + 1) >= capacity) {
		status = error_set(error, CANDIL_STATUS_BAD_ARGUMENT, "the name of %s is too long", file);
	} else {
		strcpy(name, slash + 1);
		slash[1] = '\0';
		*fd = open(path, O_PATH | O_DIRECTORY | O_CLOEXEC);
		if (*fd < 0)
			status = error_set(error, CANDIL_STATUS_SCENE_FILE, "cannot open the folder %s: %s", path,
					   strerror(errno));
	}
	free(path);
	return status;
}

candil_status candil_submit_load(candil_client *client, const struct candil_load_request *request, uint32_t *id,
				 struct candil_error *error)
{
	candil_Load load = candil_Load_init_zero;
	int fd = -1;
	candil_status status = begin(client && request, "the client, the request or the id", id, error);
	if (status == CANDIL_STATUS_OK)
		status = message_write_load(request, &load, error);
	if (status == CANDIL_STATUS_OK && request->file)
		status = open_folder(request->file, load.path, sizeof(load.path), &fd, error);
	if (status != CANDIL_STATUS_OK)
		return status;
	struct request *slot;
	status = submit_message(client, MESSAGE_LOAD, candil_Load_fields, &load, fd, false, &slot, error);
	if (status == CANDIL_STATUS_OK)
		*id = slot->id;
	else if (fd >= 0)
		close(fd);
	return status;
}

candil_status candil_submit_unload(candil_client *client, const char *name, uint32_t *id, struct candil_error *error)
{
	candil_Unload unload = candil_Unload_init_zero;
	candil_status status = begin(client && name, "the client, the name or the id", id, error);
	if (status == CANDIL_STATUS_OK)
		status = message_write_name(name, unload.name, sizeof(unload.name), error);
	if (status != CANDIL_STATUS_OK)
		return status;
	return submit_plain(client, MESSAGE_UNLOAD, candil_Unload_fields, &unload, id, error);
}

candil_status candil_submit_scenes(candil_client *client, uint32_t *id, struct candil_error *error)
{
	candil_ListScenes list = candil_ListScenes_init_zero;
	const candil_status status = begin(client, "the client or the id", id, error);
	if (status != CANDIL_STATUS_OK)
		return status;
	return submit_plain(client, MESSAGE_LIST_SCENES, candil_ListScenes_fields, &list, id, error);
}

candil_status candil_submit_describe(candil_client *client, const char *name, uint32_t *id, struct candil_error *error)
{
	candil_Describe describe = candil_Describe_init_zero;
	candil_status status = begin(client && name, "the client, the name or the id", id, error);
	if (status == CANDIL_STATUS_OK)
		status = message_write_name(name, describe.name, sizeof(describe.name), error);
	if (status != CANDIL_STATUS_OK)
		return status;
	return submit_plain(client, MESSAGE_DESCRIBE, candil_Describe_fields, &describe, id, error);
}

candil_status candil_submit_stats(candil_client *client, uint32_t *id, struct candil_error *error)
{
	candil_Stats stats = candil_Stats_init_zero;
	const candil_status status = begin(client, "the client or the id", id, error);
	if (status != CANDIL_STATUS_OK)
		return status;
	return submit_plain(client, MESSAGE_STATS, candil_Stats_fields, &stats, id, error);
}

static void expect_images(struct request *slot, const struct candil_render_request *request, uint32_t count)
{
	slot->width = request->width;
	slot->height = request->height;
	slot->format = request->format;
	slot->images = count;
}

candil_status candil_submit_render(candil_client *client, const struct candil_render_request *request, uint32_t *id,
				   struct candil_error *error)
{
	candil_Render render = candil_Render_init_zero;
	candil_status status = begin(client && request, "the client, the request or the id", id, error);
	struct request *slot;
	if (status == CANDIL_STATUS_OK)
		status = message_write_render(request, &render, error);
	if (status == CANDIL_STATUS_OK)
		status = submit_message(client, MESSAGE_RENDER, candil_Render_fields, &render, -1, false, &slot, error);
	if (status != CANDIL_STATUS_OK)
		return status;
	expect_images(slot, request, 1);
	*id = slot->id;
	return CANDIL_STATUS_OK;
}

candil_status candil_submit_sweep(candil_client *client, const struct candil_render_request *request,
				  const struct candil_camera *cameras, size_t count, uint32_t *id,
				  struct candil_error *error)
{
	candil_status status =
	    begin(client && request && cameras, "the client, the request, the cameras or the id", id, error);
	if (status != CANDIL_STATUS_OK)
		return status;
	candil_Sweep *sweep = calloc(1, sizeof(*sweep)); // too large for the stack of a thread
	struct request *slot;
	if (!sweep)
		return error_set(error, CANDIL_STATUS_MEMORY, "out of memory for a request");
	status = message_write_sweep(request, cameras, count, sweep, error);
	if (status == CANDIL_STATUS_OK)
		status = submit_message(client, MESSAGE_SWEEP, candil_Sweep_fields, sweep, -1, false, &slot, error);
	free(sweep);
	if (status != CANDIL_STATUS_OK)
		return status;
	expect_images(slot, request, (uint32_t)count);
	*id = slot->id;
	return CANDIL_STATUS_OK;
}

candil_status candil_submit_quote(candil_client *client, const struct candil_render_request *request, uint32_t pilot_ms,
				  uint32_t *id, struct candil_error *error)
{
	candil_Quote quote = {.has_render = true, .pilot_ms = pilot_ms};
	candil_status status = begin(client && request, "the client, the request or the id", id, error);
	if (status == CANDIL_STATUS_OK)
		status = message_write_render(request, &quote.render, error);
	if (status != CANDIL_STATUS_OK)
		return status;
	return submit_plain(client, MESSAGE_QUOTE, candil_Quote_fields, &quote, id, error);
}

candil_status candil_cancel(candil_client *client, uint32_t id, struct candil_error *error)
{
	candil_status status = error_if_missing(client, "the client", error);
	if (status == CANDIL_STATUS_OK && !request_any(&client->requests))
		status = connection_status(&client->connection, error);
	if (status != CANDIL_STATUS_OK)
		return status;
	struct request *render = request_find(&client->requests, id);
	if (!render || (render->type != MESSAGE_RENDER && render->type != MESSAGE_SWEEP && render->type != MESSAGE_QUOTE))
		return error_set(error, CANDIL_STATUS_NO_SUCH_REQUEST, "no render, sweep or quote %u is open", id);
	if (render->cancelled)
		return CANDIL_STATUS_OK;
	candil_Cancel cancel = {.request = id};
	struct request *slot;
	status = submit_message(client, MESSAGE_CANCEL, candil_Cancel_fields, &cancel, -1, true, &slot, error);
	render->cancelled = status == CANDIL_STATUS_OK;
	return status;
}
