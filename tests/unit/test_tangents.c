// Tangents that the loader makes: along u, the bitangent up in the map, averaged where corners agree and only there.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/loader/geometry.h"

static candil_SceneInfo info;
static struct import import;
static struct geometry g;

// A material with a normal map by plain coordinates, and a plain one.
static int fresh(void **state)
{
	const uint32_t texel = 0xFFFF8080u;
	const struct import_sampling sampling = import_plain_sampling(0);
	struct material mapped = import_plain_material(0.5f);
	(void)state;
	memset(&info, 0, sizeof info);
	import_init(&import, NULL, &info);
	assert_int_equal(
	    import_derived_texture(&import, "map", &texel, 1, 1, false, &sampling, &mapped.normal_texture, NULL), STATUS_OK);
	assert_int_equal(import_add_material(&import, &mapped, "mapped", NULL), STATUS_OK);
	mapped.normal_texture = NONE;
	assert_int_equal(import_add_material(&import, &mapped, "plain", NULL), STATUS_OK);
	return 0;
}

static int finish(void **state)
{
	(void)state;
	geometry_finish(&g);
	import_finish(&import);
	return 0;
}

static uint32_t corner(double x, double y, double z, float u, float v, float normal_z)
{
	const struct import_vertex vertex = {.position = {x, y, z}, .normal = {0, 0, normal_z}, .uv = {u, v}};
	assert_int_equal(import_add_vertex(&import, &vertex, NULL), STATUS_OK);
	return (uint32_t)import.vertex_count - 1;
}

static void face(uint32_t a, uint32_t b, uint32_t c, uint32_t material)
{
	const struct triangle t = {{a, b, c}, material};
	assert_int_equal(import_add_triangle(&import, &t, NULL), STATUS_OK);
}

static void build(void)
{
	assert_int_equal(geometry_build(&import, &g, NULL), STATUS_OK);
}

static void assert_tangent(uint32_t triangle, uint32_t k, double x, double y, double z, double sign)
{
	const float *t = g.tangents[g.triangles[triangle].vertex[k]].xyzw;
	if (!(fabs(t[0] - x) < 1e-6 && fabs(t[1] - y) < 1e-6 && fabs(t[2] - z) < 1e-6 && t[3] == (float)sign))
		fail_msg("%g %g %g %g instead of %g %g %g %g", t[0], t[1], t[2], t[3], x, y, z, sign);
}

// A quad in z = 0 that faces +z, uv (0, 0) at its upper left.
static void add_quad(bool mirrored, float normal_z, uint32_t material)
{
	const float left = mirrored ? 1 : 0, right = mirrored ? 0 : 1;
	const uint32_t a = corner(-1, -1, 0, left, 1, normal_z);
	corner(1, -1, 0, right, 1, normal_z);
	corner(1, 1, 0, right, 0, normal_z);
	corner(-1, 1, 0, left, 0, normal_z);
	face(a, a + 1, a + 2, material);
	face(a, a + 2, a + 3, material);
}

static void assert_all(double x, double y, double z, double sign)
{
	for (uint32_t i = 0; i < g.triangle_count; i++)
		for (uint32_t k = 0; k < 3; k++)
			assert_tangent(i, k, x, y, z, sign);
}

static void a_quad(void **state)
{
	(void)state;
	add_quad(false, 1, 0);
	build();
	assert_int_equal(g.vertex_count, 4);
	assert_all(1, 0, 0, 1); // cross(z, x) = y: up in the map
}

static void a_mirrored_quad(void **state)
{
	(void)state;
	add_quad(true, 1, 0);
	build();
	assert_int_equal(g.vertex_count, 4);
	assert_all(-1, 0, 0, -1); // cross(z, -x) = -y, so -1 times it is up again
}

static void a_flat_quad_takes_its_own_normal(void **state)
{
	(void)state;
	add_quad(false, 0, 0);
	build();
	assert_all(1, 0, 0, 1);
}

static void a_normal_that_looks_away(void **state)
{
	(void)state;
	add_quad(false, -1, 0);
	build();
	assert_all(1, 0, 0, -1); // cross(-z, x) = -y
}

static void a_transform_turns_it(void **state)
{
	(void)state;
	add_quad(false, 1, 0);
	import.textures[0].row_u[0] = 0; // u' = v, v' = -u
	import.textures[0].row_u[1] = 1;
	import.textures[0].row_v[0] = -1;
	import.textures[0].row_v[1] = 0;
	build();
	assert_all(0, -1, 0, 1);
}

static void the_second_coordinates(void **state)
{
	(void)state;
	add_quad(false, 1, 0);
	import.textures[0].flags = TEXTURE_UV1;
	const size_t count = import.vertex_count;
	for (size_t i = 0; i < count; i++) {
		struct import_extra extra = {.color = {1, 1, 1, 1}};
		extra.uv1[0] = -import.vertices[i].uv[0];
		extra.uv1[1] = import.vertices[i].uv[1];
		import.vertex_count = i + 1; // an extra is of the vertex added last
		assert_int_equal(import_set_extra(&import, &extra, NULL), STATUS_OK);
	}
	build();
	assert_non_null(g.uv1);
	assert_null(g.colors);
	assert_all(-1, 0, 0, -1);
}

