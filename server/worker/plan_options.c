#include "server/worker/plan_options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/limits.h"
#include "shaders/shared/vct.h"
#include "shaders/shared/vct_show.h"
#include "shaders/shared/voxel.h"

// An option is a whole number or a real one from least to most, or, where `words` are given, one of them: its place is the
// value, or `numbers` at its place.
struct option_rule {
	const char *name;
	double least, most;
	const char *const *words;
	const uint32_t *numbers;
	bool real; // a float in struct plan, else a uint32_t
	size_t offset; // in struct plan
};

static const char *const shadows[] = {"rays", "none", "map", NULL};
static const char *const map_words[] = {"256", "512", "1024", "2048", "4096", NULL};
static const uint32_t map_sides[] = {256, 512, 1024, 2048, 4096};
static const char *const effect_times[] = {"off", "on", "all", NULL};
static const char *const samplers[] = {"sobol", "independent", "blue", NULL};
static const char *const hemispheres[] = {"cosine", "uniform", NULL};
static const char *const lamp_ways[] = {"mis", "nee", "none", NULL};
static const char *const trees[] = {"auto", "on", "off", NULL};
static const char *const roulettes[] = {"on", "off", NULL};
static const char *const traversals[] = {"auto", "single", "packet", NULL};
static const char *const grids[] = {"fitted", "cube", NULL};
static const char *const emitter_ways[] = {"points", "cones", NULL};
static const char *const details[] = {"half", "full", NULL};
static const char *const pyramids[] = {"directional", "isotropic", NULL};
static const char *const covers[] = {"sum", "product", NULL};
static const char *const owns[] = {"out", "in", NULL};
static const char *const lamberts[] = {"plain", "weighted", NULL};
static const char *const volume_shadows[] = {"rays", "march", "cones", "volume", "map", NULL};
static const char *const shows[] = {"none", "albedo", "normal", "emission", "irradiance", "radiance", "coverage", NULL};
static const char *const axes[] = {"x", "y", "z", NULL};
static const char *const voxel_kinds[] = {"texture", NULL};
static const char *const resolution_words[] = {"16", "32", "64", "128", "256", "512", NULL};
static const uint32_t resolutions[] = {16, 32, 64, 128, 256, 512};

#define FIELD(name) offsetof(struct plan, name)

