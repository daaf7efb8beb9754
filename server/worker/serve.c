// One blocking socket, one message at a time. The encoder's thread writes to the same socket: a datagram is sent whole, so
// the two never mix. A job is begun, stepped and read here in the order in which the front asks.
#include "server/worker/serve.h"

#include <malloc.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "protocol/asked.h"
#include "protocol/names.h"
#include "server/base/angle.h"
#include "server/base/clock.h"
#include "server/base/ipc.h"
#include "server/base/log.h"
#include "server/base/room_need.h"
#include "server/worker/devices.h"
#include "server/worker/gl/device.h"
#include "server/worker/gl/settle.h"
#include "server/worker/image/encoder.h"
#include "server/worker/pilot/pilot.h"
#include "server/worker/plan/effects.h"
#include "server/worker/plan/make.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/technique.h"
#include "server/worker/vk/device.h"

#define REST_MS 500 // without orders, after which what was freed goes back to the system

struct job {
	struct job *next;
	uint32_t id;
	candil_Render request; // whose words go into the files
	struct plan plan;
	struct resident_scene *scene;
	struct resident_scene *environment; // the picture of the surroundings; NULL: none
	const struct technique *technique;
	struct technique_job *work;
	uint64_t edit_us; // that its edits took; 0: none, or made before
	uint64_t open_us; // that opening a device took for it
	uint64_t preview_us; // that reading intermediate images took
	uint64_t work_us; // all that this thread spent on it, on the device or beside it
	bool compile; // what its code needs is compiled whenever it is met
};

