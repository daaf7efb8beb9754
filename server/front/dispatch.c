#include "server/front/dispatch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/front/reply.h"
#include "server/front/request.h"
#include "server/front/state.h"

struct message {
	struct service *service;
	struct session *session;
	const struct header *header;
	const uint8_t *body;
};

// A handler answers the message itself, or fails, and `err` is the answer.
typedef enum status handler(const struct message *m, struct error *err);

static enum status decode(const struct message *m, const pb_msgdesc_t *fields, void *message, struct error *err)
{
	return request_decode(m->body, m->header->length, fields, message, err);
}

static enum status on_hello(const struct message *m, struct error *err)
{
	candil_Hello hello;
	if (m->session->state != SESSION_GREETING)
		return error_set(err, STATUS_BAD_MESSAGE, "hello has been said");
	enum status status = request_hello(m->body, m->header->length, &hello, err);
	if (status != STATUS_OK)
		return status;
	if (hello.version_min > CANDIL_VERSION || hello.version_max < CANDIL_VERSION)
		return error_set(err, STATUS_BAD_VERSION, "this daemon speaks version %u: use a client that does",
				 CANDIL_VERSION);
	session_open(m->session);
	log_line(LOG_DEBUG, "connection %llu: hello from \"%s\"", (unsigned long long)m->session->id, hello.client);
	candil_HelloReply reply = {.version = CANDIL_VERSION,
				   .server = "candild " CANDIL_VERSION_STRING,
				   .max_message_bytes = LIMIT_MESSAGE_BYTES,
				   .max_pixels = LIMIT_PIXELS,
				   .max_samples_times_pixels = LIMIT_SAMPLES_TIMES_PIXELS,
				   .max_jobs_per_connection = LIMIT_JOBS_PER_CONNECTION};
	reply_message(m->session, MESSAGE_HELLO_REPLY, m->header->request, candil_HelloReply_fields, &reply);
	return STATUS_OK;
}

static enum status on_ping(const struct message *m, struct error *err)
{
	candil_Ping ping;
	enum status status = decode(m, candil_Ping_fields, &ping, err);
	if (status == STATUS_OK)
		reply_message(m->session, MESSAGE_PONG, m->header->request, candil_Ping_fields, &ping);
	return status;
}

// May the message start a request that lives on after it? Such a request needs an id, and the connection has a number of
// places.
static enum status check_place(const struct message *m, struct error *err)
{
	if (m->header->request == 0)
		return error_set(err, STATUS_BAD_ARGUMENT, "request id 0 is for replies to no request: choose another");
	if (m->session->requests >= LIMIT_JOBS_PER_CONNECTION)
		return error_set(err, STATUS_TOO_MANY_JOBS, "this connection has %u requests under way: wait for one to end",
				 LIMIT_JOBS_PER_CONNECTION);
	return STATUS_OK;
}

static enum status find_source(const struct message *m, const char *path, struct source *source, struct error *err)
{
	if (!(m->header->flags & HEADER_FLAG_FD))
		return source_beneath(source, m->service->scene_root, path, err);
	int folder = reader_claim_fd(&m->session->reader);
	if (folder < 0)
		return error_set(err, STATUS_BAD_MESSAGE, "flag FD is set but no descriptor came with the header");
	return source_given(source, folder, path, err);
}

static enum status on_load(const struct message *m, struct error *err)
{
	candil_Load load;
	struct source source;
	enum status status = check_place(m, err);
	if (status == STATUS_OK)
		status = request_load(m->body, m->header->length, &load, err);
	if (status == STATUS_OK)
		status = find_source(m, load.path, &source, err);
	if (status == STATUS_OK)
		status = scenes_load(&m->service->scenes, &load, &source, m->session, m->header->request, err);
	if (status == STATUS_OK)
		m->session->requests++;
	return status;
}

