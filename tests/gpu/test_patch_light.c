// Irradiance of patches straight from lights, against closed forms and fine sums: point and spot lights with ranges and
// cones, suns with and without a disc, shadows, pictures of the sky, also by way of a mirror; the same bits whatever the
// slices.
#include "tests/gpu/patch_model.h"

#include <stdio.h>
#include <stdlib.h>

#include "server/base/angle.h"
#include "server/base/vec3.h"
#include "server/loader/environment.h"
#include "server/worker/technique/radiosity/light.h"
#include "server/worker/technique/radiosity/surfaces.h"

static struct patch_model model;
static const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1};

static void compute(struct patch_model *m, const struct plan *plan, struct light_options options, uint32_t slice_us,
		    float (*out)[3])
{
	const struct patch_scene of = {plan, &m->scene, &m->elements, &m->buffers};
	struct surfaces *s;
	struct light *l;
	assert_int_equal(surfaces_create(&of, device, &s, NULL), STATUS_OK);
	while (!surfaces_finished(s))
		assert_int_equal(surfaces_step(s, slice_us, NULL), STATUS_OK);
	surfaces_destroy(s);
	assert_true(light_wanted(plan, &m->scene));
	assert_int_equal(light_create(&of, &options, device, &l, NULL), STATUS_OK);
	assert_int_equal(light_compile(l, NULL), STATUS_OK);
	while (!light_finished(l))
		assert_int_equal(light_step(l, slice_us, NULL), STATUS_OK);
	assert_true(light_progress(l) == 1);
	assert_int_equal(light_read(l, out[0], NULL), STATUS_OK);
	light_destroy(l);
}

static float (*computed(struct patch_model *m, const struct plan *plan, struct light_options options))[3]
{
	float(*out)[3] = calloc(m->elements.count, sizeof *out);
	assert_non_null(out);
	compute(m, plan, options, 100000, out);
	return out;
}

static struct punctual_light *add_light(struct patch_model *m, uint32_t kind, const double at[3], const double towards[3])
{
	struct punctual_light *l = &m->lights[m->light_count++];
	double length = sqrt(vec3_dot(towards, towards));
	*l = (struct punctual_light){.kind = kind, .intensity = {2, 3, 5}, .outer = 1, .pmf = 1, .keep = 1};
	for (int c = 0; c < 3; c++) {
		l->position[c] = (float)at[c];
		l->direction[c] = (float)(length > 0 ? towards[c] / length : 0);
	}
	return l;
}

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
	float(*is)[3] = computed(&model, &everything, (struct light_options){points, 1, 0});
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
	float(*is)[3] = computed(&model, &everything, (struct light_options){1024, 1, 0});
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
		float(*is)[3] = computed(&model, &everything, (struct light_options){256, 1, 0});
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
	float(*is)[3] = computed(&model, &everything, (struct light_options){64, 1, 0});
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
	float(*is)[3] = computed(&model, &everything, (struct light_options){64, 1, 0});
	assert_true(fabs((double)is[0][0] - 0.5) < 1e-5 && fabs((double)is[1][0] - 2) < 1e-5);
	free(is);
	model_finish(&model);
}

// ---- the sky ------------------------------------------------------------------------------------------------------------

struct sky {
	struct import import;
	struct resident_scene scene;
	struct blob_header header;
	struct plan plan;
};

static void sky_init(struct sky *s, uint32_t width, uint32_t height, const float *rgb)
{
	memset(s, 0, sizeof *s);
	s->import.environment_width = width;
	s->import.environment_height = height;
	assert_int_equal(environment_build(&s->import, rgb, NULL), STATUS_OK);
	struct blob_view *v = &s->scene.view;
	s->scene.blob = v->blob = &s->header;
	v->sections[BLOB_ENVIRONMENT] = s->import.environment;
	v->sections[BLOB_ENVIRONMENT_ROWS] = s->import.environment_rows;
	v->counts[BLOB_ENVIRONMENT] = v->counts[BLOB_ENVIRONMENT_ROWS] = width * height;
	s->plan = everything;
	s->plan.environment = (struct plan_environment){.scene = &s->scene,
							.width = width,
							.height = height,
							.scale = 1,
							.power = (double)s->import.environment_power,
							.contrast = (double)s->import.environment_contrast};
}

static void sky_finish(struct sky *s)
{
	while (s->scene.derived) {
		struct derived *d = s->scene.derived;
		s->scene.derived = d->next;
		d->destroy(d);
	}
	free(s->import.environment);
	free(s->import.environment_rows);
}

