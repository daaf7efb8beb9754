// What voxels hold beside their places: colours; sums that do not overflow; refusals that name the resolution that fits;
// what is kept from job to job; and edited scenes, of which only what moved is voxelised again.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/worker/technique/voxel/voxel_build.h"
#include "tests/gpu/voxel_result.h"

static const double zero[3] = {0, 0, 0};

// ---- colours ---------------------------------------------------------------------------------------------------------

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
	for (int i = 0; i < 1200; i++)
		add_wall(&m, 0, 0);
	model_close(&m);
	struct result r = build(&m, 16);
	uint32_t inner = 0;
	for (uint32_t e = 0; e < r.grid.entries; e++) {
		const double area = real(&r, 2, e, 3);
		assert_true(fabs(real(&r, 1, e, 0) - 1) < 1e-3);
		assert_true(fabs(real(&r, 2, e, 0) - 5) < 5e-3);
		inner += fabs(area - 1200) < 1;
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

static uint64_t variant_key; // of the latest: no two are alike

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
	v->model.scene.keys.geometry = ++variant_key;
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

// The sums of what stays that a build begins with; they are made by then, unless it is the first.
static const struct voxels *fixed_of(struct variant *v, bool first)
{
	const struct voxel_options options = {.resolution = 64};
	struct voxels *a = NULL;
	assert_int_equal(voxels_acquire(&v->model.scene, device, &everything, &options, &a, NULL), STATUS_OK);
	assert_non_null(a->build->fixed);
	assert_int_equal(voxels_finished(a->build->fixed), !first);
	const struct voxels *fixed = a->build->fixed;
	voxels_release(a);
	return fixed;
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
	const struct voxels *fixed = NULL;
	for (int i = 0; i < 5; i++) {
		// Over the wall of what stays, at last: parts of both in the same voxels.
		const double by[3] = {-0.2 * i, 0.05 * i, 0.01 * i};
		variant_init(&v, &base, first, by);
		// What stays is made once.
		assert_true(fixed_of(&v, i == 0) == fixed || i == 0);
		assert_same_as_whole(&v);
		model_finish(&v.model);
		variant_init(&v, &base, first, by);
		fixed = fixed_of(&v, false);
		model_finish(&v.model);
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
	if (!voxel_test_begin())
		return 77;
	const struct CMUnitTest tests[] = {
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
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	return failed + voxel_test_end();
}
