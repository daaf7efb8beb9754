// Each fact follows from what the scene uses and shows, and from nothing that it merely holds or names.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/scene/casters.h"
#include "server/scene/facts.h"
#include "tests/unit/small_blob.h"

static struct small_blob blob;

static uint32_t facts(void)
{
	small_ranges(&blob);
	return facts_collect(small_header(&blob));
}

// Of the first material.
static double strength(void)
{
	struct blob_view view;
	small_ranges(&blob);
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
				      FACT_ALPHA_MASK | FACT_VERTEX_COLORS | FACT_GLASS | FACT_SURROUNDINGS | FACT_POLISHED |
				      FACT_PATCHES | FACT_FACTORS);
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

// A material of every part, none of which hides another.
static struct material all_parts(void)
{
	return (struct material){.albedo = {.5f, .5f, .5f},
				 .albedo_texture = NONE,
				 .emission = {1, 1, 1},
				 .emission_texture = NONE,
				 .specular = {.04f, .04f, .04f},
				 .specular_texture = NONE,
				 .specular_weight = 1,
				 .specular_weight_texture = NONE,
				 .metallic = .5f,
				 .roughness = .5f,
				 .surface_texture = NONE,
				 .normal_texture = NONE,
				 .normal_scale = 1,
				 .alpha = 1,
				 .alpha_cutoff = .5f,
				 .transmission = .5f,
				 .transmission_texture = NONE,
				 .ior = 1.5f,
				 .diffuse_roughness = .5f,
				 .coat = .5f,
				 .coat_texture = NONE,
				 .coat_roughness = .5f,
				 .coat_roughness_texture = NONE,
				 .coat_normal_texture = NONE,
				 .coat_normal_scale = 1};
}

// Give all vertices one colour.
static void paint(float red, float green, float blue, float alpha)
{
	struct vertex_color *colors = small_section(&blob, BLOB_COLORS);
	for (int i = 0; i < 12; i++)
		colors[i] = (struct vertex_color){{red, green, blue, alpha}};
}

// Give all texels one value, 0xAABBGGRR.
static void fill(uint32_t texel)
{
	uint32_t *texels = small_section(&blob, BLOB_TEXELS);
	for (int i = 0; i < 6; i++)
		texels[i] = texel;
}

static uint32_t by_name(void)
{
	struct blob_view view;
	small_ranges(&blob);
	blob_view_init(&view, small_header(&blob));
	return facts_by_name(&view);
}

static void textures_of_any_kind(void **state)
{
	struct material *m = small_section(&blob, BLOB_MATERIALS);
	(void)state;
	paint(1, 1, 1, 1);
	for (int i = 0; i < 10; i++) {
		uint32_t *const slots[] = {&m->albedo_texture,          &m->emission_texture,       &m->specular_texture,
					   &m->surface_texture,         &m->transmission_texture,   &m->coat_texture,
					   &m->specular_weight_texture, &m->coat_roughness_texture, &m->normal_texture,
					   &m->coat_normal_texture};
		const uint32_t fact = i < 8 ? FACT_TEXTURES : FACT_NORMAL_MAPS;
		*m = all_parts();
		assert_false(facts() & (FACT_TEXTURES | FACT_NORMAL_MAPS));
		*slots[i] = 0;
		fill(0x80808080u);
		assert_int_equal(facts() & (FACT_TEXTURES | FACT_NORMAL_MAPS), fact);
		assert_int_equal(by_name() & (FACT_TEXTURES | FACT_NORMAL_MAPS), fact);
		fill(0xFFFFFFFFu);
		assert_int_equal(facts() & (FACT_TEXTURES | FACT_NORMAL_MAPS), i < 8 ? 0 : fact);
		assert_int_equal(by_name() & (FACT_TEXTURES | FACT_NORMAL_MAPS), fact);
	}
}

