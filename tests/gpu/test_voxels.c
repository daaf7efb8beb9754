// Voxels against a reference in double precision: which (cell, layer) pairs are occupied, and the area, the projections and
// the mean place of what is in each; nothing lost; the same bits in any order of the triangles and of the slices; sums that
// do not overflow; refusals that name the resolution that fits.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/worker/technique/voxels.h"
#include "tests/gpu/voxel_model.h"

#define MARGIN 1e-3 // voxels: what is nearer to a cell's face than this may be in it or not

static uint64_t device_bytes, device_budget = 1ull << 32;
static struct gl_device *device;

static const double zero[3] = {0, 0, 0};

// What one build left, on the host.
struct result {
	struct voxel_grid grid;
	uint32_t words;
	uint32_t *bits; // two a word: bits, entries before them
	uint32_t *parts[VOXEL_PARTS]; // four words an entry
	uint64_t bytes;
};

static void *read_all(const struct gl_buffer *b)
{
	void *p = malloc(b->bytes + 4);
	assert_non_null(p);
	if (b->name)
		assert_int_equal(gl_buffer_read(b, device, 0, b->bytes, p, NULL), STATUS_OK);
	return p;
}

static const struct plan everything = {.effects = 0xFFFFFFFF, .width = 1, .height = 1};

static enum status try_build(struct model *m, uint32_t resolution, bool cube, uint32_t slice_us, struct result *r,
			     struct error *err)
{
	const struct voxel_options options = {.resolution = resolution, .cube = cube};
	struct voxels *v = NULL;
	enum status s = voxels_acquire(&m->scene, device, &everything, &options, &v, err);
	if (s != STATUS_OK)
		return s;
	while (s == STATUS_OK && !voxels_finished(v))
		s = voxels_step(v, NULL, slice_us, err);
	if (s == STATUS_OK) {
		*r = (struct result){.grid = v->grid, .words = voxel_grid_words(&v->grid), .bytes = voxels_bytes(v)};
		r->bits = read_all(&v->words);
		for (int i = 0; i < VOXEL_PARTS; i++)
			r->parts[i] = read_all(&v->parts[i]);
	}
	voxels_release(v);
	return s;
}

static struct result build(struct model *m, uint32_t resolution)
{
	struct error err = {0};
	struct result r = {0};
	if (try_build(m, resolution, false, 1000000, &r, &err) != STATUS_OK)
		fail_msg("%s", err.text);
	return r;
}

static void result_finish(struct result *r)
{
	free(r->bits);
	for (int i = 0; i < VOXEL_PARTS; i++)
		free(r->parts[i]);
}

static bool is_marked(const struct result *r, uint32_t bit)
{
	return r->bits[bit / 32 * 2] >> bit % 32 & 1u;
}

static uint32_t entry_of(const struct result *r, uint32_t bit)
{
	return r->bits[bit / 32 * 2 + 1] + (uint32_t)__builtin_popcount(r->bits[bit / 32 * 2] & ((1u << bit % 32) - 1));
}

static double real(const struct result *r, int part, uint32_t entry, int c)
{
	float f;
	memcpy(&f, &r->parts[part][4 * entry + (uint32_t)c], sizeof f);
	return (double)f;
}

static double half_to_double(uint32_t h)
{
	const int exponent = (int)(h >> 10 & 31u);
	const double fraction = (h & 1023u) / 1024.0,
		     value = exponent ? ldexp(1 + fraction, exponent - 15) : ldexp(fraction, -14);
	return h & 0x8000u ? -value : value;
}

static double projection(const struct result *r, uint32_t entry, int axis, int negative)
{
	return half_to_double(r->parts[3][4 * entry + (uint32_t)axis] >> 16 * negative & 0xFFFFu);
}

static double area_of(const struct result *r)
{
	double sum = 0;
	for (uint32_t e = 0; e < r->grid.entries; e++)
		sum += real(r, 2, e, 3);
	return sum;
}

// ---- against the reference -------------------------------------------------------------------------------------------

struct tally {
	uint32_t lost, extra, wrong_bit;
	double area_error, projection_error, place_error; // largest
	double area, expected_area;
};

