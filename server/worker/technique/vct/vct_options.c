#include "server/worker/technique/vct/vct_options.h"

#include "shaders/shared/vct.h"
#include "shaders/shared/vct_show.h"
#include "shaders/shared/voxel.h"

_Static_assert(sizeof(struct vct_settings) <= PLAN_SETTINGS_BYTES, "the plan has room for them");
_Static_assert(offsetof(struct vct_settings, direct) == 0, "direct_settings() finds them");

static const char *const gathers[] = {"cones", "rays", NULL};
static const char *const grids[] = {"fitted", "cube", NULL};
static const char *const emitter_ways[] = {"points", "cones", NULL};
static const char *const details[] = {"half", "full", NULL};
static const char *const pyramids[] = {"directional", "isotropic", NULL};
static const char *const covers[] = {"sum", "product", NULL};
static const char *const owns[] = {"out", "in", NULL};
static const char *const lamberts[] = {"plain", "weighted", NULL};
static const char *const shadows[] = {"rays", "march", "cones", "volume", "map", NULL};
static const char *const shows[] = {"none", "albedo", "normal", "emission", "irradiance", "radiance", "coverage", NULL};
static const char *const axes[] = {"x", "y", "z", NULL};
static const char *const voxel_kinds[] = {"texture", NULL};
static const char *const resolution_words[] = {"16", "32", "64", "128", "256", "512", NULL};
static const uint32_t resolutions[] = {16, 32, 64, 128, 256, 512};

static const struct option_rule rules[] = {
    OPTION_WORD("vct.voxels", voxel_kinds, struct vct_settings, voxels),
    OPTION_NUMBER("vct.resolution", resolution_words, resolutions, struct vct_settings, resolution),
    OPTION_WORD("vct.grid", grids, struct vct_settings, grid),
    OPTION_WHOLE("vct.bounces", 0, LIMIT_VCT_BOUNCES, struct vct_settings, bounces),
    OPTION_WHOLE("vct.cones", 0, LIMIT_VCT_CONES, struct vct_settings, cones),
    OPTION_WORD("vct.gather", gathers, struct vct_settings, gather),
    OPTION_WHOLE("vct.rays", 1, LIMIT_VCT_RAYS, struct vct_settings, rays),
    OPTION_WORD("vct.emitters", emitter_ways, struct vct_settings, emitters),
    OPTION_WORD("vct.detail", details, struct vct_settings, detail),
    OPTION_WORD("vct.pyramid", pyramids, struct vct_settings, pyramid),
    OPTION_WORD("vct.cover", covers, struct vct_settings, cover),
    OPTION_WORD("vct.own", owns, struct vct_settings, own),
    OPTION_WORD("vct.lambert", lamberts, struct vct_settings, lambert),
    OPTION_WORD("vct.shadows", shadows, struct vct_settings, shadows),
    OPTION_REAL("vct.shadow_aperture", 0.5, 90, struct vct_settings, shadow_aperture),
    OPTION_REAL("vct.distance", 0, 1e12, struct vct_settings, marching.reach),
    OPTION_REAL("vct.ambient", 0, LIMIT_RADIANCE, struct vct_settings, marching.ambient),
    OPTION_REAL("vct.ao", 0, 1e6, struct vct_settings, marching.falloff),
    OPTION_REAL("vct.step", 0.1, 4, struct vct_settings, marching.step),
    OPTION_REAL("vct.start", 0.25, 8, struct vct_settings, marching.start),
    OPTION_REAL("vct.dither", 0, 1, struct vct_settings, marching.dither),
    OPTION_WORD("vct.show", shows, struct vct_settings, show),
    OPTION_WHOLE("vct.level", 0, VCT_LEVELS_MAX, struct vct_settings, level),
    OPTION_WORD("vct.axis", axes, struct vct_settings, axis),
    OPTION_WHOLE("vct.slice", 0, VOXEL_RESOLUTION_MAX - 1, struct vct_settings, slice),
};

