// One blocking socket, one message at a time. The encoder's thread writes to the same socket: a datagram is sent whole, so
// the two never mix. A job is begun, stepped and read here in the order in which the front asks.
#include "server/worker/serve.h"

#include <malloc.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/ipc.h"
#include "server/base/log.h"
#include "server/base/room_need.h"
#include "server/worker/caption.h"
#include "server/worker/devices.h"
#include "server/worker/gl/device.h"
#include "server/worker/gl/settle.h"
#include "server/worker/image/encoder.h"
#include "server/worker/job.h"
#include "server/worker/pilot/pilot.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/technique.h"
#include "server/worker/vk/device.h"

#define REST_MS 500 // without orders, after which what was freed goes back to the system

struct server {
	int socket;
	struct stock stock;
	struct encoder *encoder;
	struct job *jobs;
	bool pilot_cut; // the pilot that is made was ended before it had seen all
	struct ipc_state told; // to the front, the latest
	bool rested; // since the last order
};

static struct job **find_job(struct server *s, uint32_t id)
{
	struct job **at = &s->jobs;
	while (*at && (*at)->id != id)
		at = &(*at)->next;
	return at;
}

// Tell the front what is held, if it does not know.
static enum status tell_state(struct server *s)
{
	const struct devices *d = s->stock.devices;
	if (!d->vk)
		return STATUS_OK;
	const struct ipc_state now = {.head = {.op = IPC_STATE},
				      .device_bytes = d->vk->bytes,
				      .validation_errors =
					  atomic_load(&d->vk->validation_errors) + (d->gl ? d->gl->errors : 0)};
	if (now.device_bytes == s->told.device_bytes && now.validation_errors == s->told.validation_errors)
		return STATUS_OK;
	s->told = now;
	return ipc_send(s->socket, &now, sizeof now, -1, NULL);
}

static enum status tell_lost(const struct server *s)
{
	struct ipc_lost lost = {.head = {.op = IPC_LOST}};
	error_set(&lost.error, STATUS_DEVICE, "the device was lost: %s", s->stock.devices->vk->info.name);
	ipc_send(s->socket, &lost, sizeof lost, -1, NULL);
	return STATUS_DEVICE;
}

// Send an answer, unless the device was lost. Then say that and end: the front starts another worker, hands it the same
// scenes and begins the jobs again. An answer would fail a job that can still be done.
static enum status answer_front(struct server *s, const void *answer, size_t bytes)
{
	if (s->stock.devices->vk && (s->stock.devices->vk->lost || (s->stock.devices->gl && s->stock.devices->gl->lost)))
		return tell_lost(s);
	const enum status r = tell_state(s);
	return r == STATUS_OK ? ipc_send(s->socket, answer, bytes, -1, NULL) : r;
}

static void on_scene(struct server *s, const struct ipc_scene *m, int fd)
{
	struct error err;
	if (s->encoder)
		encoder_prepare(s->encoder); // someone will want a picture of it
	if (fd >= 0 && resident_add(&s->stock.scenes, m->scene, fd, &err) != STATUS_OK)
		log_line(LOG_ERROR, "scene %llu: %s", (unsigned long long)m->scene, err.text);
}

static enum status on_begin(struct server *s, const struct ipc_begin *m)
{
	struct ipc_begun answer = {.head = {.op = IPC_BEGUN, .job = m->head.job}};
	const uint64_t start = clock_us();
	struct job *job = calloc(1, sizeof *job);
	if (!job) {
		error_set(&answer.error, STATUS_MEMORY, "out of memory");
	} else {
		if (job_begin(&s->stock, m, job, &answer.error) == STATUS_OK) {
			// Clear the reason that an attempt before the eviction may have left.
			answer.error = (struct error){.code = STATUS_OK};
			job_accept(&s->stock, job, &answer.accepted);
			job->next = s->jobs;
			job->work_us = clock_us() - start;
			s->jobs = job;
		} else {
			answer.cold = job_refused_for(&s->stock, job);
			job_destroy(&s->stock, job);
		}
	}
	return answer_front(s, &answer, sizeof answer);
}

static enum status on_step(struct server *s, const struct ipc_step *m)
{
	struct ipc_stepped answer = {.head = {.op = IPC_STEPPED, .job = m->head.job}};
	struct job *job = *find_job(s, m->head.job);
	struct step_result result = STEP_RESULT_NOTHING;
	const uint64_t start = clock_us();
	if (!job)
		error_set(&answer.error, STATUS_INTERNAL, "the worker does not know job %u", m->head.job);
	else if (job_step(&s->stock, job, m->budget_us, &result, &answer.error) == STATUS_OK)
		answer.error = (struct error){.code = STATUS_OK};
	else
		answer.cold = job_refused_for(&s->stock, job);
	answer.samples_done = result.samples_done;
	answer.finished = result.finished;
	answer.reached = result.reached;
	answer.late = result.late;
	answer.ready = job && attempts_ready(&job->attempts);
	answer.scaled = job && attempts_scaled(&job->attempts);
	answer.fraction = result.fraction;
	answer.estimate = result.estimate;
	answer.device_us = clock_us() - start;
	if (job)
		job->work_us += answer.device_us;
	return answer_front(s, &answer, sizeof answer);
}

