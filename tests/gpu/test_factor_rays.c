// Form factors by rays against closed forms and integrals by other means; what must be zero, or one, to the bit; bits that
// depend on nothing but the scene.
#include "tests/gpu/factor_rows.h"

#include <stdio.h>

#include "server/base/angle.h"
#include "server/worker/devices.h"

#define SKIPPED 77
#define FACING 0.19982489569838 // unit squares, face to face at distance 1
#define BESIDE 0.20004377607540 // unit squares with an edge in common, at 90 degrees

static struct device *device;
static struct mesh m;
static const double axis[3] = {0.26726124191242440, 0.53452248382484880, 0.80178372573727310};

static void facing_squares(double gap)
{
	start(&m);
	add_quad(&m, (const double[3]){0, 0, 0}, (const double[3]){1, 0, 0}, (const double[3]){0, 1, 0}, 0);
	add_quad(&m, (const double[3]){0, 0, gap}, (const double[3]){0, 1, 0}, (const double[3]){1, 0, 0}, 0);
}

static void check_factor(const struct factor_rows *f, uint32_t i, uint32_t j, double should, uint32_t rays)
{
	const double is = factor(f, i, j);
	if (!(fabs(is - should) <= standard_error(should, rays)))
		fail_msg("F is %.9g, not %.9g: %.2g, and the standard error is %.2g", is, should, is - should,
			 standard_error(should, rays));
}

// ---- closed forms -----------------------------------------------------------------------------------------------------

static void squares_have_their_closed_forms(void **state)
{
	static const uint32_t counts[] = {3072, 40000, 262144};
	(void)state;
	for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
		struct traced_mesh t;
		const struct rays_options o = {.rays = counts[k]};
		facing_squares(1);
		add_quad(&m, (const double[3]){5, 0, 0}, (const double[3]){1, 0, 0}, (const double[3]){0, 1, 0}, 0);
		add_quad(&m, (const double[3]){5, 0, 0}, (const double[3]){0, 1, 0}, (const double[3]){0, 0, 1}, 0);
		traced_mesh_init(&t, device, &m, INFINITY);
		assert_int_equal(t.elements.count, 8);
		struct factor_rows f = factor_rows_of(&t, &o, 8);
		check_factor(&f, 0, 1, FACING, o.rays);
		check_factor(&f, 1, 0, FACING, o.rays);
		check_factor(&f, 2, 3, BESIDE, o.rays);
		check_factor(&f, 3, 2, BESIDE, o.rays);
		factor_rows_finish(&f);
		traced_mesh_finish(&t);
	}
}

static void sizes_do_not_matter(void **state)
{
	static const double scales[] = {1e-3, 1, 1e6};
	double first = 0;
	(void)state;
	for (size_t k = 0; k < sizeof scales / sizeof *scales; k++) {
		struct traced_mesh t;
		const struct rays_options o = {.rays = 12288};
		facing_squares(1);
		mesh_place(&m, axis, 0.7, scales[k], 0.3 * scales[k]);
		traced_mesh_init(&t, device, &m, INFINITY);
		struct factor_rows f = factor_rows_of(&t, &o, 4);
		check_factor(&f, 0, 1, FACING, o.rays);
		first = k == 0 ? factor(&f, 0, 1) : first;
		assert_true(fabs(factor(&f, 0, 1) - first) <= 3.0 / o.rays);
		factor_rows_finish(&f);
		traced_mesh_finish(&t);
	}
}