// A textured part of weight zero, and a texture that alone takes a part away.
static void textures_of_nothing(void **state)
{
	struct material *m = small_section(&blob, BLOB_MATERIALS);
	(void)state;
	paint(1, 1, 1, 1);
	fill(0);
	*m = all_parts();
	m->coat = m->coat_roughness = m->roughness = m->metallic = m->transmission = 0;
	m->coat_texture = m->coat_roughness_texture = m->surface_texture = m->transmission_texture = 0;
	memset(m->albedo, 0, sizeof m->albedo);
	memset(m->emission, 0, sizeof m->emission);
	m->albedo_texture = m->emission_texture = 0;
	assert_false(facts() & FACT_TEXTURES);
	assert_true(by_name() & FACT_TEXTURES);
	m->emission[2] = 1e-6f;
	assert_true(facts() & FACT_TEXTURES);
	// Its coat is zero by its texture, which counts once another material has a coat.
	*m = all_parts();
	m->coat_texture = 0;
	assert_false(facts() & (FACT_TEXTURES | FACT_CLEARCOAT));
	m[1].coat = .1f;
	assert_int_equal(facts() & (FACT_TEXTURES | FACT_CLEARCOAT), FACT_TEXTURES | FACT_CLEARCOAT);
	// Transmission likewise; and metalness, of what is no metal by its texture.
	m[1].coat = 0;
	*m = all_parts();
	m->transmission_texture = 0;
	assert_false(facts() & (FACT_TEXTURES | FACT_GLASS));
	m[1].transmission = .1f;
	m[1].ior = 1.5f;
	assert_int_equal(facts() & (FACT_TEXTURES | FACT_GLASS), FACT_TEXTURES | FACT_GLASS);
	m[1].transmission = 0;
	*m = all_parts();
	m->specular_weight = 0;
	memset(m->specular, 0, sizeof m->specular);
	m->surface_texture = 0;
	m->transmission = 0;
	assert_false(facts() & (FACT_TEXTURES | FACT_GLOSSY));
	m[1].metallic = 1;
	assert_int_equal(facts() & (FACT_TEXTURES | FACT_GLOSSY), FACT_TEXTURES | FACT_GLOSSY);
}

static void alpha(void **state)
{
	struct material *m = small_section(&blob, BLOB_MATERIALS);
	const uint32_t asked = FACT_ALPHA_MASK | FACT_ALPHA_BLEND | FACT_TEXTURES | FACT_VERTEX_COLORS;
	(void)state;
	paint(1, 1, 1, 1);
	for (int blend = 0; blend < 2; blend++) {
		const uint32_t fact = blend ? FACT_ALPHA_BLEND : FACT_ALPHA_MASK;
		m[0] = m[1] = all_parts();
		m->flags = blend ? MATERIAL_ALPHA_BLEND : MATERIAL_ALPHA_MASK;
		assert_int_equal(facts() & asked, 0);
		assert_int_equal(by_name() & asked, fact);
		m->albedo_texture = 0;
		fill(0xFFFFFFFFu);
		assert_int_equal(facts() & asked, 0);
		fill(0x40FFFFFFu);
		assert_int_equal(facts() & asked, fact | FACT_TEXTURES);
		// What is nowhere there has nothing else.
		fill(0x00FFFFFFu);
		m[1] = *m;
		assert_int_equal(facts() & (asked | FACT_REFLECTS | FACT_GLOSSY), fact | FACT_TEXTURES);
		m->albedo_texture = m[1].albedo_texture = NONE;
		((struct vertex_color *)small_section(&blob, BLOB_COLORS))[1].rgba[3] = .25f;
		assert_int_equal(facts() & asked, fact | FACT_VERTEX_COLORS);
		paint(1, 1, 1, 1);
	}
	*m = all_parts();
	m->flags = MATERIAL_ALPHA_MASK;
	m->albedo_texture = 0;
	memset(m->albedo, 0, sizeof m->albedo);
	m[1] = *m;
	fill(0x90FFFFFFu); // beyond the cutoff
	assert_int_equal(facts() & asked, 0);
	m[0].alpha_cutoff = .6f;
	assert_int_equal(facts() & asked, FACT_ALPHA_MASK | FACT_TEXTURES);
	m[0].flags = MATERIAL_ALPHA_BLEND;
	m[0].alpha = 0;
	assert_int_equal(facts() & asked, FACT_ALPHA_BLEND | FACT_TEXTURES);
	// An alpha that vertices raise beyond the cutoff counts where masks run, not else.
	m[0] = m[1];
	paint(1, 1, 1, 2);
	m[0].alpha_cutoff = .8f;
	assert_int_equal(facts() & asked, 0);
	m[1].alpha_cutoff = 2;
	assert_int_equal(facts() & asked, FACT_ALPHA_MASK | FACT_TEXTURES | FACT_VERTEX_COLORS);
}