static void end(struct server *s, uint32_t id)
{
	struct job **at = find_job(s, id);
	struct job *job = *at;
	if (job)
		*at = job->next;
	job_destroy(&s->stock, job);
}

static enum status on_read(struct server *s, const struct ipc_read *m)
{
	struct ipc_image failure = {.head = {.op = IPC_IMAGE, .job = m->head.job}, .frame.final = m->final != 0};
	struct job *job = *find_job(s, m->head.job);
	struct frame *frame;
	const uint64_t start = clock_us();
	enum status r = job ? attempts_read(&job->attempts, &frame, &failure.error)
			    : error_set(&failure.error, STATUS_INTERNAL, "the worker does not know job %u", m->head.job);
	if (r != STATUS_OK) {
		if (m->final)
			end(s, m->head.job);
		return answer_front(s, &failure, sizeof failure);
	}
	if (frame->estimate.kind == candil_ErrorKind_ERROR_KIND_UNKNOWN && !frame_is_scaled(frame))
		frame->estimate = m->predicted;
	caption_stages(job, clock_us() - start, m->final != 0, frame);
	caption_metadata(s->stock.devices, job, frame);
	const struct encoder_task task = {.job = job->id,
					  .final = m->final != 0,
					  .frame = frame,
					  .file = {.format = (enum codec_format)job->plan.format,
						   .view = (enum codec_view)job->plan.view,
						   .exposure_ev = job->plan.exposure_ev},
					  .about = caption_about(job)};
	// The picture comes after what its job held is free, and told.
	if (m->final)
		end(s, m->head.job);
	r = tell_state(s);
	encoder_submit(s->encoder, &task);
	return r;
}

static bool make_room_for_pilot(void *user)
{
	struct server *s = user;
	return stock_make_room(&s->stock);
}

static bool pilot_is_ended(void *user)
{
	struct server *s = user;
	s->pilot_cut = ipc_next_is(s->socket, IPC_PILOT_END);
	return s->pilot_cut;
}

static enum status look(struct server *s, const struct ipc_pilot *m, struct job *job, struct pilot_result *results,
			uint32_t *cold, struct error *err)
{
	stock_allow_compiling(&s->stock, m->compile);
	if (!s->stock.devices->vk) {
		*err = s->stock.no_device;
		return err->code;
	}
	const uint64_t end_us = clock_us() + m->limit_us;
	enum status r = room_need(ROOM_WORK_BYTES, "a look at the scene", err);
	if (r == STATUS_OK)
		r = job_acquire(&s->stock, m->parts, &m->render, job, err);
	if (r != STATUS_OK)
		return r;
	// What its edits took is the pilot's, and no later job's.
	job->scene->edit_told = true;
	const struct pilot pilot = {.devices = s->stock.devices,
				    .scene = job->scene,
				    .environment = job->environment,
				    .imported = job->imported,
				    .render = &m->render,
				    .techniques = m->techniques,
				    .told = m->told,
				    .budget_us = m->budget_us,
				    .try_us = m->try_us,
				    .end_us = end_us,
				    .memory = stock_left(&s->stock),
				    .make_room = make_room_for_pilot,
				    .is_ended = pilot_is_ended,
				    .user = s};
	return pilot_run(&pilot, results, cold, err);
}

// The same for a pilot: what it sees is nobody's concern.
static void look_for(struct server *s, const struct ipc_pilot *m)
{
	struct pilot_result results[TECHNIQUE_COUNT];
	struct error err;
	uint32_t cold;
	struct job *job = calloc(1, sizeof *job);
	if (job)
		look(s, m, job, results, &cold, &err);
	job_destroy(&s->stock, job);
}

static enum status on_pilot(struct server *s, const struct ipc_pilot *m)
{
	struct ipc_piloted answer = {.head = {.op = IPC_PILOTED, .job = m->head.job}};
	struct job *job = calloc(1, sizeof *job);
	s->pilot_cut = false;
	if (!job)
		error_set(&answer.error, STATUS_MEMORY, "out of memory");
	else if (look(s, m, job, answer.results, &answer.cold_technique, &answer.error) == STATUS_OK)
		answer.error = (struct error){.code = STATUS_OK};
	answer.cut = s->pilot_cut;
	answer.cold = s->stock.devices->code.refused;
	job_destroy(&s->stock, job);
	return answer_front(s, &answer, sizeof answer);
}

static size_t expected_bytes(uint32_t op)
{
	switch (op) {
	case IPC_SCENE:
	case IPC_FORGET:
		return sizeof(struct ipc_scene);
	case IPC_BEGIN:
		return sizeof(struct ipc_begin);
	case IPC_STEP:
		return sizeof(struct ipc_step);
	case IPC_READ:
		return sizeof(struct ipc_read);
	case IPC_END:
	case IPC_PILOT_END:
		return sizeof(struct ipc_job);
	case IPC_PILOT:
		return sizeof(struct ipc_pilot);
	default:
		return 0;
	}
}

