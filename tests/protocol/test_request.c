// Each rule of a Render, broken alone.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <pb_encode.h>
#include <string.h>

#include "protocol/header.h"
#include "protocol/names.h"
#include "server/front/request.h"

static candil_Render good(void)
{
	candil_Render r = {.scene = "box", .width = 64, .height = 48, .samples = 16};
	r.has_camera = true;
	r.camera.has_eye = r.camera.has_target = r.camera.has_up = true;
	r.camera.eye = (candil_Vec3){1, 2, 3};
	r.camera.up = (candil_Vec3){0, 1, 0};
	r.camera.vfov_degrees = 45;
	return r;
}

static enum status judge(candil_Render r)
{
	struct error err = {.code = STATUS_OK};
	enum status status = request_check_render(&r, &err);
	assert_int_equal(err.code, status);
	if (status != STATUS_OK)
		assert_true(strlen(err.text) > 10);
	return status;
}

// Change one thing of a good request.
#define BROKEN(change) \
	({ \
		candil_Render r = good(); \
		change; \
		judge(r); \
	})

static void a_good_one_passes_with_its_defaults(void **state)
{
	struct error err;
	candil_Render r = {.scene = "box", .width = 1, .height = 1};
	(void)state;
	assert_int_equal(judge(good()), STATUS_OK);
	assert_int_equal(request_check_render(&r, &err), STATUS_OK);
	assert_int_equal(r.samples, 64);
	assert_int_equal(r.progress_ms, 100);
	r = good();
	r.camera.has_up = false;
	assert_int_equal(request_check_render(&r, &err), STATUS_OK);
	assert_true(r.camera.has_up && r.camera.up.y == 1);
}

static void lenses(void **state)
{
	const candil_Lens wide = {.projection = candil_Projection_PROJECTION_ORTHOGRAPHIC, .height = 2};
	const candil_Lens all = {.projection = candil_Projection_PROJECTION_PANORAMA};
	const candil_Lens thin = {.radius = 0.1, .focus = 3};
	(void)state;
	assert_int_equal(BROKEN(r.lens = wide), STATUS_OK);
	assert_int_equal(BROKEN((r.lens = wide, r.camera.vfov_degrees = 0)), STATUS_OK);
	assert_int_equal(BROKEN((r.lens = wide, r.lens.height = 0)), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN((r.lens = wide, r.lens.height = -1)), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN((r.lens = wide, r.lens.height = (double)NAN)), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN((r.lens = wide, r.technique = candil_Technique_TECHNIQUE_DIRECT)), STATUS_OK);
	assert_int_equal(BROKEN((r.lens = all, r.camera.vfov_degrees = 0)), STATUS_OK);
	assert_int_equal(BROKEN((r.lens = all, r.lens.radius = 1, r.lens.focus = 1)), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN((r.lens = all, r.technique = candil_Technique_TECHNIQUE_VCT)), STATUS_UNSUPPORTED);
	assert_int_equal(BROKEN(r.lens = thin), STATUS_OK);
	assert_int_equal(BROKEN((r.lens = thin, r.lens.focus = 0)), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN((r.lens = thin, r.lens.radius = -1)), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN((r.lens = thin, r.lens.radius = (double)INFINITY)), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN((r.lens = thin, r.lens.focus = (double)NAN)), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN((r.lens = thin, r.technique = candil_Technique_TECHNIQUE_DIRECT)), STATUS_UNSUPPORTED);
	assert_int_equal(BROKEN(r.lens.projection = (candil_Projection)9), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.filter = candil_Filter_FILTER_GAUSSIAN), STATUS_OK);
	assert_int_equal(BROKEN(r.filter = (candil_Filter)3), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN((r.filter = candil_Filter_FILTER_GAUSSIAN, r.technique = candil_Technique_TECHNIQUE_VCT)),
			 STATUS_UNSUPPORTED);
}

