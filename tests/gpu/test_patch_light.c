// Irradiance of patches straight from lights, against closed forms and fine sums: point and spot lights with ranges and
// cones, suns with and without a disc, shadows.
#include "tests/gpu/patch_lit.h"

#include <stdio.h>

// ---- point and spot lights ----------------------------------------------------------------------------------------------

static void by_light(const double at[3], const void *data, double value[3])
{
	const struct punctual_light *l = data;
	double way[3], along = 0;
	for (int c = 0; c < 3; c++) {
		way[c] = (double)l->position[c] - at[c];
		along -= way[c] * (double)l->direction[c];
	}
	const double d2 = vec3_dot(way, way), d = sqrt(d2), range = (double)l->range;
	double e = fabs(way[2]) / (d * d2);
	if (range > 0)
		e *= fmin(fmax(1 - d2 * d2 / (range * range * range * range), 0), 1);
	if (l->kind == LIGHT_SPOT) {
		const double outer = (double)l->outer, inner = (double)l->inner;
		const double ramp = fmin(fmax((outer - (1 - along / d)) / fmax(outer - inner, 1e-30), 0), 1);
		e *= ramp * ramp;
	}
	for (int c = 0; c < 3; c++)
		value[c] = e * (double)l->intensity[c];
}

// The scene is a quad in the plane z = 0, and one light.
static void check_light(const char *what, double edge, uint32_t points, double most)
{
	model_add_quad(&model, o, x, y, 0);
	model_close(&model, edge);
	const uint32_t n = model.elements.patches.count;
	const bool behind = model.lights[0].position[2] < 0;
	float(*is)[3] =
	    computed(&model, &everything, (struct light_options){.points = points, .sky_points = 1, .bounces = 0});
	double worst = 0, largest = 0;
	for (uint32_t i = 0; i < n; i++) {
		double should[3];
		model_mean(&model, i, 200, by_light, &model.lights[0], should);
		for (int c = 0; c < 3; c++) {
			largest = fmax(largest, should[c]);
			worst = fmax(worst, fabs((double)is[i + (behind ? n : 0)][c] - should[c]));
			assert_true(is[i + (behind ? 0 : n)][c] == 0);
		}
	}
	printf("%s, %u patches, %u points: off by %.2g of the most\n", what, n, points, worst / largest);
	assert_true(worst <= most * largest);
	free(is);
	model_finish(&model);
}

static void a_point_light_is_its_integral(void **state)
{
	(void)state;
	model_start(&model);
	add_light(&model, LIGHT_POINT, (const double[3]){0.3, 0.2, 0.7}, o);
	check_light("point light", 2, 64, 6e-3);
	model_start(&model);
	add_light(&model, LIGHT_POINT, (const double[3]){0.3, 0.2, 0.7}, o);
	check_light("point light", 2, 4096, 1e-3);
	model_start(&model);
	add_light(&model, LIGHT_POINT, (const double[3]){0.3, 0.2, -0.7}, o);
	check_light("point light behind", 0.3, 16, 1e-2);
	model_start(&model);
	add_light(&model, LIGHT_POINT, (const double[3]){0.3, 0.2, 0.05}, o);
	check_light("point light near", 0.1, 64, 1e-2);
	model_start(&model);
	add_light(&model, LIGHT_POINT, (const double[3]){0.3, 0.2, 0.7}, o)->range = 0.9f;
	check_light("point light with a range", 0.2, 64, 3e-3);
}

static void a_spot_light_ends_at_its_cone(void **state)
{
	static const double at[3] = {0.4, 0.5, 0.8}, down[3] = {0.2, 0.1, -1};
	(void)state;
	model_start(&model);
	struct punctual_light *l = add_light(&model, LIGHT_SPOT, at, down);
	l->outer = 0.1f;
	l->inner = 0.02f;
	check_light("spot light", 0.2, 64, 1e-2);
	model_start(&model);
	l = add_light(&model, LIGHT_SPOT, at, down);
	l->outer = l->inner = 0.05f;
	check_light("spot light with a sharp edge", 2, 1024, 1.2e-2);
}