static void what_nothing_shows(void **state)
{
	struct material *m = small_section(&blob, BLOB_MATERIALS);
	(void)state;
	paint(1, 1, 1, 1);
	*m = all_parts();
	assert_int_equal(facts() & (FACT_GLASS | FACT_ROUGH_DIFFUSE), FACT_GLASS | FACT_ROUGH_DIFFUSE);
	m->metallic = 1;
	assert_int_equal(facts() & (FACT_GLASS | FACT_ROUGH_DIFFUSE), 0);
	assert_int_equal(by_name() & (FACT_GLASS | FACT_ROUGH_DIFFUSE), FACT_GLASS | FACT_ROUGH_DIFFUSE);
	// All of it is a clear boundary: no microfacets, no diffuse part, no coat but over its emission.
	*m = all_parts();
	m->metallic = 0;
	m->transmission = 1;
	assert_int_equal(facts() & (FACT_GLASS | FACT_GLOSSY | FACT_ROUGH_DIFFUSE | FACT_CLEARCOAT),
			 FACT_GLASS | FACT_CLEARCOAT);
	memset(m->emission, 0, sizeof m->emission);
	assert_int_equal(facts() & (FACT_GLASS | FACT_CLEARCOAT), FACT_GLASS);
	// Black: no diffuse part.
	*m = all_parts();
	memset(m->albedo, 0, sizeof m->albedo);
	assert_false(facts() & FACT_ROUGH_DIFFUSE);
	// A normal map of no scale; or of scale where nothing but an AOV shows it.
	*m = all_parts();
	m->normal_texture = m->coat_normal_texture = 0;
	m->normal_scale = m->coat_normal_scale = 0;
	assert_false(facts() & (FACT_NORMAL_MAPS | FACT_DARK_NORMAL_MAPS));
	m->normal_scale = -1e-3f;
	assert_int_equal(facts() & (FACT_NORMAL_MAPS | FACT_DARK_NORMAL_MAPS), FACT_NORMAL_MAPS);
	memset(small_section(&blob, BLOB_TANGENTS), 0, 12 * sizeof(struct vertex_tangent));
	assert_false(facts() & (FACT_NORMAL_MAPS | FACT_DARK_NORMAL_MAPS));
	((struct vertex_tangent *)small_section(&blob, BLOB_TANGENTS))[4].xyzw[2] = 1;
	const struct material black = {.normal_texture = 0, .normal_scale = 1, .surface_texture = NONE};
	*m = black;
	assert_int_equal(facts() & (FACT_NORMAL_MAPS | FACT_DARK_NORMAL_MAPS), FACT_DARK_NORMAL_MAPS);
}

static uint32_t given(uint32_t hidden, uint32_t forced)
{
	struct blob_view view;
	small_ranges(&blob);
	blob_view_init(&view, small_header(&blob));
	return facts_given(&view, hidden, forced);
}