static void compare_entry(const struct result *r, const struct expected *x, uint32_t bit, struct tally *t)
{
	const uint32_t e = entry_of(r, bit);
	const double area = real(r, 2, e, 3);
	t->wrong_bit += r->parts[1][4 * e + 3] != bit;
	t->area += area;
	t->area_error = fmax(t->area_error, fabs(area - x->area) / (1e-2 + x->area));
	for (int c = 0; c < 3; c++) {
		const double plus = projection(r, e, c, 0), minus = projection(r, e, c, 1);
		t->projection_error = fmax(t->projection_error, fabs(plus - x->plus[c]) / (1e-2 + x->plus[c]));
		t->projection_error = fmax(t->projection_error, fabs(minus - x->minus[c]) / (1e-2 + x->minus[c]));
		if (x->area < 1e-3)
			continue;
		const double place = (real(r, 0, e, c) - (double)r->grid.low[c]) / (double)r->grid.side;
		t->place_error = fmax(t->place_error, fabs(place - x->place[c] / x->area));
	}
}

static struct tally compare(const struct model *m, const struct result *r)
{
	struct expected *all = model_expect(m, &r->grid, MARGIN);
	struct tally t = {0};
	for (uint32_t bit = 0; bit < 32 * r->words; bit++) {
		const struct expected *x = &all[bit];
		const bool marked = is_marked(r, bit);
		t.lost += x->must && !marked;
		t.lost += bit % 2 == 0 && x->must_either && !marked && !is_marked(r, bit + 1);
		t.extra += marked && !x->may;
		t.expected_area += x->area;
		if (marked)
			compare_entry(r, x, bit, &t);
	}
	free(all);
	return t;
}

// `places`: how far off the means of places may be, in voxels.
static void assert_as_expected(struct model *m, uint32_t resolution, const char *what, double places)
{
	struct result r = build(m, resolution);
	const struct tally t = compare(m, &r);
	print_message(
	    "%s: %u triangles at %u, %u entries, %llu KiB; area %.6g of %.6g; largest errors: area %.1e, projections %.1e, "
	    "places %.1e voxels\n",
	    what, m->triangle_count, resolution, r.grid.entries, (unsigned long long)r.bytes >> 10, t.area, t.expected_area,
	    t.area_error, t.projection_error, t.place_error);
	assert_int_equal(t.lost, 0);
	assert_int_equal(t.extra, 0);
	assert_int_equal(t.wrong_bit, 0);
	assert_true(t.area_error < 2e-3);
	assert_true(t.projection_error < 3e-3);
	assert_true(t.place_error < places);
	assert_true(fabs(t.area - t.expected_area) <= 1e-3 * t.expected_area + 1e-5);
	result_finish(&r);
}

static uint64_t random_state = 1;

static double random_unit(void)
{
	random_state = random_state * 6364136223846793005ull + 1442695040888963407ull;
	return (double)(random_state >> 40) / 16777216.0;
}

static void random_point(double p[3], const double middle[3], double reach)
{
	for (int c = 0; c < 3; c++)
		p[c] = middle[c] + reach * (2 * random_unit() - 1);
}

// Triangles of all sizes, from a thousandth of a voxel to the whole scene.
static void add_random(struct model *m, uint32_t count)
{
	random_state = 1;
	for (uint32_t i = 0; i < count; i++) {
		double middle[3], v[3][3];
		random_point(middle, zero, 0.9);
		const double size = i % 50 == 0 ? 1.0 : pow(10, -4.5 + 3.5 * random_unit());
		for (int k = 0; k < 3; k++)
			random_point(v[k], middle, size);
		model_add(m, v[0], v[1], v[2], 0);
	}
}

static void test_random_triangles_fill_what_they_overlap(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	add_random(&m, 2000);
	model_close(&m);
	assert_as_expected(&m, 64, "random", 0.01);
	model_finish(&m);
}

static void test_spheres_have_their_area(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	model_add_sphere(&m, zero, 1, 32, 0);
	model_add_sphere(&m, (const double[3]){0.1, 0.2, -0.05}, 0.3, 8, 0);
	model_close(&m);
	assert_as_expected(&m, 64, "spheres", 0.01);
	assert_as_expected(&m, 16, "spheres", 0.01);
	model_finish(&m);
}

