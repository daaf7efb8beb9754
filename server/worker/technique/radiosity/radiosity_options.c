#include "server/worker/technique/radiosity/radiosity_options.h"

#include "protocol/names.h"
#include "server/worker/technique/radiosity/hemicube.h"
#include "server/worker/technique/radiosity/imported.h"
#include "server/worker/technique/radiosity/patches.h"
#include "server/worker/technique/radiosity/sight.h"
#include "server/worker/technique/radiosity/solver.h"

_Static_assert(sizeof(struct radiosity_settings) <= PLAN_SETTINGS_BYTES, "the plan has room for them");
_Static_assert(offsetof(struct radiosity_settings, direct) == 0, "direct_settings() finds them");

#define PATCHES_DEFAULT 4096u
#define RAYS_DEFAULT 1024u

static const char *const factor_ways[] = {"hemisphere", "hemicube", "analytic", NULL};
static const char *const mirror_ways[] = {"auto", "on", "off", "portal", NULL};
static const char *const pixel_words[] = {"16", "32", "64", "128", "256", "512", "1024", NULL};
static const uint32_t pixel_numbers[] = {16, 32, 64, 128, 256, 512, 1024};
static const char *const projections[] = {"none", "sums", "both", NULL};
static const char *const solvers[] = {"gradient", "jacobi", "gauss-seidel", NULL};
static const char *const point_words[] = {"1", "4", "16", "64", "256", "1024", "4096", NULL};
static const uint32_t point_numbers[] = {1, 4, 16, 64, 256, 1024, LIMIT_RADIOSITY_POINTS};
static const char *const emitter_ways[] = {"auto", "points", "factors", NULL};
static const char *const displays[] = {"vertex", "constant", "gather", NULL};
static const char *const shows[] = {"none", "b", "e", "albedo", "id", "normal", "residual", "row", NULL};

static const struct option_rule rules[] = {
    OPTION_REAL("radiosity.edge", 0, 1e12, struct radiosity_settings, edge),
    OPTION_WHOLE("radiosity.patches", 1, PATCHES_MOST, struct radiosity_settings, patches),
    OPTION_WORD("radiosity.factors", factor_ways, struct radiosity_settings, factors),
    OPTION_WHOLE("radiosity.rays", 16, LIMIT_RADIOSITY_RAYS, struct radiosity_settings, rays),
    OPTION_NUMBER("radiosity.hemicube", pixel_words, pixel_numbers, struct radiosity_settings, pixels),
    OPTION_WHOLE("radiosity.origins", 1, HEMICUBE_ORIGINS_MOST, struct radiosity_settings, origins),
    OPTION_WORD("radiosity.mirrors", mirror_ways, struct radiosity_settings, mirrors),
    OPTION_WHOLE("radiosity.bounces", 0, LIMIT_RADIOSITY_BOUNCES, struct radiosity_settings, bounces),
    OPTION_NUMBER("radiosity.points", point_words, point_numbers, struct radiosity_settings, points),
    OPTION_WORD("radiosity.emitters", emitter_ways, struct radiosity_settings, emitters),
    OPTION_WORD("radiosity.project", projections, struct radiosity_settings, project),
    OPTION_WORD("radiosity.solver", solvers, struct radiosity_settings, solver),
    OPTION_REAL("radiosity.residual", 1e-7, 0.1, struct radiosity_settings, residual),
    OPTION_WORD("radiosity.display", displays, struct radiosity_settings, display),
    OPTION_WHOLE("radiosity.gather", 1, LIMIT_RADIOSITY_GATHER, struct radiosity_settings, gather),
    OPTION_WORD("radiosity.show", shows, struct radiosity_settings, show),
    OPTION_WHOLE("radiosity.row", 0, NONE - 1, struct radiosity_settings, row),
};

const struct option_table radiosity_options[] = {
    {rules, sizeof rules / sizeof *rules, 0},
    {direct_rules, DIRECT_RULE_COUNT, offsetof(struct radiosity_settings, direct)},
    {0}};

// ---- what they need ----------------------------------------------------------------------------------------------------

static bool makes_a_picture(const struct plan *plan)
{
	return format_is_picture(plan->format);
}

static bool shows_light(const struct plan *plan)
{
	return radiosity_settings(plan)->show == RADIOSITY_SHOW_NONE;
}

static bool gathers(const struct plan *plan)
{
	return radiosity_settings(plan)->display == RADIOSITY_DISPLAY_GATHER;
}

static bool has_maps(const struct plan *plan)
{
	return direct_settings(plan)->shadows == DIRECT_SHADOWS_MAP;
}

static bool has_rays(const struct plan *plan)
{
	return radiosity_settings(plan)->factors != ROWS_BY_HEMICUBE;
}

static bool has_hemicubes(const struct plan *plan)
{
	return radiosity_settings(plan)->factors == ROWS_BY_HEMICUBE;
}

