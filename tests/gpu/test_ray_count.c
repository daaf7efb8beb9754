// The deferred techniques' count of rays goes beyond 32 bits: one pass over a picture of many lights may.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>
#include <epoxy/gl.h>

#include "server/worker/devices.h"
#include "server/worker/gl/buffer.h"
#include "server/worker/gl/program.h"
#include "server/worker/gl/texture.h"
#include "shaders/gl/sum_comp.h"
#include "shaders/shared/bindings.h"
#include "shaders/shared/deferred.h"
#include "shaders/shared/scene_params.h"

#define SKIPPED 77
#define RAYS 1000003u // of each pixel; a float holds it exactly

static uint64_t held, budget = 64ull << 20;
static struct gl_device *device;
static struct error err;

// The count after `times` sums over one tile, from what `before` holds on.
static uint64_t counted(struct pass_counters before, int times)
{
	static const struct gl_source source = {.name = "sum", .compute = source_sum_comp};
	static const struct gl_defines none;
	const struct gl_texture_desc desc = {
	    .target = GL_TEXTURE_2D, .format = GL_RGBA32F, .width = TILE_SIDE, .height = TILE_SIDE, .depth = 1, .levels = 1};
	const float pixel[4] = {1, 1, 1, RAYS};
	struct gl_texture radiance;
	struct gl_buffer counters, sums;
	struct gl_program *program;
	assert_int_equal(gl_program_get(device, &source, &none, &program, &err), STATUS_OK);
	assert_int_equal(gl_texture_init(&radiance, device, &desc, &err), STATUS_OK);
	assert_int_equal(gl_buffer_init(&counters, device, sizeof before, &before, &err), STATUS_OK);
	assert_int_equal(gl_buffer_init(&sums, device, TILE_PIXELS * ACCUMULATOR_FLOATS * sizeof(float), NULL, &err),
			 STATUS_OK);
	glUseProgram(program->name);
	gl_texture_bind_image(&radiance, DEFERRED_RADIANCE_UNIT, 0, GL_READ_WRITE);
	gl_buffer_bind(&counters, BIND_COUNTERS);
	gl_buffer_bind(&sums, BIND_ACCUMULATOR);
	glUniform4ui(DEFERRED_AREA, 0, TILE_SIDE, 0, 1);
	glUniform4ui(DEFERRED_SAMPLE, 0, 0, 0, TILE_SIDE);
	for (int i = 0; i < times; i++) {
		glClearTexImage(radiance.name, 0, GL_RGBA, GL_FLOAT, pixel);
		glMemoryBarrier(GL_ALL_BARRIER_BITS);
		glDispatchCompute(1, 1, 1);
		glMemoryBarrier(GL_ALL_BARRIER_BITS);
	}
	struct pass_counters after;
	assert_int_equal(gl_buffer_read(&counters, device, 0, sizeof after, &after, &err), STATUS_OK);
	assert_int_equal(after.cut, 0);
	assert_int_equal(after.non_finite, 0);
	gl_texture_finish(&radiance, device);
	gl_buffer_finish(&counters, device);
	gl_buffer_finish(&sums, device);
	return (uint64_t)after.rays_high << 32 | after.rays;
}

static void rays_are_counted(void **state)
{
	(void)state;
	assert_int_equal(counted((struct pass_counters){0}, 1), (uint64_t)TILE_PIXELS * RAYS);
}

static void more_than_32_bits_of_them(void **state)
{
	(void)state;
	const uint64_t tile = (uint64_t)TILE_PIXELS * RAYS;
	assert_int_equal(counted((struct pass_counters){0}, 150), 150 * tile);
	assert_true(150 * tile > UINT32_MAX);
	assert_int_equal(counted((struct pass_counters){.rays = UINT32_MAX, .rays_high = 6}, 1), (7ull << 32) - 1 + tile);
}

int main(void)
{
	const struct gl_device_options options = {.software = true, .bytes = &held, .budget = &budget};
	if (gl_device_create(&options, &device, &err) != STATUS_OK) {
		printf("skipped: %s\n", err.text);
		return SKIPPED;
	}
	const struct CMUnitTest tests[] = {cmocka_unit_test(rays_are_counted), cmocka_unit_test(more_than_32_bits_of_them)};
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	devices_finish(&(struct devices){.gl = device});
	return failed;
}