static void test_flat_and_aligned_scenes_lie_in_one_layer_of_cells(void **state)
{
	(void)state;
	for (int axis = 0; axis < 3; axis++) {
		struct model m;
		double u[3] = {0}, v[3] = {0};
		model_init(&m);
		u[(axis + 1) % 3] = 1;
		v[(axis + 2) % 3] = 0.5;
		model_add_quad(&m, zero, u, v, 0);
		model_close(&m);
		assert_as_expected(&m, 64, "flat", 1e-4);
		struct result r = build(&m, 64);
		// 61.25 by 30.625 voxels: one layer of cells, one side.
		assert_in_range(r.grid.entries, 61 * 31, 63 * 33);
		for (uint32_t e = 0; e < r.grid.entries; e++)
			assert_true(projection(&r, e, axis, 1) == 0.0);
		result_finish(&r);
		model_finish(&m);
	}
}

static void test_needles_and_points_are_not_lost(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	model_add(&m, zero, (const double[3]){1, 0.7, 0.4}, (const double[3]){1, 0.700001, 0.4}, 0);
	model_add(&m, (const double[3]){0, 0.5, 0}, (const double[3]){1, 0.5, 0}, (const double[3]){0.5, 0.5, 1e-6}, 0);
	model_add(&m, (const double[3]){0.2, 0.1, 0}, (const double[3]){0.9, 0.1, 0.33}, (const double[3]){0.9, 0.1, 0.33},
		  0);
	model_add(&m, (const double[3]){0.3, 0.2, 0.1}, (const double[3]){0.3, 0.2, 0.1}, (const double[3]){0.3, 0.2, 0.1},
		  0);
	model_add(&m, (const double[3]){0, 0.9, 0}, (const double[3]){1, 0.91, 0.3}, (const double[3]){0.4, 0.9041, 0.1201},
		  0);
	model_close(&m);
	assert_as_expected(&m, 64, "needles", 0.01);
	assert_as_expected(&m, 128, "needles", 0.01);
	model_finish(&m);
	// Each alone, too: a scene of one point has a grid.
	model_init(&m);
	model_add(&m, (const double[3]){3, 3, 3}, (const double[3]){3, 3, 3}, (const double[3]){3, 3, 3}, 0);
	model_close(&m);
	struct result r = build(&m, 64);
	assert_int_equal(r.grid.entries, 1);
	result_finish(&r);
	model_finish(&m);
}

static void test_an_empty_scene_has_no_entries(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	model_close(&m);
	struct result r = build(&m, 64);
	assert_int_equal(r.grid.entries, 0);
	for (uint32_t i = 0; i < r.words; i++)
		assert_int_equal(r.bits[2 * i], 0);
	result_finish(&r);
	model_finish(&m);
}

// ---- the same bits ---------------------------------------------------------------------------------------------------

static void assert_same(const struct result *a, const struct result *b, bool places)
{
	assert_int_equal(a->grid.entries, b->grid.entries);
	assert_memory_equal(a->bits, b->bits, 8 * a->words);
	for (int i = places ? 0 : 1; i < VOXEL_PARTS; i++)
		assert_memory_equal(a->parts[i], b->parts[i], 16 * (size_t)a->grid.entries);
}

static void test_order_and_slices_change_no_bit(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	add_random(&m, 3000);
	model_add_sphere(&m, zero, 0.5, 24, 1);
	for (int c = 0; c < 3; c++)
		m.materials[1].emission[c] = 10.0f * (float)(c + 1);
	model_close(&m);
	struct result once = build(&m, 64);
	for (uint32_t i = m.triangle_count - 1; i > 0; i--) {
		const uint32_t j = (uint32_t)(random_unit() * (i + 1));
		const struct triangle t = m.triangles[i];
		m.triangles[i] = m.triangles[j];
		m.triangles[j] = t;
	}
	while (m.scene.derived) {
		struct derived *d = m.scene.derived;
		m.scene.derived = d->next;
		d->destroy(d);
	}
	struct result again = {0};
	assert_int_equal(try_build(&m, 64, false, 1, &again, NULL), STATUS_OK);
	assert_same(&once, &again, true);
	result_finish(&once);
	result_finish(&again);
	model_finish(&m);
}

