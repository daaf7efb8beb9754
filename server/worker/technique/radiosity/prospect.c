#include "server/worker/technique/radiosity/prospect.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/worker/devices.h"
#include "server/worker/technique/radiosity/imported.h"
#include "server/worker/technique/radiosity/light.h"
#include "server/worker/technique/radiosity/prospect_try.h"
#include "server/worker/technique/radiosity/radiosity_plan.h"

#define SEEN 0.6 // share of the elements that light reaches, as long as nothing is tried out: fronts, and some backs
#define SEEN_DOUBT 0.35 // deviation of its logarithm
#define ENTRIES_DOUBT 0.5 // likewise, of the entries of a row
#define SOLVE_FIXED 1e6 // entries
#define COUNT_DOUBT 0.1 // of what is counted
#define ROW_DOUBT 1.0 // of what a row takes, by one row
#define MOVED_DOUBT 1.0 // of rows that are taken over where something has moved

// Numbers that do not mean the same by chance: FNV-1a, by words.
static uint64_t hash_words(const uint32_t *words, size_t count)
{
	uint64_t hash = 0xcbf29ce484222325u;
	for (size_t i = 0; i < count; i++)
		hash = (hash ^ words[i]) * 0x100000001b3u;
	return hash;
}

// A row costs about as many units as it has rays or pixels, and something for each element, which are gone through to find
// those that it meets.
static double row_units(const struct row_options *o, double elements)
{
	const double each = elements / 64;
	if (o->way == ROWS_IMPORTED)
		return each;
	if (o->way == ROWS_BY_HEMISPHERE)
		return o->rays + each;
	if (o->way == ROWS_BY_HEMICUBE)
		return 3.0 * o->pixels * o->pixels * o->origins / 16 + each;
	return elements;
}

// The solver goes through all entries some ten times. Each time has a cost of its own, of so many.
static double solve_units(double entries)
{
	return entries + SOLVE_FIXED;
}

static double row_entries(const struct row_options *o, double elements)
{
	const double seen = fmax(elements / 4, 1);
	const double samples = o->way == ROWS_BY_HEMISPHERE ? o->rays
			       : o->way == ROWS_BY_HEMICUBE ? 3.0 * o->pixels * o->pixels * o->origins
							    : INFINITY;
	return seen * -expm1(-samples / seen);
}

// Rows by contour integrals have rays between pairs that are partly hidden from each other alone: few.
static void set_ways(const struct plan *plan, const struct resident_scene *scene, const struct solution_options *o,
		     struct work *w)
{
	const struct row_options *r = &o->factors.rows;
	const struct display_options d = radiosity_display_options(plan, scene);
	const uint32_t rows[] = {r->way, r->mirrors, r->bounces, r->portals};
	const uint32_t light[] = {d.light.points, d.light.shadows, d.light.map_side, d.light.dome, d.light.lamps};
	const uint32_t picture[] = {d.gather > 0, d.plain, d.corners, d.bounces, d.once};
	w->told = WORK_KEPT;
	w->way_of_rows = hash_words(rows, sizeof rows / sizeof *rows);
	w->way_of_pictures = hash_words(picture, sizeof picture / sizeof *picture);
	if (d.gather > 0)
		w->way_of_pictures ^= 3 * hash_words(light, sizeof light / sizeof *light);
	w->picture = d.gather > 0 ? d.gather : 1;
}

static struct light_options light_of(const struct solution_options *o, const struct resident_scene *scene)
{
	return (struct light_options){.points = o->points,
				      .sky_points = o->sky_points,
				      .lamps = solution_finds_lamps(o, scene),
				      .bounces = o->factors.rows.bounces};
}

// What there is to be made of a scene of so many elements, if nothing is there, without having tried.
static void count_all(const struct plan *plan, const struct resident_scene *scene, const struct solution_options *o,
		      double elements, struct work *w)
{
	const struct light_options light = light_of(o, scene);
	const double rows = SEEN * elements;
	w->left[WORK_CUT] = elements;
	w->left[WORK_LIGHT] = light_rays_wanted(plan, scene, &light, (uint32_t)(elements / 2));
	w->left[WORK_ROWS] = rows * row_units(&o->factors.rows, elements);
	w->left[WORK_SOLVE] = solve_units(rows * row_entries(&o->factors.rows, elements));
	w->doubt[WORK_CUT] = w->doubt[WORK_LIGHT] = COUNT_DOUBT;
	w->doubt[WORK_ROWS] = SEEN_DOUBT;
	w->doubt[WORK_SOLVE] = hypot(SEEN_DOUBT, ENTRIES_DOUBT);
}

// The share of the rows that is there, about.
static double share_there(const struct factor_build *there)
{
	const double wanted = SEEN * there->elements.count, rows = (double)there->rows + there->taken;
	return factor_build_finished(there) ? 1 : wanted > 0 ? fmin(1, rows / wanted) : 0;
}