// Radiance of channel 0, bilinear, as layout.h has it.
static double seen(const struct sky *s, const double w[3])
{
	const int width = (int)s->import.environment_width, height = (int)s->import.environment_height;
	const double across = sqrt(w[0] * w[0] + w[2] * w[2]);
	const double u = (0.5 + atan2(w[0], -w[2]) / (2 * PI)) * width - 0.5, v = atan2(across, w[1]) / PI * height - 0.5;
	const int i = (int)floor(u), j = (int)floor(v);
	double sum = 0;
	for (int k = 0; k < 4; k++) {
		const int column = ((i + k % 2) % width + width) % width;
		const int row = (int)fmin(fmax(j + k / 2, 0), height - 1);
		sum += (k % 2 ? u - i : 1 - (u - i)) * (k / 2 ? v - j : 1 - (v - j)) *
		       (double)s->import.environment[row * width + column].radiance[0];
	}
	return sum;
}

// Irradiance of a plane with this normal, by a million directions.
static double under(const struct sky *s, const double normal[3])
{
	const int n = 700;
	double sum = 0;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < 2 * n; j++) {
			const double h = 1 - 2 * (i + 0.5) / n, phi = PI * (j + 0.5) / n, r = sqrt(1 - h * h);
			const double w[3] = {r * cos(phi), h, r * sin(phi)};
			sum += fmax(vec3_dot(w, normal), 0) * seen(s, w);
		}
	return sum * 4 * PI / (2.0 * n * n);
}

static void an_even_sky_is_pi_times_its_radiance(void **state)
{
	static float rgb[3 * 32];
	struct sky sky;
	(void)state;
	for (int i = 0; i < 96; i++)
		rgb[i] = 0.75f;
	sky_init(&sky, 8, 4, rgb);
	model_start(&model);
	model_add_quad(&model, o, x, y, 0);
	model_close(&model, 0.25);
	float(*is)[3] = computed(&model, &sky.plan, (struct light_options){1, 16, 0});
	double worst = 0;
	for (uint32_t i = 0; i < model.elements.count; i++)
		worst = fmax(worst, fabs((double)is[i][0] / (0.75 * PI) - 1));
	printf("even sky: off by %.2g at most\n", worst);
	assert_true(worst < 1e-5);
	free(is);
	model_finish(&model);
	sky_finish(&sky);
}

static void a_sky_with_a_sun_is_its_integral(void **state)
{
	static float rgb[3 * 16 * 8];
	struct sky sky;
	(void)state;
	for (int i = 0; i < 3 * 128; i++)
		rgb[i] = 0.1f + 0.01f * (float)(i / 48);
	for (int i = 0; i < 9; i++)
		rgb[3 * (16 * (2 + i / 3) + 5 + i % 3)] = 9;
	sky_init(&sky, 16, 8, rgb);
	model_start(&model);
	model_add_quad(&model, o, x, y, 0);
	model_add_quad(&model, (const double[3]){50, 0, 0}, z, y, 0);
	model_close(&model, 0.25);
	const uint32_t n = model.elements.patches.count;
	float(*is)[3] = computed(&model, &sky.plan, (struct light_options){1, 1024, 0});
	for (int k = 0; k < 4; k++) {
		const uint32_t first = k % 2 ? n : 0;
		double mean = 0;
		struct patch p;
		patches_get(&model.elements.patches, k / 2 ? n - 1 : 0, &p);
		for (uint32_t i = 0; i < n / 2; i++)
			mean += (double)is[first + (k / 2 ? n / 2 : 0) + i][0] / (n / 2);
		const double normal[3] = {k % 2 ? -p.normal[0] : p.normal[0], k % 2 ? -p.normal[1] : p.normal[1],
					  k % 2 ? -p.normal[2] : p.normal[2]};
		const double should = under(&sky, normal);
		printf("sky with a sun, side %d: %.5g, not %.5g, %.2g off\n", k, mean, should, mean / should - 1);
		assert_true(fabs(mean / should - 1) < 6e-3);
	}
	free(is);
	model_finish(&model);
	sky_finish(&sky);
}

