// Extended form factors by hemicubes: mirrors against the image method, beside each other and facing each other, what the
// limit of bounces cuts, where each weight went, and all of it beside factors by rays.
#include "tests/gpu/hemicube_result.h"

#include <stdio.h>
#include <stdlib.h>

#include "server/base/angle.h"
#include "server/worker/technique/radiosity/rays.h"

#define MIRROR 1u // material

static struct patch_model model;
static struct radiosity_surface *surfaces;
static const double x[3] = {1, 0, 0}, y[3] = {0, 1, 0};

// Each test is done by portals and by rays.
static enum hemicube_mirrors ways[] = {HEMICUBE_MIRRORS_PORTAL, HEMICUBE_MIRRORS_HYBRID};

static enum hemicube_mirrors way_of(void **state)
{
	return *(const enum hemicube_mirrors *)*state;
}

// After the last triangle. Elements of the material MIRROR reflect this share.
static void close_polished(double edge, double share)
{
	model_close(&model, edge);
	const uint32_t n = model.elements.patches.count;
	surfaces = calloc(2 * (size_t)n, sizeof *surfaces);
	assert_non_null(surfaces);
	for (uint32_t i = 0; i < n; i++) {
		struct patch p;
		patches_get(&model.elements.patches, i, &p);
		for (int c = 0; c < 3; c++)
			surfaces[i].mirror[c] = surfaces[i + n].mirror[c] = p.material == MIRROR ? (float)share : 0;
	}
}

static void finish_polished(void)
{
	free(surfaces);
	model_finish(&model);
}

// As in test_hemicube.c: a random walk over the pixels on an outline.
static double outline_error(double length, uint32_t pixels, uint32_t origins)
{
	const double share = 4.0 / ((double)pixels * pixels * PI);
	return 4 * 0.29 * share * sqrt(0.5 * length * pixels * origins) / origins;
}

static void check(const char *what, double is, double should, double most)
{
	printf("%s: %.7f, should be %.7f: off by %.1e of %.1e\n", what, is, should, fabs(is - should), most);
	assert_true(fabs(is - should) <= most);
}

// What is absorbed, escaped or cut is all that an element sends.
static void check_whole(const struct hemicube_result *r, uint32_t row, double share)
{
	double sum = (double)r->escaped[row - r->first] + (double)r->cut[row - r->first];
	for (uint32_t j = 0; j < r->side; j++)
		sum += factor_at(r, row, j) * (surfaces[j].mirror[0] > 0 ? 1 - share : 1);
	assert_true(fabs(sum - 1) < 2e-5);
}

static void a_mirror_shows_the_image(void **state)
{
	static const double shares[] = {0.8, 1};
	for (size_t k = 0; k < sizeof shares / sizeof *shares; k++) {
		const struct hemicube_options options = {
		    .pixels = 64, .origins = 16, .mirrors = way_of(state), .bounces = 10};
		const double low = 0.2;
		model_start(&model);
		model_add_quad(&model, (const double[3]){low, 0, 0}, x, y, 0);
		model_add_quad(&model, (const double[3]){low, 0, 1}, y, x, 0);
		model_add_quad(&model, (const double[3]){0, -4, -4}, (const double[3]){0, 9, 0}, (const double[3]){0, 0, 9},
			       MIRROR);
		close_polished(100, shares[k]);
		const struct form_polygon image = {{{-low, 0, 1}, {-low - 1, 0, 1}, {-low - 1, 1, 1}, {-low, 1, 1}}, 4};
		struct hemicube_result r = hemicube_result_of(&model, surfaces, &options, 0, 6, 0);
		struct patch p;
		patches_get(&model.elements.patches, 1, &p);
		const double straight = mean_from_origins(&model, 0, 16, &p.shape, NULL);
		const double shown = mean_from_origins(&model, 0, 16, &image, NULL);
		assert_true(shown > 0.02);
		check("with its image", factor_at(&r, 0, 1), straight + shares[k] * shown, outline_error(16, 64, 16));
		// It sees its own image only edge-on.
		assert_true(factor_at(&r, 0, 0) == 0);
		for (uint32_t i = 0; i < 6; i++)
			check_whole(&r, i, shares[k]);
		hemicube_result_finish(&r);
		finish_polished();
	}
}

