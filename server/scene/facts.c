#include "server/scene/facts.h"

#include <math.h>

#include "protocol/names.h"
#include "server/scene/casters.h"
#include "server/scene/ranges.h"

// How much below its ends a range of alphas may lie by rounding, where texels or corners are interpolated.
#define ALPHA_ROUNDING 1e-6f

// What is asked: the facts of `view` where those of `hidden` are not simulated.
struct question {
	const struct blob_view *view;
	uint32_t hidden;
};

// What a material is made of, over all places that triangles use it for.
struct look {
	const struct material *m;
	const struct material_use *use;
	bool unlit;
	bool absent; // nowhere there, by its alpha
	struct range texture[4]; // of the base colour's texture
	struct range color[4]; // of the vertex colours
	struct range metal;
	bool emits;
	bool opaque; // it has other lobes than a clear boundary; this and the rest of a lit material alone
	bool diffuse;
	bool glossy;
	bool glass;
	bool coat;
};

static bool above_zero(const float c[3])
{
	return c[0] > 0 || c[1] > 0 || c[2] > 0;
}

static struct range texture_range(const struct question *q, uint32_t texture, int channel)
{
	return range_of_texture(q->view, q->hidden & FACT_TEXTURES ? NONE : texture, channel);
}

static struct range scaled(float factor, struct range range)
{
	return range_times((struct range){factor, factor}, range);
}

static bool is_one(struct range range)
{
	return range.low >= 1 && range.high <= 1;
}

// The range of what a mask compares with its cutoff.
static struct range alpha_of(const struct look *l)
{
	return range_times(l->texture[3], l->color[3]);
}

// Whether alphas from `low` on are all beyond the cutoff. Interpolation may round an alpha that is not constant.
static bool passes_mask(const struct material *m, float low)
{
	return low >= m->alpha_cutoff * (m->albedo_texture == NONE && low >= 1 ? 1 : 1 + ALPHA_ROUNDING);
}

static bool is_masked(const struct question *q, const struct material *m)
{
	return m->flags & MATERIAL_ALPHA_MASK && !(q->hidden & FACT_ALPHA_MASK);
}

static bool is_blended(const struct question *q, const struct material *m)
{
	return m->flags & MATERIAL_ALPHA_BLEND && !(q->hidden & FACT_ALPHA_BLEND);
}

// Whether the dielectric part has a specular lobe anywhere.
static bool has_dielectric_gloss(const struct question *q, const struct material *m)
{
	float most = m->specular_weight;
	for (int c = 0; c < 3; c++) {
		const float here = m->specular[c] * texture_range(q, m->specular_texture, c).high;
		most = here > most ? here : most;
	}
	return most * texture_range(q, m->specular_weight_texture, 3).high > 0;
}

// The lobes of a lit material, as set_reflectance and bsdf_make of shaders/common put them together.
static void find_lobes(const struct question *q, struct look *l)
{
	const struct material *m = l->m;
	const struct range transmission = scaled(m->transmission, texture_range(q, m->transmission_texture, 0));
	const bool gloss = !(q->hidden & FACT_GLOSSY);
	bool base = false;
	for (int c = 0; c < 3; c++)
		base |= m->albedo[c] * l->texture[c].high * l->color[c].high > 0;
	l->metal = scaled(m->metallic, texture_range(q, m->surface_texture, 2));
	l->glass = !(q->hidden & FACT_GLASS) && transmission.high > 0 && l->metal.low < 1;
	l->opaque = !(l->glass && transmission.low >= 1 && l->metal.high <= 0);
	l->glossy = gloss && l->opaque && (l->metal.high > 0 || (l->metal.low < 1 && has_dielectric_gloss(q, m)));
	l->diffuse = l->opaque && base && (l->metal.low < 1 || !gloss);
	l->coat = !(q->hidden & FACT_CLEARCOAT) && (l->opaque || l->emits) &&
		  m->coat * texture_range(q, m->coat_texture, 0).high > 0;
}

static struct look look_of(const struct question *q, uint32_t index)
{
	const struct material *m = &((const struct material *)q->view->sections[BLOB_MATERIALS])[index];
	const struct material_use *use = &((const struct material_use *)q->view->sections[BLOB_MATERIAL_USES])[index];
	const bool white = q->hidden & FACT_VERTEX_COLORS;
	struct look l = {.m = m, .use = use};
	for (int c = 0; c < 4; c++) {
		l.texture[c] = texture_range(q, m->albedo_texture, c);
		l.color[c] = white ? (struct range){1, 1} : (struct range){use->color_low[c], use->color_high[c]};
	}
	l.absent = (is_masked(q, m) && alpha_of(&l).high < m->alpha_cutoff) ||
		   (is_blended(q, m) && !(m->alpha * alpha_of(&l).high > 0));
	l.unlit = m->flags & MATERIAL_UNLIT && !(q->hidden & FACT_UNLIT);
	l.emits = !l.unlit && above_zero(m->emission) && !(q->hidden & FACT_EMITTERS);
	if (!l.unlit)
		find_lobes(q, &l);
	return l;
}