static void ends(void **state)
{
	struct error err;
	candil_Render open = {.scene = "box", .width = 1, .height = 1, .target_error = 1e-3};
	(void)state;
	assert_int_equal(request_check_render(&open, &err), STATUS_OK);
	assert_int_equal(open.samples, 65536);
	open = (candil_Render){.scene = "box", .width = 1, .height = 1, .deadline_ms = 1, .first_sample = LIMIT_SAMPLES - 3};
	assert_int_equal(request_check_render(&open, &err), STATUS_OK);
	assert_int_equal(open.samples, 3);
	assert_int_equal(BROKEN(r.target_error = -1), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.target_error = (double)NAN), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.target_error = (double)INFINITY), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN((r.target_error = 1, r.technique = candil_Technique_TECHNIQUE_DIRECT)), STATUS_UNSUPPORTED);
	assert_int_equal(BROKEN((r.deadline_ms = 1, r.technique = candil_Technique_TECHNIQUE_DIRECT)), STATUS_OK);
	assert_int_equal(BROKEN(r.deadline_ms = LIMIT_DEADLINE_MS), STATUS_OK);
	assert_int_equal(BROKEN(r.deadline_ms = LIMIT_DEADLINE_MS + 1), STATUS_LIMIT);
}

static void sizes(void **state)
{
	(void)state;
	assert_int_equal(BROKEN(r.width = 0), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.height = 0), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.width = LIMIT_SIDE + 1), STATUS_LIMIT);
	assert_int_equal(BROKEN(r.height = UINT32_MAX), STATUS_LIMIT);
	assert_int_equal(BROKEN(r.width = r.height = LIMIT_SIDE), STATUS_LIMIT);
	assert_int_equal(BROKEN((r.width = LIMIT_SIDE, r.height = LIMIT_PIXELS / LIMIT_SIDE)), STATUS_OK);
	assert_int_equal(BROKEN((r.width = LIMIT_SIDE, r.height = LIMIT_PIXELS / LIMIT_SIDE + 1)), STATUS_LIMIT);
}

static void samples(void **state)
{
	(void)state;
	assert_int_equal(BROKEN(r.samples = LIMIT_SAMPLES), STATUS_OK);
	assert_int_equal(BROKEN(r.samples = LIMIT_SAMPLES + 1), STATUS_LIMIT);
	assert_int_equal(BROKEN(r.first_sample = LIMIT_SAMPLES), STATUS_LIMIT);
	assert_int_equal(BROKEN((r.first_sample = UINT32_MAX, r.samples = UINT32_MAX)), STATUS_LIMIT);
	assert_int_equal(BROKEN((r.width = r.height = 8192, r.samples = 1u << 18)), STATUS_OK);
	assert_int_equal(BROKEN((r.width = r.height = 8192, r.samples = (1u << 18) + 1)), STATUS_LIMIT);
}

static void techniques(void **state)
{
	(void)state;
	assert_int_equal(BROKEN(r.technique = candil_Technique_TECHNIQUE_PT), STATUS_OK);
	assert_int_equal(BROKEN(r.technique = candil_Technique_TECHNIQUE_VCT), STATUS_OK);
	assert_int_equal(BROKEN(r.technique = candil_Technique_TECHNIQUE_RADIOSITY), STATUS_OK);
	assert_int_equal(BROKEN(r.technique = (candil_Technique)77), STATUS_BAD_ARGUMENT);
}

static void cameras(void **state)
{
	const double bad[] = {NAN, INFINITY, -INFINITY, 2 * LIMIT_COORDINATE};
	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		assert_int_equal(BROKEN(r.camera.eye.x = bad[i]), STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN(r.camera.target.y = bad[i]), STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN(r.camera.up.z = bad[i]), STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN(r.camera.vfov_degrees = bad[i]), STATUS_BAD_ARGUMENT);
	}
	assert_int_equal(BROKEN(r.camera.target = r.camera.eye), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.camera.up = (candil_Vec3){0}), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.camera.up = ((candil_Vec3){-2, -4, -6})), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.camera.vfov_degrees = 0), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.camera.vfov_degrees = 180), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.camera.vfov_degrees = -1), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.camera.has_eye = false), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.camera.has_target = false), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.has_camera = false), STATUS_OK);
	assert_int_equal(BROKEN((strcpy(r.camera.name, "Camera"), r.camera.eye.x = NAN)), STATUS_OK);
	assert_int_equal(BROKEN(strcpy(r.camera.name, "a\nb")), STATUS_BAD_ARGUMENT);
}

