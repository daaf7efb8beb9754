#include "server/worker/job.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/log.h"
#include "server/base/room_need.h"
#include "server/worker/devices.h"
#include "server/worker/plan/effects.h"
#include "server/worker/plan/make.h"
#include "server/worker/plan/needs.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/vk/device.h"

void job_destroy(struct stock *s, struct job *job)
{
	if (!job)
		return;
	attempts_end(&job->attempts);
	if (job->scene)
		resident_release(&s->scenes, job->scene);
	if (job->environment)
		resident_release(&s->scenes, job->environment);
	if (job->imported)
		resident_release(&s->scenes, job->imported);
	free(job);
}

void job_accept(const struct stock *s, const struct job *job, candil_Accepted *out)
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
	needs_note(&job->request, job->technique, &job->plan, out);
}

uint64_t stock_left(const struct stock *s)
{
	const struct device *d = s->devices->vk;
	const uint64_t idle = resident_idle_bytes(&s->scenes), needed = d->bytes > idle ? d->bytes - idle : 0;
	return d->budget > needed ? d->budget - needed : 0;
}

bool stock_make_room(struct stock *s)
{
	return s->devices->vk->wanted <= stock_left(s) && resident_evict(&s->scenes);
}

static enum status refuse_size(const struct stock *s, const struct job *job, uint64_t bytes, uint64_t left,
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

enum status job_acquire(struct stock *s, const uint64_t ids[PARTS], const candil_Render *render, struct job *job,
			struct error *err)
{
	enum status r =
	    resident_acquire(&s->scenes, ids[PART_SCENE], render->has_edits ? &render->edits : NULL, &job->scene, err);
	if (r == STATUS_OK && ids[PART_ENVIRONMENT])
		r = resident_acquire(&s->scenes, ids[PART_ENVIRONMENT], NULL, &job->environment, err);
	if (r == STATUS_OK && ids[PART_IMPORTED])
		r = resident_acquire(&s->scenes, ids[PART_IMPORTED], NULL, &job->imported, err);
	return r;
}

void stock_allow_compiling(struct stock *s, bool at_will)
{
	s->devices->code.at_will = at_will;
	s->devices->code.refused = 0;
}

enum status job_begin(struct stock *s, const struct ipc_begin *m, struct job *job, struct error *err)
{
	stock_allow_compiling(s, m->compile);
	if (!s->devices->vk) {
		*err = s->no_device;
		return err->code;
	}
	job->id = m->head.job;
	job->request = m->render;
	job->compile = m->compile;
	enum status r = job_acquire(s, m->parts, &m->render, job, err);
	if (r != STATUS_OK)
		return r;
	if (job->scene->base && !job->scene->edit_told) {
		job->edit_us = job->scene->edit_us;
		job->scene->edit_told = true;
	}
	r = plan_make(&m->render, &job->scene->view, job->environment ? job->environment->blob : NULL,
		      job->imported ? job->imported->blob : NULL, &job->plan, err);
	if (r != STATUS_OK)
		return r;
	job->plan.environment.scene = job->environment;
	job->plan.imported.scene = job->imported;
	job->plan.end_us = m->render.deadline_ms > 0 ? m->end_us : 0;
	job->technique = technique_find(job->plan.technique);
	// This job may share what another job of the same scene holds. Then only an attempt tells whether it fits.
	const struct resident_scene *base = job->scene->base ? job->scene->base : job->scene;
	const uint64_t budget = base->jobs > 1 ? s->devices->vk->budget : stock_left(s);
	const uint64_t bytes = job->technique->bytes(s->devices, job->scene, &job->plan);
	if (bytes > budget)
		return refuse_size(s, job, bytes, budget, err);
	r = room_need(ROOM_WORK_BYTES + (s->devices->vk->info.software ? bytes : 0), "the job", err);
	if (r != STATUS_OK)
		return r;
	const uint64_t open_us = s->devices->open_us;
	attempts_init(&job->attempts, job->technique, s->devices, job->scene, &job->plan);
	do {
		s->devices->vk->wanted = 0;
		r = attempts_begin(&job->attempts, err);
	} while (r == STATUS_MEMORY && stock_make_room(s));
	job->open_us = s->devices->open_us - open_us;
	return r == STATUS_OK ? attempts_time_effects(&job->attempts, job->plan.reports, job->plan.report_count, err) : r;
}

uint64_t job_refused_for(const struct stock *s, const struct job *job)
{
	if (s->devices->code.refused && job->edit_us > 0)
		job->scene->edit_told = false;
	return s->devices->code.refused;
}

// Some needs, of voxels above all, show only while a job works: room is made for them as at its beginning.
enum status job_step(struct stock *s, struct job *job, uint32_t budget_us, struct step_result *result, struct error *err)
{
	enum status r;
	const bool software = s->devices->vk->info.software, begins = !job->attempts.work;
	const uint64_t bytes = software && begins ? job->technique->bytes(s->devices, job->scene, &job->plan) : 0;
	stock_allow_compiling(s, job->compile);
	do {
		s->devices->vk->wanted = 0;
		r = room_need(ROOM_WORK_BYTES + bytes, "the job", err);
		if (r == STATUS_OK)
			r = attempts_step(&job->attempts, budget_us, result, err);
	} while (r == STATUS_MEMORY && stock_make_room(s));
	if (r == STATUS_OK || r == STATUS_DEVICE || !attempts_scaled(&job->attempts))
		return r;
	// Under a deadline there is something to show, if not more.
	log_line(LOG_INFO, "job %u: no larger picture: %s", job->id, err->text);
	*result = STEP_RESULT_NOTHING;
	result->late = true;
	return STATUS_OK;
}

// Steps that compile nothing: some stand between those that do, to enter a stage.
#define COMPILE_IDLE_STEPS 3u

void job_compile(struct stock *s, const struct ipc_begin *m)
{
	struct error err;
	struct step_result result = STEP_RESULT_NOTHING;
	struct job *job = calloc(1, sizeof *job);
	if (!job)
		return;
	enum status r = job_begin(s, m, job, &err);
	for (unsigned idle = 0; r == STATUS_OK && idle < COMPILE_IDLE_STEPS && !result.finished; idle++) {
		const uint32_t added = s->devices->code.added;
		r = job_step(s, job, 1, &result, &err);
		if (s->devices->code.added != added)
			idle = 0;
	}
	job_destroy(s, job);
}