// Whether a normal map tilts normals. No eight bits are exactly flat: 128 is 1/255 above it, which light shows.
static bool tilts(const struct look *l, uint32_t texture, float scale)
{
	return texture != NONE && l->use->tangents > 0 && (scale > 0 || scale < 0);
}

static uint32_t lit_facts(const struct question *q, const struct look *l)
{
	const struct material *m = l->m;
	uint32_t facts = 0;
	const bool lobes = l->diffuse || l->glossy || l->glass || l->coat;
	if (lobes)
		facts |= FACT_REFLECTS;
	if (l->glossy)
		facts |= FACT_GLOSSY;
	if (l->glass)
		facts |= FACT_GLASS;
	if (l->coat)
		facts |= FACT_CLEARCOAT;
	if (l->diffuse && m->diffuse_roughness > 0 && !(q->hidden & FACT_ROUGH_DIFFUSE))
		facts |= FACT_ROUGH_DIFFUSE;
	if (l->coat && tilts(l, m->coat_normal_texture, m->coat_normal_scale))
		facts |= FACT_NORMAL_MAPS;
	if (tilts(l, m->normal_texture, m->normal_scale))
		facts |= lobes ? FACT_NORMAL_MAPS : FACT_DARK_NORMAL_MAPS;
	return facts & ~(q->hidden & FACT_NORMAL_MAPS);
}

static uint32_t material_facts(const struct question *q, const struct look *l)
{
	const struct material *m = l->m;
	uint32_t facts = 0;
	if (is_masked(q, m) && !passes_mask(m, alpha_of(l).low))
		facts |= FACT_ALPHA_MASK;
	if (is_blended(q, m) && m->alpha * alpha_of(l).low < 1)
		facts |= FACT_ALPHA_BLEND;
	if (l->absent)
		return facts;
	return facts | (l->unlit ? FACT_UNLIT : lit_facts(q, l));
}

// Whether alpha is one that an effect of `live` looks at, which without the part of it that `rest` leaves would be another.
static bool alpha_counts(const struct question *q, const struct look *l, uint32_t live, struct range part, struct range rest)
{
	const struct material *m = l->m;
	if (is_one(part))
		return false;
	const float low = alpha_of(l).low;
	return (live & FACT_ALPHA_MASK && is_masked(q, m) && !(passes_mask(m, low) && passes_mask(m, rest.low))) ||
	       (live & FACT_ALPHA_BLEND && is_blended(q, m) && !(m->alpha * low >= 1 && m->alpha * rest.low >= 1));
}

// Whether vertex colours change the base colour. A base colour is cut at 1.
static bool colors_count(const struct question *q, const struct look *l, uint32_t live)
{
	for (int c = 0; c < 3 && !l->absent; c++) {
		const struct range base = scaled(l->m->albedo[c], l->texture[c]);
		if (base.high > 0 && (l->color[c].low < 1 || (l->color[c].high > 1 && base.low < 1)))
			return true;
	}
	return alpha_counts(q, l, live, l->color[3], l->texture[3]);
}

// Whether a texture changes a channel that it multiplies.
static bool dims(const struct question *q, float factor, uint32_t texture, int channel)
{
	return factor > 0 && texture_range(q, texture, channel).low < 1;
}

static bool dims_colour(const struct question *q, const float factor[3], uint32_t texture)
{
	return dims(q, factor[0], texture, 0) || dims(q, factor[1], texture, 1) || dims(q, factor[2], texture, 2);
}

// Whether a texture of the base colour changes it. On vertex colours that are black it does not, unless it is the one that
// is left out of two.
static bool base_texture_counts(const struct question *q, const struct look *l)
{
	for (int c = 0; c < 3; c++)
		if (dims(q, l->m->albedo[c], l->m->albedo_texture, c) && !(l->color[c].high <= 0 && l->texture[c].high > 0))
			return true;
	return false;
}

