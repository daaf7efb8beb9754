#include "server/worker/plan/effects.h"

#include <stdio.h>

#include "protocol/header.h"
#include "protocol/names.h"
#include "server/scene/facts.h"

// For each effect the facts of a scene any of which calls for it. 0: the functions below decide.
static const uint32_t calling_facts[EFFECT_COUNT] = {
    [candil_Effect_EFFECT_TEXTURES] = FACT_TEXTURES,
    [candil_Effect_EFFECT_EMITTERS] = FACT_EMITTERS,
    [candil_Effect_EFFECT_LIGHTS] = FACT_LIGHTS,
    [candil_Effect_EFFECT_GLOSSY] = FACT_GLOSSY,
    [candil_Effect_EFFECT_NORMAL_MAPS] = FACT_NORMAL_MAPS,
    [candil_Effect_EFFECT_ALPHA_MASK] = FACT_ALPHA_MASK,
    [candil_Effect_EFFECT_VERTEX_COLORS] = FACT_VERTEX_COLORS,
    [candil_Effect_EFFECT_UNLIT] = FACT_UNLIT,
    [candil_Effect_EFFECT_GLASS] = FACT_GLASS,
    [candil_Effect_EFFECT_ALPHA_BLEND] = FACT_ALPHA_BLEND,
    [candil_Effect_EFFECT_CLEARCOAT] = FACT_CLEARCOAT,
    [candil_Effect_EFFECT_ROUGH_DIFFUSE] = FACT_ROUGH_DIFFUSE,
};

static bool called_for(candil_Effect effect, const candil_Render *r, const struct plan *p, uint32_t facts);

static bool allowed(candil_Effect effect, const candil_Render *r)
{
	return !(r->effects_off >> effect & 1u);
}

// Whether some lit surface is neither a mirror nor clear glass. Those show unlit surfaces without any light, and a sky that
// nobody asked for would be seen in them.
static bool needs_light(const struct blob_view *scene)
{
	const struct material *materials = scene->sections[BLOB_MATERIALS];
	const struct material_use *uses = scene->sections[BLOB_MATERIAL_USES];
	bool needs = false;
	for (uint32_t i = 0; i < scene->counts[BLOB_MATERIALS] && !needs; i++) {
		const struct material *m = &materials[i];
		const bool shows =
		    m->flags & MATERIAL_UNLIT || (m->roughness <= 0 && (m->metallic >= 1 || m->transmission >= 1));
		needs = uses[i].triangles > 0 && !shows;
	}
	return needs;
}

// Whether nothing gives light, although the request switches none off that the scene has, and some surface needs it. A
// picture of the surroundings counts as light even if it is black, because the request names it.
static bool is_dark(const candil_Render *r, const struct plan *p, const struct blob_view *scene)
{
	const bool sky = r->has_environment || plan_has_colour(p);
	const bool shows = scene->facts & FACT_UNLIT && allowed(candil_Effect_EFFECT_UNLIT, r);
	return !sky && !(scene->emitter_power > 0) && !(scene->light_power > 0) &&
	       allowed(candil_Effect_EFFECT_ENVIRONMENT, r) && (!shows || needs_light(scene));
}

// Whether there is some light that is not switched off.
static bool shines(const candil_Render *r, const struct plan *p, uint32_t facts)
{
	static const candil_Effect lights[] = {candil_Effect_EFFECT_EMITTERS, candil_Effect_EFFECT_LIGHTS,
					       candil_Effect_EFFECT_ENVIRONMENT};
	for (size_t i = 0; i < sizeof lights / sizeof *lights; i++)
		if (called_for(lights[i], r, p, facts) && allowed(lights[i], r))
			return true;
	return false;
}

// Whether there is a lamp that light paths are worth beginning at, and that is not switched off.
static bool starts_light_paths(const candil_Render *r, const struct plan *p, uint32_t facts)
{
	const bool emitters = facts & FACT_EMITTERS && allowed(candil_Effect_EFFECT_EMITTERS, r);
	const bool lights = facts & FACT_LIGHTS && allowed(candil_Effect_EFFECT_LIGHTS, r);
	const bool sky = p->environment.power > 0 && p->environment.contrast >= PLAN_SKY_CONTRAST &&
			 allowed(candil_Effect_EFFECT_ENVIRONMENT, r);
	return emitters || lights || sky;
}