// Patches of a cut square: their mean by area is the whole square's factor, and each is what the contour integral says.
static void patches_have_what_analysis_says(void **state)
{
	struct traced_mesh t;
	const struct rays_options o = {.rays = 8192};
	uint32_t beyond = 0, pairs = 0;
	(void)state;
	start(&m);
	add_quad(&m, (const double[3]){0, 0, 0}, (const double[3]){1, 0, 0}, (const double[3]){0.2, 1, 0}, 0);
	add(&m, (const double[3]){0, 0, 0.5}, (const double[3]){0.3, 1, 0.6}, (const double[3]){1, 0, 0.7}, 0);
	traced_mesh_init(&t, device, &m, 0.4);
	struct factor_rows f = factor_rows_of(&t, &o, 16);
	const uint32_t patches = t.elements.patches.count;
	for (uint32_t i = 0; i < patches; i++)
		for (uint32_t j = 0; j < patches; j++) {
			struct patch p, q;
			double error;
			patches_get(&t.elements.patches, i, &p);
			patches_get(&t.elements.patches, j, &q);
			const double should = form_factor_exchange(&p.shape, &q.shape, 1e-9, &error) / p.area;
			const double is = factor(&f, i, j);
			pairs += should > 0;
			beyond += fabs(is - should) > standard_error(should, o.rays) + 0.5 / o.rays;
			assert_true(fabs(is - should) <= 4 * standard_error(should, o.rays) + 1.0 / o.rays);
		}
	assert_true(pairs > 100 && beyond <= pairs / 20);
	factor_rows_finish(&f);
	traced_mesh_finish(&t);
}

// The squares' factor past a screen half-way that reaches to `open`. A line from x1 to x2 passes it where x1 + x2 > 2 open.
static double past_screen(double open)
{
	const int n = 2000;
	double sum = 0;
	for (int i = 0; i < n; i++) {
		const double x = -1 + (2 * i + 1.0) / n; // x2 - x1
		const double low = fmax(fmax(0, -x), open - x / 2), high = fmin(1, 1 - x);
		double inner = 0;
		for (int k = 0; k < n; k++) {
			const double y = (k + 0.5) / n, r2 = 1 + x * x + y * y;
			inner += 2 * (1 - y) / (PI * r2 * r2) / n;
		}
		sum += fmax(high - low, 0) * inner * 2 / n;
	}
	return sum;
}

static void a_screen_hides_what_is_behind_it(void **state)
{
	static const double opens[] = {0.5, 0.3, 0.8};
	(void)state;
	assert_true(fabs(past_screen(0) - FACING) < 1e-6);
	for (size_t k = 0; k < sizeof opens / sizeof *opens; k++) {
		struct traced_mesh t;
		const struct rays_options o = {.rays = 16384};
		facing_squares(1);
		add_quad(&m, (const double[3]){-9, -9, 0.5}, (const double[3]){9 + opens[k], 0, 0},
			 (const double[3]){0, 19, 0}, 0);
		traced_mesh_init(&t, device, &m, INFINITY);
		struct factor_rows f = factor_rows_of(&t, &o, 6);
		check_factor(&f, 0, 1, past_screen(opens[k]), o.rays);
		check_factor(&f, 1, 0, past_screen(opens[k]), o.rays);
		factor_rows_finish(&f);
		traced_mesh_finish(&t);
	}
}

// A screen that is not there by its mask hides nothing; one that is blended hides its alpha, and lets through the same rays
// whatever the traversal.
static void a_screen_may_be_let_through(void **state)
{
	static const struct {
		uint32_t flags;
		float cutoff, alpha;
		double through;
	} screens[] = {
	    {MATERIAL_ALPHA_MASK, 2, 1, 1}, {MATERIAL_ALPHA_MASK, .5f, 1, 0}, {MATERIAL_ALPHA_BLEND, 0, .25f, .75}};
	const uint32_t effects = 1u << candil_Effect_EFFECT_ALPHA_MASK | 1u << candil_Effect_EFFECT_ALPHA_BLEND;
	(void)state;
	for (size_t k = 0; k < sizeof screens / sizeof *screens; k++) {
		struct traced_mesh t;
		struct rays_options o = {.rays = 16384};
		facing_squares(1);
		add_quad(&m, (const double[3]){-9, -9, 0.5}, (const double[3]){19, 0, 0}, (const double[3]){0, 19, 0}, 1);
		traced_mesh_init(&t, device, &m, INFINITY);
		t.materials[1].flags = screens[k].flags;
		t.materials[1].alpha_cutoff = screens[k].cutoff;
		t.materials[1].alpha = screens[k].alpha;
		struct factor_rows f = factor_rows_with(&t, &o, 6, effects);
		check_factor(&f, 0, 1, FACING * screens[k].through, o.rays);
		o.traversal = TRACE_SINGLE;
		struct factor_rows single = factor_rows_with(&t, &o, 1, effects);
		assert_memory_equal(f.counts, single.counts, (size_t)f.side * f.side * sizeof *f.counts);
		factor_rows_finish(&f);
		factor_rows_finish(&single);
		traced_mesh_finish(&t);
	}
}

