#include "server/front/answers.h"

#include <math.h>
#include <string.h>

#include "protocol/names.h"
#include "protocol/text.h"

// Any byte may be where a truth is, and C has rules for 0 and 1 alone.
static void truth_clean(bool *truth)
{
	unsigned char byte;
	memcpy(&byte, truth, sizeof byte);
	*truth = byte != 0;
}

static bool accepted_holds(candil_Accepted *accepted)
{
	if (accepted->plan_count > sizeof accepted->plan / sizeof *accepted->plan ||
	    accepted->notes_count > sizeof accepted->notes / sizeof *accepted->notes)
		return false;
	for (size_t i = 0; i < accepted->notes_count; i++)
		text_clean(accepted->notes[i], sizeof accepted->notes[i]);
	text_clean(accepted->device, sizeof accepted->device);
	for (size_t i = 0; i < accepted->plan_count; i++)
		text_clean(accepted->plan[i].why, sizeof accepted->plan[i].why);
	for (size_t i = 0; i < accepted->plan_count; i++) {
		truth_clean(&accepted->plan[i].has_share);
		truth_clean(&accepted->plan[i].has_cost_us);
		accepted->plan[i].has_share = accepted->plan[i].has_share && isfinite(accepted->plan[i].share);
	}
	truth_clean(&accepted->default_light);
	return true;
}

static bool done_holds(candil_Done *done)
{
	if (done->stages_count > sizeof done->stages / sizeof *done->stages ||
	    done->figures_count > sizeof done->figures / sizeof *done->figures ||
	    done->notes_count > sizeof done->notes / sizeof *done->notes)
		return false;
	for (size_t i = 0; i < done->notes_count; i++)
		text_clean(done->notes[i], sizeof done->notes[i]);
	for (size_t i = 0; i < done->figures_count; i++) {
		text_clean(done->figures[i].name, sizeof done->figures[i].name);
		text_clean(done->figures[i].unit, sizeof done->figures[i].unit);
		if (!isfinite(done->figures[i].value))
			return false;
	}
	truth_clean(&done->has_verdict);
	text_clean(done->device, sizeof done->device);
	text_clean(done->reason, sizeof done->reason);
	for (size_t i = 0; i < done->stages_count; i++)
		text_clean(done->stages[i].name, sizeof done->stages[i].name);
	return true;
}

static bool is_known(double x)
{
	return isfinite(x) && x >= 0;
}

static bool estimate_holds(const struct estimate *e)
{
	return (unsigned)e->kind < ERROR_KIND_COUNT && isfinite(e->relmse) && isfinite(e->low) && isfinite(e->high);
}

void answer_ready_clean(struct ipc_ready *ready)
{
	text_clean(ready->device, sizeof ready->device);
	text_clean(ready->error.text, sizeof ready->error.text);
	text_clean(ready->key, sizeof ready->key);
}

bool answer_begun_holds(struct ipc_begun *begun)
{
	text_clean(begun->error.text, sizeof begun->error.text);
	return accepted_holds(&begun->accepted);
}

void answer_stepped_clean(struct ipc_stepped *stepped)
{
	text_clean(stepped->error.text, sizeof stepped->error.text);
}

static bool bias_holds(const struct pilot_bias *b)
{
	return estimate_holds(&b->error) && b->pixels <= LIMIT_PIXELS && b->samples <= LIMIT_SAMPLES && b->edges >= 0 &&
	       b->edges <= 1;
}

static bool work_holds(const struct work *w)
{
	for (int part = 0; part < WORK_PARTS; part++)
		if (!is_known(w->left[part]) || !is_known(w->made[part]) || !is_known(w->us[part]) ||
		    !is_known(w->doubt[part]))
			return false;
	return is_known(w->picture) && (w->told == 0 || w->picture > 0);
}

static bool result_holds(const struct pilot_result *r)
{
	for (unsigned b = 0; b < sizeof r->bias / sizeof *r->bias; b++)
		if (!bias_holds(&r->bias[b]))
			return false;
	return work_holds(&r->work) && estimate_holds(&r->error) && is_known(r->cold_us) && is_known(r->setup_us) &&
	       is_known(r->pixel_us) && is_known(r->sample_us) && r->pixels <= LIMIT_PIXELS && r->samples <= LIMIT_SAMPLES;
}

bool answer_piloted_holds(struct ipc_piloted *piloted)
{
	text_clean(piloted->error.text, sizeof piloted->error.text);
	for (unsigned i = 0; i < TECHNIQUE_COUNT; i++)
		if (!result_holds(&piloted->results[i]))
			return false;
	return status_is_known(piloted->error.code) && piloted->cold_technique < TECHNIQUE_COUNT;
}

bool answer_image_holds(struct ipc_image *image)
{
	truth_clean(&image->frame.final);
	text_clean(image->error.text, sizeof image->error.text);
	return done_holds(&image->done) && work_holds(&image->work);
}