static void what_is_switched_off_wakes_what_it_hid(void **state)
{
	struct material *m = small_section(&blob, BLOB_MATERIALS);
	(void)state;
	paint(1, 1, 1, 1);
	*m = all_parts();
	m->metallic = 1;
	assert_int_equal(given(FACT_GLOSSY, 0) & (FACT_GLOSSY | FACT_ROUGH_DIFFUSE), FACT_ROUGH_DIFFUSE);
	*m = all_parts();
	m->coat_texture = 0;
	fill(0);
	assert_int_equal(given(FACT_TEXTURES, 0) & (FACT_TEXTURES | FACT_CLEARCOAT), FACT_CLEARCOAT);
	// What is forced on needs the texture that takes it away.
	assert_int_equal(given(0, FACT_CLEARCOAT) & FACT_TEXTURES, FACT_TEXTURES);
	*m = all_parts();
	m->metallic = 0;
	m->transmission = 1;
	assert_int_equal(given(FACT_GLASS, 0) & (FACT_GLASS | FACT_GLOSSY | FACT_ROUGH_DIFFUSE),
			 FACT_GLOSSY | FACT_ROUGH_DIFFUSE);
	// Black in each of two ways: either suffices, not none.
	*m = all_parts();
	m->albedo_texture = 0;
	paint(0, 0, 0, 1);
	assert_int_equal(given(0, 0) & (FACT_TEXTURES | FACT_VERTEX_COLORS), FACT_TEXTURES);
	assert_int_equal(given(FACT_TEXTURES, 0) & (FACT_TEXTURES | FACT_VERTEX_COLORS), FACT_VERTEX_COLORS);
	fill(0xFFFFFFFFu);
	assert_int_equal(given(0, 0) & (FACT_TEXTURES | FACT_VERTEX_COLORS), FACT_VERTEX_COLORS);
	fill(0xFF808080u);
	assert_int_equal(given(0, 0) & (FACT_TEXTURES | FACT_VERTEX_COLORS), FACT_VERTEX_COLORS);
	assert_int_equal(given(FACT_VERTEX_COLORS, 0) & (FACT_TEXTURES | FACT_VERTEX_COLORS), FACT_TEXTURES);
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
	struct material plain = all_parts();
	plain.metallic = plain.coat = plain.diffuse_roughness = plain.transmission = plain.specular_weight = 0;
	memset(plain.albedo, 0, sizeof plain.albedo);
	memset(plain.specular, 0, sizeof plain.specular);
	*m = plain;
	assert_int_equal(facts() & asked, 0);
	m->coat = .1f;
	assert_int_equal(facts() & asked, FACT_CLEARCOAT | FACT_REFLECTS);
	m->coat_normal_texture = 0;
	assert_int_equal(facts() & asked, FACT_CLEARCOAT | FACT_REFLECTS | FACT_NORMAL_MAPS);
	*m = plain;
	m->diffuse_roughness = .1f;
	m->albedo[1] = .1f;
	assert_int_equal(facts() & asked, FACT_ROUGH_DIFFUSE | FACT_REFLECTS);
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
	struct material *m = small_section(&blob, BLOB_MATERIALS);
	struct vertex_color *colors = small_section(&blob, BLOB_COLORS);
	(void)state;
	*m = all_parts();
	m[1] = *m;
	paint(1, 1, 1, .5f); // an alpha that nothing reads
	assert_false(facts() & FACT_VERTEX_COLORS);
	assert_true(by_name() & FACT_VERTEX_COLORS);
	colors[11].rgba[1] = .9f;
	assert_true(facts() & FACT_VERTEX_COLORS);
	m[1].albedo[1] = 0;
	assert_false(facts() & FACT_VERTEX_COLORS);
	// A base colour is cut at 1: brighter vertices brighten what is below it.
	paint(2, 2, 2, 1);
	assert_true(facts() & FACT_VERTEX_COLORS);
	for (int i = 0; i < 2; i++)
		m[i].albedo[0] = m[i].albedo[1] = m[i].albedo[2] = 1;
	assert_false(facts() & FACT_VERTEX_COLORS);
}

static void every_fact_has_a_name(void **state)
{
	(void)state;
	for (uint32_t bit = 1; bit <= FACT_FACTORS; bit <<= 1)
		assert_non_null(fact_name((enum fact)bit));
	assert_null(fact_name((enum fact)(FACT_FACTORS << 1)));
	assert_null(fact_name((enum fact)(FACT_TEXTURES | FACT_EMITTERS)));
}

static void lengths_that_floats_cannot_bridge(void **state)
{
	struct vertex *vertices = small_section(&blob, BLOB_VERTICES);
	const struct triangle *t = small_section(&blob, BLOB_TRIANGLES);
	(void)state;
	assert_false(facts() & FACT_VAST);
	small_header(&blob)->bounds_max[1] = 2000;
	assert_true(facts() & FACT_VAST);
	small_make(&blob);
	for (int i = 1; i < 3; i++)
		vertices[t->vertex[i]] = vertices[t->vertex[0]];
	vertices[t->vertex[1]].position[0] += 1e-6f;
	assert_true(facts() & FACT_VAST);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test_setup(everything, fresh),
	    cmocka_unit_test_setup(lights_by_kind, fresh),
	    cmocka_unit_test_setup(textures_of_any_kind, fresh),
	    cmocka_unit_test_setup(textures_of_nothing, fresh),
	    cmocka_unit_test_setup(alpha, fresh),
	    cmocka_unit_test_setup(what_nothing_shows, fresh),
	    cmocka_unit_test_setup(what_is_switched_off_wakes_what_it_hid, fresh),
	    cmocka_unit_test_setup(gloss, fresh),
	    cmocka_unit_test_setup(glass, fresh),
	    cmocka_unit_test_setup(coats_and_matte_facets, fresh),
	    cmocka_unit_test_setup(polished, fresh),
	    cmocka_unit_test_setup(lengths_that_floats_cannot_bridge, fresh),
	    cmocka_unit_test_setup(what_reflects_little_casts_if_it_is_smooth, fresh),
	    cmocka_unit_test_setup(a_texture_says_how_much_is_polished, fresh),
	    cmocka_unit_test_setup(white_vertices_have_no_colour, fresh),
	    cmocka_unit_test_setup(emitters, fresh),
	    cmocka_unit_test_setup(unused_materials_say_nothing, fresh),
	    cmocka_unit_test(every_fact_has_a_name),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