static void scaled(struct model *m, double scale, double offset)
{
	model_init(m);
	const double middle[3] = {offset, offset, offset};
	model_add_sphere(m, middle, scale, 16, 0);
	model_add_quad(m, (const double[3]){offset - scale, offset - 0.5 * scale, offset},
		       (const double[3]){2 * scale, 0, 0}, (const double[3]){0, 0.25 * scale, 0.5 * scale}, 0);
	model_close(m);
}

static void test_scale_and_offset_change_nothing(void **state)
{
	(void)state;
	struct model m;
	scaled(&m, 1, 0);
	struct result one = build(&m, 64);
	model_finish(&m);
	// A power of two scales every number exactly: all but the places are the same bits.
	for (int power = -20; power <= 20; power += 20) {
		scaled(&m, ldexp(1, power), 0);
		struct result r = build(&m, 64);
		assert_same(&one, &r, false);
		result_finish(&r);
		model_finish(&m);
	}
	const double scales[] = {1e-3, 1e6, 1e12, 1e-12};
	for (unsigned i = 0; i < sizeof scales / sizeof *scales; i++) {
		scaled(&m, scales[i], 0);
		struct result r = build(&m, 64);
		assert_true(fabs(area_of(&r) - area_of(&one)) < 1e-4 * area_of(&one));
		assert_true(abs((int)r.grid.entries - (int)one.grid.entries) <= (int)one.grid.entries / 500);
		result_finish(&r);
		model_finish(&m);
	}
	// Far away a float's steps are 1/128 here, and a voxel is 1/30: the surface is as rough as its corners.
	scaled(&m, 1, 1e5);
	assert_as_expected(&m, 64, "far", 0.25);
	model_finish(&m);
	result_finish(&one);
}

static void test_a_cube_holds_the_same_voxels(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	model_add_sphere(&m, zero, 1, 12, 0);
	for (uint32_t i = 0; i < m.vertex_count; i++)
		m.vertices[i].position[1] *= 0.2f;
	model_close(&m);
	struct result fitted = build(&m, 64), cube = {0};
	assert_int_equal(try_build(&m, 64, true, 1000000, &cube, NULL), STATUS_OK);
	assert_int_equal(fitted.grid.sides[1], 16);
	assert_int_equal(cube.grid.sides[1], 64);
	assert_int_equal(fitted.grid.entries, cube.grid.entries);
	for (int i = 0; i < VOXEL_PARTS; i++)
		for (uint32_t e = 0; e < fitted.grid.entries; e++)
			if (i != 0)
				assert_memory_equal(&fitted.parts[i][4 * e], &cube.parts[i][4 * e], i == 1 ? 12 : 16);
	result_finish(&fitted);
	result_finish(&cube);
	model_finish(&m);
}

// ---- colours ---------------------------------------------------------------------------------------------------------

static void add_wall(struct model *m, double z, uint32_t material)
{
	model_add_quad(m, (const double[3]){-1, -1, z}, (const double[3]){2, 0, 0}, (const double[3]){0, 2, 0}, material);
}

static void test_colours_are_weighted_by_area(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	for (int c = 0; c < 3; c++) {
		m.materials[0].albedo[c] = 0.25f * (float)(c + 1);
		m.materials[1].albedo[c] = 0.0f;
		m.materials[1].emission[c] = 3e4f * (float)(c + 1);
		m.materials[2].emission[c] = 1e-2f;
		m.materials[3].albedo[c] = 0.5f;
		m.materials[3].metallic = 1;
	}
	add_wall(&m, -0.5, 0);
	add_wall(&m, 0.0, 1);
	add_wall(&m, 0.25, 2);
	add_wall(&m, 0.5, 3);
	model_close(&m);
	struct result r = build(&m, 32);
	uint32_t seen[4] = {0};
	for (uint32_t e = 0; e < r.grid.entries; e++) {
		const double z = real(&r, 0, e, 2);
		const int wall = z < -0.4 ? 0 : z < 0.1 ? 1 : z < 0.4 ? 2 : 3;
		seen[wall]++;
		for (int c = 0; c < 3; c++) {
			const double albedo = wall == 0 ? 0.25 * (c + 1) : wall == 1 ? 0 : wall == 2 ? 1 : 0.5 + 0.5 / 21;
			const double emission = wall == 1 ? 3e4 * (c + 1) : wall == 2 ? 1e-2 : 0;
			assert_true(fabs(real(&r, 1, e, c) - albedo) < 1e-4);
			// Within 2⁻²⁸ of the brightest, by the area that there is.
			assert_true(fabs(real(&r, 2, e, c) - emission) * real(&r, 2, e, 3) <=
				    1e-4 * emission + 9e4 * 0x1p-27);
		}
	}
	for (int i = 0; i < 4; i++)
		assert_in_range(seen[i], 29 * 29, 32 * 32);
	result_finish(&r);
	model_finish(&m);
}

