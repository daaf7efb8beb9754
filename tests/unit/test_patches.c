// Patches: quads are found whatever the order of triangles, nothing else is merged; pieces fill their scene, are no larger
// than asked for and leave no crack; hostile sizes are refused.
#include "tests/unit/patch_mesh.h"

#include <stdio.h>
#include <stdlib.h>

#include "server/worker/technique/radiosity/patches.h"

static void cut_by(const struct mesh *m, double edge, struct patches *p)
{
	assert_int_equal(patches_init(p, &m->view, &(struct patch_options){.edge = edge}, NULL), STATUS_OK);
}

// Each patch is in order and no larger than asked for, and all together are the scene.
static void check_patches(const struct mesh *m, const struct patches *p, double edge)
{
	double area = 0;
	for (uint32_t i = 0; i < p->count; i++) {
		struct patch patch;
		patches_get(p, i, &patch);
		const struct form_polygon *s = &patch.shape;
		assert_true(s->corners == 3 || s->corners == 4);
		check_close("area", form_factor_area(s), patch.area, 1e-9);
		check_close("unit", vec3_dot(patch.normal, patch.normal), 1, 1e-12);
		assert_int_equal(patch.material, m->triangles[patch.triangle[0]].material);
		for (uint32_t k = 0; k < s->corners; k++) {
			const double *a = s->at[k], *b = s->at[(k + 1) % s->corners], *c = s->at[(k + 2) % s->corners];
			const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]},
				     v[3] = {c[0] - b[0], c[1] - b[1], c[2] - b[2]};
			double turn[3];
			vec3_cross(u, v, turn);
			assert_true(vec3_dot(turn, patch.normal) > 0);
			assert_true(distance(a, b) <= edge * (1 + 2e-6));
		}
		area += patch.area;
	}
	check_close("the scene", area, area_of(m), 1e-9);
}

static void pieces_fill_their_scene(void **state)
{
	static struct mesh m;
	static const double edges[] = {INFINITY, 0.5, 0.1, 0.03};
	uint32_t last = 0;
	(void)state;
	cornell_box(&m);
	shuffle(&m);
	for (size_t i = 0; i < sizeof edges / sizeof *edges; i++) {
		struct patches p;
		cut_by(&m, edges[i], &p);
		assert_true(i == 0 ? p.count == 18 : p.count > last);
		check_patches(&m, &p, edges[i]);
		last = p.count;
		patches_finish(&p);
	}
}

static void counts_are_those_of_grids(void **state)
{
	static const double o[3] = {0, 0, 0}, x[3] = {2, 0, 0}, y[3] = {0, 1, 0}, low[3] = {0, 0, -2};
	static const struct {
		double edge;
		uint32_t quad, triangle;
	} cases[] = {{INFINITY, 1, 1}, {1, 2, 9}, {0.5, 8, 25}, {0.3, 28, 64}, {0.1, 200, 529}, {2.5, 1, 1}};
	static struct mesh m;
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct patches p;
		start(&m);
		add_quad(&m, o, x, y, 0);
		add(&m, o, y, low, 1); // its longest side is √5
		cut_by(&m, cases[i].edge, &p);
		assert_int_equal(p.count, cases[i].quad + cases[i].triangle);
		check_patches(&m, &p, fmin(cases[i].edge, 3));
		patches_finish(&p);
	}
}

static void the_longer_side_decides(void **state)
{
	static const double v[4][3] = {{0, 0, 0}, {1, 0, 0}, {1.5, 1, 0}, {-0.5, 1, 0}};
	static struct mesh m;
	(void)state;
	for (uint32_t i = 0; i < 24; i++) {
		struct patches p;
		start(&m);
		m.seed = i;
		add(&m, v[i % 4], v[(i + 1) % 4], v[(i + 2) % 4], 0);
		add(&m, v[(i + 2) % 4], v[(i + 3) % 4], v[i % 4], 0);
		cut_by(&m, 0.5, &p);
		assert_int_equal(p.count, 4 * 3);
		check_patches(&m, &p, 0.5);
		patches_finish(&p);
	}
}