const struct option_table vct_options[] = {
    {rules, sizeof rules / sizeof *rules, 0}, {direct_rules, DIRECT_RULE_COUNT, offsetof(struct vct_settings, direct)}, {0}};

static bool shadows_by_rays(const struct plan *plan)
{
	return vct_settings(plan)->shadows == VCT_SHADOWS_RAYS;
}

static bool shadows_by_maps(const struct plan *plan)
{
	return vct_settings(plan)->shadows == VCT_SHADOWS_MAP ||
	       (shadows_by_rays(plan) && direct_settings(plan)->shadows == DIRECT_SHADOWS_MAP);
}

static bool shadows_by_cones(const struct plan *plan)
{
	return vct_settings(plan)->shadows == VCT_SHADOWS_CONES;
}

static bool is_ambient(const struct plan *plan)
{
	return vct_settings(plan)->marching.ambient > 0;
}

static bool shows_a_slice(const struct plan *plan)
{
	return vct_settings(plan)->slice != NONE;
}

static bool shows_no_voxels(const struct plan *plan)
{
	return vct_settings(plan)->show == VCT_SHOW_NONE;
}

bool vct_shadows_in_volume(uint32_t way)
{
	return way != VCT_SHADOWS_RAYS && way != VCT_SHADOWS_MAP;
}

static bool gathers_by_cones(const struct plan *plan)
{
	return vct_settings(plan)->gather == VCT_GATHER_BY_CONES;
}

static bool gathers_by_rays(const struct plan *plan)
{
	return !gathers_by_cones(plan);
}

// Rays find the diffuse light of pixels and entries; all else comes from the pyramid.
bool vct_options_march(const struct plan *plan)
{
	return gathers_by_cones(plan) || plan_has(plan, candil_Effect_EFFECT_GLOSSY) ||
	       plan_has(plan, candil_Effect_EFFECT_GLASS) || vct_shadows_in_volume(vct_settings(plan)->shadows) ||
	       !shows_no_voxels(plan);
}

static const char marched[] = "cones: vct.gather=cones, glossy surfaces, glass, or vct.shadows through the voxels";

const struct option_need vct_needs[] = {{"vct.rays", "vct.gather=rays", gathers_by_rays},
					{"vct.cones", "vct.gather=cones", gathers_by_cones},
					{"vct.cones", "vct.show=none", shows_no_voxels},
					{"vct.step", marched, vct_options_march},
					{"vct.start", marched, vct_options_march},
					{"vct.dither", marched, vct_options_march},
					{"vct.pyramid", marched, vct_options_march},
					{"vct.cover", marched, vct_options_march},
					{"vct.own", marched, vct_options_march},
					{"vct.shadow_aperture", "vct.shadows=cones", shadows_by_cones},
					{"vct.ao", "vct.ambient", is_ambient},
					{"vct.axis", "vct.slice", shows_a_slice},
					{"vct.detail", "vct.show=none", shows_no_voxels},
					{"direct.shadows", "vct.shadows=rays", shadows_by_rays},
					{"direct.map", "vct.shadows=map", shadows_by_maps},
					{0}};

void vct_options_default(void *settings)
{
	struct vct_settings *s = settings;
	direct_options_default(&s->direct);
	s->resolution = 128;
	s->bounces = 2;
	s->rays = 16;
	s->shadow_aperture = 10;
	s->marching.falloff = 1;
	s->marching.step = 0.5f;
	s->marching.start = 1;
	s->slice = NONE;
}

enum status vct_options_check(const struct plan *plan, struct error *err)
{
	const struct vct_settings *s = vct_settings(plan);
	const bool lit_by_level = s->show == VCT_SHOW_RADIANCE || s->show == VCT_SHOW_COVERAGE;
	if (s->show == VCT_SHOW_NONE && (s->level > 0 || s->slice != NONE))
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "vct.level and vct.slice say where vct.show looks: say what with vct.show, too");
	if (s->level > 0 && !lit_by_level)
		return error_set(
		    err, STATUS_BAD_ARGUMENT,
		    "the levels above 0 hold radiance and coverage: take one of these for vct.show, or vct.level=0");
	return STATUS_OK;
}