// What a file has is not made, and all that it has is known.
static void count_imported(const struct plan *plan, struct work *w)
{
	if (imported_factors(plan)) {
		w->left[WORK_SOLVE] = solve_units(plan->imported.entries);
		w->doubt[WORK_SOLVE] = COUNT_DOUBT;
	} else if (imported_solution(plan)) {
		w->left[WORK_LIGHT] = w->left[WORK_ROWS] = w->left[WORK_SOLVE] = 0;
	}
}

// Factors of these places are there, or some of them. What lights reach now that did not reach it before is not foreseen.
static void count_there(const struct factor_build *there, struct work *w)
{
	const bool done = factor_build_finished(there);
	w->left[WORK_ROWS] *= 1 - share_there(there);
	w->doubt[WORK_ROWS] = there->moves ? MOVED_DOUBT : SEEN_DOUBT;
	if (!done || there->factors.entries == 0)
		return;
	w->left[WORK_SOLVE] = solve_units((double)there->factors.entries);
	w->doubt[WORK_SOLVE] = COUNT_DOUBT;
}

enum status radiosity_foresee(struct devices *devices, struct resident_scene *scene, const struct plan *plan,
			      uint32_t budget_us, struct work *w, struct error *err)
{
	struct solution_options options;
	*w = (struct work){0};
	radiosity_solution_options(plan, scene, &options);
	set_ways(plan, scene, &options, w);
	if (solution_is_made(scene, &options))
		return STATUS_OK;
	const struct factor_build *there = factor_build_find(scene, &options.factors);
	const double elements = there ? there->elements.count : 2 * radiosity_patches_guess(plan, scene);
	count_all(plan, scene, &options, elements, w);
	if (there)
		count_there(there, w);
	else
		w->told = WORK_COUNTED;
	count_imported(plan, w);
	if (budget_us == 0 || elements <= 0 || imported_solution(plan))
		return STATUS_OK;
	const struct light_options light = light_of(&options, scene);
	const struct prospect_try of = {.devices = devices,
					.scene = scene,
					.plan = plan,
					.factors = &options.factors,
					.light = &light,
					.background = options.background[0] > 0 || options.background[1] > 0 ||
						      options.background[2] > 0,
					.rows = !imported_factors(plan) && (!there || !factor_build_finished(there))};
	struct prospect_found found;
	const enum status s = prospect_run(&of, budget_us, &found, err);
	if (s != STATUS_OK || found.elements == 0)
		return s;
	const double units = row_units(&options.factors.rows, found.elements);
	w->left[WORK_CUT] = found.elements;
	w->made[WORK_CUT] = found.cut;
	w->us[WORK_CUT] = found.cut_us;
	w->left[WORK_LIGHT] = light_rays_wanted(plan, scene, &light, found.elements / 2);
	w->made[WORK_LIGHT] = found.rays;
	w->us[WORK_LIGHT] = found.light_us;
	if (!of.rows)
		return STATUS_OK;
	w->told = there ? WORK_KEPT : WORK_TRIED;
	w->made[WORK_ROWS] = found.rows * units;
	w->us[WORK_ROWS] = found.rows_us;
	w->left[WORK_ROWS] = found.wanted * units * (there ? 1 - share_there(there) : 1);
	w->doubt[WORK_ROWS] = hypot(found.doubt, ROW_DOUBT / sqrt(fmax(found.rows, 1)));
	const double entries = found.rows > 0 ? found.entries : row_entries(&options.factors.rows, found.elements);
	w->left[WORK_SOLVE] = solve_units(found.wanted * entries);
	w->doubt[WORK_SOLVE] = hypot(found.doubt, found.rows > 0 ? COUNT_DOUBT : ENTRIES_DOUBT);
	return STATUS_OK;
}

void radiosity_work(const struct solution *v, const struct resident_scene *scene, const struct plan *plan, bool made,
		    struct work *w)
{
	const struct light_options light = light_of(&v->options, scene);
	const struct elements *e = &v->factors->elements;
	*w = (struct work){0};
	set_ways(plan, scene, &v->options, w);
	if (!made)
		return;
	w->made[WORK_CUT] = e->count;
	w->us[WORK_CUT] =
	    (double)(v->stage_us[SOLUTION_SURFACES] + v->stage_us[SOLUTION_IMPORT] + v->stage_us[SOLUTION_CORNERS]);
	if (v->taken)
		return;
	w->made[WORK_LIGHT] = light_rays_wanted(plan, scene, &light, e->patches.count);
	w->us[WORK_LIGHT] = (double)v->stage_us[SOLUTION_LIGHT];
	w->made[WORK_ROWS] = (double)v->rows * row_units(&v->options.factors.rows, e->count);
	w->us[WORK_ROWS] = (double)v->stage_us[SOLUTION_FACTORS];
	w->made[WORK_SOLVE] = solve_units((double)v->factors->factors.entries);
	w->us[WORK_SOLVE] = (double)v->stage_us[SOLUTION_SOLVE];
}