static enum status find_scene(const struct message *m, const char *name, struct scene **scene, struct error *err)
{
	*scene = scenes_find(&m->service->scenes, name);
	if (*scene)
		return STATUS_OK;
	return error_set(err, STATUS_SCENE_NOT_FOUND, "there is no scene \"%s\": load it first", name);
}

static enum status on_unload(const struct message *m, struct error *err)
{
	candil_Unload unload;
	struct scene *scene;
	enum status status = request_unload(m->body, m->header->length, &unload, err);
	if (status == STATUS_OK)
		status = find_scene(m, unload.name, &scene, err);
	if (status != STATUS_OK)
		return status;
	// Two scenes have the name while one is being replaced.
	for (; scene; scene = scenes_find(&m->service->scenes, unload.name))
		scenes_unload(scene);
	reply_ok(m->session, m->header->request);
	return STATUS_OK;
}

static enum status on_list(const struct message *m, struct error *err)
{
	candil_ListScenes question;
	candil_SceneList list = {0};
	enum status status = decode(m, candil_ListScenes_fields, &question, err);
	if (status != STATUS_OK)
		return status;
	for (const struct scene *s = m->service->scenes.first; s && list.scenes_count < LIMIT_SCENES; s = s->next) {
		if (!s->listed)
			continue;
		candil_SceneList_Entry *entry = &list.scenes[list.scenes_count++];
		memcpy(entry->name, s->info.name, sizeof entry->name);
		entry->triangles = s->info.triangles;
		entry->blob_bytes = s->info.blob_bytes;
		entry->loading = s->state != SCENE_READY;
		entry->jobs = jobs_using(&m->service->jobs, s);
	}
	reply_message(m->session, MESSAGE_SCENE_LIST, m->header->request, candil_SceneList_fields, &list);
	return STATUS_OK;
}

static enum status on_describe(const struct message *m, struct error *err)
{
	candil_Describe describe;
	struct scene *scene;
	enum status status = request_describe(m->body, m->header->length, &describe, err);
	if (status == STATUS_OK)
		status = find_scene(m, describe.name, &scene, err);
	if (status != STATUS_OK)
		return status;
	if (scene->state != SCENE_READY)
		return error_set(err, STATUS_SCENE_NOT_FOUND, "scene \"%s\" is still being loaded: ask again later",
				 describe.name);
	reply_message(m->session, MESSAGE_SCENE_INFO, m->header->request, candil_SceneInfo_fields, &scene->info);
	return STATUS_OK;
}

// Refuse what is known not to be what it is named as. The worker refuses what is still being loaded.
static enum status check_parts(const struct subject *subject, struct error *err)
{
	const struct scene *picture = subject->part[PART_ENVIRONMENT], *file = subject->part[PART_IMPORTED];
	if (picture && picture->state == SCENE_READY && picture->info.environment_width == 0)
		return error_set(err, STATUS_BAD_ARGUMENT, "\"%s\" is a scene, no picture of surroundings",
				 picture->info.name);
	if (file && file->state == SCENE_READY && file->info.patch_elements == 0 && file->info.factor_rows == 0)
		return error_set(err, STATUS_BAD_ARGUMENT, "\"%s\" is no file of patches or of form factors",
				 file->info.name);
	return STATUS_OK;
}

// Find the scenes of a request that is to be worked on.
static enum status find_subject(const struct message *m, const candil_Render *render, struct subject *subject,
				struct error *err)
{
	const char *const names[PARTS] = {
	    [PART_SCENE] = render->scene,
	    [PART_ENVIRONMENT] = render->has_environment ? render->environment.scene : NULL,
	    [PART_IMPORTED] = render->imported[0] ? render->imported : NULL,
	};
	enum status status = STATUS_OK;
	*subject = (struct subject){0};
	for (unsigned i = 0; status == STATUS_OK && i < PARTS; i++)
		if (names[i])
			status = find_scene(m, names[i], &subject->part[i], err);
	if (status == STATUS_OK)
		status = check_parts(subject, err);
	if (status != STATUS_OK)
		return status;
	const struct subject_hashes suspects = subject_hashes_of(subject);
	return quarantine_check(&m->service->scenes.quarantine, &suspects, err);
}