// From the barycentre: what a point sees.
static void cells_from_the_barycentre_have_a_points_factor(void **state)
{
	struct traced_mesh t;
	const struct rays_options o = {.rays = 16384, .barycentre = true};
	(void)state;
	facing_squares(0.5);
	traced_mesh_init(&t, device, &m, INFINITY);
	struct patch q;
	patches_get(&t.elements.patches, 1, &q);
	const double should = form_factor_at((const double[3]){0.5, 0.5, 0}, (const double[3]){0, 0, 1}, &q.shape);
	struct factor_rows f = factor_rows_of(&t, &o, 4);
	check_factor(&f, 0, 1, should, o.rays);
	factor_rows_finish(&f);
	traced_mesh_finish(&t);
}

// ---- exactly ----------------------------------------------------------------------------------------------------------

static const double turns[] = {0, 0.7};
static const double shifts[] = {0, 3, 1000};

static void room(struct traced_mesh *t, double angle, double scale, double shift)
{
	start(&m);
	add_box(&m, (const double[3]){0, 0, 0}, (const double[3]){1, 1, 1}, 0, 0);
	mesh_place(&m, axis, angle, scale, shift * scale);
	traced_mesh_init(t, device, &m, 0.26 * scale);
}

// The box's faces look outwards: inside are the backs.
static void nothing_leaves_a_closed_room(void **state)
{
	static const double scales[] = {1e-3, 1, 1e6};
	(void)state;
	for (size_t k = 0; k < 18; k++) {
		struct traced_mesh t;
		const struct rays_options o = {.rays = 3072};
		room(&t, turns[k % 2], scales[k / 2 % 3], shifts[k / 6]);
		const uint32_t patches = t.elements.patches.count;
		assert_int_equal(patches, 96);
		struct factor_rows f = factor_rows_of(&t, &o, 64);
		for (uint32_t i = 0; i < 2 * patches; i++) {
			uint64_t inside = 0, outside = 0;
			for (uint32_t j = 0; j < patches; j++) {
				const uint32_t *row = f.counts + (size_t)i * f.side;
				outside += row[j];
				inside += row[j + patches];
				if (t.elements.shapes[j].face == t.elements.shapes[i % patches].face)
					assert_int_equal(row[j] + row[j + patches], 0);
			}
			assert_int_equal(outside, 0);
			assert_int_equal(inside, i < patches ? 0 : o.rays);
			assert_true(f.lost[i].element == i && f.lost[i].cut == 0);
			assert_true(f.lost[i].escaped == (i < patches ? 1.0f : 0.0f));
		}
		factor_rows_finish(&f);
		traced_mesh_finish(&t);
	}
}

static void bits_are_those_of_any_batch_and_traversal(void **state)
{
	struct traced_mesh t;
	struct rays_options o = {.rays = 1000, .traversal = TRACE_SINGLE};
	(void)state;
	cornell_box(&m);
	traced_mesh_init(&t, device, &m, 0.2);
	struct factor_rows all = factor_rows_of(&t, &o, t.elements.count);
	for (int k = 0; k < 3; k++) {
		o.traversal = k == 0 ? TRACE_SINGLE : TRACE_PACKET;
		struct factor_rows f = factor_rows_of(&t, &o, k == 2 ? t.elements.count : 7);
		assert_memory_equal(f.counts, all.counts, (size_t)f.side * f.side * sizeof *f.counts);
		assert_memory_equal(f.lost, all.lost, f.side * sizeof *f.lost);
		factor_rows_finish(&f);
	}
	factor_rows_finish(&all);
	traced_mesh_finish(&t);
}