static bool may_mirror(const struct plan *plan)
{
	return radiosity_settings(plan)->factors != ROWS_BY_CONTOUR;
}

static bool mirrors(const struct plan *plan)
{
	return radiosity_has_mirrors(radiosity_settings(plan)) && plan_has(plan, candil_Effect_EFFECT_GLOSSY);
}

static bool makes_factors(const struct plan *plan)
{
	return !imported_solution(plan) && !imported_factors(plan);
}

static bool solves(const struct plan *plan)
{
	return !imported_solution(plan);
}

static bool is_cut_by_count(const struct plan *plan)
{
	return !(radiosity_settings(plan)->edge > 0);
}

#define MADE(option) \
	{ \
		option, "factors that are made, not imported", makes_factors \
	}

#define GATHERED(option) \
	{option, "a picture", makes_a_picture}, {option, "radiosity.show=none", shows_light}, \
	{ \
		option, "radiosity.display=gather", gathers \
	}

const struct option_need radiosity_needs[] = {{"radiosity.patches", "radiosity.edge=0", is_cut_by_count},
					      MADE("radiosity.factors"),
					      MADE("radiosity.rays"),
					      MADE("radiosity.hemicube"),
					      MADE("radiosity.origins"),
					      MADE("radiosity.mirrors"),
					      MADE("radiosity.bounces"),
					      MADE("radiosity.project"),
					      {"radiosity.points", "light that is found, not imported", solves},
					      {"radiosity.emitters", "light that is found, not imported", solves},
					      {"radiosity.solver", "light that is found, not imported", solves},
					      {"radiosity.residual", "light that is found, not imported", solves},
					      {"radiosity.rays", "radiosity.factors=hemisphere or analytic", has_rays},
					      {"radiosity.hemicube", "radiosity.factors=hemicube", has_hemicubes},
					      {"radiosity.origins", "radiosity.factors=hemicube", has_hemicubes},
					      {"radiosity.mirrors", "radiosity.factors=hemisphere or hemicube", may_mirror},
					      {"radiosity.bounces", "mirrors", mirrors},
					      {"radiosity.display", "a picture", makes_a_picture},
					      {"radiosity.display", "radiosity.show=none", shows_light},
					      {"radiosity.show", "a picture", makes_a_picture},
					      {"radiosity.row", "a picture", makes_a_picture},
					      GATHERED("radiosity.gather"),
					      GATHERED("direct.samples"),
					      GATHERED("direct.shadows"),
					      GATHERED("direct.map"),
					      {"direct.map", "direct.shadows=map", has_maps},
					      {"direct.rows", "a picture", makes_a_picture},
					      {0}};

// ---- the rest -----------------------------------------------------------------------------------------------------------

void radiosity_options_default(void *settings)
{
	struct radiosity_settings *s = settings;
	direct_options_default(&s->direct);
	s->patches = PATCHES_DEFAULT;
	s->rays = RAYS_DEFAULT;
	s->pixels = 64;
	s->origins = 4;
	s->bounces = 10;
	s->points = 16;
	s->residual = 1e-5f;
	s->gather = 16;
	s->row = NONE;
}

enum status radiosity_options_check(const struct plan *plan, struct error *err)
{
	const struct radiosity_settings *s = radiosity_settings(plan);
	if (imported_solution(plan) && (s->show == RADIOSITY_SHOW_ROW || s->show == RADIOSITY_SHOW_RESIDUAL ||
					plan->format == candil_Format_FORMAT_MTX))
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "the imported file is a solution, and has no form factors: import those, a .mtx, or leave "
				 "out " TECHNIQUE_OPTION_IMPORT);
	if (s->row != NONE && s->show != RADIOSITY_SHOW_ROW)
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "radiosity.row says whose row radiosity.show=row shows: ask for that, too");
	if (s->mirrors == RADIOSITY_MIRRORS_PORTAL && s->factors != ROWS_BY_HEMICUBE)
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "radiosity.mirrors=portal is a way of hemicubes: ask for radiosity.factors=hemicube, too");
	if (s->mirrors == RADIOSITY_MIRRORS_PORTAL && s->bounces > HEMICUBE_PORTALS_MOST)
		return error_set(
		    err, STATUS_BAD_ARGUMENT,
		    "radiosity.mirrors=portal looks into %u mirrors one behind the other, not into %u: ask for a "
		    "smaller radiosity.bounces",
		    HEMICUBE_PORTALS_MOST, s->bounces);
	if (s->factors == ROWS_BY_CONTOUR && (s->rays % 16 != 0 || s->rays < SIGHT_PROBE || s->rays > SIGHT_RAYS_MOST))
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "with radiosity.factors=analytic radiosity.rays is a multiple of 16 from %u to %u: rays "
				 "between two patches that are partly hidden from each other",
				 SIGHT_PROBE, SIGHT_RAYS_MOST);
	return STATUS_OK;
}