static void test_textures_finer_than_voxels_are_averaged(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	// 8 × 8 texels in turn black and white, repeated every tenth of the wall: a voxel has several times that.
	m.texture = (struct texture_info){.width = 8, .height = 8, .row_u = {10, 0, 0.013f}, .row_v = {0, 10, 0.027f}};
	for (uint32_t i = 0; i < 64; i++)
		m.texels[i] = (i + i / 8) % 2 ? 0xFFFFFFFFu : 0xFF000000u;
	m.materials[0].albedo_texture = 0;
	add_wall(&m, 0, 0);
	model_close(&m);
	struct result r = build(&m, 16);
	double mean = 0;
	for (uint32_t e = 0; e < r.grid.entries; e++)
		mean += real(&r, 1, e, 0) / r.grid.entries;
	assert_true(fabs(mean - 0.5) < 0.05);
	result_finish(&r);
	model_finish(&m);
}

static void test_cut_out_parts_weigh_nothing(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	// The left half of the picture is cut out: three quarters of the triangle, u being 1 at its second corner.
	m.texture =
	    (struct texture_info){.width = 2, .height = 1, .row_u = {1, 0, 0}, .row_v = {0, 1, 0}, .flags = TEXTURE_NEAREST};
	m.texels[0] = 0x00FFFFFFu;
	m.texels[1] = 0xFFFFFFFFu;
	m.materials[0].albedo_texture = 0;
	m.materials[0].flags = MATERIAL_ALPHA_MASK;
	m.materials[0].alpha_cutoff = 0.5f;
	model_add(&m, zero, (const double[3]){1, 0, 0}, (const double[3]){0, 1, 0}, 0);
	model_close(&m);
	struct result r = build(&m, 64);
	const double whole = 0.5 / ((double)r.grid.side * (double)r.grid.side);
	assert_true(fabs(area_of(&r) - whole / 4) < 0.03 * whole);
	result_finish(&r);
	model_finish(&m);
}

// ---- limits ----------------------------------------------------------------------------------------------------------

static void test_no_sum_overflows(void **state)
{
	(void)state;
	struct model m;
	model_init(&m);
	m.materials[0].emission[0] = 5;
	for (int i = 0; i < 4000; i++)
		add_wall(&m, 0, 0);
	model_close(&m);
	struct result r = build(&m, 16);
	uint32_t inner = 0;
	for (uint32_t e = 0; e < r.grid.entries; e++) {
		const double area = real(&r, 2, e, 3);
		assert_true(fabs(real(&r, 1, e, 0) - 1) < 1e-3);
		assert_true(fabs(real(&r, 2, e, 0) - 5) < 5e-3);
		inner += fabs(area - 4000) < 1;
	}
	assert_in_range(inner, 12 * 12, 14 * 14);
	result_finish(&r);
	model_finish(&m);
}

static void test_too_little_memory_is_refused_with_what_fits(void **state)
{
	(void)state;
	struct model m;
	struct error err = {0};
	struct result r = {0};
	model_init(&m);
	model_add_sphere(&m, zero, 1, 32, 0);
	model_close(&m);
	const uint64_t before = device_bytes;
	device_budget = before + (8u << 20);
	assert_int_equal(try_build(&m, 512, false, 1000000, &r, &err), STATUS_MEMORY);
	print_message("%s\n", err.text);
	assert_non_null(strstr(err.text, "resolution 128 would fit"));
	assert_int_equal(try_build(&m, 128, false, 1000000, &r, &err), STATUS_OK);
	result_finish(&r);
	// The masks fit, what they count does not.
	model_finish(&m);
	assert_int_equal(device_bytes, before);
	model_init(&m);
	random_state = 1;
	for (int i = 0; i < 60; i++)
		add_wall(&m, -1 + i / 30.0, 0);
	model_close(&m);
	device_budget = before + (20u << 20);
	assert_int_equal(try_build(&m, 128, false, 1000000, &r, &err), STATUS_MEMORY);
	print_message("%s\n", err.text);
	assert_non_null(strstr(err.text, "resolution 64 would fit"));
	assert_int_equal(try_build(&m, 64, false, 1000000, &r, &err), STATUS_OK);
	result_finish(&r);
	model_finish(&m);
	assert_int_equal(device_bytes, before);
	device_budget = 1ull << 32;
}

