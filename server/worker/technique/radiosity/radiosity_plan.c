#include "server/worker/technique/radiosity/radiosity_plan.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/names.h"
#include "server/worker/devices.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/deferred/deferred.h"
#include "server/worker/technique/radiosity/imported.h"
#include "server/worker/technique/radiosity/light.h"
#include "server/worker/technique/radiosity/radiosity_options.h"
#include "server/worker/technique/radiosity/row_maker.h"
#include "server/worker/technique/radiosity/solver.h"
#include "server/worker/technique/radiosity/surfaces.h"
#include "server/worker/technique/technique.h"

#define SKY_POINTS 16u // of a patch for one of those that look at lights

// ---- what is asked for --------------------------------------------------------------------------------------------------

static bool has_mirrors(const struct plan *plan, const struct resident_scene *scene)
{
	return radiosity_has_mirrors(radiosity_settings(plan)) && plan_has(plan, candil_Effect_EFFECT_GLOSSY) &&
	       (radiosity_settings(plan)->mirrors == RADIOSITY_MIRRORS_ON || surfaces_may_mirror(&scene->view));
}

// Only what the way reads is filled in, so that what it does not read makes no other rows.
static void rows_of(const struct plan *plan, const struct resident_scene *scene, struct row_options *o)
{
	const struct radiosity_settings *s = radiosity_settings(plan);
	o->mirrors = has_mirrors(plan, scene);
	o->bounces = o->mirrors ? s->bounces : 0;
	o->way = plan->imported.elements > 0 ? ROWS_IMPORTED : s->factors;
	if (o->way == ROWS_IMPORTED)
		return;
	o->rays = s->factors != ROWS_BY_HEMICUBE ? s->rays : 0;
	o->portals = o->mirrors && s->mirrors == RADIOSITY_MIRRORS_PORTAL;
	o->pixels = s->factors == ROWS_BY_HEMICUBE ? s->pixels : 0;
	o->origins = s->factors == ROWS_BY_HEMICUBE ? s->origins : 0;
}

// Effects that matter to rows: what is cut out, and what mirrors reflect.
static uint32_t effects_of_rows(const struct plan *plan, bool mirrors)
{
	const uint32_t masks = plan->effects & 1u << candil_Effect_EFFECT_ALPHA_MASK;
	const uint32_t looks = 1u << candil_Effect_EFFECT_TEXTURES | 1u << candil_Effect_EFFECT_VERTEX_COLORS |
			       1u << candil_Effect_EFFECT_UNLIT;
	return masks | (masks || mirrors ? plan->effects & looks : 0);
}

void radiosity_solution_options(const struct plan *plan, const struct resident_scene *scene, struct solution_options *o)
{
	const struct radiosity_settings *s = radiosity_settings(plan);
	memset(o, 0, sizeof *o);
	o->factors.cut.edge = (double)s->edge;
	o->factors.cut.count = s->edge > 0 ? 0 : s->patches;
	rows_of(plan, scene, &o->factors.rows);
	// What masks cut out also changes what is covered of patches, whoever made the rows.
	o->factors.effects = effects_of_rows(plan, o->factors.rows.mirrors && plan->imported.elements == 0);
	memcpy(o->factors.imported, plan->imported.hash, sizeof o->factors.imported);
	o->effects = plan->effects;
	o->points = s->points;
	o->sky_points = s->points < LIMIT_RADIOSITY_POINTS / SKY_POINTS ? SKY_POINTS * s->points : LIMIT_RADIOSITY_POINTS;
	o->emitters = s->emitters;
	// Light that mirrors pass on counts at each of them, so that sums of rows say nothing; imported rows may have met
	// some.
	o->project = o->factors.rows.mirrors || plan->imported.elements > 0 ? RADIOSITY_PROJECT_NONE : s->project;
	o->solver = s->solver;
	o->residual = s->residual;
	if (plan_has_sky(plan)) {
		o->sky = plan->environment.scene->id;
		o->sky_turn = (float)plan->environment.turn;
		o->sky_scale = (float)plan->environment.scale;
	} else if (plan_has(plan, candil_Effect_EFFECT_ENVIRONMENT)) {
		memcpy(o->background, plan->background, sizeof o->background);
	}
}

