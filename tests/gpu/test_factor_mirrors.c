// Extended form factors by rays: mirrors against the image method, what the limit of bounces cuts, and where each weight
// went.
#include "tests/gpu/factor_rows.h"

#include <stdio.h>

#include "server/worker/devices.h"

#define SKIPPED 77
#define MIRROR 1u // material

static struct device *device;
static struct mesh m;
static const double axis[3] = {0.26726124191242440, 0.53452248382484880, 0.80178372573727310};

// The factor of two facing unit squares.
static double facing(double gap)
{
	const struct form_polygon a = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 4},
				  b = {{{0, 0, gap}, {0, 1, gap}, {1, 1, gap}, {1, 0, gap}}, 4};
	return exchange(&a, &b);
}

static void check_factor(const struct factor_rows *f, uint32_t i, uint32_t j, double should, uint32_t rays)
{
	const double is = factor(f, i, j), units = 2 / f->unit;
	if (!(fabs(is - should) <= standard_error(should, rays) + units))
		fail_msg("F is %.9g, not %.9g: %.2g, and the standard error is %.2g", is, should, is - should,
			 standard_error(should, rays));
}

// Two squares beside a wide mirror in the plane x = 0: one sees the other, and its image at -x.
static void a_mirror_shows_the_image(void **state)
{
	static const float mirrors[] = {0.8f, 1, 0.1f};
	(void)state;
	for (int turned = 0; turned < 2; turned++)
		for (size_t k = 0; k < sizeof mirrors / sizeof *mirrors; k++) {
			struct traced_mesh t;
			const struct rays_options o = {.rays = 40000, .mirrors = true, .bounces = 10};
			const double low = 0.2;
			start(&m);
			add_quad(&m, (const double[3]){low, 0, 0}, (const double[3]){1, 0, 0}, (const double[3]){0, 1, 0},
				 0);
			add_quad(&m, (const double[3]){low, 0, 1}, (const double[3]){0, 1, 0}, (const double[3]){1, 0, 0},
				 0);
			add_quad(&m, (const double[3]){0, -4, -4}, (const double[3]){0, 9, 0}, (const double[3]){0, 0, 9},
				 MIRROR);
			const struct form_polygon a = {{{low, 0, 0}, {low + 1, 0, 0}, {low + 1, 1, 0}, {low, 1, 0}}, 4};
			const struct form_polygon image = {{{-low, 0, 1}, {-low - 1, 0, 1}, {-low - 1, 1, 1}, {-low, 1, 1}},
							   4};
			const double shown = exchange(&a, &image);
			if (turned)
				mesh_place(&m, axis, 0.7, 3, 5);
			traced_mesh_init(&t, device, &m, INFINITY);
			traced_mesh_polish(&t, MIRROR, mirrors[k]);
			struct factor_rows f = factor_rows_of(&t, &o, 6);
			assert_true(shown > 0.02);
			check_factor(&f, 0, 1, facing(1) + (double)mirrors[k] * shown, o.rays);
			check_factor(&f, 1, 0, facing(1) + (double)mirrors[k] * shown, o.rays);
			factor_rows_finish(&f);
			traced_mesh_finish(&t);
		}
}