// A patch at the foot of a wide mirror sees half of the sky in it.
static void mirrors_show_the_sky(void **state)
{
	static float rgb[3 * 32];
	struct sky sky;
	(void)state;
	for (int i = 0; i < 96; i++)
		rgb[i] = 1;
	sky_init(&sky, 8, 4, rgb);
	model_start(&model);
	model.materials[1].metallic = 1;
	model.materials[1].roughness = 0;
	for (int c = 0; c < 3; c++)
		model.materials[1].albedo[c] = 0.6f;
	model_add_quad(&model, (const double[3]){1e-3, -0.5, 0}, (const double[3]){0.01, 0, 0}, y, 0);
	model_add_quad(&model, (const double[3]){0, -1e4, -1e4}, (const double[3]){0, 2e4, 0}, (const double[3]){0, 0, 2e4},
		       1);
	model_close(&model, 1e5);
	for (uint32_t bounces = 0; bounces < 2; bounces++) {
		float(*is)[3] = computed(&model, &sky.plan, (struct light_options){1, 1024, bounces});
		const double should = PI * (0.5 + 0.5 * 0.6 * bounces);
		printf("beside a mirror, %u bounces: %.5g, not %.5g\n", bounces, (double)is[0][0], should);
		assert_true(fabs((double)is[0][0] / should - 1) < 0.01);
		free(is);
	}
	model_finish(&model);
	sky_finish(&sky);
}

// ---- and more -----------------------------------------------------------------------------------------------------------

static void closed_rooms_are_dark_and_slices_do_not_matter(void **state)
{
	static float rgb[3 * 32];
	struct sky sky;
	(void)state;
	for (int i = 0; i < 96; i++)
		rgb[i] = 1;
	sky_init(&sky, 8, 4, rgb);
	model_start(&model);
	add_light(&model, LIGHT_DIRECTIONAL, o, (const double[3]){0.4, 0.3, -1})->spread = 0.01f;
	add_light(&model, LIGHT_POINT, (const double[3]){3, 4, 5}, o);
	// Fronts are inside.
	const double far[3] = {1, 1, 1}, minus[3][3] = {{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
	model_add_quad(&model, o, x, y, 0);
	model_add_quad(&model, o, y, z, 0);
	model_add_quad(&model, o, z, x, 0);
	model_add_quad(&model, far, minus[1], minus[0], 0);
	model_add_quad(&model, far, minus[2], minus[1], 0);
	model_add_quad(&model, far, minus[0], minus[2], 0);
	model_close(&model, 0.13);
	const uint32_t n = model.elements.count;
	float(*one)[3] = calloc(n, sizeof *one), (*two)[3] = calloc(n, sizeof *two);
	assert_non_null(one);
	assert_non_null(two);
	compute(&model, &sky.plan, (struct light_options){16, 32, 0}, 1, one);
	compute(&model, &sky.plan, (struct light_options){16, 32, 0}, 3000000, two);
	assert_memory_equal(one, two, n * sizeof *one);
	double inside = 0, outside = 0;
	for (uint32_t i = 0; i < n; i++) {
		inside += i < n / 2 ? (double)one[i][0] : 0;
		outside += i < n / 2 ? 0 : (double)one[i][0];
	}
	assert_true(inside == 0 && outside > n);
	free(one);
	free(two);
	model_finish(&model);
	sky_finish(&sky);
}

static void without_lights_there_is_no_pass(void **state)
{
	struct light *l;
	(void)state;
	model_start(&model);
	model_add_quad(&model, o, x, y, 0);
	model_close(&model, 1);
	assert_false(light_wanted(&everything, &model.scene));
	const struct patch_scene of = {&everything, &model.scene, &model.elements, &model.buffers};
	static const uint32_t bad[] = {0, 3, LIGHT_POINTS_MOST * 2};
	for (int i = 0; i < 3; i++) {
		assert_int_equal(light_create(&of, &(struct light_options){bad[i], 1, 0}, device, &l, NULL),
				 STATUS_BAD_ARGUMENT);
		assert_int_equal(light_create(&of, &(struct light_options){1, bad[i], 0}, device, &l, NULL),
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
	    cmocka_unit_test(an_even_sky_is_pi_times_its_radiance),
	    cmocka_unit_test(a_sky_with_a_sun_is_its_integral),
	    cmocka_unit_test(mirrors_show_the_sky),
	    cmocka_unit_test(closed_rooms_are_dark_and_slices_do_not_matter),
	    cmocka_unit_test(without_lights_there_is_no_pass),
	};
	if (!model_test_begin())
		return 77;
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	return failed + model_test_end();
}