struct display_options radiosity_display_options(const struct plan *plan, const struct resident_scene *scene)
{
	const struct radiosity_settings *s = radiosity_settings(plan);
	const bool shows = s->show != RADIOSITY_SHOW_NONE;
	return (struct display_options){
	    .plain = shows,
	    .corners = !shows && s->display != RADIOSITY_DISPLAY_CONSTANT,
	    .gather = !shows && s->display == RADIOSITY_DISPLAY_GATHER ? s->gather : 0,
	    .bounces = !shows && has_mirrors(plan, scene) ? s->bounces : 0,
	    .once = !plan_has(plan, candil_Effect_EFFECT_BOUNCES),
	    .light = lighting_wish_of(&s->direct, s->direct.shadows == DIRECT_SHADOWS_MAP, true),
	};
}

// ---- memory -------------------------------------------------------------------------------------------------------------

static double side_of(const struct vertex *a, const struct vertex *b)
{
	double sum = 0;
	for (int c = 0; c < 3; c++) {
		const double d = (double)b->position[c] - (double)a->position[c];
		sum += d * d;
	}
	return sqrt(sum);
}

// Triangles count as halves of quads.
static double count_patches(const struct resident_scene *scene, double edge)
{
	const struct triangle *triangles = scene_section(scene, BLOB_TRIANGLES);
	const struct vertex *vertices = scene_section(scene, BLOB_VERTICES);
	double sum = 0;
	for (uint32_t i = 0; i < scene_count(scene, BLOB_TRIANGLES); i++) {
		const struct vertex *v[3];
		double side[3], longest = 0, parts = 0.5;
		for (int k = 0; k < 3; k++)
			v[k] = &vertices[triangles[i].vertex[k]];
		for (int k = 0; k < 3; k++) {
			side[k] = side_of(v[k], v[(k + 1) % 3]);
			longest = fmax(longest, side[k]);
		}
		for (int k = 0; k < 3; k++)
			parts *= side[k] < longest ? ceil(side[k] / edge) : 1;
		sum += parts;
	}
	return fmin(sum, PATCHES_MOST);
}

// What was counted last of a scene: it is asked for several times a job, and a scene may have millions of triangles.
struct patch_guess {
	struct derived derived;
	double edge; // 0: nothing was counted
	double patches;
};

static void guess_destroy(struct derived *derived)
{
	free(derived);
}

double radiosity_patches_guess(const struct plan *plan, struct resident_scene *scene)
{
	static const char kind;
	const struct radiosity_settings *s = radiosity_settings(plan);
	const double edge = (double)s->edge;
	if (!(edge > 0))
		return fmax(s->patches, 0.5 * scene_count(scene, BLOB_TRIANGLES));
	struct patch_guess *guess = (struct patch_guess *)resident_derived(scene, &kind);
	if (!guess && (guess = calloc(1, sizeof *guess))) {
		guess->derived = (struct derived){.kind = &kind, .destroy = guess_destroy};
		resident_derive(scene, &guess->derived);
	}
	// Without memory for it, it is counted again.
	if (!guess)
		return count_patches(scene, edge);
	if (guess->edge != edge)
		*guess =
		    (struct patch_guess){.derived = guess->derived, .edge = edge, .patches = count_patches(scene, edge)};
	return guess->patches;
}

// Of `n` elements that are seen, so many are met by some of the rays of a row, if all are met alike.
static double entries_guess(double n, double rays)
{
	return n > 0 ? n * -expm1(-rays / n) : 0;
}

uint64_t radiosity_bytes(const struct devices *devices, struct resident_scene *scene, const struct plan *plan)
{
	const struct display_options display = radiosity_display_options(plan, scene);
	const uint32_t triangles = scene_count(scene, BLOB_TRIANGLES);
	const double n = radiosity_patches_guess(plan, scene);
	const uint32_t patches = (uint32_t)n;
	const struct row_scene of = {triangles, scene_count(scene, BLOB_VERTICES), triangles, patches};
	struct row_options rows = {0};
	rows_of(plan, scene, &rows);
	const double samples = rows.way == ROWS_BY_HEMISPHERE ? rows.rays
			       : rows.way == ROWS_BY_HEMICUBE ? 3.0 * rows.pixels * rows.pixels * rows.origins
							      : INFINITY;
	const double entries = rows.way == ROWS_IMPORTED ? plan->imported.entries : n * entries_guess(n, samples);
	const bool taken = imported_solution(plan);
	const uint64_t shown = deferred_bytes(devices, plan, radiosity_settings(plan)->direct.rows) +
			       display_bytes(devices, scene, plan, &display) +
			       display_field_bytes(triangles, triangles, patches, display.corners);
	return (format_is_picture(plan->format) ? shown : 0) + element_buffers_bytes(triangles, triangles, patches) +
	       surfaces_bytes(triangles) + (taken ? 0 : light_bytes(plan, triangles, patches)) +
	       row_maker_bytes(&of, &rows) + (taken ? 0 : solver_bytes(2 * patches)) +
	       factors_bytes_most((uint64_t)entries, patches) +
	       (radiosity_settings(plan)->project != RADIOSITY_PROJECT_NONE
		    ? factors_bytes_most((uint64_t)(2 * entries), patches)
		    : 0);
}

