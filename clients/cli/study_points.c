// The points of a plan.
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/render_values.h"
#include "clients/cli/study.h"
#include "clients/libcandil/message.h"
#include "protocol/asked.h"

// What a plain point of a technique without noise has: edges, and what it gains from more of them. Where the last two counts
// have the same error, more would not lower it; what does not fit into the budget is left out.
static const uint32_t plain_samples[] = {1, 4, 16, 64};
#define PLAIN_SEEDS 3u // at least, for where in a pixel the samples are is drawn, too

// ---- points ----------------------------------------------------------------------------------------------------------

static bool same_settings(const struct study_point *a, const struct study_point *b)
{
	if (a->setting_count != b->setting_count)
		return false;
	for (uint32_t i = 0; i < a->setting_count; i++)
		if (strcmp(a->settings[i].name, b->settings[i].name) != 0 ||
		    strcmp(a->settings[i].value, b->settings[i].value) != 0)
			return false;
	return true;
}

bool study_is_series(const struct study_point *a, const struct study_point *b)
{
	return a->technique == b->technique && same_settings(a, b) && strcmp(a->effects, b->effects) == 0;
}

bool study_is_first(const struct study_plan *plan, uint32_t point)
{
	for (uint32_t i = 0; i < point; i++)
		if (study_is_series(&plan->points[i], &plan->points[point]))
			return false;
	return true;
}

bool study_add_point(struct study_plan *plan, const struct study_point *point)
{
	for (uint32_t i = 0; i < plan->point_count; i++) {
		struct study_point *p = &plan->points[i];
		if (p->samples == point->samples && study_is_series(p, point)) {
			p->probe = p->probe && point->probe;
			p->seeds = point->seeds > p->seeds ? point->seeds : p->seeds;
			return true;
		}
	}
	if (plan->point_count == STUDY_POINTS_MAX)
		return false;
	struct study_point *more = realloc(plan->points, (plan->point_count + 1) * sizeof(*more));
	if (!more)
		return false;
	plan->points = more;
	plan->points[plan->point_count] = *point;
	// The order of options does not matter to a technique, but would to the id of a run.
	struct study_point *p = &plan->points[plan->point_count++];
	for (uint32_t i = 1; i < p->setting_count; i++)
		for (uint32_t j = i; j > 0 && strcmp(p->settings[j - 1].name, p->settings[j].name) > 0; j--) {
			const struct study_setting s = p->settings[j];
			p->settings[j] = p->settings[j - 1];
			p->settings[j - 1] = s;
		}
	return true;
}

// Whether a point comes before another: by technique, then as they were added, those of a series by their samples.
static bool is_before(const struct study_plan *plan, const struct study_point *a, const struct study_point *b)
{
	uint32_t i = 0;
	if (a->technique != b->technique)
		return a->technique < b->technique;
	if (study_is_series(a, b))
		return a->samples < b->samples;
	while (!study_is_series(&plan->points[i], a) && !study_is_series(&plan->points[i], b))
		i++;
	return study_is_series(&plan->points[i], a);
}

void study_sort_points(struct study_plan *plan)
{
	for (uint32_t i = 1; i < plan->point_count; i++) {
		for (uint32_t j = i; j > 0 && is_before(plan, &plan->points[j], &plan->points[j - 1]); j--) {
			const struct study_point p = plan->points[j];
			plan->points[j] = plan->points[j - 1];
			plan->points[j - 1] = p;
		}
	}
}

bool study_is_plain(const struct study_point *point, unsigned technique, uint32_t samples)
{
	return point->technique == technique && point->samples == samples && point->setting_count == 0 &&
	       point->kind == STUDY_POINT;
}

uint32_t study_seeds_of(const struct study_plan *plan, const struct study_point *point)
{
	if (point->seeds > 0)
		return point->seeds;
	return study_has_noise(point->technique) ? plan->seeds : plan->repeats;
}

// Add a point for each of the values between spaces.
static bool add_values(struct study_plan *plan, unsigned technique, const char *option, const char *values)
{
	struct study_point point = {.kind = STUDY_POINT, .technique = technique, .samples = 1, .setting_count = 1};
	snprintf(point.settings[0].name, sizeof(point.settings[0].name), "%s", option);
	while (*values) {
		const size_t length = strcspn(values, " ");
		snprintf(point.settings[0].value, sizeof(point.settings[0].value), "%.*s", (int)length, values);
		if (!study_add_point(plan, &point))
			return false;
		values += length + strspn(values + length, " ");
	}
	return true;
}

bool study_default_points(struct study *study)
{
	static const struct {
		const char *option, *values, *quick;
	} knobs[] = {
#define KNOB(option, values, quick) {option, values, quick},
	    CANDIL_KNOB_LIST(KNOB)
#undef KNOB
	};
	for (unsigned t = 1; t < TECHNIQUE_COUNT; t++) {
		if (!(study->techniques & 1u << t))
			continue;
		struct study_point plain = {.kind = STUDY_POINT, .technique = t, .samples = STUDY_SAMPLES_FIT};
		const size_t count = study_has_noise(t) ? 0 : sizeof(plain_samples) / sizeof(*plain_samples);
		if (count > 0 && study->plan.repeats < PLAIN_SEEDS)
			plain.seeds = PLAIN_SEEDS;
		if (count == 0 && !study_add_point(&study->plan, &plain))
			return false;
		for (size_t i = 0; i < count; i++) {
			plain.samples = plain_samples[i];
			if (!study_add_point(&study->plan, &plain))
				return false;
		}
		for (size_t i = 0; i < sizeof(knobs) / sizeof(*knobs); i++) {
			const char *dot = strchr(knobs[i].option, '.');
			if (technique_number(knobs[i].option, (size_t)(dot - knobs[i].option)) == (int)t &&
			    !add_values(&study->plan, t, knobs[i].option,
					study->texts.quick ? knobs[i].quick : knobs[i].values))
				return false;
		}
	}
	return true;
}
