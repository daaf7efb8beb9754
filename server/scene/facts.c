#include "server/scene/facts.h"

#include "protocol/names.h"
#include "server/scene/casters.h"

static bool above_zero(const float c[3])
{
	return c[0] > 0 || c[1] > 0 || c[2] > 0;
}

static uint32_t material_facts(const struct material *m)
{
	uint32_t facts = 0;
	const bool unlit = m->flags & MATERIAL_UNLIT;
	const bool glossy = !unlit && (m->metallic > 0 || m->specular_weight > 0 || above_zero(m->specular));
	if (m->albedo_texture != NONE || m->emission_texture != NONE || m->specular_texture != NONE ||
	    m->surface_texture != NONE || m->normal_texture != NONE || m->transmission_texture != NONE ||
	    m->specular_weight_texture != NONE || m->coat_texture != NONE || m->coat_roughness_texture != NONE ||
	    m->coat_normal_texture != NONE)
		facts |= FACT_TEXTURES;
	if (glossy)
		facts |= FACT_GLOSSY | FACT_REFLECTS;
	if (!unlit && above_zero(m->albedo))
		facts |= FACT_REFLECTS;
	if (!unlit && m->transmission > 0)
		facts |= FACT_GLASS | FACT_REFLECTS;
	if (!unlit && m->coat > 0)
		facts |= FACT_CLEARCOAT | FACT_REFLECTS;
	if (!unlit && m->diffuse_roughness > 0)
		facts |= FACT_ROUGH_DIFFUSE;
	if (m->normal_texture != NONE || m->coat_normal_texture != NONE)
		facts |= FACT_NORMAL_MAPS;
	if (m->flags & MATERIAL_ALPHA_MASK)
		facts |= FACT_ALPHA_MASK;
	if (m->flags & MATERIAL_ALPHA_BLEND)
		facts |= FACT_ALPHA_BLEND;
	if (unlit)
		facts |= FACT_UNLIT;
	return facts;
}

static bool has_colours(const struct blob_view *view)
{
	const struct vertex_color *colors = view->sections[BLOB_COLORS];
	for (uint32_t i = 0; i < view->counts[BLOB_COLORS]; i++)
		for (int c = 0; c < 4; c++)
			if (colors[i].rgba[c] != 1.0f)
				return true;
	return false;
}

uint32_t facts_of_view(const struct blob_view *view)
{
	const struct triangle *triangles = view->sections[BLOB_TRIANGLES];
	const struct material *materials = view->sections[BLOB_MATERIALS];
	const struct punctual_light *lights = view->sections[BLOB_LIGHTS];
#define FACT_OF_KIND(NAME, number, ...) [number] = FACT_##NAME##_LIGHTS,
	static const uint32_t light_facts[LIGHT_KIND_COUNT] = {CANDIL_LIGHT_KIND_LIST(FACT_OF_KIND)};
	uint32_t facts = view->counts[BLOB_EMITTERS] > 0 ? FACT_EMITTERS : 0;
	uint32_t last = NONE;

	// Only materials that a triangle uses count.
	for (uint32_t i = 0; i < view->counts[BLOB_TRIANGLES]; i++) {
		if (triangles[i].material != last)
			facts |= material_facts(&materials[triangles[i].material]);
		last = triangles[i].material;
	}
	for (uint32_t i = 0; i < view->counts[BLOB_LIGHTS]; i++)
		facts |= light_facts[lights[i].kind];
	if (view->counts[BLOB_ENVIRONMENT] > 0)
		facts |= FACT_SURROUNDINGS;
	if (casters_count(view) > 0)
		facts |= FACT_POLISHED;
	return has_colours(view) ? facts | FACT_VERTEX_COLORS : facts;
}

uint32_t facts_collect(const struct blob_header *blob)
{
	struct blob_view view;
	blob_view_init(&view, blob);
	return facts_of_view(&view);
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
	}
	return NULL;
}
