// Elements: a place within a patch is that patch's, whichever triangle of a face it is on and wherever that begins; the
// arrays for shaders say what the patches are.
#include "tests/unit/element_samples.h"

#include <stdlib.h>

static void made(const struct mesh *m, double edge, struct elements *e)
{
	assert_int_equal(elements_init(e, &m->view, &(struct patch_options){.edge = edge}, NULL), STATUS_OK);
	assert_int_equal(e->count, 2 * e->patches.count);
	assert_int_equal(e->triangle_count, m->count);
}

static void places_are_of_their_patches(void **state)
{
	static const double edges[] = {INFINITY, 0.3, 0.05};
	static struct mesh m;
	(void)state;
	for (uint32_t kind = 0; kind < ELEMENT_MESHES; kind++)
		for (size_t k = 0; k < sizeof edges / sizeof *edges; k++) {
			struct elements e;
			element_mesh(&m, kind);
			made(&m, edges[k], &e);
			assert_int_equal(e.patches.faces.count, ELEMENT_FACES);
			for (uint32_t i = 0; i < e.patches.count; i++)
				for (int n = 0; n < 10; n++) {
					const struct element_sample s = element_sample(&m, &e.patches, i, 1e-3);
					assert_int_equal(elements_at(&e, s.triangle, s.uv, true), i);
					assert_int_equal(elements_at(&e, s.triangle, s.uv, false), i + e.patches.count);
				}
			elements_finish(&e);
		}
}

// Every place has an element, on borders and beyond them by rounding too.
static void places_on_borders_have_an_element(void **state)
{
	static const double ends[] = {-1e-7, 0, 1e-12, 0.25, 1.0 / 3, 0.5, 1 - 1e-12, 1, 1 + 1e-7};
	static struct mesh m;
	struct elements e;
	(void)state;
	for (uint32_t kind = 0; kind < ELEMENT_MESHES; kind++) {
		element_mesh(&m, kind);
		made(&m, 0.1, &e);
		for (uint32_t t = 0; t < m.count; t++)
			for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
				for (size_t k = 0; k < sizeof ends / sizeof *ends; k++) {
					const double uv[2] = {ends[i], ends[k]};
					const uint32_t face = e.triangles[t] >> RADIOSITY_FACE_SHIFT;
					const uint32_t at = elements_at(&e, t, uv, true);
					assert_true(at < e.patches.count && e.shapes[at].face == face);
				}
		elements_finish(&e);
	}
}

static void shapes_are_those_of_patches(void **state)
{
	static struct mesh m;
	struct elements e;
	uint32_t shared = 0, quads = 0;
	(void)state;
	for (uint32_t kind = 0; kind < ELEMENT_MESHES; kind++) {
		element_mesh(&m, kind);
		made(&m, 0.1, &e);
		for (uint32_t i = 0; i < e.patches.count; i++) {
			const struct radiosity_patch *p = &e.shapes[i];
			struct patch patch;
			uint32_t on[2] = {0, 0};
			double area[2] = {0, 0};
			patches_get(&e.patches, i, &patch);
			for (uint32_t k = 0; k < 4; k++)
				for (int c = 0; c < 3; c++)
					assert_true((double)p->corner[3 * k + (uint32_t)c] ==
						    (double)(float)patch.shape.at[k < patch.shape.corners ? k : 2][c]);
			check_close("area", (double)p->area, patch.area, 1e-6);
			assert_int_equal(p->face, patch.face);
			// What the shares say: two triangles of floats have the patch's area.
			for (uint32_t k = 0; k < 2; k++) {
				double across[3];
				vec3_across(p->corner, p->corner + 3 * (k + 1), p->corner + 3 * (k + 2), across);
				area[k] = 0.5 * sqrt(vec3_dot(across, across));
			}
			assert_true(fabs(area[0] - (double)p->share * (area[0] + area[1])) < 1e-3 * patch.area);
			// Whose triangle it is: the only one, or the first of two.
			for (int n = 0; n < 40; n++)
				on[element_sample(&m, &e.patches, i, 1e-3).triangle != patch.triangle[0]]++;
			assert_true(p->triangle == patch.triangle[on[0] == 0] ||
				    (on[0] <= 2 && p->triangle == patch.triangle[0]));
			shared += on[0] && on[1];
			quads += patch.shape.corners == 4;
		}
		elements_finish(&e);
	}
	assert_true(quads > 1000 && shared > 100);
}

// A triangle without an area is in no element, and takes nothing from the others.
static void nothing_has_no_element(void **state)
{
	static const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {0, 1, 0}, third[2] = {1.0 / 3, 1.0 / 3};
	static struct mesh m;
	struct elements e;
	(void)state;
	start(&m);
	add(&m, a, b, b, 0);
	add(&m, a, b, c, 0);
	add(&m, a, a, a, 0);
	made(&m, INFINITY, &e);
	assert_int_equal(elements_at(&e, 0, third, true), NONE);
	assert_int_equal(elements_at(&e, 1, third, true), 0);
	assert_int_equal(elements_at(&e, 1, third, false), 1);
	assert_int_equal(elements_at(&e, 2, third, false), NONE);
	elements_finish(&e);
	m.view.counts[BLOB_TRIANGLES] = 0;
	assert_int_equal(elements_init(&e, &m.view, &(struct patch_options){.edge = 1}, NULL), STATUS_OK);
	assert_int_equal(e.count, 0);
	elements_finish(&e);
}

static void what_cannot_be_is_refused(void **state)
{
	static struct mesh m;
	struct elements e;
	(void)state;
	cornell_box(&m);
	assert_int_equal(elements_init(&e, &m.view, &(struct patch_options){.edge = 1e-30}, NULL), STATUS_LIMIT);
	assert_true(e.faces == NULL && e.triangles == NULL && e.shapes == NULL && e.count == 0);
	elements_finish(&e);
	assert_true(elements_bytes(UINT32_MAX, UINT32_MAX) > UINT32_MAX && elements_bytes(0, 0) < 64);
	assert_true(elements_bytes(0, 100) - elements_bytes(0, 0) == 100 * sizeof(struct radiosity_patch));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(places_are_of_their_patches), cmocka_unit_test(places_on_borders_have_an_element),
	    cmocka_unit_test(shapes_are_those_of_patches), cmocka_unit_test(nothing_has_no_element),
	    cmocka_unit_test(what_cannot_be_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
