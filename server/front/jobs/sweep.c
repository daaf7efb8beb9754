#include "server/front/jobs/sweep.h"

#include <stdlib.h>
#include <string.h>

#include "protocol/names.h"
#include "protocol/text.h"
#include "server/base/clock.h"

#define MAX_NOTES (sizeof((candil_Done *)0)->notes / sizeof((candil_Done *)0)->notes[0])
#define MAX_STAGES (sizeof((candil_Done *)0)->stages / sizeof(candil_Stage))

struct sweep *sweep_create(struct session *session, uint32_t request, const struct subject *subject, candil_Sweep *message)
{
	struct sweep *sweep = calloc(1, sizeof *sweep);
	if (!sweep)
		return NULL;
	sweep->session = session;
	sweep->request = request;
	sweep->subject = *subject;
	sweep->message = message;
	sweep->asked_us = clock_us();
	subject_hold(subject);
	return sweep;
}

void sweep_destroy(struct sweep *sweep)
{
	subject_release(&sweep->subject);
	free(sweep->message);
	free(sweep);
}

uint32_t sweep_count(const struct sweep *sweep)
{
	const candil_Sweep *m = sweep->message;
	return m->times_count > 0 ? m->times_count : m->cameras_count;
}

void sweep_frame(const struct sweep *sweep, uint32_t index, candil_Render *render)
{
	*render = sweep->message->render;
	render->has_camera = true;
	// With times one camera may stand for all images.
	render->camera = sweep->message->cameras[sweep->message->cameras_count > 1 ? index : 0];
	if (sweep->message->times_count > 0)
		render->edits.time_s = sweep->message->times[index];
}

static void add_stage(candil_Done *total, const candil_Stage *stage)
{
	for (pb_size_t i = 0; i < total->stages_count; i++)
		if (!strcmp(total->stages[i].name, stage->name)) {
			total->stages[i].us += stage->us;
			return;
		}
	if (total->stages_count < MAX_STAGES)
		total->stages[total->stages_count++] = *stage;
}

// Add to a sum of numbers that are negative where they are not known. If one image's is unknown, so is the mean.
static void add_known(double *sum, double x)
{
	*sum = *sum < 0 || x < 0 ? -1 : *sum + x;
}

static void divide_known(double *sum, uint32_t count)
{
	if (*sum > 0)
		*sum /= count;
}

// Add a sentence of a kind that no image before has had, as long as there is room.
static void add_note(candil_Done *total, const char *note)
{
	for (pb_size_t i = 0; i < total->notes_count; i++)
		if (text_alike(total->notes[i], note))
			return;
	if (total->notes_count < MAX_NOTES)
		memcpy(total->notes[total->notes_count++], note, sizeof total->notes[0]);
}

void sweep_add(struct sweep *sweep, const candil_Done *done)
{
	candil_Done *total = &sweep->total;
	for (pb_size_t i = 0; i < done->stages_count; i++)
		add_stage(total, &done->stages[i]);
	total->error_kind = sweep->finished == 0 ? done->error_kind
						 : (candil_ErrorKind)error_kind_of_both(total->error_kind, done->error_kind);
	add_known(&total->estimated_relmse, done->estimated_relmse);
	add_known(&total->relmse_low, done->relmse_low);
	add_known(&total->relmse_high, done->relmse_high);
	total->figures_count = done->figures_count;
	memcpy(total->figures, done->figures, sizeof total->figures);
	for (pb_size_t i = 0; i < done->notes_count; i++)
		add_note(total, done->notes[i]);
	total->has_verdict = true;
	total->verdict.black += done->verdict.black;
	total->verdict.clipped += done->verdict.clipped;
	total->verdict.missed += done->verdict.missed;
	total->samples = done->samples;
	total->non_finite_samples += done->non_finite_samples;
	total->rays += done->rays;
	total->cold_us += done->cold_us;
	total->slices += done->slices;
	total->retries += done->retries;
	memcpy(total->device, done->device, sizeof total->device);
	// If the deadline cut one image short, that is said of the whole sweep.
	if (strcmp(total->reason, "time") != 0)
		memcpy(total->reason, done->reason, sizeof total->reason);
	sweep->finished++;
}

void sweep_close(struct sweep *sweep, uint64_t now_us)
{
	divide_known(&sweep->total.estimated_relmse, sweep_count(sweep));
	divide_known(&sweep->total.relmse_low, sweep_count(sweep));
	divide_known(&sweep->total.relmse_high, sweep_count(sweep));
	sweep->total.verdict.black /= sweep_count(sweep);
	sweep->total.verdict.clipped /= sweep_count(sweep);
	sweep->total.verdict.missed /= sweep_count(sweep);
	sweep->total.elapsed_us = now_us - sweep->asked_us;
}

void sweep_progress(const struct sweep *sweep, candil_Progress *progress)
{
	uint64_t samples = sweep->message->render.samples;
	uint64_t all = samples * sweep_count(sweep), done = samples * sweep->finished + progress->samples_done;
	progress->samples = all < UINT32_MAX ? (uint32_t)all : UINT32_MAX;
	progress->samples_done = done < UINT32_MAX ? (uint32_t)done : UINT32_MAX;
	progress->fraction = (sweep->finished + progress->fraction) / sweep_count(sweep);
	progress->device_us = sweep->device_us;
	progress->elapsed_us = clock_us() - sweep->asked_us;
}