static const struct option_rule options[] = {
    {"direct.samples", 1, LIMIT_DIRECT_SAMPLES, NULL, NULL, false, FIELD(direct_points)},
    {"direct.shadows", 0, 0, shadows, NULL, false, FIELD(direct_shadows)},
    {"direct.map", 0, 0, map_words, map_sides, false, FIELD(direct_map)},
    {"direct.rows", 0, LIMIT_SIDE, NULL, NULL, false, FIELD(direct_rows)},
    {"pt.depth", 1, LIMIT_DEPTH, NULL, NULL, false, FIELD(depth)},
    {"pt.segment", 1, LIMIT_DEPTH + 1, NULL, NULL, false, FIELD(segment)},
    {"pt.batch", 1, PLAN_BATCH_MOST, NULL, NULL, false, FIELD(batch)},
    {"pt.effect_times", 0, 0, effect_times, NULL, false, FIELD(effect_times)},
    {"pt.traversal", 0, 0, traversals, NULL, false, FIELD(traversal)},
    {"pt.sampler", 0, 0, samplers, NULL, false, FIELD(sampler)},
    {"pt.hemisphere", 0, 0, hemispheres, NULL, false, FIELD(hemisphere)},
    {"pt.lights", 0, 0, lamp_ways, NULL, false, FIELD(lamps)},
    {"pt.light_tree", 0, 0, trees, NULL, false, FIELD(light_tree)},
    {"pt.roulette", 0, 0, roulettes, NULL, false, FIELD(roulette)},
    {"pt.clamp", 0, LIMIT_RADIANCE, NULL, NULL, true, FIELD(clamp)},
    {"vct.voxels", 0, 0, voxel_kinds, NULL, false, FIELD(vct_voxels)},
    {"vct.resolution", 0, 0, resolution_words, resolutions, false, FIELD(vct_resolution)},
    {"vct.grid", 0, 0, grids, NULL, false, FIELD(vct_grid)},
    {"vct.bounces", 0, LIMIT_VCT_BOUNCES, NULL, NULL, false, FIELD(vct_bounces)},
    {"vct.cones", 0, LIMIT_VCT_CONES, NULL, NULL, false, FIELD(vct_cones)},
    {"vct.emitters", 0, 0, emitter_ways, NULL, false, FIELD(vct_emitters)},
    {"vct.detail", 0, 0, details, NULL, false, FIELD(vct_detail)},
    {"vct.pyramid", 0, 0, pyramids, NULL, false, FIELD(vct_pyramid)},
    {"vct.cover", 0, 0, covers, NULL, false, FIELD(vct_cover)},
    {"vct.own", 0, 0, owns, NULL, false, FIELD(vct_own)},
    {"vct.lambert", 0, 0, lamberts, NULL, false, FIELD(vct_lambert)},
    {"vct.shadows", 0, 0, volume_shadows, NULL, false, FIELD(vct_shadows)},
    {"vct.shadow_aperture", 0.5, 90, NULL, NULL, true, FIELD(vct_shadow_aperture)},
    {"vct.distance", 0, 1e12, NULL, NULL, true, FIELD(vct_distance)},
    {"vct.ambient", 0, LIMIT_RADIANCE, NULL, NULL, true, FIELD(vct_ambient)},
    {"vct.ao", 0, 1e6, NULL, NULL, true, FIELD(vct_ao)},
    {"vct.step", 0.1, 4, NULL, NULL, true, FIELD(vct_step)},
    {"vct.start", 0.25, 8, NULL, NULL, true, FIELD(vct_start)},
    {"vct.dither", 0, 1, NULL, NULL, true, FIELD(vct_dither)},
    {"vct.show", 0, 0, shows, NULL, false, FIELD(vct_show)},
    {"vct.level", 0, VCT_LEVELS_MAX, NULL, NULL, false, FIELD(vct_level)},
    {"vct.axis", 0, 0, axes, NULL, false, FIELD(vct_axis)},
    {"vct.slice", 0, VOXEL_RESOLUTION_MAX - 1, NULL, NULL, false, FIELD(vct_slice)},
};

void plan_options_default(struct plan *p)
{
	p->depth = PLAN_DEPTH_DEFAULT;
	p->direct_points = PLAN_POINTS_DEFAULT;
	p->direct_map = PLAN_MAP_DEFAULT;
	p->vct_resolution = 128;
	p->vct_bounces = 2;
	p->vct_shadow_aperture = 10;
	p->vct_ao = 1;
	p->vct_step = 0.5f;
	p->vct_start = 1;
	p->vct_dither = 0;
	p->vct_slice = NONE;
}

static enum status option_word(const struct option_rule *rule, const char *text, uint32_t *value, struct error *err)
{
	char known[96] = "";
	for (uint32_t i = 0; rule->words[i]; i++) {
		if (!strcmp(rule->words[i], text)) {
			*value = rule->numbers ? rule->numbers[i] : i;
			return STATUS_OK;
		}
		snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? ", " : "", rule->words[i]);
	}
	return error_set(err, STATUS_BAD_ARGUMENT, "option %s is one of %s, not '%s'", rule->name, known, text);
}

static enum status option_whole(const struct option_rule *rule, const char *text, uint32_t *value, struct error *err)
{
	char *end;
	const unsigned long v = strtoul(text, &end, 10);
	if (text[0] < '0' || text[0] > '9' || *end || (double)v < rule->least || (double)v > rule->most)
		return error_set(err, STATUS_BAD_ARGUMENT, "option %s takes a whole number from %.0f to %.0f, not '%s'",
				 rule->name, rule->least, rule->most, text);
	*value = (uint32_t)v;
	return STATUS_OK;
}