static void effects_and_outputs(void **state)
{
	(void)state;
	assert_int_equal(BROKEN(r.effects_on = 1u << _candil_Effect_ARRAYSIZE), STATUS_UNSUPPORTED);
	assert_int_equal(BROKEN(r.effects_off = 1u << 31), STATUS_UNSUPPORTED);
	assert_int_equal(BROKEN(r.effects_on = r.effects_off = 2), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN((r.effects_on = 1, r.effects_off = 30)), STATUS_OK);
	assert_int_equal(BROKEN(r.aovs = AOV_ALL), STATUS_OK);
	assert_int_equal(BROKEN(r.aovs = AOV_ALL + 1), STATUS_UNSUPPORTED);
	assert_int_equal(BROKEN((r.aovs = AOV_ID, r.format = candil_Format_FORMAT_PNG)), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.format = (candil_Format)9), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.format = (candil_Format)(candil_Format_FORMAT_MTX + 1)), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.view = (candil_View)9), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.exposure_ev = NAN), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.exposure_ev = -LIMIT_EXPOSURE_EV - 1), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN((r.has_background = true, r.background.x = -1)), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN((r.has_background = true, r.background.y = NAN)), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN((r.has_background = true, r.background.z = 2 * LIMIT_RADIANCE)), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(r.progress_ms = LIMIT_PROGRESS_MS + 1), STATUS_LIMIT);
}

