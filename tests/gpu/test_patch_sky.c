// Irradiance of patches from a picture of the sky: even, with a sun, by way of a mirror, and in a closed room; with other
// lights, the same bits whatever the slices.
#include "tests/gpu/patch_lit.h"

#include <stdio.h>

#include "server/base/angle.h"
#include "server/loader/environment.h"

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
	float(*is)[3] = computed(&model, &sky.plan, (struct light_options){.points = 1, .sky_points = 16, .bounces = 0});
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
	float(*is)[3] = computed(&model, &sky.plan, (struct light_options){.points = 1, .sky_points = 1024, .bounces = 0});
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
		float(*is)[3] =
		    computed(&model, &sky.plan, (struct light_options){.points = 1, .sky_points = 1024, .bounces = bounces});
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
	compute(&model, &sky.plan, (struct light_options){.points = 16, .sky_points = 32, .bounces = 0}, 1, one);
	compute(&model, &sky.plan, (struct light_options){.points = 16, .sky_points = 32, .bounces = 0}, 3000000, two);
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

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(an_even_sky_is_pi_times_its_radiance),
	    cmocka_unit_test(a_sky_with_a_sun_is_its_integral),
	    cmocka_unit_test(mirrors_show_the_sky),
	    cmocka_unit_test(closed_rooms_are_dark_and_slices_do_not_matter),
	};
	if (!model_test_begin())
		return 77;
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	return failed + model_test_end();
}
