#include "server/worker/technique/radiosity/corner_values.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/base/clock.h"
#include "server/worker/technique/radiosity/corner_fit.h"
#include "server/worker/technique/radiosity/corners_parts.h"

#define SWEEPS 64u // over corners on sides whose sides end in corners on sides
#define AROUND (0.9 * 2 * PI) // radians: a corner with less about it is at a border
#define STEPS_NEAR 1024u // members that may be looked at for one border corner
#define PIECE 256u // of hangs, groups or corners, between two looks at the clock

// What is done next, in this order.
enum stage { CHOOSE, TAKE, SWEEP, PUT, DONE };

struct corner_values {
	const struct corners *corners;
	const float *irradiance;
	const uint8_t *reached;
	float *out;
	float (*values)[3]; // by group
	uint8_t *decided; // by group: 1: it hangs
	uint32_t *held; // hangs that count
	uint32_t held_count;
	enum stage stage;
	uint32_t next; // hang, group, held hang or corner
	uint32_t sweep;
	bool changed; // in this sweep
};

// ---- a value ------------------------------------------------------------------------------------------------------------

static bool is_reached(const uint8_t *reached, uint32_t corner)
{
	return !reached || reached[corner / 4];
}

// The mean of a group's irradiances, as the first one and the mean difference from it: that of equal ones is the same.
static void take_mean(const struct corners *c, uint32_t group, const float *irradiance, const uint8_t *reached, float out[3])
{
	const uint32_t half = corners_of(c->elements) / 2;
	const float *first = NULL;
	double sum[3] = {0}, weights = 0;
	for (uint32_t i = c->first[group]; i < c->first[group + 1]; i++) {
		const uint32_t corner = c->members[i];
		if (!is_reached(reached, corner))
			continue;
		const float *h = irradiance + 3 * (uint64_t)(corner / 4);
		const double weight = (double)c->angle[corner % half];
		first = first ? first : h;
		weights += weight;
		for (int k = 0; k < 3; k++)
			sum[k] += weight * ((double)h[k] - (double)first[k]);
	}
	for (int k = 0; k < 3; k++)
		out[k] = !first ? 0 : weights > 0 ? (float)((double)first[k] + sum[k] / weights) : first[k];
}

// Whether what light reaches about a group's corner is not all around it.
static bool is_border(const struct corners *c, uint32_t group, const uint8_t *reached)
{
	const uint32_t half = corners_of(c->elements) / 2;
	double around = 0;
	for (uint32_t i = c->first[group]; i < c->first[group + 1]; i++)
		around += is_reached(reached, c->members[i]) ? (double)c->angle[c->members[i] % half] : 0;
	return around > 0 && around < AROUND;
}

static bool is_listed(const uint32_t *list, uint32_t count, uint32_t element)
{
	for (uint32_t i = 0; i < count; i++)
		if (list[i] == element)
			return true;
	return false;
}

// The elements of a group, and those that share corners with them. Returns their number; 0: they are too many.
static uint32_t list_near(const struct corners *c, uint32_t group, const uint8_t *reached, uint32_t *near)
{
	uint32_t n = 0, steps = 0;
	for (uint32_t i = c->first[group]; i < c->first[group + 1]; i++) {
		const uint32_t own = c->members[i] / 4;
		for (uint32_t k = 4 * own; is_reached(reached, 4 * own) && k < 4 * own + 4; k++) {
			const uint32_t of = c->group[k];
			for (uint32_t m = of == NONE ? 0 : c->first[of]; of != NONE && m < c->first[of + 1]; m++) {
				const uint32_t element = c->members[m] / 4;
				if (++steps > STEPS_NEAR)
					return 0;
				if (!is_reached(reached, c->members[m]) || is_listed(near, n, element))
					continue;
				if (n == CORNER_FIT_MOST)
					return 0;
				near[n++] = element;
			}
		}
	}
	return n;
}

// Extrapolate what a group at a border has, if there is enough to go by.
static void extrapolate(struct corner_values *v, uint32_t group)
{
	const struct corners *c = v->corners;
	uint32_t near[CORNER_FIT_MOST];
	struct corner_sample samples[CORNER_FIT_MOST];
	const uint32_t n = list_near(c, group, v->reached, near);
	for (uint32_t i = 0; i < n; i++)
		samples[i] = (struct corner_sample){c->middle[near[i] % c->elements->patches.count],
						    v->irradiance + 3 * (uint64_t)near[i]};
	corner_fit(c->at[group], samples, n, v->values[group]);
}

