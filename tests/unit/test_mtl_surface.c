// What MTL's statements become: the roughness of an exponent, which illum shines, heights as normals.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/loader/mtl_surface.h"

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

static bool near_to(double a, double b)
{
	return fabs(a - b) < 1e-6;
}

static void exponents(void **state)
{
	(void)state;
	assert_true(mtl_roughness(0) == 1);
	assert_true(near_to(mtl_roughness(30), 0.5)); // α = sqrt(2/32) = 1/4
	assert_true(near_to(mtl_roughness(510), sqrt(0.0625))); // α = 1/16
	assert_true(mtl_roughness(-5) == 1 && mtl_roughness(NAN) == 1 && mtl_roughness(INFINITY) == 1);
	assert_true(mtl_roughness(1e30) > 0 && mtl_roughness(1e30) < 1e-6f);
}

// The material of a name that a file has defined.
static const struct mtl_note *find(struct mtl_notes *notes, const char *name)
{
	uint32_t number;
	const size_t count = notes->count;
	assert_int_equal(mtl_notes_number(notes, name, &number, NULL), STATUS_OK);
	assert_true(number < count);
	return &notes->notes[number];
}

static struct material surface(int illum, double ks, double ns)
{
	const struct mtl_note note = {
	    .illum = illum, .specular = {ks, ks / 2, 0}, .exponent = ns, .has_exponent = ns >= 0, .dissolve = 1};
	struct material m = import_plain_material(0.5f);
	assert_true(mtl_set_surface(&import, &note, &m) == (ks <= 1));
	return m;
}

static void illumination_models(void **state)
{
	(void)state;
	for (int illum = 0; illum <= 1; illum++) {
		const struct material m = surface(illum, 0.5, 30);
		assert_true(m.specular[0] == 0 && m.specular_weight == 0 && m.roughness == 1);
	}
	for (int illum = 2; illum <= 3; illum++) {
		const struct material m = surface(illum, 0.5, 30);
		assert_true(m.specular[0] == 0.5f && m.specular[1] == 0.25f && m.specular[2] == 0);
		assert_true(m.specular_weight == 0.5f && m.metallic == 0 && near_to(m.roughness, 0.5));
	}
	assert_int_equal(info.ignored_count, 0);
	for (int illum = 4; illum <= 9; illum++) { // nothing says that light comes through
		const struct material m = surface(illum, 0.5, 30);
		assert_true(m.specular[0] == 0.5f && m.transmission == 0 && near_to(m.roughness, 0.5));
		assert_true(m.specular_weight == (illum == 5 ? 1 : 0.5f));
	}
	assert_true(surface(5, 0, 30).specular_weight == 0);
	for (int illum = 2; illum <= 10; illum++) // without Ns
		assert_true(surface(illum, 0.5, -1).roughness == (illum == 3 || illum == 5 || illum == 8 ? 0 : 1));
	fresh(NULL);
	assert_int_equal(info.ignored_count, 0);
	assert_true(surface(10, 0.5, 30).specular_weight == 0.5f);
	assert_int_equal(info.ignored_count, 1);
	assert_string_equal(info.ignored[0], "illum 10");
	assert_true(surface(2, 3, 30).specular[0] == 1);
	assert_true(surface(2, 0.5, 0).roughness == 1 && surface(3, 0.5, 0).roughness == 1);
	assert_true(surface(2, 0, 30).specular_weight == 0);
	// Without an illum both must be given.
	assert_true(surface(-1, 0.5, 30).specular_weight == 0.5f);
	assert_true(surface(-1, 0.5, 0).specular_weight == 0);
	assert_true(surface(-1, 0, 30).specular_weight == 0);
}

