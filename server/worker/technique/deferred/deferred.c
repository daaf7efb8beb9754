// The cursor goes sample by sample, band by band, pass by pass, unit by unit. It takes as many units at once as should fit
// the rest of the slice by the speed measured so far. Where a slice ends changes no bit, because the units of a pass are
// independent of each other.
#include "server/worker/technique/deferred/deferred.h"

#include <stdlib.h>

#include "server/base/clock.h"
#include "server/worker/technique/common/resolve.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/deferred/deferred_cover.h"
#include "server/worker/technique/deferred/deferred_job.h"

#define FIRST_TILES 64u
#define FIRST_TILES_TIMED 4u // with a deadline, which they may not overrun by more than about a tile's time
#define FIRST_COST 1e6 // of the first piece of triangles, pixels
#define LEAST_COST 1e5 // of any piece of triangles, pixels: less would measure little but the wait for the device

static bool finished(const struct deferred *d)
{
	return d->sample == d->plan.samples;
}

static void advance(struct deferred *d, uint32_t units)
{
	const uint32_t works = d->aov_done ? d->work_count : 2;
	d->unit += units;
	if (d->unit < deferred_units(d, deferred_current(d), d->band))
		return;
	d->unit = 0;
	if (++d->work < works)
		return;
	d->work = 0;
	if (++d->band < d->band_count)
		return;
	d->band = 0;
	if (d->aov_done)
		d->sample++;
	d->aov_done = true;
}

// The cursor's place in the pass's forecast, which goes over all bands.
static uint32_t place(const struct deferred *d, const struct deferred_work *w)
{
	return d->band * deferred_units_most(d, w) + d->unit;
}

// How many units should take `us`: at least one if there is one. A scene without triangles has none to draw, and what
// another scene's job left bound must not be drawn in its stead. *cost is that of triangles together, deferred_drawable's,
// because one may cover a point or all of the picture.
static uint32_t affordable(const struct deferred *d, const struct deferred_work *w, double us, double *cost)
{
	const uint32_t left = deferred_units(d, w, d->band) - d->unit;
	if (w->kind == DEFERRED_DRAW) {
		const struct deferred_rows *r = &d->bands[d->band].outer;
		*cost = w->pixel_us > 0 ? us / w->pixel_us : FIRST_COST;
		*cost = *cost > LEAST_COST ? *cost : LEAST_COST;
		return deferred_drawable(&d->plan, d->scene, r->first_row, r->rows, d->unit, left, cost);
	}
	const uint32_t first = d->plan.end_us > 0 ? FIRST_TILES_TIMED : FIRST_TILES;
	if (forecast_us(w->forecast, place(d, w), 1) > 0)
		return forecast_fit(w->forecast, place(d, w), left, us);
	return first < left ? first : left;
}

// Microseconds that the shortest piece from the cursor on takes, as far as is known.
static double least_us(struct deferred *d)
{
	const struct deferred_work *w = deferred_current(d);
	return w->kind == DEFERRED_DRAW ? LEAST_COST * w->pixel_us : forecast_least_us(w->forecast, place(d, w));
}

static enum status deferred_take_counters(struct deferred *d, struct error *err)
{
	struct pass_counters now;
	enum status s = gl_buffer_read(&d->counters, d->device, 0, sizeof now, &now, err);
	if (s != STATUS_OK)
		return s;
	d->rays = (uint64_t)now.rays_high << 32 | now.rays;
	d->non_finite += now.non_finite - d->seen.non_finite;
	d->seen = now;
	if (now.cut)
		return error_set(err, STATUS_TRAVERSAL_CUT,
				 "one pixel's rays visit more of this scene than the driver lets a loop run: ask for fewer "
				 "points on its lamps, or use a GPU or a newer driver");
	return STATUS_OK;
}

static enum status run_piece(struct deferred *d, double us, struct error *err)
{
	struct deferred_work *w = deferred_current(d);
	double cost = 0;
	const uint32_t units = affordable(d, w, us, &cost);
	const uint64_t start = clock_us();
	deferred_record(d, units);
	enum status s = gl_wait(d->device, w->stage, err);
	if (s == STATUS_OK && w->kind == DEFERRED_SUM)
		s = deferred_take_counters(d, err);
	const uint64_t us_taken = clock_us() - start;
	d->work_us += us_taken;
	if (units > 0 && w->kind == DEFERRED_DRAW) {
		const double measured = (double)us_taken / cost;
		w->pixel_us = w->pixel_us > 0 ? 0.5 * (w->pixel_us + measured) : measured;
	} else if (units > 0) {
		forecast_add(w->forecast, place(d, w), units, (double)us_taken);
	}
	advance(d, units);
	return s;
}

static double fraction(struct deferred *d)
{
	if (finished(d))
		return 1;
	const double works = d->aov_done ? d->work_count : 2;
	const uint32_t units = d->work < works ? deferred_units(d, deferred_current(d), d->band) : 0;
	const double unit = units > 0 ? (double)d->unit / units : 0;
	return (d->sample + (d->band + (d->work + unit) / works) / d->band_count) / d->plan.samples;
}

// Whether there is no time for another piece before the end.
static bool deferred_is_late(struct deferred *d)
{
	return !finished(d) && (d->sample > 0 || !d->plan.first_sure) && !plan_fits(&d->plan, clock_us(), least_us(d));
}