// Whether a file that is no picture may be asked for so.
#define FILE_OF(format_, change) \
	BROKEN(r.technique = candil_Technique_TECHNIQUE_RADIOSITY; r.format = candil_Format_##format_; change)

static void files_of_patches(void **state)
{
	(void)state;
	assert_int_equal(FILE_OF(FORMAT_PLY, r.seed = 1), STATUS_OK);
	assert_int_equal(FILE_OF(FORMAT_MTX, r.samples = 2), STATUS_OK);
	for (unsigned i = 0; i < TECHNIQUE_COUNT; i++)
		if (!(technique_traits(i) & TECHNIQUE_PATCHES))
			assert_int_equal(FILE_OF(FORMAT_PLY, r.technique = (candil_Technique)i), STATUS_UNSUPPORTED);
	assert_int_equal(FILE_OF(FORMAT_PLY, r.aovs = AOV_ID), STATUS_BAD_ARGUMENT);
	assert_int_equal(FILE_OF(FORMAT_MTX, r.progressive = true), STATUS_BAD_ARGUMENT);
	assert_int_equal(FILE_OF(FORMAT_MTX, r.deadline_ms = 1000), STATUS_BAD_ARGUMENT);
}

static enum status with_option(const char *name, const char *value)
{
	candil_Render r = good();
	r.options_count = 1;
	strcpy(r.options[0].name, name);
	strcpy(r.options[0].value, value);
	return judge(r);
}

static void options(void **state)
{
	(void)state;
	assert_int_equal(with_option("pt.depth", "8"), STATUS_OK);
	assert_int_equal(with_option("depth", "8"), STATUS_BAD_ARGUMENT);
	assert_int_equal(with_option("pt.", "8"), STATUS_BAD_ARGUMENT);
	assert_int_equal(with_option("pt.a.b", "8"), STATUS_BAD_ARGUMENT);
	assert_int_equal(with_option("", ""), STATUS_BAD_ARGUMENT);
	assert_int_equal(with_option("pt.sampler", ""), STATUS_BAD_ARGUMENT);
	assert_int_equal(with_option("pt.sampler", "a b"), STATUS_BAD_ARGUMENT);
	candil_Render r = good();
	r.options_count = 2;
	strcpy(r.options[0].name, "pt.depth");
	strcpy(r.options[0].value, "8");
	r.options[1] = r.options[0];
	assert_int_equal(judge(r), STATUS_BAD_ARGUMENT);
}

// A good request with one good edit of each kind.
static candil_Render edited(void)
{
	candil_Render r = good();
	candil_Edits *e = &r.edits;
	r.has_edits = true;
	e->lights_count = e->materials_count = e->nodes_count = 1;
	e->lights[0] = (candil_Light){.kind = candil_LightKind_LIGHT_KIND_SPOT,
				      .has_position = true,
				      .has_direction = true,
				      .direction = {0, -1, 0},
				      .has_intensity = true,
				      .intensity = {1, 1, 1},
				      .outer_degrees = 30};
	e->materials[0] = (candil_MaterialEdit){.name = "wall", .has_metallic = true, .metallic = 1};
	e->nodes[0] = (candil_NodeEdit){.name = "arm", .has_rotation = true, .rotation = {0, 0, 0, 2}};
	return r;
}

#define BROKEN_EDIT(change) \
	({ \
		candil_Render r = edited(); \
		candil_Light *l = &r.edits.lights[0]; \
		candil_MaterialEdit *m = &r.edits.materials[0]; \
		candil_NodeEdit *n = &r.edits.nodes[0]; \
		(void)l, (void)m, (void)n; \
		change; \
		judge(r); \
	})

static void edits(void **state)
{
	const double bad[] = {NAN, INFINITY, -INFINITY, 2 * LIMIT_INTENSITY, -1};
	(void)state;
	assert_int_equal(judge(edited()), STATUS_OK);
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		assert_int_equal(BROKEN_EDIT(l->intensity.y = bad[i]), STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN_EDIT(l->inner_degrees = bad[i]), STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN_EDIT(l->outer_degrees = bad[i]), STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN_EDIT(m->metallic = bad[i]), STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN_EDIT((m->has_roughness = true, m->roughness = bad[i])), STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN_EDIT((m->has_coat = true, m->coat = bad[i])), STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN_EDIT((m->has_coat_roughness = true, m->coat_roughness = bad[i])),
				 STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN_EDIT((m->has_diffuse_roughness = true, m->diffuse_roughness = bad[i])),
				 STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN_EDIT((m->has_base_color = true, m->base_color.x = bad[i])), STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN_EDIT((m->has_emission = true, m->emission.z = bad[i])), STATUS_BAD_ARGUMENT);
	}
	for (size_t i = 0; i < 4; i++) {
		assert_int_equal(BROKEN_EDIT(l->position.x = bad[i]), STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN_EDIT((n->has_translation = true, n->translation.x = bad[i])), STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN_EDIT((n->has_scale = true, n->scale = (candil_Vec3){1, bad[i], 1})),
				 STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN_EDIT(r.edits.time_s = bad[i]), STATUS_BAD_ARGUMENT);
	}
	for (size_t i = 0; i < 3; i++) {
		assert_int_equal(BROKEN_EDIT(l->direction.z = bad[i]), STATUS_BAD_ARGUMENT);
		assert_int_equal(BROKEN_EDIT(n->rotation.w = bad[i]), STATUS_BAD_ARGUMENT);
	}
	assert_int_equal(BROKEN_EDIT(l->kind = (candil_LightKind)3), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN_EDIT(l->direction.y = 0), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN_EDIT(l->has_position = false), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN_EDIT(l->has_direction = false), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN_EDIT(l->has_intensity = false), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN_EDIT(l->outer_degrees = 91), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN_EDIT(l->inner_degrees = 30), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN_EDIT((l->kind = candil_LightKind_LIGHT_KIND_POINT, l->has_direction = false)), STATUS_OK);
	assert_int_equal(BROKEN_EDIT((l->kind = candil_LightKind_LIGHT_KIND_DIRECTIONAL, l->has_position = false)),
			 STATUS_OK);
	assert_int_equal(BROKEN_EDIT(n->rotation.w = 0), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN_EDIT((n->has_scale = true, n->scale = (candil_Vec3){1, 0, 1})), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN_EDIT((n->has_scale = true, n->scale = (candil_Vec3){1, -2, 1})), STATUS_OK);
	assert_int_equal(BROKEN_EDIT(n->name[0] = 0), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN_EDIT(strcpy(m->name, "a\nb")), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN_EDIT(strcpy(r.edits.animation, "\xFF")), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN_EDIT((r.has_edits = false, n->name[0] = 0)), STATUS_OK);
}

