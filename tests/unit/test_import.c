// From an import to a blob's parts: text made clean, what is unsound dropped and counted, the origin where precision needs
// it, emitter tables in proportion to power.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/base/angle.h"
#include "server/loader/geometry.h"
#include "server/loader/import.h"
#include "server/scene/lights.h"

static candil_SceneInfo info;
static struct import import;

static int fresh(void **state)
{
	(void)state;
	memset(&info, 0, sizeof info);
	import_init(&import, NULL, &info);
	import.decoder = &image_decoder;
	return 0;
}

static int finish(void **state)
{
	(void)state;
	import_finish(&import);
	return 0;
}

static void add_triangle(double x, double y, double z, double size, uint32_t material)
{
	const struct triangle t = {
	    {(uint32_t)import.vertex_count, (uint32_t)import.vertex_count + 1, (uint32_t)import.vertex_count + 2}, material};
	for (int k = 0; k < 3; k++) {
		struct import_vertex v = {.position = {x + (k == 1 ? size : 0), y + (k == 2 ? size : 0), z}};
		assert_int_equal(import_add_vertex(&import, &v, NULL), STATUS_OK);
	}
	assert_int_equal(import_add_triangle(&import, &t, NULL), STATUS_OK);
}

static void colours_are_made_fit(void **state)
{
	float v;
	(void)state;
	assert_true(import_fit(&v, 0.25, 1) && v == 0.25f);
	assert_false(import_fit(&v, 2, 1));
	assert_true(v == 1);
	assert_false(import_fit(&v, -1, 1));
	assert_true(v == 0);
	assert_false(import_fit(&v, NAN, 1));
	assert_true(v == 0);
	assert_false(import_fit(&v, INFINITY, 1e12));
	assert_true(v == 1e12f);
}

static void warnings_have_an_end(void **state)
{
	(void)state;
	for (unsigned i = 0; i < LIMIT_WARNINGS + 5; i++)
		import_warn(&import, "warning %u", i);
	import_warn(&import, "warning 0");
	assert_int_equal(info.warnings_count, LIMIT_WARNINGS);
	assert_int_equal(info.warnings_more, 5);
	for (unsigned i = 0; i < 100; i++)
		import_ignore(&import, i % 2 ? "one" : "other");
	assert_int_equal(info.ignored_count, 2);
}

static void unsound_triangles_are_dropped(void **state)
{
	struct geometry g;
	(void)state;
	add_triangle(0, 0, 0, 1, 0);
	add_triangle(NAN, 0, 0, 1, 0);
	add_triangle(0, INFINITY, 0, 1, 0);
	add_triangle(0, 0, 1e13, 1, 0);
	add_triangle(0, 0, 0, 0, 0);
	add_triangle(1, 1, 1, 1, 0);
	assert_int_equal(geometry_build(&import, &g, NULL), STATUS_OK);
	assert_int_equal(g.triangle_count, 2);
	assert_int_equal(info.dropped_non_finite, 3);
	assert_int_equal(info.dropped_degenerate, 1);
	assert_true(g.max[0] == 2 && g.max[1] == 2 && g.max[2] == 1 && g.min[0] == 0);
	geometry_finish(&g);
}

static void normals_and_uvs_are_made_sound(void **state)
{
	struct geometry g;
	(void)state;
	add_triangle(0, 0, 0, 1, 0);
	import.vertices[0].normal[1] = 4;
	import.vertices[1].normal[0] = NAN;
	import.vertices[2].uv[0] = INFINITY;
	assert_int_equal(geometry_build(&import, &g, NULL), STATUS_OK);
	assert_true(g.vertices[0].normal[1] == 1);
	assert_true(g.vertices[1].normal[0] == 0 && g.vertices[1].normal[1] == 0);
	assert_true(g.vertices[2].uv[0] == 0);
	geometry_finish(&g);
}

static void origin_of(double x, double size, double origin[3], float first[3])
{
	struct geometry g;
	fresh(NULL);
	add_triangle(x, 0, 0, size, 0);
	assert_int_equal(geometry_build(&import, &g, NULL), STATUS_OK);
	memcpy(origin, g.origin, sizeof g.origin);
	memcpy(first, g.vertices[0].position, sizeof g.vertices[0].position);
	geometry_finish(&g);
	import_finish(&import);
}

static void the_origin_moves_where_precision_needs_it(void **state)
{
	double origin[3];
	float near_zero[3], far_off[3];
	(void)state;
	origin_of(0.3, 1, origin, near_zero);
	assert_true(origin[0] == 0 && near_zero[0] == 0.3f);
	origin_of(10, 1, origin, far_off); // 10 extents away: floats still have digits to spare
	assert_true(origin[0] == 0 && far_off[0] == 10);
	origin_of(1e5, 1, origin, far_off);
	assert_true(origin[0] == 1e5 + 1 || origin[0] == 1e5);
	assert_true((double)(float)origin[0] == origin[0]);
	assert_true(origin[0] + (double)far_off[0] == 1e5);
	origin_of(1e9, 1e-3, origin, far_off);
	assert_true((double)(float)origin[0] == origin[0]);
	origin_of(-1e5 + 0.25, 0.5, origin, far_off);
	assert_true(origin[0] + (double)far_off[0] == -1e5 + 0.25);
}