enum status deferred_step(struct deferred *d, uint32_t budget_us, struct step_result *result, struct error *err)
{
	const uint64_t start = clock_us();
	const uint32_t begun_at = d->sample;
	uint64_t spent = 0;
	while (!finished(d) && !deferred_is_late(d)) {
		const double left_us = (double)(budget_us - spent);
		enum status s = run_piece(d, plan_piece_us(&d->plan, start + spent, left_us), err);
		if (s != STATUS_OK)
			return s;
		if (d->plan.deadline && begun_at == 0 && d->sample == 1)
			break;
		spent = clock_us() - start;
		// What is left of the budget is less than another piece takes.
		if (spent >= budget_us || (!finished(d) && (double)(budget_us - spent) < least_us(d)))
			break;
	}
	result->samples_done = d->sample;
	result->finished = finished(d);
	result->late = deferred_is_late(d);
	result->drawing = true;
	result->sample_us = d->sample > 0 ? (double)d->work_us / d->sample : 0;
	result->fraction = fraction(d);
	return STATUS_OK;
}

// ---- read ---------------------------------------------------------------------------------------------------------------

static enum status read_pixels(const struct gl_buffer *b, struct gl_device *device, uint64_t before, uint64_t count,
			       uint64_t each, void *out, struct error *err)
{
	return gl_buffer_read(b, device, before * each, count * each, out, err);
}

static enum status deferred_read_band(struct deferred *d, uint32_t index, struct frame *f, struct resolver *r,
				      struct error *err)
{
	const struct deferred_band *b = &d->bands[index];
	const uint64_t before = (uint64_t)(b->own.first_row - b->outer.first_row) * d->plan.width;
	const uint64_t pixels = (uint64_t)b->own.rows * d->plan.width;
	void *host = malloc((size_t)pixels * ACCUMULATOR_FLOATS * sizeof(float));
	if (!host)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status s = read_pixels(&b->sums, d->device, before, pixels, ACCUMULATOR_FLOATS * sizeof(float), host, err);
	if (s == STATUS_OK)
		resolve_sums(r, host, b->own.first_row, b->own.rows, f);
	if (s == STATUS_OK && b->aov.bytes > 0) {
		// AOVs need less room than the sums did, which are read by now.
		s = read_pixels(&b->aov, d->device, before, pixels, AOV_WORDS * sizeof(uint32_t), host, err);
		if (s == STATUS_OK)
			resolve_aovs(host, b->own.first_row, b->own.rows, f);
	}
	free(host);
	return s;
}

static enum status deferred_read_met(const struct deferred *d, struct frame *f, struct error *err)
{
	const uint64_t bytes = met_bytes(f->width, f->height);
	uint32_t *met = malloc(bytes);
	if (!met)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status s = gl_buffer_read(&d->counters, d->device, sizeof(struct pass_counters), bytes, met, err);
	if (s == STATUS_OK)
		resolve_met(met, f);
	free(met);
	return s;
}

// The number of tiles whose sums have one sample more than d->sample: those of whole bands, and those of the cursor's band
// that the sum pass has done.
static uint32_t tiles_ahead(const struct deferred *d)
{
	if (finished(d) || !d->aov_done)
		return 0;
	const struct deferred_band *b = &d->bands[d->band];
	return b->own.first_tile + (d->work == d->work_count - 1 ? d->unit : 0);
}

static void deferred_account(struct deferred *d, struct frame *f, uint64_t resolve_us)
{
	f->samples = d->sample;
	f->ahead = d->sample == 0 ? tiles_ahead(d) : 0;
	f->non_finite_samples = d->non_finite;
	f->rays = d->rays;
	if (d->upload_us)
		frame_add_stage(f, "upload", d->upload_us);
	gl_timer_collect(&d->timer);
	for (uint32_t i = 0; i < d->timer.stage_count; i++)
		if (d->timer.stages[i].us > 0 || d->timer.stages[i].passes > 0)
			frame_add_stage(f, d->timer.stages[i].name, d->timer.stages[i].us);
	frame_add_stage(f, "resolve", resolve_us);
}

enum status deferred_read(struct deferred *d, struct frame **frame, struct error *err)
{
	struct frame *f;
	const uint64_t start = clock_us();
	enum status s = frame_create(d->plan.width, d->plan.height, d->plan.aovs, &f, err);
	if (s != STATUS_OK)
		return s;
	struct resolver resolver;
	resolver_init(&resolver, d->plan.first_sample, d->sample, tiles_ahead(d), 1);
	for (uint32_t i = 0; s == STATUS_OK && i < d->band_count; i++)
		s = deferred_read_band(d, i, f, &resolver, err);
	if (s == STATUS_OK)
		s = deferred_read_met(d, f, err);
	if (s != STATUS_OK) {
		frame_destroy(f);
		return s;
	}
	deferred_account(d, f, clock_us() - start);
	*frame = f;
	return STATUS_OK;
}

void deferred_notes(const struct resident_scene *scene, const struct plan *plan, candil_Accepted *accepted)
{
	if (plan_has(plan, candil_Effect_EFFECT_LIGHTS) && scene_has_discs(scene))
		technique_note(accepted, "a directional light's angle is left out: its shadows are sharp");
}

struct gl_timer *deferred_timer(struct deferred *d)
{
	return &d->timer;
}

void deferred_add_setup(struct deferred *d, uint64_t upload_us, uint64_t compile_us)
{
	d->upload_us += upload_us;
	gl_timer_add(&d->timer, FRAME_STAGE_COMPILE, compile_us);
}