static enum status option_real(const struct option_rule *rule, const char *text, float *value, struct error *err)
{
	char *end;
	const double v = strtod(text, &end);
	if (text[0] == '\0' || *end || !(v >= rule->least && v <= rule->most))
		return error_set(err, STATUS_BAD_ARGUMENT, "option %s takes a number from %g to %g, not '%s'", rule->name,
				 rule->least, rule->most, text);
	*value = (float)v;
	return STATUS_OK;
}

static enum status option_take(const struct option_rule *rule, const char *text, struct plan *p, struct error *err)
{
	uint32_t whole = 0;
	float real = 0;
	enum status s = rule->real    ? option_real(rule, text, &real, err)
			: rule->words ? option_word(rule, text, &whole, err)
				      : option_whole(rule, text, &whole, err);
	if (s == STATUS_OK)
		memcpy((char *)p + rule->offset, rule->real ? (const void *)&real : &whole, sizeof whole);
	return s;
}

// Those of the same technique, for all together would not fit the sentence.
static enum status no_such_option(const char *name, struct error *err)
{
	const char *dot = strchr(name, '.');
	const size_t technique = dot ? (size_t)(dot - name) + 1 : 0;
	char known[LIMIT_TEXT + 1] = "";
	for (size_t i = 0; technique && i < sizeof options / sizeof *options; i++) {
		const size_t used = strlen(known);
		if (!strncmp(options[i].name, name, technique))
			snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", options[i].name + technique);
	}
	if (known[0])
		return error_set(err, STATUS_BAD_ARGUMENT, "there is no option '%s': known are %.*s%s", name, (int)technique,
				 name, known);
	return error_set(err, STATUS_BAD_ARGUMENT,
			 "there is no option '%s': they begin with direct., pt. or vct., and with a wrong name behind that "
			 "the rest is told",
			 name);
}

static bool begins(const char *name, const char *with)
{
	return !strncmp(name, with, strlen(with));
}

// vct takes the light that comes straight from its source as direct does, with its options.
static enum status check_technique(const char *name, candil_Technique technique, struct error *err)
{
	const char *of = begins(name, "pt.") ? "pt" : begins(name, "vct.") ? "vct" : "direct or vct";
	const char *is = technique == candil_Technique_TECHNIQUE_PT    ? "pt"
			 : technique == candil_Technique_TECHNIQUE_VCT ? "vct"
								       : "direct";
	if (strstr(of, is))
		return STATUS_OK;
	return error_set(err, STATUS_BAD_ARGUMENT,
			 "option %s does nothing in %s, only with technique %s: ask for that, or leave the option out", name,
			 is, of);
}

enum status plan_option(const candil_Option *o, struct plan *p, struct error *err)
{
	for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
		if (strcmp(options[i].name, o->name))
			continue;
		const enum status s = check_technique(o->name, p->technique, err);
		return s == STATUS_OK ? option_take(&options[i], o->value, p, err) : s;
	}
	return no_such_option(o->name, err);
}

enum status plan_options_check(const struct plan *p, struct error *err)
{
	const bool lit_by_level = p->vct_show == VCT_SHOW_RADIANCE || p->vct_show == VCT_SHOW_COVERAGE;
	if (p->technique != candil_Technique_TECHNIQUE_VCT)
		return STATUS_OK;
	if (p->vct_show == VCT_SHOW_NONE && (p->vct_level > 0 || p->vct_slice != NONE))
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "vct.level and vct.slice say where vct.show looks: say what with vct.show, too");
	if (p->vct_level > 0 && !lit_by_level)
		return error_set(
		    err, STATUS_BAD_ARGUMENT,
		    "the levels above 0 hold radiance and coverage: take one of these for vct.show, or vct.level=0");
	return STATUS_OK;
}