static void weigh_materials(void)
{
	for (size_t i = 0; i < import.material_count; i++)
		import.materials[i].power_density =
		    lights_power_density(&import.materials[i], import.textures, import.texels);
}

static void emitters_go_by_power(void **state)
{
	struct emitter *once, *twice;
	uint32_t count, again;
	float power, doubled;
	struct geometry g;
	const struct material dark = import_plain_material(0);
	(void)state;
	for (int i = 0; i < 4; i++) {
		struct material m = dark;
		m.emission[0] = m.emission[1] = m.emission[2] = (float)i; // the first is black
		m.flags = i == 3 ? MATERIAL_EMITS_BOTH_SIDES : 0;
		assert_int_equal(import_add_material(&import, &m, "m", NULL), STATUS_OK);
		add_triangle(i, 0, 0, 1 + i, (uint32_t)i);
	}
	assert_int_equal(geometry_build(&import, &g, NULL), STATUS_OK);
	weigh_materials();
	assert_true(fabsf(import.materials[1].power_density - (float)PI) < 1e-5f);
	assert_true(fabsf(import.materials[3].power_density - 6 * (float)PI) < 1e-5f);
	assert_int_equal(lights_collect_emitters(import.materials, g.vertices, g.triangles, g.triangle_count, &once, &count,
						 &power, NULL),
			 STATUS_OK);
	assert_int_equal(count, 3);
	// area · radiance · sides: 2·1, 4.5·2, 8·3·2, of 59 in all
	assert_true(fabs(once[0].pmf - 2 / 59.0) < 1e-6 && fabs(once[1].pmf - 9 / 59.0) < 1e-6 &&
		    fabs(once[2].pmf - 48 / 59.0) < 1e-6);
	assert_true(fabs(power - 59 * PI) < 1e-3);
	for (int i = 0; i < 4; i++)
		for (int c = 0; c < 3; c++)
			import.materials[i].emission[c] *= 2;
	weigh_materials();
	assert_int_equal(lights_collect_emitters(import.materials, g.vertices, g.triangles, g.triangle_count, &twice, &again,
						 &doubled, NULL),
			 STATUS_OK);
	assert_int_equal(again, count);
	assert_memory_equal(once, twice, count * sizeof *once);
	assert_true(doubled == 2 * power);
	free(once);
	free(twice);
	geometry_finish(&g);
}

static void punctual_lights_go_by_power(void **state)
{
	struct punctual_light table[4];
	uint32_t count = 4, place[4];
	float power;
	const double weights[3] = {4, 2 * (1 - 0.75), 9}; // in units of pi, with radius 3
	(void)state;
	table[0] = (struct punctual_light){.kind = LIGHT_POINT}; // black
	for (uint32_t kind = 0; kind < 3; kind++)
		table[1 + kind] = (struct punctual_light){.kind = kind, .intensity = {1, 1, 1}, .outer = 0.5f};
	assert_int_equal(lights_make_table(table, &count, 3, place, &power, NULL), STATUS_OK);
	assert_int_equal(count, 3);
	assert_int_equal(place[0], NONE);
	for (uint32_t i = 0; i < 3; i++)
		assert_true(place[1 + i] == i && table[i].kind == i);
	for (int i = 0; i < 3; i++)
		assert_true(fabs(table[i].pmf - weights[i] / 13.5) < 1e-6);
	assert_true(fabs(power - 13.5 * PI) < 1e-4);
}

// An import whose texels have room for so many more.
static void leave_room(uint32_t count)
{
	import.texel_count = LIMIT_TEXELS - count;
	import.texel_room = LIMIT_TEXELS;
	import.texels = malloc((size_t)LIMIT_TEXELS * sizeof *import.texels); // touched in its last few words alone
	assert_non_null(import.texels);
}

// Derive an image of two by one texels, whose numbers of 16 bits are first, first + 1 …
static uint32_t derive(const char *key, uint32_t first, bool deep)
{
	const struct import_sampling sampling = import_plain_sampling(0);
	uint32_t texels[4], texture;
	for (uint32_t i = 0; i < 4; i++)
		texels[i] = deep ? (first + 2 * i) | (first + 2 * i + 1) << 16 : 0x01010101u * (first + i);
	assert_int_equal(import_derived_texture(&import, key, texels, 2, 1, deep, &sampling, &texture, NULL), STATUS_OK);
	return texture;
}