static void as_many_as_asked_for(void **state)
{
	static struct mesh m;
	(void)state;
	cornell_box(&m);
	for (uint32_t few = 1; few <= 18; few++) { // a face is at least one
		struct patches p;
		assert_int_equal(patches_init(&p, &m.view, &(struct patch_options){.count = few}, NULL), STATUS_OK);
		assert_int_equal(p.count, 18);
		patches_finish(&p);
	}
	for (uint32_t wanted = 18; wanted < 100000; wanted += 1 + wanted / 2) {
		struct patches p;
		assert_int_equal(patches_init(&p, &m.view, &(struct patch_options){.count = wanted}, NULL), STATUS_OK);
		assert_in_range(p.count, wanted < 100 ? 18 : wanted / 10 * 7, wanted);
		if (wanted < 10000)
			check_patches(&m, &p, p.edge);
		patches_finish(&p);
	}
}

// ---- cracks -----------------------------------------------------------------------------------------------------------

struct border {
	double from[3], to[3];
};

static int by_bits(const void *a, const void *b)
{
	return memcmp(a, b, sizeof(struct border));
}

// How many sides of patches have no other patch that runs along them the other way, corner by corner, to the bit.
static uint32_t open_sides(const struct patches *p)
{
	static struct border list[4 * MOST];
	uint32_t n = 0, open = 0;
	for (uint32_t i = 0; i < p->count; i++) {
		struct patch patch;
		patches_get(p, i, &patch);
		for (uint32_t k = 0; k < patch.shape.corners; k++, n++) {
			assert_true(n < 4 * MOST);
			for (int c = 0; c < 3; c++) {
				list[n].from[c] = patch.shape.at[k][c] + 0.0;
				list[n].to[c] = patch.shape.at[(k + 1) % patch.shape.corners][c] + 0.0;
			}
		}
	}
	qsort(list, n, sizeof *list, by_bits);
	for (uint32_t i = 0; i < n; i++) {
		struct border back;
		memcpy(back.from, list[i].to, sizeof back.from);
		memcpy(back.to, list[i].from, sizeof back.to);
		open += bsearch(&back, list, n, sizeof *list, by_bits) == NULL;
	}
	return open;
}

static void there_are_no_cracks(void **state)
{
	static const double a[3] = {0.1, 0.7, 0.3}, b[3] = {1.3, 0.1, -0.2}, c[3] = {0.4, 0.9, 2.1},
			    d[3] = {-0.5, 0.33, 0.8};
	static struct mesh m;
	struct patches p;
	(void)state;
	for (uint32_t n = 1; n < 12; n++) {
		start(&m);
		add_box(&m, (const double[3]){0.3, 2, -2}, (const double[3]){1, 1, 1}, 0.4, 0);
		cut_by(&m, 1.0 / n, &p);
		assert_int_equal(p.count, 6 * n * n);
		assert_int_equal(open_sides(&p), 0);
		patches_finish(&p);
		// One triangle: its sides are open, of n parts each, and what is within is not.
		start(&m);
		add(&m, a, b, c, 0);
		cut_by(&m, distance(a, b) > distance(b, c) ? distance(a, b) / n : fmax(distance(b, c), distance(a, c)) / n,
		       &p);
		assert_int_equal(p.count, n * n);
		assert_int_equal(open_sides(&p), 3 * n);
		patches_finish(&p);
		// A body of triangles that are not alike, in as many parts each.
		start(&m);
		add(&m, a, b, c, 0);
		add(&m, b, a, d, 0);
		add(&m, c, b, d, 0);
		add(&m, a, c, d, 0);
		cut_by(&m, INFINITY, &p);
		assert_int_equal(p.count, 4);
		for (uint32_t i = 0; i < 4; i++)
			p.cuts[i] = (struct patch_cut){i * n * n, n, 0};
		p.count = 4 * n * n;
		assert_int_equal(open_sides(&p), 0);
		patches_finish(&p);
	}
}