struct server {
	int socket;
	struct devices *devices;
	struct error no_device;
	struct resident_scenes scenes;
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

static void job_destroy(struct server *s, struct job *job)
{
	if (!job)
		return;
	if (job->work)
		job->technique->end(job->work);
	if (job->scene)
		resident_release(&s->scenes, job->scene);
	if (job->environment)
		resident_release(&s->scenes, job->environment);
	free(job);
}

// Tell the front what is held, if it does not know.
static enum status tell_state(struct server *s)
{
	const struct devices *d = s->devices;
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
	error_set(&lost.error, STATUS_DEVICE, "the device was lost: %s", s->devices->vk->info.name);
	ipc_send(s->socket, &lost, sizeof lost, -1, NULL);
	return STATUS_DEVICE;
}

// Send an answer, unless the device was lost. Then say that and end: the front starts another worker, hands it the same
// scenes and begins the jobs again. An answer would fail a job that can still be done.
static enum status answer_front(struct server *s, const void *answer, size_t bytes)
{
	if (s->devices->vk && (s->devices->vk->lost || (s->devices->gl && s->devices->gl->lost)))
		return tell_lost(s);
	const enum status r = tell_state(s);
	return r == STATUS_OK ? ipc_send(s->socket, answer, bytes, -1, NULL) : r;
}

static void on_scene(struct server *s, const struct ipc_scene *m, int fd)
{
	struct error err;
	if (s->encoder)
		encoder_prepare(s->encoder); // someone will want a picture of it
	if (fd >= 0 && resident_add(&s->scenes, m->scene, fd, &err) != STATUS_OK)
		log_line(LOG_ERROR, "scene %llu: %s", (unsigned long long)m->scene, err.text);
}

static void fill_accepted(const struct server *s, const struct job *job, candil_Accepted *out)
{
	out->technique = job->plan.technique;
	out->plan_count = (pb_size_t)job->plan.report_count;
	memcpy(out->plan, job->plan.reports, job->plan.report_count * sizeof *out->plan);
	snprintf(out->device, sizeof out->device, "%s", s->devices->vk->info.name);
	out->job_bytes = job->technique->bytes(s->devices, job->scene, &job->plan);
	out->samples = job->plan.samples;
	out->depth = job->plan.depth;
	out->default_light = job->plan.default_light;
	if (out->default_light)
		technique_note(out, "nothing in the scene gives light: a neutral sky of %g W/(m² sr) does, by default",
			       DEFAULT_LIGHT_RADIANCE);
	if (job->scene->edited.note[0])
		snprintf(out->notes[out->notes_count++], sizeof out->notes[0], "%s", job->scene->edited.note);
	if (job->technique->notes)
		job->technique->notes(job->scene, &job->plan, out);
}

// Bytes of the budget that are free once everything that no job needs has made room.
static uint64_t budget_left(const struct server *s)
{
	const struct device *d = s->devices->vk;
	const uint64_t idle = resident_idle_bytes(&s->scenes), needed = d->bytes > idle ? d->bytes - idle : 0;
	return d->budget > needed ? d->budget - needed : 0;
}

// After STATUS_MEMORY: evict scenes that no job uses, the one unused for longest first. Evict nothing if it would not help.
static bool make_room(struct server *s)
{
	return s->devices->vk->wanted <= budget_left(s) && resident_evict(&s->scenes);
}

static enum status refuse_size(const struct server *s, const struct job *job, uint64_t bytes, uint64_t left,
			       struct error *err)
{
	const uint64_t budget = s->devices->vk->budget;
	char advice[TECHNIQUE_ADVICE_BYTES] = "render smaller";
	if (job->technique->advise)
		job->technique->advise(s->devices, job->scene, &job->plan, left, advice);
	return error_set(err, STATUS_MEMORY, "the job takes %llu MiB, the memory budget %s %llu MiB: %s",
			 (unsigned long long)(bytes >> 20), bytes > budget ? "is" : "leaves",
			 (unsigned long long)((bytes > budget ? budget : left) >> 20), advice);
}

// Take hold of what a request is about. On failure job_destroy gives back what was taken.
static enum status acquire(struct server *s, uint64_t scene, uint64_t environment, const candil_Render *render,
			   struct job *job, struct error *err)
{
	enum status r = resident_acquire(&s->scenes, scene, render->has_edits ? &render->edits : NULL, &job->scene, err);
	if (r == STATUS_OK && environment)
		r = resident_acquire(&s->scenes, environment, NULL, &job->environment, err);
	return r;
}

static void allow_compiling(struct server *s, bool at_will)
{
	s->devices->code.at_will = at_will;
	s->devices->code.refused = 0;
}

static enum status begin(struct server *s, const struct ipc_begin *m, struct job *job, struct error *err)
{
	allow_compiling(s, m->compile);
	if (!s->devices->vk) {
		*err = s->no_device;
		return err->code;
	}
	enum status r = acquire(s, m->scene, m->environment, &m->render, job, err);
	if (r != STATUS_OK)
		return r;
	if (job->scene->base && !job->scene->edit_told) {
		job->edit_us = job->scene->edit_us;
		job->scene->edit_told = true;
	}
	r = plan_make(&m->render, &job->scene->view, job->environment ? job->environment->blob : NULL, &job->plan, err);
	if (r != STATUS_OK)
		return r;
	job->plan.environment.scene = job->environment;
	job->plan.end_us = m->render.deadline_ms > 0 ? m->end_us : 0;
	job->technique = technique_find(job->plan.technique);
	// This job may share what another job of the same scene holds. Then only an attempt tells whether it fits.
	const struct resident_scene *base = job->scene->base ? job->scene->base : job->scene;
	const uint64_t budget = base->jobs > 1 ? s->devices->vk->budget : budget_left(s);
	const uint64_t bytes = job->technique->bytes(s->devices, job->scene, &job->plan);
	if (bytes > budget)
		return refuse_size(s, job, bytes, budget, err);
	r = room_need(ROOM_WORK_BYTES + (s->devices->vk->info.software ? bytes : 0), "the job", err);
	if (r != STATUS_OK)
		return r;
	const uint64_t open_us = s->devices->open_us;
	do {
		s->devices->vk->wanted = 0;
		r = job->technique->begin(s->devices, job->scene, &job->plan, &job->work, err);
	} while (r == STATUS_MEMORY && make_room(s));
	job->open_us = s->devices->open_us - open_us;
	if (r == STATUS_OK && job->technique->time_effects)
		r = job->technique->time_effects(job->work, job->plan.reports, job->plan.report_count, err);
	return r;
}

// The code for want of which the job was refused; 0: that is not why it failed. It is begun again, and then tells what its
// edits took.
static uint64_t refused_for(const struct server *s, const struct job *job)
{
	if (s->devices->code.refused && job->edit_us > 0)
		job->scene->edit_told = false;
	return s->devices->code.refused;
}

static enum status on_begin(struct server *s, const struct ipc_begin *m)
{
	struct ipc_begun answer = {.head = {.op = IPC_BEGUN, .job = m->head.job}};
	const uint64_t start = clock_us();
	struct job *job = calloc(1, sizeof *job);
	if (!job) {
		error_set(&answer.error, STATUS_MEMORY, "out of memory");
	} else {
		job->id = m->head.job;
		job->request = m->render;
		job->compile = m->compile;
		if (begin(s, m, job, &answer.error) == STATUS_OK) {
			// Clear the reason that an attempt before the eviction may have left.
			answer.error = (struct error){.code = STATUS_OK};
			fill_accepted(s, job, &answer.accepted);
			job->next = s->jobs;
			job->work_us = clock_us() - start;
			s->jobs = job;
		} else {
			answer.cold = refused_for(s, job);
			job_destroy(s, job);
		}
	}
	return answer_front(s, &answer, sizeof answer);
}

// Some needs, of voxels above all, show only while a job works: room is made for them as at its beginning.
static enum status step(struct server *s, struct job *job, uint32_t budget_us, struct step_result *result, struct error *err)
{
	enum status r;
	allow_compiling(s, job->compile);
	do {
		s->devices->vk->wanted = 0;
		r = room_need(ROOM_WORK_BYTES, "the job", err);
		if (r == STATUS_OK)
			r = job->technique->step(job->work, budget_us, result, err);
	} while (r == STATUS_MEMORY && make_room(s));
	return r;
}

static enum status on_step(struct server *s, const struct ipc_step *m)
{
	struct ipc_stepped answer = {.head = {.op = IPC_STEPPED, .job = m->head.job}};
	struct job *job = *find_job(s, m->head.job);
	struct step_result result = STEP_RESULT_NOTHING;
	const uint64_t start = clock_us();
	if (!job)
		error_set(&answer.error, STATUS_INTERNAL, "the worker does not know job %u", m->head.job);
	else if (step(s, job, m->budget_us, &result, &answer.error) == STATUS_OK)
		answer.error = (struct error){.code = STATUS_OK};
	else
		answer.cold = refused_for(s, job);
	answer.samples_done = result.samples_done;
	answer.finished = result.finished;
	answer.reached = result.reached;
	answer.late = result.late;
	answer.fraction = result.fraction;
	answer.estimate = result.estimate;
	answer.device_us = clock_us() - start;
	if (job)
		job->work_us += answer.device_us;
	return answer_front(s, &answer, sizeof answer);
}

// ---- compiling for another ----------------------------------------------------------------------------------------------

// Steps that compile nothing: some stand between those that do, to enter a stage.
#define COMPILE_IDLE_STEPS 3u

// Begin a job and take the steps in which code is compiled, which fills the driver's cache. What goes wrong goes wrong again
// where somebody is told.
static void compile_for(struct server *s, const struct ipc_begin *m)
{
	struct error err;
	struct step_result result = STEP_RESULT_NOTHING;
	struct job *job = calloc(1, sizeof *job);
	if (!job)
		return;
	job->compile = true;
	enum status r = begin(s, m, job, &err);
	for (unsigned idle = 0; r == STATUS_OK && idle < COMPILE_IDLE_STEPS && !result.finished; idle++) {
		const uint32_t added = s->devices->code.added;
		r = step(s, job, 1, &result, &err);
		if (s->devices->code.added != added)
			idle = 0;
	}
	job_destroy(s, job);
}

static void add_asked(void *user, const char *key, const char *text)
{
	char whole[64];
	snprintf(whole, sizeof whole, ASKED_KEY "%s", key);
	frame_add_metadata(user, whole, "%s", text);
}

// The camera as the plan has it, wherever it came from.
static void add_camera(const struct plan_camera *c, struct frame *f)
{
	const double half_height = sqrt(c->up[0] * c->up[0] + c->up[1] * c->up[1] + c->up[2] * c->up[2]);
	frame_add_metadata(f, "camera_eye", "%.9g,%.9g,%.9g", c->eye[0], c->eye[1], c->eye[2]);
	frame_add_metadata(f, "camera_forward", "%.9g,%.9g,%.9g", c->forward[0], c->forward[1], c->forward[2]);
	frame_add_metadata(f, "camera_up", "%.9g,%.9g,%.9g", c->up[0] / half_height, c->up[1] / half_height,
			   c->up[2] / half_height);
	if (c->panorama)
		frame_add_metadata(f, "camera_projection", "panorama");
	else if (c->orthographic)
		frame_add_metadata(f, "camera_projection", "orthographic %.9g", 2 * half_height);
	else
		frame_add_metadata(f, "camera_projection", "perspective %.9g", atan(half_height) * 360 / PI);
	if (c->lens_radius > 0)
		frame_add_metadata(f, "camera_lens", "%.9g,%.9g", c->lens_radius, c->focus);
}

static void add_metadata(const struct server *s, const struct job *job, struct frame *f)
{
	const struct plan *p = &job->plan;
	char effects[512] = "";
	for (uint32_t i = 0; i < p->report_count; i++)
		if (plan_has(p, p->reports[i].effect))
			snprintf(effects + strlen(effects), sizeof effects - strlen(effects), "%s%s", effects[0] ? "," : "",
				 effect_name(p->reports[i].effect));
	frame_add_metadata(f, "version", "%s", CANDIL_VERSION_STRING);
	frame_add_metadata(f, "technique", "%s", technique_name(job->plan.technique));
	frame_add_metadata(f, "effects", "%s", effects[0] ? effects : "none");
	frame_add_metadata(f, "samples", "%u", f->samples);
	frame_add_metadata(f, "first_sample", "%u", p->first_sample);
	frame_add_metadata(f, "seed", "%llu", (unsigned long long)p->seed);
	frame_add_metadata(f, "depth", "%u", p->depth);
	frame_add_metadata(f, "error_kind", "%s", error_kind_name(f->estimate.kind));
	frame_add_metadata(f, "estimated_relmse", "%.6g", f->estimate.relmse);
	frame_add_metadata(f, "relmse_low", "%.6g", f->estimate.low);
	frame_add_metadata(f, "relmse_high", "%.6g", f->estimate.high);
	frame_add_metadata(f, "non_finite_samples", "%llu", (unsigned long long)f->non_finite_samples);
	frame_add_metadata(f, "device", "%s", s->devices->vk->info.name);
	frame_add_metadata(f, "scene_hash", "%016llx%016llx", (unsigned long long)job->scene->blob->hash[1],
			   (unsigned long long)job->scene->blob->hash[0]);
	if (job->environment)
		frame_add_metadata(f, "environment_hash", "%016llx%016llx",
				   (unsigned long long)job->environment->blob->hash[1],
				   (unsigned long long)job->environment->blob->hash[0]);
	if (p->default_light)
		frame_add_metadata(f, "default_light", "%g", DEFAULT_LIGHT_RADIANCE);
	if (job->scene->base)
		frame_add_metadata(f, "edits", "%016llx", (unsigned long long)job->scene->edit_hash);
	add_camera(&p->camera, f);
	asked_words(&job->request, add_asked, f);
	for (uint32_t i = 0; i < f->stage_count; i++) {
		char key[40];
		snprintf(key, sizeof key, "%s_us", f->stages[i].name);
		frame_add_metadata(f, key, "%llu", (unsigned long long)f->stages[i].us);
	}
}

// What the picture's verdict must know of its scene and plan.
static struct verdict_about about_of(const struct job *job)
{
	const struct plan *p = &job->plan;
	const struct blob_view *scene = &job->scene->view;
	struct verdict_about about = {.surfaces = scene->counts[BLOB_TRIANGLES] > 0};
	about.lamps = scene_emitter_power(p, scene) > 0 || scene_light_power(p, scene) > 0;
	about.background = plan_has(p, candil_Effect_EFFECT_ENVIRONMENT) && (plan_has_colour(p) || p->environment.power > 0);
	about.background_lights = about.background && (!job->technique->sky_is_seen_alone || p->default_light);
	effects_list_lit_by_background(about.lit_by_background, sizeof about.lit_by_background);
	const uint32_t lights =
	    1u << candil_Effect_EFFECT_EMITTERS | 1u << candil_Effect_EFFECT_LIGHTS | 1u << candil_Effect_EFFECT_ENVIRONMENT;
	const char *off[EFFECT_COUNT];
	size_t count = 0;
	for (uint32_t i = 0; i < p->report_count; i++)
		if (lights >> p->reports[i].effect & 1u &&
		    p->reports[i].state == candil_EffectState_EFFECT_STATE_SWITCHED_OFF)
			off[count++] = effect_name(p->reports[i].effect);
	names_list(off, count, "and", about.off, sizeof about.off);
	for (int c = 0; c < 3; c++) {
		const double eye = p->camera.eye[c] - scene->blob->origin[c];
		about.outside |= eye < (double)scene->bounds_min[c] || eye > (double)scene->bounds_max[c];
	}
	return about;
}

// Add what the technique does not know of the time that was spent on its job, of which `read_us` on this frame: what has no
// name in the end is told, too.
static void add_stages(struct job *job, uint64_t read_us, bool final, struct frame *f)
{
	if (job->edit_us > 0)
		frame_add_stage(f, "edit", job->edit_us);
	if (job->open_us > 0)
		frame_add_stage(f, FRAME_STAGE_OPEN, job->open_us);
	if (job->preview_us > 0)
		frame_add_stage(f, "preview", job->preview_us);
	uint64_t named_us = 0, resolve_us = 0;
	for (uint32_t i = 0; i < f->stage_count; i++) {
		named_us += f->stages[i].us;
		if (!strcmp(f->stages[i].name, "resolve"))
			resolve_us = f->stages[i].us;
	}
	job->work_us += read_us;
	if (job->work_us > named_us)
		frame_add_stage(f, "host", job->work_us - named_us);
	// The other stages of an intermediate image are those of the final one, as far as they have come.
	if (!final)
		job->preview_us += resolve_us;
}

static void end(struct server *s, uint32_t id)
{
	struct job **at = find_job(s, id);
	struct job *job = *at;
	if (job)
		*at = job->next;
	job_destroy(s, job);
}

static enum status on_read(struct server *s, const struct ipc_read *m)
{
	struct ipc_image failure = {.head = {.op = IPC_IMAGE, .job = m->head.job}, .frame.final = m->final != 0};
	struct job *job = *find_job(s, m->head.job);
	struct frame *frame;
	const uint64_t start = clock_us();
	enum status r = job ? job->technique->read(job->work, &frame, &failure.error)
			    : error_set(&failure.error, STATUS_INTERNAL, "the worker does not know job %u", m->head.job);
	if (r != STATUS_OK) {
		if (m->final)
			end(s, m->head.job);
		return answer_front(s, &failure, sizeof failure);
	}
	if (frame->estimate.kind == candil_ErrorKind_ERROR_KIND_UNKNOWN)
		frame->estimate = m->predicted;
	add_stages(job, clock_us() - start, m->final != 0, frame);
	add_metadata(s, job, frame);
	const struct encoder_task task = {.job = job->id,
					  .final = m->final != 0,
					  .frame = frame,
					  .file = {.format = (enum codec_format)job->plan.format,
						   .view = (enum codec_view)job->plan.view,
						   .exposure_ev = job->plan.exposure_ev},
					  .about = about_of(job)};
	// The picture comes after what its job held is free, and told.
	if (m->final)
		end(s, m->head.job);
	r = tell_state(s);
	encoder_submit(s->encoder, &task);
	return r;
}

static bool make_room_for_pilot(void *user)
{
	return make_room(user);
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
	allow_compiling(s, m->compile);
	if (!s->devices->vk) {
		*err = s->no_device;
		return err->code;
	}
	const uint64_t end_us = clock_us() + m->limit_us;
	enum status r = room_need(ROOM_WORK_BYTES, "a look at the scene", err);
	if (r == STATUS_OK)
		r = acquire(s, m->scene, m->environment, &m->render, job, err);
	if (r != STATUS_OK)
		return r;
	// What its edits took is the pilot's, and no later job's.
	job->scene->edit_told = true;
	const struct pilot pilot = {.devices = s->devices,
				    .scene = job->scene,
				    .environment = job->environment,
				    .render = &m->render,
				    .techniques = m->techniques,
				    .budget_us = m->budget_us,
				    .end_us = end_us,
				    .memory = budget_left(s),
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
	job_destroy(s, job);
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
	answer.cold = s->devices->code.refused;
	job_destroy(s, job);
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
		resident_forget(&s->scenes, ((const struct ipc_scene *)message)->scene);
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
	if (s->devices->gl) {
		gl_settle(s->devices->gl);
		gl_wait(s->devices->gl, "resting", &ignored);
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
		job_destroy(s, job);
	}
	if (s->devices->vk)
		resident_finish(&s->scenes);
}

_Alignas(16) static char inbox[IPC_MAX_BYTES];

enum status serve(int socket, struct devices *devices, const struct error *why)
{
	struct server s = {.socket = socket, .devices = devices, .scenes = {.device = devices->vk}};
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
		s.no_device = *why;
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
	struct server s = {.socket = socket, .devices = devices, .scenes = {.device = devices->vk}};
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
			compile_for(&s, (const struct ipc_begin *)inbox);
		else if (head->op == IPC_PILOT && devices->vk)
			look_for(&s, (const struct ipc_pilot *)inbox);
		break;
	}
	finish(&s);
	return r;
}