static void test_voxels_are_kept_for_the_next_job(void **state)
{
	(void)state;
	struct model m;
	const struct voxel_options options = {.resolution = 32}, other = {.resolution = 64};
	struct voxels *a = NULL, *b = NULL, *c = NULL;
	model_init(&m);
	model_add_sphere(&m, zero, 1, 8, 0);
	model_close(&m);
	assert_int_equal(voxels_acquire(&m.scene, device, &everything, &options, &a, NULL), STATUS_OK);
	// Two jobs at once share what is being made.
	assert_int_equal(voxels_acquire(&m.scene, device, &everything, &options, &b, NULL), STATUS_OK);
	assert_ptr_equal(a, b);
	while (!voxels_finished(a))
		assert_int_equal(voxels_step(a, NULL, 100, NULL), STATUS_OK);
	voxels_release(a);
	voxels_release(b);
	assert_int_equal(voxels_acquire(&m.scene, device, &everything, &options, &c, NULL), STATUS_OK);
	assert_ptr_equal(a, c);
	assert_true(voxels_finished(c));
	const uint64_t held = device_bytes;
	// One that is left half-way is not kept.
	assert_int_equal(voxels_acquire(&m.scene, device, &everything, &other, &b, NULL), STATUS_OK);
	assert_int_equal(voxels_step(b, NULL, 1, NULL), STATUS_OK);
	voxels_release(b);
	assert_int_equal(device_bytes, held);
	voxels_release(c);
	model_finish(&m);
}

// ---- edited scenes ---------------------------------------------------------------------------------------------------

// A scene in which something moved, over its base: a resident scene's variant as edit.h makes one.
struct variant {
	struct model model; // owns the moved vertices
	struct scene_move move;
};

static void variant_init(struct variant *v, struct model *base, uint32_t first, const double by[3])
{
	v->model = *base;
	v->model.scene.derived = NULL;
	v->model.vertices = malloc(base->vertex_count * sizeof *base->vertices);
	v->model.triangles = malloc(base->triangle_count * sizeof *base->triangles);
	assert_non_null(v->model.vertices);
	assert_non_null(v->model.triangles);
	memcpy(v->model.vertices, base->vertices, base->vertex_count * sizeof *base->vertices);
	memcpy(v->model.triangles, base->triangles, base->triangle_count * sizeof *base->triangles);
	for (uint32_t i = 3 * first; i < base->vertex_count; i++)
		for (int c = 0; c < 3; c++)
			v->model.vertices[i].position[c] += (float)by[c];
	v->move = (struct scene_move){.first_triangle = first, .triangle_count = base->triangle_count - first};
	model_close(&v->model);
	v->model.scene.base = &base->scene;
	v->model.scene.edited.moves = &v->move;
	v->model.scene.edited.move_count = 1;
	v->model.scene.keys.geometry = 1;
}

static void assert_same_as_whole(struct variant *v)
{
	struct result merged = build(&v->model, 64);
	struct model whole = v->model;
	whole.scene.base = NULL;
	whole.scene.derived = NULL;
	struct result all = build(&whole, 64);
	assert_same(&merged, &all, true);
	result_finish(&merged);
	result_finish(&all);
	whole.vertices = NULL;
	whole.triangles = NULL;
	model_finish(&whole);
}