// A room's patches see each other and nothing else.
static void rows_of_a_room_are_1(void **state)
{
	static struct mesh m;
	struct patches p;
	(void)state;
	start(&m);
	add_box(&m, (const double[3]){0.3, 7, -2}, (const double[3]){1, 2, 1}, 0.4, 0);
	for (uint32_t i = 0; i < m.count; i++) { // seen from within
		const uint32_t first = m.triangles[i].vertex[0];
		m.triangles[i].vertex[0] = m.triangles[i].vertex[1];
		m.triangles[i].vertex[1] = first;
	}
	cut_by(&m, 0.6, &p);
	assert_int_equal(p.count, 4 * 8 + 2 * 4);
	for (uint32_t i = 0; i < p.count; i++) {
		struct patch from, to;
		double row = 0, error;
		patches_get(&p, i, &from);
		for (uint32_t k = 0; k < p.count; k++) {
			patches_get(&p, k, &to);
			row += form_factor_exchange(&from.shape, &to.shape, 1e-12 * from.area, &error);
		}
		check_close("row", row / from.area, 1, 1e-6);
	}
	patches_finish(&p);
}

// ---- hostile sizes ----------------------------------------------------------------------------------------------------

static void refuse(const struct mesh *m, struct patch_options options, enum status status, const char *says)
{
	struct patches p;
	struct error err;
	assert_int_equal(patches_init(&p, &m->view, &options, &err), status);
	assert_true(p.count == 0 && p.cuts == NULL && p.faces.list == NULL);
	if (!strstr(err.text, says))
		fail_msg("\"%s\" does not say \"%s\"", err.text, says);
}

static void what_cannot_be_is_refused_with_what_can(void **state)
{
	static struct mesh m;
	struct patches p;
	struct error err;
	double edge;
	(void)state;
	cornell_box(&m);
	refuse(&m, (struct patch_options){0}, STATUS_BAD_ARGUMENT, "needs");
	refuse(&m, (struct patch_options){.edge = -1}, STATUS_BAD_ARGUMENT, "no length");
	refuse(&m, (struct patch_options){.edge = NAN}, STATUS_BAD_ARGUMENT, "no length");
	refuse(&m, (struct patch_options){.count = PATCHES_MOST + 1}, STATUS_LIMIT, "1048576");
	refuse(&m, (struct patch_options){.edge = 1e-30}, STATUS_LIMIT, "1048576");
	refuse(&m, (struct patch_options){.edge = 5e-324}, STATUS_LIMIT, "1048576");
	assert_int_equal(patches_init(&p, &m.view, &(struct patch_options){.edge = 1e-3}, &err), STATUS_LIMIT);
	assert_int_equal(sscanf(strstr(err.text, "can be: "), "can be: %lf m would do", &edge), 1);
	cut_by(&m, edge, &p);
	assert_in_range(p.count, PATCHES_MOST / 10 * 9, PATCHES_MOST);
	patches_finish(&p);
	// More triangles than are ever looked at: these are not there.
	m.view.counts[BLOB_TRIANGLES] = 2 * PATCH_FACES_MOST + 1;
	refuse(&m, (struct patch_options){.edge = 1}, STATUS_SCENE_LIMIT, "triangles");
	assert_true(patches_bytes(UINT32_MAX) > UINT32_MAX && patches_bytes(0) < 64);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(pieces_fill_their_scene),
	    cmocka_unit_test(counts_are_those_of_grids),
	    cmocka_unit_test(the_longer_side_decides),
	    cmocka_unit_test(as_many_as_asked_for),
	    cmocka_unit_test(there_are_no_cracks),
	    cmocka_unit_test(rows_of_a_room_are_1),
	    cmocka_unit_test(what_cannot_be_is_refused_with_what_can),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