static void is_shallow(uint32_t texture, uint32_t first, uint32_t second)
{
	const struct texture_info *t = &import.textures[texture];
	assert_int_equal(t->flags & TEXTURE_DEEP, 0);
	assert_int_equal(import.texels[t->offset], 0x01010101u * first);
	assert_int_equal(import.texels[t->offset + 1], 0x01010101u * second);
}

static void deep_textures_are_rounded_where_they_have_no_room(void **state)
{
	(void)state;
	leave_room(8);
	const uint32_t deep = derive("deep", 257 * 3 - 4, true), plain = derive("plain", 40, false);
	assert_true(import.textures[deep].flags & TEXTURE_DEEP);
	assert_int_equal(info.warnings_count, 0);
	const uint32_t rounded = derive("rounded", 257 * 7 - 4, true); // four words, but two are left
	is_shallow(rounded, 7, 7);
	assert_true(import.textures[deep].flags & TEXTURE_DEEP);
	assert_int_equal(info.warnings_count, 1);
	assert_int_equal(import.texel_count, LIMIT_TEXELS);
	const uint32_t last = derive("last", 80, false); // none is left, until the first one is rounded
	is_shallow(deep, 3, 3);
	is_shallow(plain, 40, 41);
	is_shallow(rounded, 7, 7);
	is_shallow(last, 80, 81);
	assert_int_equal(derive("deep", 0, true), deep);
	assert_int_equal(info.warnings_count, 1);
	assert_int_equal(import.texel_count, LIMIT_TEXELS);
	const struct import_sampling sampling = import_plain_sampling(0);
	uint32_t texel = 0, texture;
	struct error err;
	assert_int_equal(import_derived_texture(&import, "more", &texel, 1, 1, false, &sampling, &texture, &err),
			 STATUS_SCENE_LIMIT);
}

// Read a TIFF of one pixel, grey, of 16 bits.
static uint32_t read_grey(const char *key, unsigned number)
{
	// Size, bits, not compressed, zero is black, the only strip's place, samples, rows and bytes: tags from 256 on.
	static const uint8_t entries[9][2] = {{0, 1}, {1, 1}, {2, 16}, {3, 1}, {6, 1}, {17, 122}, {21, 1}, {22, 1}, {23, 2}};
	uint8_t file[124] = {'I', 'I', 42, 0, 8, 0, 0, 0, 9};
	for (size_t i = 0; i < 9; i++)
		memcpy(file + 10 + 12 * i, (uint8_t[12]){entries[i][0], 1, 3, 0, 1, 0, 0, 0, entries[i][1]}, 12);
	file[122] = (uint8_t)number;
	file[123] = (uint8_t)(number >> 8);
	const struct import_sampling sampling = import_plain_sampling(0);
	uint32_t texture;
	assert_int_equal(import_texture(&import, key, file, sizeof file, true, &sampling, &texture, NULL), STATUS_OK);
	assert_int_not_equal(texture, NONE);
	return texture;
}

static void files_of_16_bits_are_rounded_where_they_have_no_room(void **state)
{
	(void)state;
	leave_room(4);
	const uint32_t deep = read_grey("deep", 258);
	assert_true(import.textures[deep].flags & TEXTURE_DEEP);
	assert_int_equal(import.texels[import.textures[deep].offset], 258 | 258u << 16);
	const uint32_t eight = read_grey("8 bits", 257 * 9);
	assert_int_equal(import.texels[import.textures[eight].offset], 0xFF090909u);
	// One word is left: enough, without a loss, for 8 bits in 16.
	const uint32_t again = read_grey("8 bits more", 257 * 200);
	assert_int_equal(import.texels[import.textures[again].offset], 0xFFC8C8C8u);
	assert_int_equal(info.warnings_count, 0);
	// None is left, so the first one is rounded, and then this one.
	const uint32_t last = read_grey("last", 257 * 5 + 129);
	assert_int_equal(import.texels[import.textures[last].offset], 0xFF060606u);
	assert_int_equal(import.texels[import.textures[deep].offset], 0xFF010101u);
	assert_int_equal(import.texels[import.textures[again].offset], 0xFFC8C8C8u);
	assert_int_equal(info.warnings_count, 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(colours_are_made_fit),
	    cmocka_unit_test_setup_teardown(warnings_have_an_end, fresh, finish),
	    cmocka_unit_test_setup_teardown(unsound_triangles_are_dropped, fresh, finish),
	    cmocka_unit_test_setup_teardown(normals_and_uvs_are_made_sound, fresh, finish),
	    cmocka_unit_test(the_origin_moves_where_precision_needs_it),
	    cmocka_unit_test_setup_teardown(emitters_go_by_power, fresh, finish),
	    cmocka_unit_test_setup_teardown(deep_textures_are_rounded_where_they_have_no_room, fresh, finish),
	    cmocka_unit_test_setup_teardown(files_of_16_bits_are_rounded_where_they_have_no_room, fresh, finish),
	    cmocka_unit_test_setup_teardown(punctual_lights_go_by_power, fresh, finish),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