static void add_box(double side, uint32_t mirror_axis)
{
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < 2; k++) {
			double corner[3] = {0}, u[3] = {0}, v[3] = {0};
			corner[c] = k ? side : 0;
			u[(c + 1) % 3] = v[(c + 2) % 3] = side;
			model_add_quad(&model, corner, k ? v : u, k ? u : v, (uint32_t)c == mirror_axis ? MIRROR : 0);
		}
}

// A corridor between two mirrors that face each other. Unfolded, a row of image squares one behind the other: the light that
// meets the k-th was reflected k - 1 times.
static void mirrors_face_each_other(void **state)
{
	static const double share = 0.9;
	const uint32_t origins = 4;
	for (uint32_t bounces = 0; bounces <= 10; bounces += bounces < 1 ? 1 : 9) {
		const struct hemicube_options options = {
		    .pixels = 64, .origins = origins, .mirrors = way_of(state), .bounces = bounces};
		model_start(&model);
		add_box(1, 0);
		close_polished(2, share);
		struct hemicube_result r = hemicube_result_of(&model, surfaces, &options, 0, 6, 0);
		double own = 0, other = 0, left = 1, last = 0;
		for (uint32_t k = 1; k <= bounces + 1; k++, left *= share) {
			const struct form_polygon square = {{{k, 0, 0}, {k, 0, 1}, {k, 1, 1}, {k, 1, 0}}, 4};
			last = mean_from_origins(&model, 0, origins, &square, NULL);
			*(k % 2 ? &other : &own) += left * last;
		}
		const double most = outline_error(16, 64, origins);
		check("itself", factor_at(&r, 0, 0), own, most);
		check("the other mirror", factor_at(&r, 0, 1), other, most);
		check("cut", (double)r.cut[0], left * last, most);
		for (uint32_t i = 0; i < 6; i++) {
			check_whole(&r, i, share);
			assert_true(r.escaped[i] == 0);
		}
		hemicube_result_finish(&r);
		finish_polished();
	}
}

// A room with a mirror that leans, a second one behind it that is in two pieces, and a block.
static void add_room(void)
{
	model_start(&model);
	add_box(1, 3);
	model_add_quad(&model, (const double[3]){0.1, 0.3, 0.1}, (const double[3]){0, 0.5, 0},
		       (const double[3]){0.2, 0, 0.6}, MIRROR);
	model_add_quad(&model, (const double[3]){0.9, 0.2, 0.2}, (const double[3]){0, 0, 0.5}, (const double[3]){0, 0.3, 0},
		       MIRROR);
	model_add_quad(&model, (const double[3]){0.9, 0.6, 0.2}, (const double[3]){0, 0, 0.5}, (const double[3]){0, 0.3, 0},
		       MIRROR);
	model_add_quad(&model, (const double[3]){0.45, 0.45, 0.4}, (const double[3]){0.2, 0, 0},
		       (const double[3]){0, 0.2, 0.1}, 0);
}

static double *rows_by_rays(uint32_t count, uint32_t bounces, uint32_t number, double *cut)
{
	const struct plan plan = {0};
	const uint32_t side = model.elements.count;
	const struct rays_options options = {.rays = number, .mirrors = true, .bounces = bounces};
	double *f = calloc((size_t)count * side, sizeof *f);
	uint32_t *words = calloc((size_t)count * side, sizeof *words), *list = calloc(count, sizeof *list);
	struct rays *rays;
	struct error err = {0};
	assert_true(f && words && list);
	buffer_finish(&model.buffers.surfaces, device);
	assert_int_equal(buffer_init_with(&model.buffers.surfaces, device, surfaces, side * sizeof *surfaces, &err),
			 STATUS_OK);
	if (rays_create(device, &model.scene, &plan, &model.elements, &model.buffers, &options, &rays, &err) != STATUS_OK)
		fail_msg("%s", err.text);
	for (uint32_t i = 0; i < count; i++)
		list[i] = i;
	assert_int_equal(rays_trace(rays, list, count, &err), STATUS_OK);
	assert_int_equal(buffer_read(rays_dense(rays), device, 0, (uint64_t)count * side * sizeof *words, words, &err),
			 STATUS_OK);
	for (size_t i = 0; i < (size_t)count * side; i++)
		f[i] = words[i] / rays_unit(rays);
	for (uint32_t i = 0; i < count; i++)
		cut[i] = (double)rays_lost(rays)[i].cut;
	rays_destroy(rays);
	free(words);
	free(list);
	return f;
}