static enum status on_render(const struct message *m, struct error *err)
{
	candil_Render render;
	struct subject subject;
	enum status status = check_place(m, err);
	if (status == STATUS_OK)
		status = request_render(m->body, m->header->length, &render, err);
	if (status == STATUS_OK)
		status = find_subject(m, &render, &subject, err);
	if (status == STATUS_OK)
		status = jobs_add(&m->service->jobs, m->session, m->header->request, &subject, &render, err);
	if (status == STATUS_OK && request_is_open(&render))
		quotes_choose(&m->service->quotes, m->session, m->header->request, &subject, &render);
	return status;
}

static enum status on_quote(const struct message *m, struct error *err)
{
	candil_Quote quote;
	struct subject subject;
	enum status status = check_place(m, err);
	if (status == STATUS_OK)
		status = request_quote(m->body, m->header->length, &quote, err);
	if (status == STATUS_OK)
		status = find_subject(m, &quote.render, &subject, err);
	if (status == STATUS_OK)
		status = quotes_add(&m->service->quotes, m->session, m->header->request, &subject, &quote, err);
	return status;
}

static enum status on_sweep(const struct message *m, struct error *err)
{
	struct subject subject;
	enum status status = check_place(m, err);
	if (status != STATUS_OK)
		return status;
	candil_Sweep *sweep = malloc(sizeof *sweep);
	if (!sweep)
		return error_set(err, STATUS_MEMORY, "no memory for a sweep");
	status = request_sweep(m->body, m->header->length, sweep, err);
	if (status == STATUS_OK)
		status = find_subject(m, &sweep->render, &subject, err);
	if (status == STATUS_OK)
		status = jobs_add_sweep(&m->service->jobs, m->session, m->header->request, &subject, sweep, err);
	if (status != STATUS_OK)
		free(sweep);
	return status;
}

static enum status on_cancel(const struct message *m, struct error *err)
{
	candil_Cancel cancel;
	struct error reason;
	enum status status = decode(m, candil_Cancel_fields, &cancel, err);
	if (status != STATUS_OK)
		return status;
	struct job *job = jobs_find(&m->service->jobs, m->session, cancel.request);
	struct scene *load = job ? NULL : scenes_find_load(&m->service->scenes, m->session, cancel.request);
	// The reason is also told to those whose renders wait for the scene: they end with its load.
	error_set(&reason, STATUS_CANCELLED, load ? "the load of the scene was cancelled" : "cancelled as asked");
	if (job)
		jobs_fail(&m->service->jobs, job, &reason);
	else if (load)
		scenes_stop_load(load, &reason);
	else if (quotes_find(&m->service->quotes, m->session, cancel.request))
		quotes_cancel(&m->service->quotes, m->session, cancel.request, &reason);
	else
		return error_set(err, STATUS_NO_SUCH_REQUEST, "this connection has no request %u under way", cancel.request);
	reply_ok(m->session, m->header->request);
	return STATUS_OK;
}

