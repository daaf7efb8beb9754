// Irradiance of patches straight from emissive surfaces, beside form factors in closed form: a small lamp, one as wide as
// the room that touches its wall, a dark side, and a mirror beside which the lamp is seen twice.
#include "tests/gpu/patch_lit.h"

#include <stdio.h>

#include "server/base/angle.h"
#include "server/worker/technique/radiosity/form_factor.h"

#define RADIANCE 5.0

static struct emitter emitters[MODEL_TRIANGLES];

// Make the lamps of material 1 the scene's emitters, all of one area.
static void add_emitters(struct patch_model *m, double area)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < m->count; i++)
		if (m->triangles[i].material == 1)
			emitters[count++] = (struct emitter){.triangle = i, .keep = 1};
	for (uint32_t i = 0; i < count; i++)
		emitters[i].pmf = 1 / (float)count;
	m->scene.view.sections[BLOB_EMITTERS] = emitters;
	m->scene.view.counts[BLOB_EMITTERS] = count;
	m->scene.view.emitter_power = (float)(PI * RADIANCE * area);
}

static void shine(struct patch_model *m)
{
	for (int c = 0; c < 3; c++)
		m->materials[1].emission[c] = (float)RADIANCE;
	m->materials[1].power_density = (float)(PI * RADIANCE);
}

// π L F of a patch and a lamp.
static double expected(const struct patch_model *m, uint32_t patch, const struct form_polygon *lamp)
{
	struct patch p;
	double error;
	patches_get(&m->elements.patches, patch, &p);
	return PI * RADIANCE * form_factor_exchange(&p.shape, lamp, 1e-9, &error) / p.area;
}

static void check(const char *what, const double at[3], double side, double most)
{
	const double u[3] = {0, side, 0}, v[3] = {side, 0, 0};
	const struct form_polygon lamp = {{{at[0], at[1], at[2]},
					   {at[0], at[1] + side, at[2]},
					   {at[0] + side, at[1] + side, at[2]},
					   {at[0] + side, at[1], at[2]}},
					  4};
	model_start(&model);
	shine(&model);
	model_add_quad(&model, o, x, y, 0);
	model_add_quad(&model, at, u, v, 1); // its front is below
	model_close(&model, 0.25);
	add_emitters(&model, side * side);
	float(*is)[3] =
	    computed(&model, &everything, (struct light_options){.points = 1, .sky_points = 1024, .lamps = true});
	const uint32_t n = model.elements.patches.count;
	double worst = 0;
	for (uint32_t i = 0; i < 16; i++) {
		const double should = expected(&model, i, &lamp);
		worst = fmax(worst, fabs((double)is[i][1] / should - 1));
		assert_true(is[n + i][1] == 0); // the floor's back
	}
	printf("%s: off by %.2g at most\n", what, worst);
	assert_true(worst < most);
	free(is);
	model_finish(&model);
}

static void lamps_are_form_factors(void **state)
{
	(void)state;
	check("a small lamp", (const double[3]){0.45, 0.45, 1}, 0.1, 0.01);
	check("a distant one", (const double[3]){-3, 2, 40}, 0.5, 0.01);
	check("one as wide as the floor", (const double[3]){0, 0, 1}, 1, 0.02);
	check("one that nearly touches it", (const double[3]){0, 0, 0.01}, 1, 0.02);
}

// A wide mirror behind a wall's foot shows the lamp a second time: the lamp's image is as if the mirror were not there.
static void a_mirror_shows_the_lamp_again(void **state)
{
	const double at[3] = {0.4, 0.3, 1}, u[3] = {0, 0.2, 0}, v[3] = {0.2, 0, 0};
	struct form_polygon lamp = {{{0.4, 0.3, 1}, {0.4, 0.5, 1}, {0.6, 0.5, 1}, {0.6, 0.3, 1}}, 4}, image = {.corners = 4};
	struct plan plan = everything;
	(void)state;
	// The mirror is the plane y = 0; what it shows is turned round, and so are the corners.
	for (int k = 0; k < 4; k++) {
		memcpy(image.at[k], lamp.at[3 - k], sizeof image.at[k]);
		image.at[k][1] = -image.at[k][1];
	}
	model_start(&model);
	shine(&model);
	model.materials[2].metallic = 1;
	model.materials[2].roughness = 0;
	for (int c = 0; c < 3; c++)
		model.materials[2].albedo[c] = 1;
	model_add_quad(&model, o, x, y, 0);
	model_add_quad(&model, at, u, v, 1);
	model_add_quad(&model, (const double[3]){-200, 0, -200}, (const double[3]){0, 0, 400}, (const double[3]){400, 0, 0},
		       2);
	model_close(&model, 100);
	add_emitters(&model, 0.04);
	float(*is)[3] =
	    computed(&model, &plan, (struct light_options){.points = 1, .sky_points = 4096, .bounces = 2, .lamps = true});
	const double straight = expected(&model, 0, &lamp), by_mirror = expected(&model, 0, &image);
	printf("mirror: %.5g, not %.5g + %.5g\n", (double)is[0][1], straight, by_mirror);
	// Only the cosine's rays find what the mirror shows.
	const double share = by_mirror / (PI * RADIANCE), error = PI * RADIANCE * sqrt(share / 4096);
	assert_true(fabs((double)is[0][1] - straight - by_mirror) < 3 * error + 0.01 * straight);
	assert_true((double)is[0][1] > straight + 0.5 * by_mirror);
	free(is);
	model_finish(&model);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(lamps_are_form_factors),
	    cmocka_unit_test(a_mirror_shows_the_lamp_again),
	};
	if (!model_test_begin())
		return 77;
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	return failed + model_test_end();
}