void radiosity_advise(const struct devices *devices, struct resident_scene *scene, const struct plan *plan, uint64_t budget,
		      char *advice)
{
	struct plan smaller = *plan;
	struct radiosity_settings *s = radiosity_settings_of(&smaller);
	const double least = 0.5 * scene_count(scene, BLOB_TRIANGLES);
	s->patches = (uint32_t)radiosity_patches_guess(plan, scene);
	s->edge = 0;
	// A file is of as many patches as it is.
	if (plan->imported.elements > 0)
		return;
	while (s->patches > 1 && s->patches > least && radiosity_bytes(devices, scene, &smaller) > budget)
		s->patches -= s->patches / 8 + 1;
	if (radiosity_bytes(devices, scene, &smaller) <= budget)
		snprintf(advice, TECHNIQUE_ADVICE_BYTES, "radiosity.patches=%u would fit", s->patches);
}

// ---- what is said of it
// -----------------------------------------------------------------------------------------------------------

uint32_t radiosity_depth(const struct plan *plan)
{
	(void)plan;
	return DEPTH_UNBOUNDED; // the solver ends it
}

const char *radiosity_cannot(const struct plan *plan, candil_Effect effect)
{
	if (effect == candil_Effect_EFFECT_CAUSTICS)
		return "mirrors pass on the light of surfaces, but not that of point, spot and directional lights";
	if (effect == candil_Effect_EFFECT_GLOSSY && !radiosity_has_mirrors(radiosity_settings(plan)))
		return "radiosity.mirrors or radiosity.factors says so: metals are diffuse";
	return NULL;
}

const char *radiosity_simulates(const struct plan *plan, candil_Effect effect)
{
	(void)plan;
	return effect == candil_Effect_EFFECT_GLOSSY ? "polished metals are mirrors; what else is glossy is diffuse" : NULL;
}

// Materials that pt shows as glossy and that are diffuse here.
static uint32_t glossy_materials(const struct resident_scene *scene)
{
	const struct material *m = scene_section(scene, BLOB_MATERIALS);
	const struct material_use *uses = scene_section(scene, BLOB_MATERIAL_USES);
	uint32_t count = 0;
	for (uint32_t i = 0; i < scene_count(scene, BLOB_MATERIALS); i++) {
		const bool lobe = m[i].specular_weight > 0 || m[i].metallic > 0;
		const bool mirror = m[i].metallic >= 1 && (double)(m[i].roughness * m[i].roughness) <= PATCH_MIRROR_ALPHA;
		count += uses[i].triangles > 0 && !(m[i].flags & MATERIAL_UNLIT) && lobe && !mirror;
	}
	return count;
}

void radiosity_notes(const struct resident_scene *scene, const struct plan *plan, candil_Accepted *accepted)
{
	const uint32_t glossy = plan_has(plan, candil_Effect_EFFECT_GLOSSY) ? glossy_materials(scene) : 0;
	deferred_notes(scene, plan, accepted);
	if (imported_factors(plan))
		technique_note(accepted,
			       "form factors are those of the imported file: radiosity.factors and what goes with it "
			       "count for nothing");
	if (imported_solution(plan))
		technique_note(accepted,
			       "the light on surfaces is that of the imported file, whatever lights this request has");
	if (radiosity_settings(plan)->project != RADIOSITY_PROJECT_NONE && has_mirrors(plan, scene))
		technique_note(accepted,
			       "radiosity.project does nothing where mirrors pass on light: rows of form factors have no "
			       "known sum there");
	if (glossy > 0)
		technique_note(accepted,
			       "radiosity has no glossy surfaces but mirrors of polished metal: %u material%s drawn diffuse",
			       glossy, glossy == 1 ? " is" : "s are");
}