// Whether textures change a lit surface by way of an effect of `live`. Those are the effects that run, whichever material
// calls for them: a texture that takes a coat away is needed where others have one.
static bool lit_textures_count(const struct question *q, const struct look *l, uint32_t live)
{
	const struct material *m = l->m;
	const bool gloss = live & FACT_GLOSSY && l->opaque, glass = live & FACT_GLASS && m->transmission > 0;
	const bool dielectric = gloss && l->metal.low < 1;
	const float weight = above_zero(m->specular) ? 1 : m->specular_weight;
	return (live & FACT_EMITTERS && dims_colour(q, m->emission, m->emission_texture)) ||
	       ((l->glossy || l->glass) && dims(q, m->roughness, m->surface_texture, 1)) ||
	       ((gloss || glass) && dims(q, m->metallic, m->surface_texture, 2)) ||
	       (dielectric && dims_colour(q, m->specular, m->specular_texture)) ||
	       (dielectric && dims(q, weight, m->specular_weight_texture, 3)) ||
	       (glass && l->metal.low < 1 && dims(q, m->transmission, m->transmission_texture, 0)) ||
	       (live & FACT_CLEARCOAT && dims(q, m->coat, m->coat_texture, 0)) ||
	       (l->coat && dims(q, m->coat_roughness, m->coat_roughness_texture, 1));
}

static bool textures_count(const struct question *q, const struct look *l, uint32_t live)
{
	return alpha_counts(q, l, live, l->texture[3], l->color[3]) || (!l->absent && base_texture_counts(q, l)) ||
	       (!l->absent && !l->unlit && lit_textures_count(q, l, live));
}

static bool is_used(const struct blob_view *view, uint32_t material)
{
	return ((const struct material_use *)view->sections[BLOB_MATERIAL_USES])[material].triangles > 0;
}

// All but those of polish and of lengths, which no effect changes.
static uint32_t facts_of_effects(const struct blob_view *view, uint32_t hidden, uint32_t forced)
{
	const struct question q = {view, hidden};
	const struct punctual_light *lights = view->sections[BLOB_LIGHTS];
#define FACT_OF_KIND(NAME, number, ...) [number] = FACT_##NAME##_LIGHTS,
	static const uint32_t light_facts[LIGHT_KIND_COUNT] = {CANDIL_LIGHT_KIND_LIST(FACT_OF_KIND)};
	uint32_t facts = view->counts[BLOB_EMITTERS] > 0 ? FACT_EMITTERS : 0;

	for (uint32_t i = 0; i < view->counts[BLOB_LIGHTS]; i++)
		facts |= light_facts[lights[i].kind];
	if (view->counts[BLOB_ENVIRONMENT] > 0)
		facts |= FACT_SURROUNDINGS;
	facts |= view->counts[BLOB_PATCH_ELEMENTS] > 0 ? FACT_PATCHES : 0;
	facts |= view->counts[BLOB_FACTOR_ROWS] > 0 ? FACT_FACTORS : 0;
	for (uint32_t i = 0; i < view->counts[BLOB_MATERIALS]; i++) {
		const struct look l = look_of(&q, i);
		if (is_used(view, i))
			facts |= material_facts(&q, &l);
	}
	facts &= ~hidden;
	// Textures and vertex colours count by what the effects that run make of them. vct runs gloss for glass, too.
	const uint32_t live = facts | forced | (facts & FACT_GLASS ? FACT_GLOSSY : 0);
	for (uint32_t i = 0; i < view->counts[BLOB_MATERIALS]; i++) {
		const struct look l = look_of(&q, i);
		if (!is_used(view, i))
			continue;
		facts |= textures_count(&q, &l, live) ? FACT_TEXTURES : 0;
		facts |= colors_count(&q, &l, live) ? FACT_VERTEX_COLORS : 0;
	}
	return facts & ~hidden;
}

// Rays start off a triangle by some 2⁻²⁰ of its coordinates. That must be no length of interest: neither a millimetre nor an
// eighth of a triangle.
#define VAST_FROM 1024.0 // metres
#define VAST_RATIO 131072.0

// The longest extent of a triangle along an axis.
static double extent(const struct vertex *vertices, const struct triangle *t)
{
	const float *a = vertices[t->vertex[0]].position, *b = vertices[t->vertex[1]].position;
	const float *c = vertices[t->vertex[2]].position;
	double longest = 0;
	for (int i = 0; i < 3; i++)
		longest = fmax(longest, fmax(fmax(a[i], b[i]), c[i]) - fmin(fmin(a[i], b[i]), c[i]));
	return longest;
}

static bool is_vast(const struct blob_view *view)
{
	const struct triangle *triangles = view->sections[BLOB_TRIANGLES];
	double reach = 0;
	for (int i = 0; i < 3; i++)
		reach = fmax(reach, fmax(fabs((double)view->bounds_min[i]), fabs((double)view->bounds_max[i])));
	bool vast = reach >= VAST_FROM;
	for (uint32_t i = 0; i < view->counts[BLOB_TRIANGLES] && !vast; i++)
		vast = extent(view->sections[BLOB_VERTICES], &triangles[i]) * VAST_RATIO < reach;
	return vast;
}