// Whether there is an unlit surface, and something in which or through which it may be seen.
static bool shows_images(const candil_Render *r, uint32_t facts)
{
	return facts & FACT_UNLIT && facts & (FACT_GLOSSY | FACT_GLASS | FACT_CLEARCOAT) &&
	       allowed(candil_Effect_EFFECT_UNLIT, r);
}

// Whether the scene and the request's own values call for an effect.
static bool called_for(candil_Effect effect, const candil_Render *r, const struct plan *p, uint32_t facts)
{
	if (effect == candil_Effect_EFFECT_NORMAL_MAPS && p->aovs & AOV_NORMAL && facts & FACT_DARK_NORMAL_MAPS)
		return true;
	if (calling_facts[effect])
		return facts & calling_facts[effect];
	if (effect == candil_Effect_EFFECT_ENVIRONMENT)
		return plan_has_colour(p) || p->environment.power > 0;
	if (effect == candil_Effect_EFFECT_BOUNCES)
		return p->depth > 1 && facts & (FACT_REFLECTS | FACT_GLOSSY) &&
		       (shines(r, p, facts) || shows_images(r, facts));
	if (effect == candil_Effect_EFFECT_CAUSTICS)
		return p->depth > 1 && facts & FACT_POLISHED && starts_light_paths(r, p, facts) &&
		       allowed(candil_Effect_EFFECT_BOUNCES, r);
	return false;
}

// Whether there is an environment or background that is not black, and its light may scatter twice.
static bool sky_shines(const candil_Render *r, const struct plan *p, uint32_t facts)
{
	return p->depth > 1 && called_for(candil_Effect_EFFECT_ENVIRONMENT, r, p, facts) &&
	       allowed(candil_Effect_EFFECT_ENVIRONMENT, r);
}

// Why a technique cannot do an effect; "": others can; NULL: it can.
static const char *cannot(const struct technique *technique, const struct plan *p, candil_Effect effect)
{
	const char *why = technique->cannot ? technique->cannot(p, effect) : NULL;
	return why || technique->effects >> effect & 1u ? why : "";
}

static bool can_by_default(const struct technique *technique, candil_Effect effect)
{
	struct plan p = {.technique = technique->number};
	technique->defaults(&p.settings);
	return !cannot(technique, &p, effect);
}

// List the techniques that can, with their default options: "pt and vct". `lights`: only those where it lights surfaces.
static void who_can(candil_Effect effect, bool lights, const char *word, char *out, size_t capacity)
{
	const char *can[TECHNIQUE_COUNT];
	size_t count = 0;
	for (uint32_t i = 0; i < technique_count(); i++)
		if (can_by_default(technique_at(i), effect) && !(lights && technique_at(i)->sky_is_seen_alone))
			can[count++] = technique_name(technique_at(i)->number);
	names_list(can, count, word, out, capacity);
}

void effects_list_lit_by_background(char *out, size_t capacity)
{
	who_can(candil_Effect_EFFECT_ENVIRONMENT, true, "or", out, capacity);
}

// Name the techniques that can: "only pt and vct can: clear surfaces are opaque".
static void tell_who_can(candil_Effect effect, const char *instead, char *out, size_t capacity)
{
	char names[64];
	who_can(effect, false, "and", names, sizeof names);
	snprintf(out, capacity, "only %s can: %s", names, instead);
}

static void explain(candil_EffectReport *report, candil_EffectState state, const char *why)
{
	report->state = state;
	snprintf(report->why, sizeof report->why, "%s", why);
}

// The scene's facts where this technique does this request: without what it cannot or may not simulate, and with what it
// must.
static uint32_t facts_here(const candil_Render *r, const struct blob_view *scene, const struct technique *technique,
			   const struct plan *p)
{
	uint32_t hidden = 0, forced = 0;
	for (unsigned i = 0; i < EFFECT_COUNT; i++) {
		const bool off = cannot(technique, p, (candil_Effect)i) || !allowed((candil_Effect)i, r);
		hidden |= off ? calling_facts[i] : 0;
		forced |= !off && r->effects_on >> i & 1u ? calling_facts[i] : 0;
	}
	return facts_given(scene, hidden, forced);
}