// u falls again right of x = 0: vertices on that line are shared, their tangents may not be.
static void handedness_is_kept_apart(void **state)
{
	(void)state;
	const uint32_t a = corner(-1, 0, 0, 0, 1, 1);
	corner(0, 0, 0, 1, 1, 1);
	corner(0, 1, 0, 1, 0, 1);
	corner(1, 0, 0, 0, 1, 1);
	face(a, a + 1, a + 2, 0);
	face(a + 1, a + 3, a + 2, 0);
	build();
	assert_int_equal(g.vertex_count, 6);
	for (uint32_t k = 0; k < 3; k++) {
		assert_tangent(0, k, 1, 0, 0, 1);
		assert_tangent(1, k, -1, 0, 0, -1);
	}
	for (uint32_t k = 0; k < 3; k++)
		assert_true(g.vertices[g.triangles[1].vertex[k]].position[0] >= 0);
}

// Two triangles that agree at one corner, their u turned by 90 degrees; each has an angle of 45 degrees there.
static void corners_that_agree_are_averaged(void **state)
{
	(void)state;
	for (int copies = 0; copies < 2; copies++) {
		finish(NULL);
		fresh(NULL);
		const uint32_t a = corner(0, 0, 0, 0, 0, 1);
		corner(1, 0, 0, 1, 0, 1);
		corner(1, 1, 0, 1, -1, 1); // u along +x
		const uint32_t d = copies ? corner(0, 0, 0, 0, 0, 1) : a;
		const uint32_t e = corner(-1, 0, 0, 0, -1, 1);
		corner(-1, -1, 0, -1, -1, 1); // u along +y
		face(a, a + 1, a + 2, 0);
		face(d, e, e + 1, 0);
		build();
		const double half = sqrt(0.5);
		assert_int_equal(g.vertex_count, copies ? 6 : 5);
		assert_tangent(0, 0, half, half, 0, 1);
		assert_tangent(1, 0, half, half, 0, 1);
		assert_tangent(0, 1, 1, 0, 0, 1);
		assert_tangent(1, 1, 0, 1, 0, 1);
	}
}

static void without_area_in_the_map(void **state)
{
	(void)state;
	const uint32_t a = corner(-1, -1, 0, .5f, .5f, 1);
	corner(1, -1, 0, .5f, .5f, 1);
	corner(1, 1, 0, .5f, .5f, 1);
	face(a, a + 1, a + 2, 0);
	const uint32_t b = corner(-1, -1, 1, 0, 0, 1);
	corner(1, -1, 1, .5f, .5f, 1);
	corner(1, 1, 1, 1, 1, 1); // a line
	face(b, b + 1, b + 2, 0);
	build();
	assert_int_equal(g.triangle_count, 2);
	assert_all(0, 0, 0, 0);
}

static void tangents_of_the_file_stay(void **state)
{
	struct import_extra extra = {.color = {1, 1, 1, 1}, .tangent = {0, 3, 0, -1}};
	(void)state;
	add_quad(false, 1, 0); // its last vertex gets one
	assert_int_equal(import_set_extra(&import, &extra, NULL), STATUS_OK);
	build();
	assert_tangent(1, 2, 0, 1, 0, -1);
	assert_tangent(1, 0, 1, 0, 0, 1);
	finish(NULL);
	fresh(NULL);
	add_quad(false, 0, 0); // a flat surface: the file's do not count
	assert_int_equal(import_set_extra(&import, &extra, NULL), STATUS_OK);
	build();
	assert_all(1, 0, 0, 1);
}

static void no_map_no_tangents(void **state)
{
	(void)state;
	add_quad(false, 1, 1);
	build();
	assert_null(g.tangents);
	assert_null(g.uv1);
}

static void wild_coordinates(void **state)
{
	(void)state;
	const uint32_t a = corner(0, 0, 0, -3e38f, 3e38f, 1);
	corner(1, 0, 0, 3e38f, -3e38f, 1);
	corner(0, 1, 0, 3e38f, 3e38f, 1);
	face(a, a + 1, a + 2, 0);
	import.textures[0].row_u[0] = import.textures[0].row_v[1] = 3e38f;
	build();
	for (uint32_t i = 0; i < g.vertex_count; i++)
		for (int c = 0; c < 4; c++)
			assert_true(isfinite(g.tangents[i].xyzw[c]));
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fresh, finish)

int main(void)
{
	const struct CMUnitTest tests[] = {
	    TEST(a_quad),
	    TEST(a_mirrored_quad),
	    TEST(a_flat_quad_takes_its_own_normal),
	    TEST(a_normal_that_looks_away),
	    TEST(a_transform_turns_it),
	    TEST(the_second_coordinates),
	    TEST(handedness_is_kept_apart),
	    TEST(corners_that_agree_are_averaged),
	    TEST(without_area_in_the_map),
	    TEST(tangents_of_the_file_stay),
	    TEST(no_map_no_tangents),
	    TEST(wild_coordinates),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