// Of each group the hang with the longest side counts, of which light reaches both elements.
static void choose_hang(struct corner_values *v, uint32_t i)
{
	const struct corner_hang *h = &v->corners->hangs[i];
	const uint32_t group = v->corners->group[h->corner];
	if (v->decided[group] || !is_reached(v->reached, h->corner) || !is_reached(v->reached, h->side))
		return;
	v->decided[group] = 1;
	v->held[v->held_count++] = i;
}

// Put a group's value where its side has it. Returns whether it was another.
static bool put_on_side(struct corner_values *v, const struct corner_hang *h)
{
	const struct corners *c = v->corners;
	const uint32_t quarter = h->side & ~3u, half = corners_of(c->elements) / 2;
	const uint32_t corners = c->elements->faces[c->elements->shapes[h->side % half / 4].face].v ? 4 : 3;
	const float *a = v->values[c->group[h->side]], *b = v->values[c->group[quarter + (h->side % 4 + 1) % corners]];
	float *out = v->values[c->group[h->corner]], was[3];
	memcpy(was, out, sizeof was);
	for (int k = 0; k < 3; k++)
		out[k] = (float)((double)a[k] + (double)h->t * ((double)b[k] - (double)a[k]));
	return memcmp(was, out, sizeof was) != 0;
}

// ---- slices -------------------------------------------------------------------------------------------------------------

enum status corner_values_create(const struct corners *corners, const float *irradiance, const uint8_t *reached, float *out,
				 struct corner_values **values, struct error *err)
{
	struct corner_values *v = calloc(1, sizeof *v);
	if (!v)
		return error_set(err, STATUS_MEMORY, "out of memory");
	*v = (struct corner_values){.corners = corners, .irradiance = irradiance, .reached = reached, .out = out};
	v->values = malloc(corners->groups * sizeof *v->values + 1);
	v->decided = calloc((size_t)corners->groups + 1, sizeof *v->decided);
	v->held = malloc(corners->groups * sizeof *v->held + 1);
	if (!v->values || !v->decided || !v->held) {
		corner_values_destroy(v);
		return error_set(err, STATUS_MEMORY, "out of memory");
	}
	*values = v;
	return STATUS_OK;
}

void corner_values_destroy(struct corner_values *v)
{
	if (!v)
		return;
	free(v->values);
	free(v->decided);
	free(v->held);
	free(v);
}

static void take_value(struct corner_values *v, uint32_t group)
{
	take_mean(v->corners, group, v->irradiance, v->reached, v->values[group]);
	if (!v->decided[group] && is_border(v->corners, group, v->reached))
		extrapolate(v, group);
}

static void put_value(struct corner_values *v, uint32_t i)
{
	const uint32_t *of = v->corners->group, group = of[i] == NONE ? of[i - 1] : of[i];
	for (uint32_t k = 0; k < 3; k++)
		v->out[3 * (uint64_t)i + k] = is_reached(v->reached, i) ? v->values[group][k] : 0;
}

// How many things a stage goes through.
static uint32_t things(const struct corner_values *v)
{
	return v->stage == CHOOSE  ? v->corners->hang_count
	       : v->stage == TAKE  ? v->corners->groups
	       : v->stage == SWEEP ? v->held_count
				   : corners_of(v->corners->elements);
}

static void do_thing(struct corner_values *v)
{
	const uint32_t i = v->next++;
	if (v->stage == CHOOSE)
		choose_hang(v, i);
	else if (v->stage == TAKE)
		take_value(v, i);
	else if (v->stage == SWEEP)
		v->changed |= put_on_side(v, &v->corners->hangs[v->held[i]]);
	else
		put_value(v, i);
}

// A stage is over. What depends on longer sides alone is right after one sweep; sides in a ring approach the mean that
// satisfies them all, so there are more as long as one changes something.
static void go_on(struct corner_values *v)
{
	const bool again = v->stage == SWEEP && v->changed && ++v->sweep < SWEEPS;
	v->next = 0;
	v->changed = false;
	v->stage += !again;
}

void corner_values_step(struct corner_values *v, uint32_t budget_us)
{
	const uint64_t start = clock_us();
	do {
		for (uint32_t i = 0; i < PIECE && v->next < things(v); i++)
			do_thing(v);
		if (v->next == things(v))
			go_on(v);
	} while (v->stage != DONE && clock_us() - start < budget_us);
}

bool corner_values_finished(const struct corner_values *v)
{
	return v->stage == DONE;
}
