// The faces of a scene: quads are found whatever the order of triangles, and nothing else is merged.
#include "tests/unit/patch_mesh.h"

#include "server/base/angle.h"
#include "server/worker/technique/radiosity/patch_faces.h"

static uint32_t faces_of(const struct mesh *m, uint32_t *quads)
{
	struct patch_faces f;
	assert_int_equal(patch_faces_init(&f, &m->view, NULL), STATUS_OK);
	*quads = 0;
	for (uint32_t i = 0; i < f.count; i++)
		*quads += f.list[i].triangle[1] != NONE;
	const uint32_t count = f.count;
	patch_faces_finish(&f);
	return count;
}

static void a_cornell_box_is_all_quads_in_any_order(void **state)
{
	static struct mesh m;
	uint32_t quads;
	(void)state;
	cornell_box(&m);
	for (int i = 0; i < 20; i++) {
		shuffle(&m);
		assert_int_equal(faces_of(&m, &quads), 18);
		assert_int_equal(quads, 18);
	}
}

static void quads_are_found_where_floats_are_coarse(void **state)
{
	static struct mesh m;
	uint32_t quads;
	(void)state;
	start(&m);
	for (int i = 0; i < 400; i++) {
		double at[3], u[3], v[3];
		for (int k = 0; k < 3; k++) {
			at[k] = 6000 * noise(&m.seed) - 3000;
			u[k] = 2 * noise(&m.seed) - 1;
			v[k] = 2 * noise(&m.seed) - 1;
		}
		const double across =
		    (u[1] * v[2] - u[2] * v[1]) + (u[2] * v[0] - u[0] * v[2]) + (u[0] * v[1] - u[1] * v[0]);
		if (fabs(across) > 0.3)
			add_quad(&m, at, u, v, 0);
	}
	assert_in_range(m.count, 300, 800);
	assert_int_equal(faces_of(&m, &quads), m.count / 2);
	assert_int_equal(quads, m.count / 2);
}

// A flat mesh has many pairs that are parallelograms. Zeros have either sign.
static void a_flat_mesh_is_its_squares(void **state)
{
	static struct mesh m;
	struct patch_faces f;
	uint32_t quads;
	(void)state;
	start(&m);
	for (int i = 0; i < 400; i++)
		add_quad(&m, (const double[3]){i % 20, i & 1 ? 0.0 : -0.0, i / 20}, (const double[3]){0, 0, 1},
			 (const double[3]){1, 0, 0}, 0);
	shuffle(&m);
	assert_int_equal(faces_of(&m, &quads), 400);
	assert_int_equal(quads, 400);
	assert_int_equal(patch_faces_init(&f, &m.view, NULL), STATUS_OK);
	for (uint32_t i = 0; i < f.count; i++) {
		for (uint32_t k = 0; k < 4; k++) {
			const float *a = m.vertices[f.list[i].corner[k]].position,
				    *b = m.vertices[f.list[i].corner[(k + 1) % 4]].position;
			assert_true(fabsf(a[0] - b[0]) + fabsf(a[2] - b[2]) == 1);
		}
	}
	patch_faces_finish(&f);
}

static void what_is_no_flat_convex_quad_stays_two(void **state)
{
	// Four corners around, cut from the first to the third.
	static const double four[][4][3] = {
	    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.002}, {0, 1, 0}}, // bent
	    {{0, 0, 0}, {1, 0, 0}, {0.2, 0.2, 0}, {0, 1, 0}}, // an arrow's head
	    {{1, 1, 0}, {0, 1, 0}, {0, 0, 0}, {0.5, 0.5, 0}}, // the third triangle is none
	    {{1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 0}}, // a corner that is none
	    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 1}}, // a wedge
	};
	static struct mesh m;
	uint32_t quads;
	(void)state;
	for (size_t i = 0; i < sizeof four / sizeof *four; i++) {
		const double(*v)[3] = four[i];
		start(&m);
		add(&m, v[0], v[1], v[2], 0);
		add(&m, v[0], v[2], v[3], 0);
		faces_of(&m, &quads);
		assert_int_equal(quads, 0);
	}
	static const double square[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
	const double(*v)[3] = square;
	for (int kind = 0; kind < 4; kind++) {
		start(&m);
		add(&m, v[0], v[1], v[2], 0);
		if (kind == 0) // of another material
			add(&m, v[0], v[2], v[3], 1);
		if (kind == 1) // turned over
			add(&m, v[0], v[3], v[2], 0);
		if (kind == 2) // on top of it
			add(&m, v[0], v[1], v[2], 0);
		if (kind == 3) // its back
			add(&m, v[0], v[2], v[1], 0);
		assert_int_equal(faces_of(&m, &quads), 2);
		assert_int_equal(quads, 0);
	}
}

static void triangles_without_an_area_are_skipped(void **state)
{
	static const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {2, 0, 0}, d[3] = {0, 1, 0};
	static struct mesh m;
	struct patch_faces f;
	(void)state;
	start(&m);
	add(&m, a, b, c, 0);
	add(&m, a, a, a, 0);
	add(&m, a, b, d, 0);
	add(&m, b, b, d, 0);
	assert_int_equal(patch_faces_init(&f, &m.view, NULL), STATUS_OK);
	assert_int_equal(f.count, 1);
	assert_int_equal(f.skipped, 3);
	assert_int_equal(f.list[0].triangle[0], 2);
	patch_faces_finish(&f);
	start(&m);
	assert_int_equal(patch_faces_init(&f, &m.view, NULL), STATUS_OK);
	assert_int_equal(f.count, 0);
	patch_faces_finish(&f);
}

// A side that thousands of triangles have in common, as leaves of a book have: each looks at few others.
static void leaves_of_a_book_have_one_partner_at_most(void **state)
{
	static const double low[3] = {0, 0, 0}, high[3] = {0, 1, 0};
	static struct mesh m;
	uint32_t quads;
	(void)state;
	start(&m);
	for (uint32_t i = 0; i < MOST; i++) {
		const double angle = 2 * PI * i / MOST, out[3] = {cos(angle), 0.5, sin(angle)};
		add(&m, low, i % 2 ? high : out, i % 2 ? out : high, 0);
	}
	assert_int_equal(faces_of(&m, &quads) + quads, MOST);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_cornell_box_is_all_quads_in_any_order),
	    cmocka_unit_test(quads_are_found_where_floats_are_coarse),
	    cmocka_unit_test(a_flat_mesh_is_its_squares),
	    cmocka_unit_test(what_is_no_flat_convex_quad_stays_two),
	    cmocka_unit_test(triangles_without_an_area_are_skipped),
	    cmocka_unit_test(leaves_of_a_book_have_one_partner_at_most),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
