// What patches are made of: means of textures, vertex colours and emission are the integrals over the patch, however it is
// cut; materials become diffuse or mirrors as they are said to; the same bits whatever the slices.
#include "tests/gpu/patch_model.h"

#include <stdio.h>
#include <stdlib.h>

#include "server/worker/technique/radiosity/surfaces.h"

static void compute(struct patch_model *m, const struct plan *plan, uint32_t slice_us, struct radiosity_surface *out)
{
	const struct patch_scene of = {plan, &m->scene, &m->elements, &m->buffers};
	struct surfaces *s;
	assert_int_equal(surfaces_create(&of, NULL, device, &s, NULL), STATUS_OK);
	assert_int_equal(surfaces_compile(s, NULL), STATUS_OK);
	assert_true(surfaces_compiled(s));
	while (!surfaces_finished(s))
		assert_int_equal(surfaces_step(s, slice_us, NULL), STATUS_OK);
	assert_true(surfaces_progress(s) == 1);
	surfaces_destroy(s);
	model_surfaces(m, out);
}

// ---- textures of our own ----------------------------------------------------------------------------------------------

// A texture of four channels in linear light, over the square 0 … 1 of a quad in the plane z = 0.
struct cloth {
	uint32_t width, height;
	bool nearest;
	const uint32_t *texels;
};

static uint32_t random_bits(uint32_t *state)
{
	*state = *state * 1664525u + 1013904223u;
	return *state >> 8;
}

static uint32_t add_texture(struct patch_model *m, uint32_t width, uint32_t height, bool nearest, struct cloth *cloth)
{
	const uint32_t t = m->texture_count++;
	m->textures[t] = (struct texture_info){.offset = m->texel_count,
					       .width = width,
					       .height = height,
					       .flags = nearest ? TEXTURE_NEAREST : 0,
					       .row_u = {1, 0, 0},
					       .row_v = {0, 1, 0}};
	*cloth = (struct cloth){width, height, nearest, m->texels + m->texel_count};
	m->texel_count += width * height;
	assert_true(m->texel_count <= 4096);
	return t;
}

static double texel(const struct cloth *c, int x, int y, int channel)
{
	const int w = (int)c->width, h = (int)c->height;
	const uint32_t bits = c->texels[((y % h + h) % h) * w + (x % w + w) % w];
	return (bits >> 8 * channel & 255) / 255.0;
}

static void cloth_at(const double at[3], const void *data, double value[3])
{
	const struct cloth *c = data;
	const double x = at[0] * c->width - (c->nearest ? 0 : 0.5), y = at[1] * c->height - (c->nearest ? 0 : 0.5);
	const int i = (int)floor(x), j = (int)floor(y);
	const double s = c->nearest ? 0 : x - i, t = c->nearest ? 0 : y - j;
	for (int k = 0; k < 3; k++)
		value[k] = (1 - t) * ((1 - s) * texel(c, i, j, k) + s * texel(c, i + 1, j, k)) +
			   t * ((1 - s) * texel(c, i, j + 1, k) + s * texel(c, i + 1, j + 1, k));
}

// The largest error of albedo, or of emission over `scale`, beside the means of a field.
static double worst_error(const struct patch_model *m, const struct radiosity_surface *s, model_field *field,
			  const void *data, float scale)
{
	double worst = 0;
	for (uint32_t i = 0; i < m->elements.patches.count; i++) {
		double mean[3];
		model_mean(m, i, m->elements.patches.count > 10 ? 120 : 300, field, data, mean);
		for (int c = 0; c < 3; c++) {
			const float is = scale > 0 ? s[i].emission[c] / scale : s[i].albedo[c];
			worst = fmax(worst, fabs((double)is - mean[c]));
			assert_true(s[i].albedo[c] == s[i + m->elements.patches.count].albedo[c]);
			assert_true(s[i].there == 1);
		}
	}
	return worst;
}

static void check_textured(struct patch_model *m, double edge, const char *what, model_field *field, const void *data,
			   float scale, double most)
{
	model_close(m, edge);
	struct radiosity_surface *s = calloc(m->elements.count, sizeof *s);
	assert_non_null(s);
	compute(m, &everything, 1000000, s);
	const double worst = worst_error(m, s, field, data, scale);
	printf("%s, %u patches: off by %.2g at most\n", what, m->elements.patches.count, worst);
	assert_true(worst <= most);
	free(s);
	model_finish(m);
}

static struct patch_model model;
static const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0};

static void checkers_have_the_mean_of_their_squares(void **state)
{
	static const double edges[] = {2, 0.37, 0.11};
	(void)state;
	for (int i = 0; i < 3; i++) {
		struct cloth cloth;
		model_start(&model);
		model.materials[0].albedo_texture = add_texture(&model, 7, 5, true, &cloth);
		for (uint32_t k = 0; k < 35; k++)
			model.texels[k] = (k % 7 + k / 7) % 2 ? 0xFFFFFFFF : 0xFF204000;
		model_add_quad(&model, o, x, y, 0);
		check_textured(&model, edges[i], "checker", cloth_at, &cloth, 0, 3e-3);
	}
}

