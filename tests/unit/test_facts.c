// Each fact follows from what the scene uses, and from nothing that it merely holds.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/scene/casters.h"
#include "server/scene/facts.h"
#include "tests/unit/small_blob.h"

static struct small_blob blob;

static uint32_t facts(void)
{
	return facts_collect(small_header(&blob));
}

// Of the first material.
static double strength(void)
{
	struct blob_view view;
	blob_view_init(&view, small_header(&blob));
	return casters_strength(&view, small_section(&blob, BLOB_MATERIALS));
}

static int fresh(void **state)
{
	(void)state;
	small_make(&blob);
	return 0;
}

static void everything(void **state)
{
	(void)state;
	assert_int_equal(facts(), FACT_TEXTURES | FACT_EMITTERS | FACT_POINT_LIGHTS | FACT_SPOT_LIGHTS |
				      FACT_DIRECTIONAL_LIGHTS | FACT_REFLECTS | FACT_GLOSSY | FACT_NORMAL_MAPS |
				      FACT_ALPHA_MASK | FACT_VERTEX_COLORS | FACT_GLASS | FACT_SURROUNDINGS | FACT_POLISHED);
}

static void lights_by_kind(void **state)
{
	struct punctual_light *lights = small_section(&blob, BLOB_LIGHTS);
	static const uint32_t facts_of[] = {FACT_POINT_LIGHTS, FACT_SPOT_LIGHTS, FACT_DIRECTIONAL_LIGHTS};
	(void)state;
	small_header(&blob)->sections[BLOB_LIGHTS].count = 1;
	for (uint32_t kind = 0; kind < 3; kind++) {
		lights[0].kind = kind;
		assert_int_equal(facts() & (FACT_POINT_LIGHTS | FACT_SPOT_LIGHTS | FACT_DIRECTIONAL_LIGHTS), facts_of[kind]);
	}
}

static void emitters(void **state)
{
	(void)state;
	small_header(&blob)->sections[BLOB_EMITTERS].count = 0;
	assert_false(facts() & FACT_EMITTERS);
}

static void unused_materials_say_nothing(void **state)
{
	struct triangle *triangles = small_section(&blob, BLOB_TRIANGLES);
	(void)state;
	for (int i = 0; i < 4; i++)
		triangles[i].material = 1; // black, untextured
	assert_false(facts() & (FACT_TEXTURES | FACT_REFLECTS));
	triangles[3].material = 0;
	assert_int_equal(facts() & (FACT_TEXTURES | FACT_REFLECTS), FACT_TEXTURES | FACT_REFLECTS);
}

static void textures_of_any_kind(void **state)
{
	struct material *m = small_section(&blob, BLOB_MATERIALS);
	(void)state;
	for (int i = 0; i < 10; i++) {
		uint32_t *const slots[] = {&m->albedo_texture,          &m->emission_texture, &m->specular_texture,
					   &m->surface_texture,         &m->normal_texture,   &m->transmission_texture,
					   &m->specular_weight_texture, &m->coat_texture,     &m->coat_roughness_texture,
					   &m->coat_normal_texture};
		for (int k = 0; k < 10; k++)
			*slots[k] = k == i ? 0 : NONE;
		assert_true(facts() & FACT_TEXTURES);
		*slots[i] = NONE;
		assert_false(facts() & FACT_TEXTURES);
		assert_false(facts() & FACT_NORMAL_MAPS);
	}
}

static void gloss(void **state)
{
	struct material *m = small_section(&blob, BLOB_MATERIALS);
	(void)state;
	*m = (struct material){.albedo = {.5f, 0, 0}};
	assert_int_equal(facts() & (FACT_GLOSSY | FACT_REFLECTS), FACT_REFLECTS);
	*m = (struct material){.metallic = .1f};
	assert_int_equal(facts() & (FACT_GLOSSY | FACT_REFLECTS), FACT_GLOSSY | FACT_REFLECTS);
	*m = (struct material){.specular_weight = .1f};
	assert_int_equal(facts() & (FACT_GLOSSY | FACT_REFLECTS), FACT_GLOSSY | FACT_REFLECTS);
	*m = (struct material){.specular = {0, 0, .1f}};
	assert_int_equal(facts() & (FACT_GLOSSY | FACT_REFLECTS), FACT_GLOSSY | FACT_REFLECTS);
	*m = (struct material){.albedo = {1, 1, 1}, .specular_weight = 1, .flags = MATERIAL_UNLIT};
	assert_int_equal(facts() & (FACT_GLOSSY | FACT_REFLECTS | FACT_UNLIT | FACT_ALPHA_MASK), FACT_UNLIT);
}

static void glass(void **state)
{
	struct material *m = small_section(&blob, BLOB_MATERIALS);
	(void)state;
	*m = (struct material){.transmission = .1f};
	assert_int_equal(facts() & (FACT_GLASS | FACT_REFLECTS | FACT_ALPHA_BLEND), FACT_GLASS | FACT_REFLECTS);
	*m = (struct material){.transmission = .1f, .flags = MATERIAL_UNLIT | MATERIAL_ALPHA_BLEND};
	assert_int_equal(facts() & (FACT_GLASS | FACT_REFLECTS | FACT_ALPHA_BLEND), FACT_ALPHA_BLEND);
}