static bool is_polished(const struct blob_view *view)
{
	bool polished = false;
	for (uint32_t i = 0; i < view->counts[BLOB_MATERIALS] && !polished; i++)
		polished = is_used(view, i) && casters_has(view, i);
	return polished;
}

uint32_t facts_of_view(const struct blob_view *view)
{
	return facts_of_effects(view, 0, 0) | (is_polished(view) ? FACT_POLISHED : 0) | (is_vast(view) ? FACT_VAST : 0);
}

uint32_t facts_given(const struct blob_view *view, uint32_t hidden, uint32_t forced)
{
	return facts_of_effects(view, hidden, forced) | (view->facts & (FACT_POLISHED | FACT_VAST) & ~hidden);
}

uint32_t facts_collect(const struct blob_header *blob)
{
	struct blob_view view;
	blob_view_init(&view, blob);
	return facts_of_view(&view);
}

static uint32_t named_facts(const struct material *m, const struct material_use *use)
{
	uint32_t facts = 0;
	if (m->albedo_texture != NONE || m->emission_texture != NONE || m->specular_texture != NONE ||
	    m->surface_texture != NONE || m->transmission_texture != NONE || m->specular_weight_texture != NONE ||
	    m->coat_texture != NONE || m->coat_roughness_texture != NONE)
		facts |= FACT_TEXTURES;
	if (m->normal_texture != NONE || m->coat_normal_texture != NONE)
		facts |= FACT_NORMAL_MAPS;
	if (above_zero(m->emission))
		facts |= FACT_EMITTERS;
	if (m->metallic > 0 || m->specular_weight > 0 || above_zero(m->specular))
		facts |= FACT_GLOSSY;
	if (m->transmission > 0)
		facts |= FACT_GLASS;
	if (m->coat > 0)
		facts |= FACT_CLEARCOAT;
	if (m->diffuse_roughness > 0)
		facts |= FACT_ROUGH_DIFFUSE;
	if (m->flags & MATERIAL_UNLIT)
		facts |= FACT_UNLIT;
	if (m->flags & MATERIAL_ALPHA_MASK)
		facts |= FACT_ALPHA_MASK;
	if (m->flags & MATERIAL_ALPHA_BLEND)
		facts |= FACT_ALPHA_BLEND;
	for (int c = 0; c < 4; c++)
		if (use->color_low[c] < 1 || use->color_high[c] > 1)
			facts |= FACT_VERTEX_COLORS;
	return facts;
}

uint32_t facts_by_name(const struct blob_view *view)
{
	const struct material *materials = view->sections[BLOB_MATERIALS];
	const struct material_use *uses = view->sections[BLOB_MATERIAL_USES];
	uint32_t facts = 0;
	for (uint32_t i = 0; i < view->counts[BLOB_MATERIALS]; i++)
		if (is_used(view, i))
			facts |= named_facts(&materials[i], &uses[i]);
	return facts;
}

const char *fact_name(enum fact fact)
{
	switch (fact) {
	case FACT_TEXTURES:
		return "textures";
	case FACT_EMITTERS:
		return "emitters";
#define NAME_OF_KIND(NAME, number, name, ...) \
	case FACT_##NAME##_LIGHTS: \
		return name " lights";
		CANDIL_LIGHT_KIND_LIST(NAME_OF_KIND)
	case FACT_REFLECTS:
		return "reflecting surfaces";
	case FACT_GLOSSY:
		return "glossy surfaces";
	case FACT_NORMAL_MAPS:
		return "normal maps";
	case FACT_ALPHA_MASK:
		return "alpha masks";
	case FACT_VERTEX_COLORS:
		return "vertex colours";
	case FACT_UNLIT:
		return "unlit surfaces";
	case FACT_GLASS:
		return "glass";
	case FACT_ALPHA_BLEND:
		return "alpha blending";
	case FACT_CLEARCOAT:
		return "clear coats";
	case FACT_ROUGH_DIFFUSE:
		return "rough diffuse surfaces";
	case FACT_SURROUNDINGS:
		return "surroundings";
	case FACT_POLISHED:
		return "polished surfaces";
	case FACT_DARK_NORMAL_MAPS:
		return "normal maps on black";
	case FACT_VAST:
		return "lengths many decades apart";
	case FACT_PATCHES:
		return "patches";
	case FACT_FACTORS:
		return "form factors";
	}
	return NULL;
}