static enum status handle(struct server *s, const void *message, int fd)
{
	const struct ipc_head *head = message;
	if (head->op == IPC_SCENE && fd < 0)
		return STATUS_INTERNAL; // it was lost on the way: the next worker is given all scenes anew
	if (head->op == IPC_SCENE) {
		on_scene(s, message, fd);
		return STATUS_OK;
	}
	if (fd >= 0)
		close(fd);
	switch (head->op) {
	case IPC_FORGET:
		resident_forget(&s->stock.scenes, ((const struct ipc_scene *)message)->scene);
		return STATUS_OK;
	case IPC_BEGIN:
		return on_begin(s, message);
	case IPC_STEP:
		return on_step(s, message);
	case IPC_READ:
		return on_read(s, message);
	case IPC_PILOT:
		return on_pilot(s, message);
	case IPC_PILOT_END:
		return STATUS_OK; // its pilot has looked for it, or had ended before
	default:
		end(s, head->job);
		return STATUS_OK;
	}
}

// Once nothing has been asked for a while, give back what was freed: a driver keeps what was deleted until it is told to
// finish, and malloc keeps pieces between others.
static void rest(struct server *s)
{
	struct pollfd p = {.fd = s->socket, .events = POLLIN};
	struct error ignored; // a device that is lost says so again
	if (s->rested || poll(&p, 1, REST_MS) != 0)
		return;
	if (s->stock.devices->gl) {
		gl_settle(s->stock.devices->gl);
		gl_wait(s->stock.devices->gl, "resting", &ignored);
	}
	malloc_trim(0);
	s->rested = true;
}

// Take the next message of those that fit; *bytes is 0 when the front has gone. *fd becomes the caller's.
static enum status receive(int socket, void *message, size_t *bytes, int *fd)
{
	struct error err;
	enum status r = ipc_receive(socket, message, IPC_MAX_BYTES, bytes, fd, &err);
	const struct ipc_head *head = message;
	if (r != STATUS_OK || *bytes == 0 || (*bytes >= sizeof *head && *bytes == expected_bytes(head->op)))
		return r;
	if (*fd >= 0)
		close(*fd);
	log_line(LOG_ERROR, "the front sent a message of %zu bytes that is none", *bytes);
	return STATUS_INTERNAL;
}

static void finish(struct server *s)
{
	while (s->jobs) {
		struct job *job = s->jobs;
		s->jobs = job->next;
		job_destroy(&s->stock, job);
	}
	if (s->stock.devices->vk)
		resident_finish(&s->stock.scenes);
}

_Alignas(16) static char inbox[IPC_MAX_BYTES];

enum status serve(int socket, struct devices *devices, const struct error *why)
{
	struct server s = {.socket = socket, .stock = {.devices = devices, .scenes = {.device = devices->vk}}};
	struct ipc_ready ready = {.head = {.op = IPC_READY}};
	struct error err;
	size_t bytes = 1;
	int fd;
	snprintf(ready.build, sizeof ready.build, "%s", ipc_build());
	if (devices->vk) {
		snprintf(ready.device, sizeof ready.device, "%s", devices->vk->info.name);
		snprintf(ready.key, sizeof ready.key, "%s", devices->vk->info.key);
		ready.software = devices->vk->info.software;
		ready.others = devices->vk->others;
	} else {
		s.stock.no_device = *why;
		ready.error = *why;
	}
	if (encoder_create(socket, ready.device, codec_open, &s.encoder, &err) != STATUS_OK) {
		log_line(LOG_ERROR, "%s", err.text);
		return STATUS_INTERNAL;
	}
	enum status r = ipc_send(socket, &ready, sizeof ready, -1, &err);
	while (r == STATUS_OK) {
		rest(&s);
		r = receive(socket, inbox, &bytes, &fd);
		if (r != STATUS_OK || bytes == 0)
			break;
		r = handle(&s, inbox, fd);
		s.rested = false;
		if (r == STATUS_OK)
			r = tell_state(&s);
	}
	encoder_destroy(s.encoder);
	finish(&s);
	return r;
}

enum status serve_compiling(int socket, struct devices *devices)
{
	struct server s = {.socket = socket, .stock = {.devices = devices, .scenes = {.device = devices->vk}}};
	size_t bytes;
	int fd;
	enum status r = receive(socket, inbox, &bytes, &fd);
	for (; r == STATUS_OK && bytes > 0; r = receive(socket, inbox, &bytes, &fd)) {
		const struct ipc_head *head = (const struct ipc_head *)inbox;
		if (head->op == IPC_SCENE) {
			on_scene(&s, (const struct ipc_scene *)inbox, fd);
			continue;
		}
		if (fd >= 0)
			close(fd);
		if (head->op == IPC_BEGIN && devices->vk)
			job_compile(&s.stock, (const struct ipc_begin *)inbox);
		else if (head->op == IPC_PILOT && devices->vk)
			look_for(&s, (const struct ipc_pilot *)inbox);
		break;
	}
	finish(&s);
	return r;
}