static void coats_and_matte_facets(void **state)
{
	const uint32_t asked = FACT_CLEARCOAT | FACT_REFLECTS | FACT_ROUGH_DIFFUSE | FACT_NORMAL_MAPS;
	struct material *m = small_section(&blob, BLOB_MATERIALS);
	(void)state;
	const struct material plain = {.normal_texture = NONE, .coat_normal_texture = NONE};
	*m = plain;
	assert_int_equal(facts() & asked, 0);
	m->coat = .1f;
	assert_int_equal(facts() & asked, FACT_CLEARCOAT | FACT_REFLECTS);
	m->coat_normal_texture = 0;
	assert_int_equal(facts() & asked, FACT_CLEARCOAT | FACT_REFLECTS | FACT_NORMAL_MAPS);
	*m = plain;
	m->diffuse_roughness = .1f;
	assert_int_equal(facts() & asked, FACT_ROUGH_DIFFUSE);
	m->coat = 1;
	m->flags = MATERIAL_UNLIT;
	assert_int_equal(facts() & asked, 0);
}

static void polished(void **state)
{
	struct material *m = small_section(&blob, BLOB_MATERIALS);
	(void)state;
	*m = (struct material){.metallic = 1, .albedo = {.5f, .5f, .5f}, .surface_texture = NONE};
	assert_true(facts() & FACT_POLISHED);
	assert_true(fabs(strength() - .5) < 1e-6);
	m->flags = MATERIAL_UNLIT;
	assert_false(facts() & FACT_POLISHED);
	*m = (struct material){.metallic = 1, .albedo = {.5f, .5f, .5f}, .roughness = .5f, .surface_texture = NONE};
	assert_true(facts() & FACT_POLISHED);
	m->roughness = .51f;
	assert_false(facts() & FACT_POLISHED);
	*m = (struct material){.transmission = .25f, .ior = 1.5f, .surface_texture = NONE};
	assert_true(facts() & FACT_POLISHED);
	assert_true(fabs(strength() - .25) < 1e-6);
	// Too little bent to be spread, unless it is a wall's own facets that spread it.
	*m = (struct material){.transmission = 1, .ior = 1.1f, .roughness = .8f, .surface_texture = NONE};
	assert_true(facts() & FACT_POLISHED);
	m->flags = MATERIAL_THIN;
	assert_false(facts() & FACT_POLISHED);
}

static void what_reflects_little_casts_if_it_is_smooth(void **state)
{
	struct material *m = small_section(&blob, BLOB_MATERIALS);
	(void)state;
	*m = (struct material){.specular = {.04f, .04f, .04f}, .surface_texture = NONE};
	assert_true(fabs(strength() - .04) < 1e-6);
	m->roughness = .1f;
	assert_false(facts() & FACT_POLISHED);
	m->coat = .5f;
	assert_true(fabs(strength() - .02) < 1e-6);
	m->coat_roughness = .1f;
	assert_false(facts() & FACT_POLISHED);
}

static void a_texture_says_how_much_is_polished(void **state)
{
	struct material *m = small_section(&blob, BLOB_MATERIALS);
	struct texture_info *t = small_section(&blob, BLOB_TEXTURES);
	uint32_t *texels = small_section(&blob, BLOB_TEXELS);
	(void)state;
	*m = (struct material){.metallic = 1, .albedo = {.5f, .5f, .5f}, .roughness = 1};
	// Green is roughness, blue is metal: half of it is smooth metal.
	for (uint32_t i = 0; i < t->width * t->height; i++)
		texels[t->offset + i] = i < t->width * t->height / 2 ? 0xffff0000u : 0xffffff00u;
	assert_true(facts() & FACT_POLISHED);
	assert_true(fabs(strength() - .5 * (t->width * t->height / 2) / (t->width * t->height)) < 1e-6);
	for (uint32_t i = 0; i < t->width * t->height; i++)
		texels[t->offset + i] = 0xffff8000u | 0xff00u;
	assert_false(facts() & FACT_POLISHED);
}

static void white_vertices_have_no_colour(void **state)
{
	struct vertex_color *colors = small_section(&blob, BLOB_COLORS);
	(void)state;
	for (int i = 0; i < 12; i++)
		colors[i] = (struct vertex_color){{1, 1, 1, 1}};
	assert_false(facts() & FACT_VERTEX_COLORS);
	colors[11].rgba[1] = .9f;
	assert_true(facts() & FACT_VERTEX_COLORS);
}

static void every_fact_has_a_name(void **state)
{
	(void)state;
	for (uint32_t bit = 1; bit <= FACT_POLISHED; bit <<= 1)
		assert_non_null(fact_name((enum fact)bit));
	assert_null(fact_name((enum fact)(FACT_POLISHED << 1)));
	assert_null(fact_name((enum fact)(FACT_TEXTURES | FACT_EMITTERS)));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test_setup(everything, fresh),
	    cmocka_unit_test_setup(lights_by_kind, fresh),
	    cmocka_unit_test_setup(textures_of_any_kind, fresh),
	    cmocka_unit_test_setup(gloss, fresh),
	    cmocka_unit_test_setup(glass, fresh),
	    cmocka_unit_test_setup(coats_and_matte_facets, fresh),
	    cmocka_unit_test_setup(polished, fresh),
	    cmocka_unit_test_setup(what_reflects_little_casts_if_it_is_smooth, fresh),
	    cmocka_unit_test_setup(a_texture_says_how_much_is_polished, fresh),
	    cmocka_unit_test_setup(white_vertices_have_no_colour, fresh),
	    cmocka_unit_test_setup(emitters, fresh),
	    cmocka_unit_test_setup(unused_materials_say_nothing, fresh),
	    cmocka_unit_test(every_fact_has_a_name),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