static void glass(void **state)
{
	static const int clear[] = {4, 6, 7, 9};
	struct mtl_note note = {
	    .specular = {1, 1, 1}, .exponent = 9, .dissolve = 1, .has_filter = true, .filter = {1, .25, 0}};
	(void)state;
	for (int i = 0; i < 4; i++) {
		struct material m = import_plain_material(0.5f);
		note.illum = clear[i];
		note.ior = i == 0 ? 0 : 1.25;
		assert_true(mtl_set_surface(&import, &note, &m));
		assert_true(m.transmission == 1 && m.roughness == 0 && m.ior == (i == 0 ? 1.5f : 1.25f));
		assert_true(m.albedo[0] == 1 && m.albedo[1] == 0.5f && m.albedo[2] == 0);
		assert_int_equal(m.flags, 0); // solid
	}
	assert_int_equal(info.ignored_count, 0);
	struct material m = import_plain_material(0.5f);
	note.ior = 1e9;
	assert_false(mtl_set_surface(&import, &note, &m));
	assert_true(m.ior == (float)LIMIT_IOR_MOST);
	// No light comes through, or the model is none of glass.
	const struct mtl_note opaque[] = {{.illum = 7, .ior = 2, .dissolve = 1, .has_filter = true},
					  {.illum = 2, .ior = 2, .dissolve = 1}};
	for (int i = 0; i < 2; i++) {
		m = import_plain_material(0.5f);
		assert_true(mtl_set_surface(&import, &opaque[i], &m));
		assert_true(m.transmission == 0 && m.albedo[0] == 0.5f);
	}
	assert_int_equal(info.ignored_count, 2);
	assert_string_equal(info.ignored[0], "Ni");
	assert_string_equal(info.ignored[1], "Tf");
}

static void priorities(void **state)
{
	static char text[] =
	    "newmtl glass\nillum 7\nNi 1.5\nPp 3\nnewmtl high\nillum 7\nNi 1.5\nPp 1e9\nnewmtl matt\nPp 3\n";
	const struct file_bytes bytes = {(uint8_t *)text, sizeof text - 1};
	static const char *const names[] = {"glass", "high", "matt"};
	static const uint32_t flags[] = {3u << MATERIAL_PRIORITY_SHIFT, LIMIT_PRIORITY << MATERIAL_PRIORITY_SHIFT, 0};
	struct mtl_notes notes;
	mtl_notes_init(&notes);
	(void)state;
	assert_int_equal(mtl_notes_read(&notes, &import, "a.mtl", &bytes, NULL), STATUS_OK);
	for (int i = 0; i < 3; i++) {
		struct material m = import_plain_material(0.5f);
		assert_true(mtl_set_surface(&import, find(&notes, names[i]), &m) == (i != 1));
		assert_int_equal(m.flags, flags[i]);
	}
	mtl_notes_finish(&notes);
	assert_int_equal(info.ignored_count, 1);
	assert_string_equal(info.ignored[0], "Pp");
}

static void physical_keys(void **state)
{
	static char text[] = "newmtl metal\nKs 0.5 0.5 0.5\nNs 30\nillum 1\nPm 1\nPr 0.25\nNi 3\n"
			     "newmtl coat\nillum 1\nPc 0.5\nPcr 0.125\nPdr 0.75\n"
			     "newmtl dull\nPm 0.5\nNs 30\n"
			     "newmtl wrong\nPr 7\nPm -1\nPc nan\n"
			     "newmtl glass\nillum 7\nNi 1.5\nPr 0.5\nPc 1\n"
			     "newmtl empty\nPr\nPm\nPc\n";
	const struct file_bytes bytes = {(uint8_t *)text, sizeof text - 1};
	struct mtl_notes notes;
	mtl_notes_init(&notes);
	struct material m[6];
	static const char *const names[] = {"metal", "coat", "dull", "wrong", "glass", "empty"};
	(void)state;
	assert_int_equal(mtl_notes_read(&notes, &import, "a.mtl", &bytes, NULL), STATUS_OK);
	for (int i = 0; i < 6; i++) {
		m[i] = import_plain_material(0.5f);
		assert_true(mtl_set_surface(&import, find(&notes, names[i]), &m[i]) == (i != 3));
	}
	mtl_notes_finish(&notes);
	assert_true(m[0].metallic == 1 && m[0].roughness == 0.25f && m[0].specular[0] == 0.25f && m[0].specular_weight == 1);
	assert_true(m[1].coat == 0.5f && m[1].coat_roughness == 0.125f && m[1].diffuse_roughness == 0.75f);
	assert_true(m[1].specular_weight == 0 && m[1].metallic == 0);
	assert_true(m[2].metallic == 0.5f && near_to(m[2].roughness, 0.5) && near_to(m[2].specular[2], 0.04));
	assert_true(m[3].metallic == 0 && m[3].roughness == 1 && m[3].coat == 0);
	assert_true(m[4].transmission == 1 && m[4].roughness == 0.5f && m[4].coat == 0);
	assert_true(m[5].specular_weight == 0 && m[5].coat == 0);
	assert_int_equal(info.ignored_count, 1); // not Ni: it says how much the metal's other half reflects
	assert_string_equal(info.ignored[0], "Pc");
}