static enum status on_stats(const struct message *m, struct error *err)
{
	const struct service *s = m->service;
	candil_Stats question;
	enum status status = decode(m, candil_Stats_fields, &question, err);
	if (status != STATUS_OK)
		return status;
	candil_StatsReply reply = {.uptime_us = clock_us() - s->started_us,
				   .connections = s->sessions.count,
				   .jobs = s->jobs.count,
				   .jobs_done = s->jobs.done,
				   .jobs_failed = s->jobs.failed,
				   .jobs_cancelled = s->jobs.cancelled,
				   .slices = s->jobs.slices,
				   .worker_starts = s->worker.starts,
				   .loader_starts = s->scenes.loader_starts,
				   .loader_failures = s->scenes.loader_failures,
				   .buffered_bytes = sessions_buffered(&s->sessions),
				   .image_bytes = room_bytes(&s->jobs.room),
				   .worker_pid = (uint32_t)s->worker.child.pid,
				   .device_bytes = s->worker.held.device_bytes,
				   .device_losses = s->worker.losses.total,
				   .validation_errors = s->worker.held.validation_errors,
				   .slice_ms = s->options->slice_ms,
				   .loader_pid = (uint32_t)scenes_loader_pid(&s->scenes),
				   .max_connections = s->capacity.connections,
				   .max_scenes = s->capacity.scenes};
	reply.scenes = scenes_count(&s->scenes, &reply.scene_bytes);
	memcpy(reply.device, s->worker.ready.device, sizeof reply.device);
	if (s->worker.ready.error.code != STATUS_OK)
		memcpy(reply.device_error, s->worker.ready.error.text, sizeof reply.device_error);
	worker_device_note(&s->worker, reply.device_note);
	if (!reply.device_note[0])
		cache_note(&s->cache, reply.device_note);
	reply_message(m->session, MESSAGE_STATS_REPLY, m->header->request, candil_StatsReply_fields, &reply);
	return STATUS_OK;
}

static handler *find_handler(uint8_t type)
{
	static const struct {
		uint8_t type;
		handler *handle;
	} table[] = {
	    {MESSAGE_HELLO, on_hello},   {MESSAGE_PING, on_ping},        {MESSAGE_LOAD, on_load},
	    {MESSAGE_UNLOAD, on_unload}, {MESSAGE_LIST_SCENES, on_list}, {MESSAGE_DESCRIBE, on_describe},
	    {MESSAGE_RENDER, on_render}, {MESSAGE_CANCEL, on_cancel},    {MESSAGE_STATS, on_stats},
	    {MESSAGE_SWEEP, on_sweep},   {MESSAGE_QUOTE, on_quote},
	};
	for (size_t i = 0; i < sizeof table / sizeof *table; i++)
		if (table[i].type == type)
			return table[i].handle;
	return NULL;
}

static bool is_under_way(const struct message *m)
{
	return jobs_find(&m->service->jobs, m->session, m->header->request) ||
	       scenes_find_load(&m->service->scenes, m->session, m->header->request) ||
	       quotes_find(&m->service->quotes, m->session, m->header->request);
}

static enum status handle_message(const struct message *m, struct error *err)
{
	handler *handle_it = find_handler(m->header->type);
	if (!handle_it)
		return error_set(err, STATUS_UNKNOWN_TYPE, "message type 0x%02X is none that a client sends",
				 m->header->type);
	if ((m->header->flags & HEADER_FLAG_FD) && m->header->type != MESSAGE_LOAD)
		return error_set(err, STATUS_BAD_MESSAGE, "flag FD belongs to LOAD alone");
	return handle_it(m, err);
}

void dispatch_message(struct service *service, struct session *session, const struct header *header, const uint8_t *body)
{
	const struct message m = {.service = service, .session = session, .header = header, .body = body};
	struct error err;
	if (session->state == SESSION_GREETING && header->type != MESSAGE_HELLO) {
		error_set(&err, STATUS_HELLO_FIRST, "the first message must be HELLO");
		reply_error(session, header->request, &err);
		session_close(session);
		return;
	}
	if (is_under_way(&m)) {
		// An error under that id would end the request that has it, so this one is sent under id 0.
		error_set(&err, STATUS_DUPLICATE_REQUEST, "request id %u is in use: choose another", header->request);
		reply_error(session, 0, &err);
		return;
	}
	if (handle_message(&m, &err) == STATUS_OK)
		return;
	log_line(LOG_DEBUG, "connection %llu: %s refused: %s: %s", (unsigned long long)session->id,
		 message_type_name(header->type), status_name(err.code), err.text);
	reply_error(session, header->request, &err);
	// A connection whose hello was refused cannot go on.
	if (session->state == SESSION_GREETING)
		session_close(session);
}
