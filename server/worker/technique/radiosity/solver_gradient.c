// Conjugate residuals, each channel with its own: <x, y> = Σ A ρ x y, z = (1 - F ρ) r.
//	β = -<z, q> / <q, q>,  p ← r + β p,  q ← z + β q,  α = <r, q> / <q, q>,  e ← e + α p,  r ← r - α q
#include <math.h>

#include "server/worker/technique/radiosity/solver_parts.h"
#include "server/worker/vk/command.h"

#define LOOK_AGAIN 16u // gradients, in which the residual must have fallen
#define FALLS_TO 0.8 // times <r, r>, in some channel

static double quotient(double a, double b)
{
	const double q = a / b;
	// A channel without light is all 0; so is one whose products no float can hold any more.
	return b > 0 && isfinite(q) ? q : 0;
}

// Run a step over all elements.
static enum status run_step(struct solver *s, uint32_t step, const double scale[4], struct error *err)
{
	enum status status = command_begin(s->device, err);
	if (status != STATUS_OK)
		return status;
	solver_clear_maxima(s);
	solver_record_step(s, step, 0, s->count, scale);
	solver_fetch_maxima(s);
	return command_finish(s->device, err);
}

// Whether in no channel the residual has fallen for some time.
static bool is_stuck(struct solver *s)
{
	bool fell = false;
	if (s->gradients % LOOK_AGAIN != 0)
		return false;
	for (int c = 0; c < 3; c++) {
		const double length = solver_sum(s, 1, c);
		fell = fell || s->gradients == 0 || length < FALLS_TO * s->mark[c];
		s->mark[c] = length;
	}
	return !fell;
}

enum status solver_gradient(struct solver *s, bool *stuck, struct error *err)
{
	double scale[4] = {0};
	*stuck = is_stuck(s);
	for (int c = 0; c < 3; c++)
		scale[c] = s->gradients > 0 ? -quotient(solver_sum(s, 0, c), s->length[c]) : 0;
	s->gradients++;
	enum status status = run_step(s, STEP_AIM, scale, err);
	if (status != STATUS_OK)
		return status;
	for (int c = 0; c < 3; c++) {
		s->length[c] = solver_sum(s, 1, c);
		scale[c] = quotient(solver_sum(s, 0, c), s->length[c]);
	}
	return run_step(s, STEP_MOVE, scale, err);
}