static void dissolve(void **state)
{
	static char text[] =
	    "newmtl a\nd 0.25\nTr 0.5\nnewmtl b\nTr 0.25\nnewmtl c\nTr 1\nnewmtl e\nd 7\nnewmtl f\nd\nTf 0.5\nNi 2\n";
	const struct file_bytes bytes = {(uint8_t *)text, sizeof text - 1};
	static const char *const names[] = {"a", "b", "c", "e", "f"};
	static const float alphas[] = {.25f, .75f, 1, 1, 1};
	struct mtl_notes notes;
	mtl_notes_init(&notes);
	(void)state;
	assert_int_equal(mtl_notes_read(&notes, &import, "a.mtl", &bytes, NULL), STATUS_OK);
	for (int i = 0; i < 5; i++) {
		struct material m = import_plain_material(0.5f);
		assert_true(mtl_set_surface(&import, find(&notes, names[i]), &m) == (i != 3));
		assert_true(m.alpha == alphas[i] && m.flags == (alphas[i] < 1 ? MATERIAL_ALPHA_BLEND : 0));
	}
	const struct mtl_note *f = find(&notes, "f");
	assert_true(f->ior == 2 && f->has_filter && f->filter[0] == .5 && f->filter[2] == .5);
	mtl_notes_finish(&notes);
}

static void statements(void **state)
{
	static char text[] = "newmtl a\nKs 0.25 0.5 1\n  Ns 12\nillum 2\nmap_Bump -bm 0.5 a.png\nKd 1 1 1\n"
			     "newmtl b\nKs 0.5\nbump b.png\nmap_Ks x.png\nnorm n.png\n"
			     "newmtl c\nillum -7\nbump -bm\n";
	const struct file_bytes bytes = {(uint8_t *)text, sizeof text - 1};
	struct mtl_notes notes;
	mtl_notes_init(&notes);
	(void)state;
	assert_int_equal(mtl_notes_read(&notes, &import, "a.mtl", &bytes, NULL), STATUS_OK);
	const struct mtl_note *a = find(&notes, "a"), *b = find(&notes, "b"), *c = find(&notes, "c");
	assert_non_null(a);
	assert_true(a->specular[0] == 0.25 && a->specular[1] == 0.5 && a->specular[2] == 1);
	assert_true(a->exponent == 12 && a->illum == 2 && a->maps[MTL_BUMPS].bump == 0.5 && a->has_diffuse);
	assert_non_null(b);
	assert_true(b->specular[0] == 0.5 && b->specular[1] == 0.5 && b->specular[2] == 0.5);
	assert_true(b->illum == -1 && b->maps[MTL_NORMALS].bump == 1 && !b->has_diffuse);
	assert_non_null(c);
	assert_true(c->illum == -1 && !c->maps[MTL_BUMPS].file);
	assert_int_equal(info.ignored_count, 0);
	mtl_notes_finish(&notes);
}