// The scene's facts and a plan where some technique does this request that can do everything, and no effect but `effect` is
// switched off.
static uint32_t facts_elsewhere(candil_Effect effect, const candil_Render *r, const struct blob_view *scene, struct plan *p)
{
	uint32_t hidden = 0, forced = 0;
	for (unsigned i = 0; i < EFFECT_COUNT; i++) {
		hidden |= i != effect && !allowed((candil_Effect)i, r) ? calling_facts[i] : 0;
		forced |= i != effect && allowed((candil_Effect)i, r) && r->effects_on >> i & 1u ? calling_facts[i] : 0;
	}
	p->depth = LIMIT_DEPTH;
	return facts_given(scene, hidden, forced);
}

// Why a scene does not call for an effect. `named`: what it has by name.
static const char *why_absent(candil_Effect effect, const candil_Render *r, const struct plan *p, uint32_t facts,
			      uint32_t named)
{
	const struct effect_words *words = effect_words(effect);
	if (effect == candil_Effect_EFFECT_CAUSTICS && facts & FACT_POLISHED && sky_shines(r, p, facts))
		return "only the background shines, and evenly enough that chance finds its caustics as well";
	return named & calling_facts[effect] ? words->inert : words->absent;
}

// Why a technique lacks an effect that a scene or the request calls for, as cannot(). What nothing calls for is not lacking;
// NULL then, too.
static const char *lacks(candil_Effect effect, const candil_Render *r, const struct blob_view *scene,
			 const struct technique *technique, const struct plan *p)
{
	struct plan elsewhere = *p;
	const char *why = cannot(technique, p, effect);
	if (!why || r->effects_on >> effect & 1u)
		return why;
	const uint32_t facts = facts_elsewhere(effect, r, scene, &elsewhere);
	return called_for(effect, r, &elsewhere, facts) ? why : NULL;
}

// Decide what becomes of an effect, and the reason to report.
static void decide(candil_EffectReport *report, const candil_Render *r, const struct blob_view *scene, uint32_t facts,
		   uint32_t named, const struct technique *technique, const struct plan *p)
{
	const candil_Effect effect = report->effect;
	const struct effect_words *words = effect_words(effect);
	const uint32_t bit = 1u << effect;
	const bool can = !cannot(technique, p, effect);
	const char *why_not = lacks(effect, r, scene, technique, p);
	if (why_not) {
		explain(report, candil_EffectState_EFFECT_STATE_UNSUPPORTED, why_not);
		if (!*why_not)
			tell_who_can(effect, words->substitute, report->why, sizeof report->why);
	} else if (r->effects_off & bit) {
		explain(report, candil_EffectState_EFFECT_STATE_SWITCHED_OFF, words->substitute);
	} else if (effect == candil_Effect_EFFECT_ENVIRONMENT && p->default_light) {
		explain(report, candil_EffectState_EFFECT_STATE_SIMULATED, "nothing else gives light: a neutral sky does");
	} else if (can && called_for(effect, r, p, facts)) {
		const char *how = technique->simulates ? technique->simulates(p, effect) : NULL;
		explain(report, candil_EffectState_EFFECT_STATE_SIMULATED, how ? how : words->simulated);
	} else {
		explain(report,
			r->effects_on & bit ? candil_EffectState_EFFECT_STATE_FORCED
					    : candil_EffectState_EFFECT_STATE_ABSENT,
			why_absent(effect, r, p, can ? facts : 0, named));
	}
}

void plan_effects(const candil_Render *r, const struct blob_view *scene, const struct technique *technique, struct plan *p)
{
	p->default_light =
	    r->default_light && is_dark(r, p, scene) && !cannot(technique, p, candil_Effect_EFFECT_ENVIRONMENT);
	for (int i = 0; p->default_light && i < 3; i++)
		p->background[i] = (float)DEFAULT_LIGHT_RADIANCE;

	const uint32_t facts = facts_here(r, scene, technique, p), named = facts_by_name(scene);
	for (unsigned i = 0; i < EFFECT_COUNT; i++) {
		candil_EffectReport *report = &p->reports[p->report_count++];
		*report = (candil_EffectReport)candil_EffectReport_init_zero;
		report->effect = (candil_Effect)i;
		decide(report, r, scene, facts, named, technique, p);
		if (report->state == candil_EffectState_EFFECT_STATE_SIMULATED ||
		    report->state == candil_EffectState_EFFECT_STATE_FORCED)
			p->effects |= 1u << i;
	}
	if (technique->settle)
		technique->settle(p, ~r->effects_off);
}