static void names(void **state)
{
	(void)state;
	assert_int_equal(BROKEN(r.scene[0] = 0), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(strcpy(r.scene, "a/b")), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(strcpy(r.scene, "\xFF")), STATUS_BAD_ARGUMENT);
	assert_int_equal(BROKEN(strcpy(r.scene, "l\xC3\xA1mpara 1")), STATUS_OK);
}

// ---- the other messages ------------------------------------------------------------------------------------------------

static enum status load(const char *name, const char *path, candil_UpAxis up, double unit)
{
	candil_Load message = {.up = up, .metres_per_unit = unit}, read_back;
	uint8_t body[candil_Load_size];
	struct error err;
	strcpy(message.name, name);
	strcpy(message.path, path);
	pb_ostream_t stream = pb_ostream_from_buffer(body, sizeof body);
	assert_true(pb_encode(&stream, candil_Load_fields, &message));
	enum status status = request_load(body, stream.bytes_written, &read_back, &err);
	if (status == STATUS_OK)
		assert_true(read_back.metres_per_unit > 0);
	return status;
}

static void loads(void **state)
{
	const char *const outside[] = {"", "/etc/x", "..", "a/../b", "./a", "a//b", "a/", "../a", "a/.."};
	(void)state;
	assert_int_equal(load("box", "dir/box.gltf", candil_UpAxis_UP_DEFAULT, 0), STATUS_OK);
	assert_int_equal(load("box", "..a/b..", candil_UpAxis_UP_Z, 0.01), STATUS_OK);
	for (size_t i = 0; i < sizeof outside / sizeof *outside; i++)
		assert_int_equal(load("box", outside[i], candil_UpAxis_UP_DEFAULT, 0), STATUS_SCENE_PATH);
	assert_int_equal(load("", "a", candil_UpAxis_UP_DEFAULT, 0), STATUS_BAD_ARGUMENT);
	assert_int_equal(load("box", "a", (candil_UpAxis)3, 0), STATUS_BAD_ARGUMENT);
	assert_int_equal(load("box", "a", candil_UpAxis_UP_Y, NAN), STATUS_BAD_ARGUMENT);
	assert_int_equal(load("box", "a", candil_UpAxis_UP_Y, -1), STATUS_BAD_ARGUMENT);
	assert_int_equal(load("box", "a", candil_UpAxis_UP_Y, 1e30), STATUS_BAD_ARGUMENT);
}

// Any bytes at all: an answer, never a crash; under the sanitizers this is where one would show.
static void noise_is_refused_or_read(void **state)
{
	uint8_t body[512];
	uint32_t x = 1;
	unsigned refused = 0;
	(void)state;
	for (unsigned round = 0; round < 20000; round++) {
		candil_Render render;
		candil_Load load_message;
		struct error err;
		size_t length = 1 + round % sizeof body;
		for (size_t i = 0; i < length; i++) {
			x = x * 1664525u + 1013904223u;
			body[i] = (uint8_t)(x >> 24);
		}
		refused += request_render(body, length, &render, &err) != STATUS_OK;
		refused += request_load(body, length, &load_message, &err) != STATUS_OK;
	}
	assert_int_equal(refused, 40000); // no noise names a scene
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(a_good_one_passes_with_its_defaults),
	    cmocka_unit_test(sizes),
	    cmocka_unit_test(samples),
	    cmocka_unit_test(techniques),
	    cmocka_unit_test(cameras),
	    cmocka_unit_test(effects_and_outputs),
	    cmocka_unit_test(files_of_patches),
	    cmocka_unit_test(options),
	    cmocka_unit_test(lenses),
	    cmocka_unit_test(ends),
	    cmocka_unit_test(edits),
	    cmocka_unit_test(names),
	    cmocka_unit_test(loads),
	    cmocka_unit_test(noise_is_refused_or_read),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
