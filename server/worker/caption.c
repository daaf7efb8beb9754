#include "server/worker/caption.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "protocol/asked.h"
#include "protocol/names.h"
#include "server/base/angle.h"
#include "server/worker/devices.h"
#include "server/worker/image/frame.h"
#include "server/worker/job.h"
#include "server/worker/plan/effects.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/vk/device.h"

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

static void add_hash(const char *key, const struct blob_header *blob, struct frame *f)
{
	frame_add_metadata(f, key, "%016llx%016llx", (unsigned long long)blob->hash[1], (unsigned long long)blob->hash[0]);
}

void caption_metadata(const struct devices *devices, const struct job *job, struct frame *f)
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
	frame_add_metadata(f, "device", "%s", devices->vk->info.name);
	add_hash("scene_hash", job->scene->blob, f);
	if (job->environment)
		add_hash("environment_hash", job->environment->blob, f);
	if (job->imported)
		add_hash("import_hash", job->imported->blob, f);
	if (frame_is_scaled(f))
		frame_add_metadata(f, "made_of", "%ux%u", f->made_width, f->made_height);
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

struct verdict_about caption_about(const struct job *job)
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

void caption_stages(struct job *job, uint64_t read_us, bool final, struct frame *f)
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