// What is put into the matrix is what the dense rows were.
static void rows_are_put_whole(void **state)
{
	struct traced_mesh t;
	const struct rays_options o = {.rays = 500};
	const struct plan plan = {0};
	struct factors f;
	struct rays *rays;
	struct error err;
	(void)state;
	cornell_box(&m);
	traced_mesh_init(&t, device, &m, 0.4);
	struct factor_rows dense = factor_rows_of(&t, &o, 64);
	assert_int_equal(factors_init(&f, device, dense.side, &err), STATUS_OK);
	assert_int_equal(rays_create(device, &t.scene, &plan, &t.elements, &t.buffers, &o, &rays, &err), STATUS_OK);
	for (uint32_t i = 0; i < dense.side; i++)
		assert_int_equal(rays_rows(rays, (const uint32_t[]){dense.side - 1 - i}, 1, &f, &err), STATUS_OK);
	for (uint32_t i = 0; i < dense.side; i++) {
		uint32_t *columns, k = 0;
		float *values;
		assert_int_equal(factors_read_row(&f, i, &columns, &values, &err), STATUS_OK);
		for (uint32_t j = 0; j < dense.side; j++) {
			const double should = factor(&dense, i, j);
			if (should == 0)
				continue;
			assert_true(k < f.rows[i].count && columns[k] == j);
			assert_true(fabs((double)values[k++] / should - 1) < 1e-6);
		}
		assert_int_equal(k, f.rows[i].count);
		assert_true(f.rows[i].escaped == dense.lost[i].escaped);
		free(columns);
		free(values);
	}
	rays_destroy(rays);
	factors_finish(&f);
	factor_rows_finish(&dense);
	traced_mesh_finish(&t);
}

// Near the budget a batch has fewer rows, beyond it there are none at all.
static void batches_keep_to_the_budget(void **state)
{
	struct traced_mesh t;
	const struct rays_options o = {.rays = 64};
	const struct plan plan = {0};
	const uint64_t budget = device->budget;
	struct rays *rays;
	struct error err;
	(void)state;
	cornell_box(&m);
	traced_mesh_init(&t, device, &m, 0.04);
	const uint64_t row = t.elements.count * sizeof(uint32_t);
	assert_int_equal(resident_upload(&t.scene, device, TRACE_BINDINGS, &err), STATUS_OK);
	device->budget = device->bytes + 64 * row;
	assert_int_equal(rays_create(device, &t.scene, &plan, &t.elements, &t.buffers, &o, &rays, &err), STATUS_OK);
	assert_true(rays_batch(rays, 1e9) <= 32 && device->bytes <= device->budget);
	rays_destroy(rays);
	device->budget = device->bytes;
	assert_int_equal(rays_create(device, &t.scene, &plan, &t.elements, &t.buffers, &o, &rays, &err), STATUS_MEMORY);
	assert_null(rays);
	device->budget = budget;
	traced_mesh_finish(&t);
}

static void options_are_checked(void **state)
{
	static const struct rays_options bad[] = {
	    {.rays = 0}, {.rays = RAY_TABLE_MOST + 1}, {.rays = 1, .mirrors = true, .bounces = RAYS_BOUNCES_MOST + 1}};
	struct traced_mesh t;
	struct rays *rays;
	struct error err;
	(void)state;
	facing_squares(1);
	traced_mesh_init(&t, device, &m, INFINITY);
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		assert_int_equal(
		    rays_create(device, &t.scene, &(const struct plan){0}, &t.elements, &t.buffers, &bad[i], &rays, &err),
		    STATUS_BAD_ARGUMENT);
		assert_null(rays);
	}
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
	const struct CMUnitTest tests[] = {cmocka_unit_test(squares_have_their_closed_forms),
					   cmocka_unit_test(sizes_do_not_matter),
					   cmocka_unit_test(patches_have_what_analysis_says),
					   cmocka_unit_test(a_screen_hides_what_is_behind_it),
					   cmocka_unit_test(a_screen_may_be_let_through),
					   cmocka_unit_test(cells_from_the_barycentre_have_a_points_factor),
					   cmocka_unit_test(nothing_leaves_a_closed_room),
					   cmocka_unit_test(bits_are_those_of_any_batch_and_traversal),
					   cmocka_unit_test(rows_are_put_whole),
					   cmocka_unit_test(batches_keep_to_the_budget),
					   cmocka_unit_test(options_are_checked)};
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	devices_finish(&(struct devices){.vk = device});
	return failed;
}