static void lights_add_up(void **state)
{
	(void)state;
	model_start(&model);
	add_light(&model, LIGHT_POINT, (const double[3]){0.3, 0.2, 0.7}, o);
	add_light(&model, LIGHT_POINT, (const double[3]){0.8, 0.9, 0.5}, o);
	add_light(&model, LIGHT_POINT, (const double[3]){0.5, 0.5, -2}, o);
	model_add_quad(&model, o, x, y, 0);
	model_close(&model, 2);
	float(*is)[3] = computed(&model, &everything, (struct light_options){.points = 1024, .sky_points = 1, .bounces = 0});
	double one[3], two[3], three[3];
	model_mean(&model, 0, 200, by_light, &model.lights[0], one);
	model_mean(&model, 0, 200, by_light, &model.lights[1], two);
	model_mean(&model, 0, 200, by_light, &model.lights[2], three);
	for (int c = 0; c < 3; c++) {
		assert_true(fabs((double)is[0][c] - one[c] - two[c]) <= 2e-3 * (one[c] + two[c]));
		assert_true(fabs((double)is[1][c] - three[c]) <= 2e-3 * three[c]);
	}
	free(is);
	model_finish(&model);
}

// ---- suns and shadows ---------------------------------------------------------------------------------------------------

// Length of the overlap of two intervals.
static double overlap(double a, double b, double c, double d)
{
	return fmax(0, fmin(b, d) - fmax(a, c));
}

#define HOLE_LOW 0.31
#define HOLE_HIGH 0.72

// A wide lid at height 1 with a square hole over the square 0 … 1.
static void add_lid(struct patch_model *m, uint32_t material)
{
	const double a = HOLE_LOW, b = HOLE_HIGH, far = 4;
	const double down[3] = {0, -2 * far, 0};
	model_add_quad(m, (const double[3]){-far, far, 1}, (const double[3]){far + a, 0, 0}, down, material);
	model_add_quad(m, (const double[3]){b, far, 1}, (const double[3]){far - b, 0, 0}, down, material);
	model_add_quad(m, (const double[3]){a, a, 1}, (const double[3]){b - a, 0, 0}, (const double[3]){0, -far - a, 0},
		       material);
	model_add_quad(m, (const double[3]){a, far, 1}, (const double[3]){b - a, 0, 0}, (const double[3]){0, b - far, 0},
		       material);
}

static void a_sun_shines_through_a_hole(void **state)
{
	static const double way[3] = {0.3, -0.2, -1};
	const double edges[2] = {2, 0.25}, cosine = 1 / sqrt(0.09 + 0.04 + 1);
	(void)state;
	for (int k = 0; k < 2; k++) {
		model_start(&model);
		add_light(&model, LIGHT_DIRECTIONAL, o, way);
		model_add_quad(&model, o, x, y, 0);
		add_lid(&model, 1);
		model_close(&model, edges[k]);
		float(*is)[3] =
		    computed(&model, &everything, (struct light_options){.points = 256, .sky_points = 1, .bounces = 0});
		double worst = 0;
		for (uint32_t i = 0; i < model.elements.patches.count; i++) {
			struct patch p;
			patches_get(&model.elements.patches, i, &p);
			if (p.face != 0)
				continue;
			double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, lit = 1;
			for (uint32_t q = 0; q < 4; q++)
				for (int c = 0; c < 2; c++) {
					low[c] = fmin(low[c], p.shape.at[q][c]);
					high[c] = fmax(high[c], p.shape.at[q][c]);
				}
			for (int c = 0; c < 2; c++)
				lit *= overlap(low[c], high[c], HOLE_LOW + way[c], HOLE_HIGH + way[c]) / (high[c] - low[c]);
			worst = fmax(worst, fabs((double)is[i][0] / (2 * cosine) - lit));
		}
		printf("sun through a hole, sides of %g: share off by %.2g\n", edges[k], worst);
		assert_true(worst <= 0.012);
		free(is);
		model_finish(&model);
	}
}