static void gradients_have_the_mean_of_their_bilinear_cells(void **state)
{
	static const double edges[] = {2, 0.37, 0.11};
	(void)state;
	for (int i = 0; i < 3; i++) {
		struct cloth cloth;
		model_start(&model);
		model.materials[0].albedo_texture = add_texture(&model, 16, 16, false, &cloth);
		for (uint32_t k = 0; k < 256; k++)
			model.texels[k] = k | (k % 16 * 17) << 8 | (k / 16 * 17) << 16 | 0xFF000000;
		model_add_quad(&model, o, x, y, 0);
		check_textured(&model, edges[i], "gradient", cloth_at, &cloth, 0, 1e-3);
	}
}

static void noise_emits_its_mean(void **state)
{
	struct cloth cloth;
	uint32_t seed = 1;
	(void)state;
	model_start(&model);
	model.materials[0].emission_texture = add_texture(&model, 32, 32, false, &cloth);
	for (int c = 0; c < 3; c++)
		model.materials[0].emission[c] = 40;
	for (uint32_t k = 0; k < 1024; k++)
		model.texels[k] = random_bits(&seed);
	// A trapezoid and a triangle: neither is mapped evenly from a square.
	const double corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0.6, 0.7, 0}, {0.1, 0.7, 0}};
	model_add_corners(&model, corners, 0);
	const double a[3] = {0, 0.8, 0}, b[3] = {0.9, 0.75, 0}, c[3] = {0.5, 1, 0};
	const double uv[3][2] = {{a[0], a[1]}, {b[0], b[1]}, {c[0], c[1]}};
	model_add(&model, a, b, c, uv, 0);
	check_textured(&model, 0.25, "noise", cloth_at, &cloth, 40, 4e-3);
}

static void colours_at(const double at[3], const void *data, double value[3])
{
	(void)data;
	for (int c = 0; c < 3; c++)
		value[c] = 0.25 * (c + 1) * at[0] + 0.2 * at[1];
}

static void vertex_colours_have_the_mean_of_their_triangles(void **state)
{
	static const double corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0.6, 1, 0}, {0.2, 1, 0}};
	static const double a[3] = {1, 0, 0}, b[3] = {1, 1, 0}, c[3] = {0.6, 1, 0};
	(void)state;
	model_start(&model);
	model.has_colors = true;
	model_add_corners(&model, corners, 0);
	model_add(&model, a, b, c, NULL, 0);
	for (uint32_t i = 0; i < 3 * model.count; i++) {
		double at[3], value[3];
		for (int k = 0; k < 3; k++)
			at[k] = (double)model.vertices[i].position[k];
		colours_at(at, NULL, value);
		for (int k = 0; k < 3; k++)
			model.colors[i].rgba[k] = (float)value[k];
	}
	check_textured(&model, 0.4, "colours", colours_at, NULL, 0, 1e-3);
}

// ---- materials --------------------------------------------------------------------------------------------------------

static void check_surface(const struct radiosity_surface *s, const char *name, double emission, double albedo, double mirror,
			  double there)
{
	const double should[4] = {emission, albedo, mirror, there};
	const double is[4] = {(double)s->emission[1], (double)s->albedo[1], (double)s->mirror[1], (double)s->there};
	for (int i = 0; i < 4; i++)
		if (!(fabs(is[i] - should[i]) <= 1e-6 * fmax(1, should[i])))
			fail_msg("%s: %s is %.9g, not %.9g", name,
				 i == 0   ? "emission"
				 : i == 1 ? "albedo"
				 : i == 2 ? "mirror"
					  : "there",
				 is[i], should[i]);
}

struct kind {
	const char *name;
	struct material material; // fields that are zero here are as model_start sets them, but for those below
	float metallic, roughness;
	double front, back, albedo, mirror;
};

static const struct kind kinds[8] = {
    {"lambert", {.flags = 0}, 0, 1, 0, 0, 0.5, 0},
    {"polished dielectric", {.specular = {0.04f, 0.04f, 0.04f}, .specular_weight = 1}, 0, 0, 0, 0, 0.5, 0},
    {"polished metal", {.flags = 0}, 1, 0, 0, 0, 0, 0.5},
    {"half a mirror", {.flags = 0}, 0.5f, 0.04f, 0, 0, 0.25, 0.25},
    {"rough metal", {.flags = 0}, 1, 0.3f, 0, 0, 0.5, 0},
    {"lamp", {.emission = {3, 3, 3}}, 0, 1, 3, 0, 0.5, 0},
    {"lamp of two sides", {.emission = {3, 3, 3}, .flags = MATERIAL_EMITS_BOTH_SIDES}, 0, 1, 3, 3, 0.5, 0},
    {"unlit", {.emission = {3, 3, 3}, .flags = MATERIAL_UNLIT}, 0, 1, 0, 0, 0, 0},
};