static void factors_are_those_of_rays(void **state)
{
	const uint32_t number = 65536, bounces = 4;
	const struct hemicube_options options = {.pixels = 32, .origins = 512, .mirrors = way_of(state), .bounces = bounces};
	add_room();
	close_polished(0.51, 0.8);
	const uint32_t n = 4; // rows: a wall's quarters
	double *cut = calloc(n, sizeof *cut), *f = rows_by_rays(n, bounces, number, cut), worst = 0;
	struct hemicube_result r = hemicube_result_of(&model, surfaces, &options, 0, n, 0);
	uint32_t within = 0, all = 0;
	for (uint32_t i = 0; i < n; i++) {
		check_whole(&r, i, 0.8);
		for (uint32_t j = 0; j < r.side; j++) {
			const double should = f[(size_t)i * r.side + j], off = fabs(factor_at(&r, i, j) - should);
			// Both are estimates. Points of a patch are off by their strata: 1 / 512, where what is
			// near changes much from point to point.
			const double most = sqrt(should * (1 - fmin(should, 1)) / number) + 2e-3 * should + 1e-4;
			within += off <= most;
			all++;
			worst = fmax(worst, off);
		}
	}
	printf("%u bounces: %u of %u factors within the standard error, the worst off by %.1e\n", bounces, within, all,
	       worst);
	assert_true(within >= 0.95 * all && worst < 2e-3);
	for (uint32_t i = 0; i < n; i++)
		assert_true(fabs(cut[i] - (double)r.cut[i]) < 2e-3);
	free(cut);
	free(f);
	hemicube_result_finish(&r);
	finish_polished();
}

static void batches_do_not_matter(void **state)
{
	const struct hemicube_options options = {.pixels = 32, .origins = 3, .mirrors = way_of(state), .bounces = 3};
	add_room();
	close_polished(0.51, 0.8);
	const uint32_t n = model.elements.patches.count;
	struct hemicube_result all = hemicube_result_of(&model, surfaces, &options, 0, n, 0);
	for (uint32_t batch = 1; batch < 10; batch = 5 * batch + 2) {
		struct hemicube_result r = hemicube_result_of(&model, surfaces, &options, 0, n, batch);
		assert_memory_equal(r.values, all.values, (size_t)n * r.side * sizeof *r.values);
		assert_memory_equal(r.escaped, all.escaped, n * sizeof *r.escaped);
		assert_memory_equal(r.cut, all.cut, n * sizeof *r.cut);
		hemicube_result_finish(&r);
	}
	hemicube_result_finish(&all);
	finish_polished();
}

static void no_mirror_changes_nothing(void **state)
{
	struct hemicube_options options = {.pixels = 32, .origins = 3};
	add_room();
	close_polished(0.51, 0);
	const uint32_t n = model.elements.patches.count;
	struct hemicube_result off = hemicube_result_of(&model, surfaces, &options, 0, n, 0);
	options.mirrors = way_of(state);
	options.bounces = 10;
	struct hemicube_result forced = hemicube_result_of(&model, surfaces, &options, 0, n, 0);
	assert_memory_equal(off.values, forced.values, (size_t)n * off.side * sizeof *off.values);
	hemicube_result_finish(&off);
	hemicube_result_finish(&forced);
	finish_polished();
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test_prestate(a_mirror_shows_the_image, &ways[0]),
	    cmocka_unit_test_prestate(a_mirror_shows_the_image, &ways[1]),
	    cmocka_unit_test_prestate(mirrors_face_each_other, &ways[0]),
	    cmocka_unit_test_prestate(mirrors_face_each_other, &ways[1]),
	    cmocka_unit_test_prestate(factors_are_those_of_rays, &ways[0]),
	    cmocka_unit_test_prestate(factors_are_those_of_rays, &ways[1]),
	    cmocka_unit_test_prestate(batches_do_not_matter, &ways[0]),
	    cmocka_unit_test_prestate(batches_do_not_matter, &ways[1]),
	    cmocka_unit_test_prestate(no_mirror_changes_nothing, &ways[0]),
	    cmocka_unit_test_prestate(no_mirror_changes_nothing, &ways[1]),
	};
	if (!hemicube_test_begin())
		return 77;
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	return failed + hemicube_test_end();
}