static void a_sun_with_a_disc_is_as_bright(void **state)
{
	(void)state;
	model_start(&model);
	const double way[3] = {0.6, 0, -0.8};
	add_light(&model, LIGHT_DIRECTIONAL, o, way)->spread = 0.05f;
	model_add_quad(&model, o, x, y, 0);
	model_close(&model, 0.25);
	float(*is)[3] = computed(&model, &everything, (struct light_options){.points = 64, .sky_points = 1, .bounces = 0});
	double sum = 0;
	const uint32_t n = model.elements.patches.count;
	for (uint32_t i = 0; i < n; i++) {
		sum += (double)is[i][0] / n;
		assert_true(fabs((double)is[i][0] - 1.6) < 0.02);
	}
	printf("sun of 18 degrees: %.6g, not 1.6\n", sum);
	assert_true(fabs(sum - 1.6) < 2e-3);
	free(is);
	model_finish(&model);
}

// A mask with a quarter of holes lets a quarter of a sun through; the masked quad itself gets it all.
static void masks_let_light_through(void **state)
{
	static const uint32_t texels[4] = {0x00FFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF};
	(void)state;
	model_start(&model);
	add_light(&model, LIGHT_DIRECTIONAL, o, (const double[3]){0, 0, -1});
	model.texture_count = 1;
	model.texel_count = 4;
	memcpy(model.texels, texels, sizeof texels);
	model.textures[0] =
	    (struct texture_info){.width = 2, .height = 2, .flags = TEXTURE_NEAREST, .row_u = {1, 0, 0}, .row_v = {0, 1, 0}};
	model.materials[1].albedo_texture = 0;
	model.materials[1].flags = MATERIAL_ALPHA_MASK;
	model.materials[1].alpha_cutoff = 0.5f;
	model_add_quad(&model, o, x, y, 0);
	model_add_quad(&model, z, x, y, 1);
	model_close(&model, 2);
	float(*is)[3] = computed(&model, &everything, (struct light_options){.points = 64, .sky_points = 1, .bounces = 0});
	assert_true(fabs((double)is[0][0] - 0.5) < 1e-5 && fabs((double)is[1][0] - 2) < 1e-5);
	free(is);
	model_finish(&model);
}

static void without_lights_there_is_no_pass(void **state)
{
	struct light *l;
	(void)state;
	model_start(&model);
	model_add_quad(&model, o, x, y, 0);
	model_close(&model, 1);
	assert_false(light_wanted(&everything, &model.scene, false));
	const struct patch_scene of = {&everything, &model.scene, &model.elements, &model.buffers};
	static const uint32_t bad[] = {0, 3, LIGHT_POINTS_MOST * 2};
	for (int i = 0; i < 3; i++) {
		assert_int_equal(light_create(&of, &(struct light_options){.points = bad[i], .sky_points = 1, .bounces = 0},
					      device, &l, NULL),
				 STATUS_BAD_ARGUMENT);
		assert_int_equal(light_create(&of, &(struct light_options){.points = 1, .sky_points = bad[i], .bounces = 0},
					      device, &l, NULL),
				 STATUS_BAD_ARGUMENT);
		assert_null(l);
	}
	model_finish(&model);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_point_light_is_its_integral),
	    cmocka_unit_test(a_spot_light_ends_at_its_cone),
	    cmocka_unit_test(lights_add_up),
	    cmocka_unit_test(a_sun_shines_through_a_hole),
	    cmocka_unit_test(a_sun_with_a_disc_is_as_bright),
	    cmocka_unit_test(masks_let_light_through),
	    cmocka_unit_test(without_lights_there_is_no_pass),
	};
	if (!model_test_begin())
		return 77;
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	return failed + model_test_end();
}
