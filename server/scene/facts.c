#include "server/scene/facts.h"

static uint32_t material_facts(const struct material *m)
{
	uint32_t facts = 0;
	if (m->albedo_texture != NONE || m->emission_texture != NONE)
		facts |= FACT_TEXTURES;
	if (m->albedo[0] > 0 || m->albedo[1] > 0 || m->albedo[2] > 0)
		facts |= FACT_REFLECTS;
	return facts;
}

static uint32_t light_facts(const struct punctual_light *light)
{
	switch (light->kind) {
	case LIGHT_POINT:
		return FACT_POINT_LIGHTS;
	case LIGHT_SPOT:
		return FACT_SPOT_LIGHTS;
	case LIGHT_DIRECTIONAL:
		return FACT_DIRECTIONAL_LIGHTS;
	}
	return 0;
}

uint32_t facts_collect(const struct blob_header *blob)
{
	const struct triangle *triangles = blob_section(blob, BLOB_TRIANGLES);
	const struct material *materials = blob_section(blob, BLOB_MATERIALS);
	const struct punctual_light *lights = blob_section(blob, BLOB_LIGHTS);
	uint32_t facts = blob_count(blob, BLOB_EMITTERS) > 0 ? FACT_EMITTERS : 0;
	uint32_t last = NONE;

	// Only what some triangle uses counts: an unused material calls for nothing.
	for (uint32_t i = 0; i < blob_count(blob, BLOB_TRIANGLES); i++) {
		if (triangles[i].material != last)
			facts |= material_facts(&materials[triangles[i].material]);
		last = triangles[i].material;
	}
	for (uint32_t i = 0; i < blob_count(blob, BLOB_LIGHTS); i++)
		facts |= light_facts(&lights[i]);
	return facts;
}

const char *fact_name(enum fact fact)
{
	switch (fact) {
	case FACT_TEXTURES:
		return "textures";
	case FACT_EMITTERS:
		return "emitters";
	case FACT_POINT_LIGHTS:
		return "point lights";
	case FACT_SPOT_LIGHTS:
		return "spot lights";
	case FACT_DIRECTIONAL_LIGHTS:
		return "directional lights";
	case FACT_REFLECTS:
		return "reflecting surfaces";
	}
	return NULL;
}