// A corridor between two mirrors that face each other, its walls absorb. Unfolded, a row of image squares one behind the
// other: the ray that meets the k-th was reflected k - 1 times.
static void mirrors_face_each_other(void **state)
{
	static const float mirror = 0.9f;
	(void)state;
	for (uint32_t bounces = 0; bounces < 12; bounces += bounces < 3 ? 1 : 4) {
		struct traced_mesh t;
		const struct rays_options o = {.rays = 40000, .mirrors = true, .bounces = bounces};
		start(&m);
		add_box(&m, (const double[3]){0, 0, 0}, (const double[3]){1, 1, 1}, 0, 0);
		for (uint32_t i = 0; i < m.count; i++) {
			const uint32_t *v = m.triangles[i].vertex;
			const float *p[3] = {m.vertices[v[0]].position, m.vertices[v[1]].position,
					     m.vertices[v[2]].position};
			m.triangles[i].material = p[0][0] == p[1][0] && p[1][0] == p[2][0] ? MIRROR : 0;
		}
		traced_mesh_init(&t, device, &m, INFINITY);
		traced_mesh_polish(&t, MIRROR, mirror);
		struct factor_rows f = factor_rows_of(&t, &o, 12);
		double own = 0, other = 0, left = 1;
		for (uint32_t k = 1; k <= bounces + 1; k++, left *= (double)mirror)
			*(k % 2 ? &other : &own) += left * facing(k);
		for (uint32_t i = 0; i < 6; i++) {
			struct patch p;
			patches_get(&t.elements.patches, i, &p);
			if (p.material != MIRROR)
				continue;
			double sum = (double)f.lost[i + 6].cut, cut = left * facing(bounces + 1);
			for (uint32_t j = 0; j < 6; j++) {
				struct patch q;
				patches_get(&t.elements.patches, j, &q);
				const bool polished = q.material == MIRROR;
				sum += factor(&f, i + 6, j + 6) * (polished ? 1 - (double)mirror : 1);
				if (polished)
					check_factor(&f, i + 6, j + 6, i == j ? own : other, o.rays);
			}
			assert_true(f.lost[i + 6].escaped == 0);
			assert_true(fabs((double)f.lost[i + 6].cut - cut) <= standard_error(cut, o.rays) + 2 / f.unit);
			assert_true(fabs(sum - 1) <= 0.5 * (bounces + 1) * o.rays / f.unit + 1e-6);
		}
		factor_rows_finish(&f);
		traced_mesh_finish(&t);
	}
}

// Without a polished element the code for mirrors changes nothing.
static void no_mirror_changes_nothing(void **state)
{
	struct traced_mesh t;
	struct rays_options o = {.rays = 1000};
	(void)state;
	cornell_box(&m);
	traced_mesh_init(&t, device, &m, 0.3);
	struct factor_rows plain = factor_rows_of(&t, &o, 64);
	o.mirrors = true;
	o.bounces = 10;
	struct factor_rows forced = factor_rows_of(&t, &o, 64);
	const double scale = forced.unit / plain.unit;
	assert_true(scale == floor(scale) && scale > 1000);
	for (size_t i = 0; i < (size_t)plain.side * plain.side; i++)
		assert_true(plain.counts[i] * scale == forced.counts[i]);
	assert_memory_equal(plain.lost, forced.lost, plain.side * sizeof *plain.lost);
	factor_rows_finish(&plain);
	factor_rows_finish(&forced);
	traced_mesh_finish(&t);
}

static void bits_are_those_of_any_batch_and_traversal(void **state)
{
	struct traced_mesh t;
	struct rays_options o = {.rays = 1000, .mirrors = true, .bounces = 10, .traversal = TRACE_SINGLE};
	(void)state;
	// No two surfaces coincide: at a distance of next to nothing, rounding chooses between such.
	start(&m);
	add_box(&m, (const double[3]){0, 0, 0}, (const double[3]){1, 1, 1}, 0, 0);
	add_box(&m, (const double[3]){0.2, 0.01, 0.3}, (const double[3]){0.3, 0.6, 0.3}, 0.3, 0);
	add_box(&m, (const double[3]){0.5, 0.01, 0.7}, (const double[3]){0.3, 0.3, 0.2}, -0.3, 1);
	traced_mesh_init(&t, device, &m, 0.3);
	traced_mesh_polish(&t, 0, 0.95f);
	struct factor_rows all = factor_rows_of(&t, &o, t.elements.count);
	o.traversal = TRACE_PACKET;
	for (uint32_t batch = 5; batch < 10; batch += 4) {
		struct factor_rows f = factor_rows_of(&t, &o, batch);
		assert_memory_equal(f.counts, all.counts, (size_t)f.side * f.side * sizeof *f.counts);
		assert_memory_equal(f.lost, all.lost, f.side * sizeof *f.lost);
		factor_rows_finish(&f);
	}
	factor_rows_finish(&all);
	traced_mesh_finish(&t);
}

int main(void)
{
	struct error err;
	const struct device_options options = {0};
	if (device_create(&options, &device, &err) != STATUS_OK) {
		printf("skipped: %s\n", err.text);
		return SKIPPED;
	}
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_mirror_shows_the_image), cmocka_unit_test(mirrors_face_each_other),
	    cmocka_unit_test(no_mirror_changes_nothing), cmocka_unit_test(bits_are_those_of_any_batch_and_traversal)};
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	devices_finish(&(struct devices){.vk = device});
	return failed;
}