static void materials_are_diffuse_or_mirrors(void **state)
{
	(void)state;
	model_start(&model);
	for (uint32_t i = 0; i < 8; i++) {
		struct material *m = &model.materials[i];
		const struct material *k = &kinds[i].material;
		memcpy(m->emission, k->emission, sizeof m->emission);
		memcpy(m->specular, k->specular, sizeof m->specular);
		m->specular_weight = k->specular_weight;
		m->flags = k->flags;
		m->metallic = kinds[i].metallic;
		m->roughness = kinds[i].roughness;
		m->albedo[0] = m->albedo[1] = m->albedo[2] = 0.5f;
		model_add_quad(&model, (const double[3]){0, 0, i}, x, y, i);
	}
	model_close(&model, 2);
	struct radiosity_surface s[16];
	assert_int_equal(model.elements.patches.count, 8);
	compute(&model, &everything, 1000, s);
	for (uint32_t i = 0; i < 8; i++) {
		check_surface(&s[i], kinds[i].name, kinds[i].front, kinds[i].albedo, kinds[i].mirror, 1);
		check_surface(&s[i + 8], kinds[i].name, kinds[i].back, kinds[i].albedo, kinds[i].mirror, 1);
	}
	// Without mirrors all is diffuse, and without emitters nothing emits.
	struct plan plan = everything;
	plan.effects &= ~(1u << candil_Effect_EFFECT_GLOSSY | 1u << candil_Effect_EFFECT_EMITTERS);
	compute(&model, &plan, 1000, s);
	for (uint32_t i = 0; i < 7; i++)
		check_surface(&s[i], kinds[i].name, 0, 0.5, 0, 1);
	model_finish(&model);
}

// A mask that lets a quarter of the quad be there, where it is red and shines.
static void masks_count_what_is_there(void **state)
{
	struct cloth cloth, glow;
	(void)state;
	model_start(&model);
	model.materials[0].albedo_texture = add_texture(&model, 2, 2, true, &cloth);
	model.materials[0].emission_texture = add_texture(&model, 2, 2, true, &glow);
	model.materials[0].emission[0] = model.materials[0].emission[1] = model.materials[0].emission[2] = 8;
	model.materials[0].flags = MATERIAL_ALPHA_MASK;
	model.materials[0].alpha_cutoff = 0.5f;
	model.materials[1] = model.materials[0];
	model.materials[1].flags = MATERIAL_ALPHA_BLEND;
	model.materials[1].alpha = 0.5f;
	static const uint32_t texels[8] = {0xFF00FF33, 0x00FFFFFF, 0x00FFFFFF, 0x00FFFFFF,
					   0xFFFFFFFF, 0xFF000000, 0xFF000000, 0xFF000000};
	memcpy(model.texels, texels, sizeof texels);
	model_add_quad(&model, o, x, y, 0);
	model_add_quad(&model, (const double[3]){0, 0, 1}, x, y, 1);
	model_close(&model, 0.5);
	struct radiosity_surface s[16];
	assert_int_equal(model.elements.patches.count, 8);
	compute(&model, &everything, 1000, s);
	check_surface(&s[0], "what is there", 8, 1, 0, 1);
	check_surface(&s[3], "what is not", 0, 0, 0, 0);
	check_surface(&s[4], "half there", 8, 1, 0, 0.5);
	model_finish(&model);
	model_close(&model, 2);
	assert_int_equal(model.elements.patches.count, 2);
	compute(&model, &everything, 1000, s);
	check_surface(&s[0], "a quarter", 8, 1, 0, 0.25);
	check_surface(&s[1], "an eighth", 8, 1, 0, 0.125);
	assert_true(fabsf(s[0].albedo[0] - 0.2f) < 1e-6f && s[0].albedo[2] == 0);
	model_finish(&model);
}

static void slices_do_not_matter(void **state)
{
	struct cloth cloth;
	uint32_t seed = 3;
	(void)state;
	model_start(&model);
	model.materials[0].albedo_texture = add_texture(&model, 32, 32, false, &cloth);
	for (uint32_t k = 0; k < 1024; k++)
		model.texels[k] = random_bits(&seed);
	model_add_quad(&model, o, x, y, 0);
	model_close(&model, 0.02);
	const uint32_t n = model.elements.count;
	struct radiosity_surface *one = calloc(n, sizeof *one), *two = calloc(n, sizeof *two);
	assert_non_null(one);
	assert_non_null(two);
	assert_int_equal(n, 5000);
	compute(&model, &everything, 1, one);
	compute(&model, &everything, 10000000, two);
	assert_memory_equal(one, two, n * sizeof *one);
	free(one);
	free(two);
	model_finish(&model);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(checkers_have_the_mean_of_their_squares),
	    cmocka_unit_test(gradients_have_the_mean_of_their_bilinear_cells),
	    cmocka_unit_test(noise_emits_its_mean),
	    cmocka_unit_test(vertex_colours_have_the_mean_of_their_triangles),
	    cmocka_unit_test(materials_are_diffuse_or_mirrors),
	    cmocka_unit_test(masks_count_what_is_there),
	    cmocka_unit_test(slices_do_not_matter),
	};
	if (!model_test_begin())
		return 77;
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	return failed + model_test_end();
}