static void test_what_moved_is_voxelised_alone(void **state)
{
	(void)state;
	struct model base;
	struct variant v;
	model_init(&base);
	for (int c = 0; c < 3; c++) {
		base.materials[1].albedo[c] = 0.2f * (float)(c + 1);
		base.materials[1].emission[c] = 3.0f * (float)(c + 1);
	}
	model_add_sphere(&base, zero, 1, 24, 0);
	const uint32_t first = base.triangle_count;
	model_add_sphere(&base, (const double[3]){0.3, 0, 0}, 0.4, 12, 1);
	model_close(&base);
	struct result before = build(&base, 64);
	const uint64_t held = device_bytes;
	uint64_t after = 0;
	for (int i = 0; i < 5; i++) {
		// Over the wall of what stays, at last: parts of both in the same voxels.
		const double by[3] = {-0.2 * i, 0.05 * i, 0.01 * i};
		variant_init(&v, &base, first, by);
		assert_same_as_whole(&v);
		model_finish(&v.model);
		// What stays is made once.
		assert_true(i < 1 || device_bytes == after);
		after = device_bytes;
		assert_true(after > held);
	}
	// The base is as it was.
	struct result now = build(&base, 64);
	assert_same(&before, &now, true);
	result_finish(&before);
	result_finish(&now);
	model_finish(&base);
}

static void test_sums_that_moved_parts_would_overflow_are_made_anew(void **state)
{
	(void)state;
	struct model base;
	struct variant v;
	model_init(&base);
	for (int i = 0; i < 900; i++)
		add_wall(&base, -0.5, 0);
	add_wall(&base, 0.5, 0); // the bounds stay
	const uint32_t first = base.triangle_count;
	for (int i = 0; i < 200; i++)
		add_wall(&base, 0.5, 0);
	model_close(&base);
	variant_init(&v, &base, first, (const double[3]){0, 0, -1});
	assert_same_as_whole(&v);
	model_finish(&v.model);
	model_finish(&base);
}

static void test_a_lost_build_takes_nothing_with_it(void **state)
{
	(void)state;
	struct model base;
	struct variant v;
	const struct voxel_options options = {.resolution = 64};
	struct voxels *a = NULL;
	model_init(&base);
	model_add_sphere(&base, zero, 1, 24, 0);
	const uint32_t first = base.triangle_count;
	model_add_sphere(&base, (const double[3]){0.3, 0, 0}, 0.4, 12, 1);
	model_close(&base);
	const uint64_t held = device_bytes;
	for (int steps = 0; steps < 12; steps += 3) {
		variant_init(&v, &base, first, (const double[3]){0.1, 0, 0});
		assert_int_equal(voxels_acquire(&v.model.scene, device, &everything, &options, &a, NULL), STATUS_OK);
		for (int i = 0; i < steps; i++)
			assert_int_equal(voxels_step(a, NULL, 1, NULL), STATUS_OK);
		voxels_release(a);
		model_finish(&v.model);
	}
	model_finish(&base);
	assert_int_equal(device_bytes, held);
}

int main(void)
{
	const struct gl_device_options options = {.software = true, .bytes = &device_bytes, .budget = &device_budget};
	struct error err;
	if (gl_device_create(&options, &device, &err) != STATUS_OK) {
		print_message("skipped: %s\n", err.text);
		return 77;
	}
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_random_triangles_fill_what_they_overlap),
	    cmocka_unit_test(test_spheres_have_their_area),
	    cmocka_unit_test(test_flat_and_aligned_scenes_lie_in_one_layer_of_cells),
	    cmocka_unit_test(test_needles_and_points_are_not_lost),
	    cmocka_unit_test(test_an_empty_scene_has_no_entries),
	    cmocka_unit_test(test_order_and_slices_change_no_bit),
	    cmocka_unit_test(test_scale_and_offset_change_nothing),
	    cmocka_unit_test(test_a_cube_holds_the_same_voxels),
	    cmocka_unit_test(test_colours_are_weighted_by_area),
	    cmocka_unit_test(test_textures_finer_than_voxels_are_averaged),
	    cmocka_unit_test(test_cut_out_parts_weigh_nothing),
	    cmocka_unit_test(test_no_sum_overflows),
	    cmocka_unit_test(test_too_little_memory_is_refused_with_what_fits),
	    cmocka_unit_test(test_voxels_are_kept_for_the_next_job),
	    cmocka_unit_test(test_what_moved_is_voxelised_alone),
	    cmocka_unit_test(test_sums_that_moved_parts_would_overflow_are_made_anew),
	    cmocka_unit_test(test_a_lost_build_takes_nothing_with_it),
	};
	int failed = cmocka_run_group_tests(tests, NULL, NULL);
	failed += device->errors > 0;
	gl_device_destroy(device);
	return failed + (device_bytes != 0);
}