static void normal_maps_are_told_from_heights(void **state)
{
	const uint32_t flat = 128u | 128u << 8 | 255u << 16, grey = 128u | 128u << 8 | 128u << 16, white = 0xFFFFFF;
	const uint32_t mixed[4] = {flat, 90u | 128u << 8 | 240u << 16, 160u | 100u << 8 | 240u << 16, flat};
	const struct texture_info one = {.width = 1, .height = 1}, four = {.width = 2, .height = 2};
	(void)state;
	assert_true(mtl_is_normal_map(&one, &flat));
	assert_true(mtl_is_normal_map(&four, mixed));
	assert_false(mtl_is_normal_map(&one, &grey));
	assert_false(mtl_is_normal_map(&one, &white));
}

// Four columns of grey: 0, 51, 102, 51 of 255, that is 0, 0.2, 0.4, 0.2.
static void heights_become_normals(void **state)
{
	static const uint32_t grey[4] = {0, 51, 102, 51};
	const struct texture_info wide = {.width = 4, .height = 2}, high = {.width = 1, .height = 4};
	uint32_t heights[8], *normals;
	(void)state;
	for (int i = 0; i < 8; i++)
		heights[i] = grey[i % 4] * 0x010101u;
	assert_int_equal(mtl_normals_of_heights(&wide, heights, &normals, NULL), STATUS_OK);
	const double rise = 0.2, x = rise / sqrt(rise * rise + 1), z = 1 / sqrt(rise * rise + 1);
	const uint32_t up = (uint32_t)lround(255 * (0.5 - x / 2)), down = (uint32_t)lround(255 * (0.5 + x / 2));
	const uint32_t out = (uint32_t)lround(255 * (0.5 + z / 2));
	assert_int_equal(normals[0], 128u | 128u << 8 | 255u << 16 | 255u << 24); // a valley
	assert_int_equal(normals[1], up | 128u << 8 | out << 16 | 255u << 24); // rises to the right: leans left
	assert_int_equal(normals[7], down | 128u << 8 | out << 16 | 255u << 24); // second row, falling
	free(normals);
	// The same along y, which points up: bright below dark leans up.
	const uint32_t column[4] = {0, 51u * 0x010101u, 102u * 0x010101u, 51u * 0x010101u};
	assert_int_equal(mtl_normals_of_heights(&high, column, &normals, NULL), STATUS_OK);
	assert_int_equal(normals[1], 128u | down << 8 | out << 16 | 255u << 24);
	free(normals);
}

// A slope of three of 65535 steps a texel, which 8 bits would flatten.
static void deep_heights_become_deep_normals(void **state)
{
	const struct texture_info deep = {.width = 4, .height = 1, .flags = TEXTURE_DEEP};
	uint32_t heights[8], *normals;
	(void)state;
	for (uint32_t i = 0; i < 4; i++) {
		const uint32_t h = 30000 + 3 * (i < 3 ? i : 1);
		heights[2 * i] = h | h << 16;
		heights[2 * i + 1] = h | 65535u << 16;
	}
	assert_int_equal(mtl_normals_of_heights(&deep, heights, &normals, NULL), STATUS_OK);
	const uint32_t lean = (uint32_t)lround(65535 * 0.5 - 1.5);
	assert_int_equal(normals[2], lean | 32768u << 16);
	assert_int_equal(normals[3], 65535u | 65535u << 16);
	free(normals);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(exponents),
	    cmocka_unit_test_setup(illumination_models, fresh),
	    cmocka_unit_test_setup(glass, fresh),
	    cmocka_unit_test_setup(priorities, fresh),
	    cmocka_unit_test_setup(physical_keys, fresh),
	    cmocka_unit_test_setup(dissolve, fresh),
	    cmocka_unit_test_setup(statements, fresh),
	    cmocka_unit_test(normal_maps_are_told_from_heights),
	    cmocka_unit_test(heights_become_normals),
	    cmocka_unit_test(deep_heights_become_deep_normals),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
