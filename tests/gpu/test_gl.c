// The OpenGL device's parts: what is made is counted and given back, what does not fit is refused whole, a broken shader
// says so, and the driver finds nothing to complain about.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <epoxy/gl.h>

#include "server/worker/devices.h"
#include "server/worker/gl/buffer.h"
#include "server/worker/gl/program.h"
#include "server/worker/gl/texture.h"
#include "server/worker/gl/timer.h"

#define SKIPPED 77
#define BUDGET (64ull << 20)

static uint64_t held;
static uint64_t budget = BUDGET;
static struct gl_device *device;
static struct error err;
static uint64_t mistakes; // that a test made on purpose and the driver counted

static void buffers(void **state)
{
	(void)state;
	const uint32_t data[4] = {1, 2, 3, 4};
	uint32_t back[4] = {9, 9, 9, 9};
	struct gl_buffer b;
	assert_int_equal(gl_buffer_init(&b, device, sizeof data, data, &err), STATUS_OK);
	assert_int_equal(held, sizeof data);
	assert_int_equal(gl_buffer_read(&b, device, 4, 8, back, &err), STATUS_OK);
	assert_int_equal(back[0], 2);
	assert_int_equal(back[1], 3);
	gl_buffer_write(&b, 12, 4, data);
	assert_int_equal(gl_buffer_read(&b, device, 0, sizeof back, back, &err), STATUS_OK);
	assert_int_equal(back[3], 1);
	gl_buffer_clear(&b);
	assert_int_equal(gl_buffer_read(&b, device, 0, sizeof back, back, &err), STATUS_OK);
	for (int i = 0; i < 4; i++)
		assert_int_equal(back[i], 0);
	gl_buffer_finish(&b, device);
	gl_buffer_finish(&b, device);
	assert_int_equal(held, 0);
}

static void fresh_buffers_are_zero(void **state)
{
	(void)state;
	uint32_t back[64];
	struct gl_buffer b;
	memset(back, 1, sizeof back);
	assert_int_equal(gl_buffer_init(&b, device, sizeof back, NULL, &err), STATUS_OK);
	assert_int_equal(gl_buffer_read(&b, device, 0, sizeof back, back, &err), STATUS_OK);
	for (int i = 0; i < 64; i++)
		assert_int_equal(back[i], 0);
	gl_buffer_finish(&b, device);
}

static void textures(void **state)
{
	(void)state;
	const struct gl_texture_desc desc = {
	    .target = GL_TEXTURE_3D, .format = GL_RGBA8, .width = 16, .height = 8, .depth = 4, .levels = 0};
	struct gl_texture t;
	assert_int_equal(gl_texture_bytes(&desc), 4 * (16 * 8 * 4 + 8 * 4 * 2 + 4 * 2 * 1 + 2 * 1 * 1 + 1));
	assert_int_equal(gl_texture_init(&t, device, &desc, &err), STATUS_OK);
	assert_int_equal(t.desc.levels, 5);
	assert_int_equal(held, gl_texture_bytes(&desc));
	uint8_t texels[4 * 16 * 8 * 4];
	memset(texels, 1, sizeof texels);
	glGetTextureImage(t.name, 0, GL_RGBA, GL_UNSIGNED_BYTE, sizeof texels, texels);
	for (size_t i = 0; i < sizeof texels; i++)
		assert_int_equal(texels[i], 0);
	gl_texture_finish(&t, device);
	assert_int_equal(held, 0);
	assert_int_equal(gl_wait(device, "textures", &err), STATUS_OK);
}

static void refusals_leave_nothing(void **state)
{
	(void)state;
	struct gl_buffer b;
	struct gl_texture t;
	const struct gl_texture_desc big = {
	    .target = GL_TEXTURE_2D, .format = GL_RGBA32F, .width = 4096, .height = 4096, .depth = 1, .levels = 1};
	const struct gl_texture_desc wide = {.target = GL_TEXTURE_2D,
					     .format = GL_R8,
					     .width = device->image_side_max + 1,
					     .height = 1,
					     .depth = 1,
					     .levels = 1};
	const struct gl_texture_desc unknown = {
	    .target = GL_TEXTURE_2D, .format = GL_RGB5, .width = 4, .height = 4, .depth = 1, .levels = 1};
	assert_int_equal(gl_buffer_init(&b, device, BUDGET + 1, NULL, &err), STATUS_MEMORY);
	assert_non_null(strstr(err.text, "budget"));
	assert_int_equal(b.name, 0);
	budget = UINT64_MAX;
	assert_int_equal(gl_buffer_init(&b, device, device->storage_bytes_max + 1, NULL, &err), STATUS_MEMORY);
	budget = BUDGET;
	assert_int_equal(gl_texture_init(&t, device, &big, &err), STATUS_MEMORY);
	assert_int_equal(gl_texture_init(&t, device, &wide, &err), STATUS_MEMORY);
	assert_int_equal(gl_texture_init(&t, device, &unknown, &err), STATUS_INTERNAL);
	assert_int_equal(held, 0);
	assert_int_equal(gl_check(device, "refusals", &err), STATUS_OK);
}

static const char doubles[] = "layout(local_size_x = 64) in;\n"
			      "layout(std430, binding = 0) buffer Values { uint values[]; };\n"
			      "void main() { values[gl_GlobalInvocationID.x] *= FACTOR; }\n";
static const struct gl_source source = {.name = "doubles", .compute = doubles};

static struct gl_program *program_of(int factor)
{
	struct gl_defines defines = {0};
	struct gl_program *p = NULL;
	gl_define(&defines, "FACTOR", "%du", factor);
	assert_int_equal(gl_program_get(device, &source, &defines, &p, &err), STATUS_OK);
	return p;
}

static void programs_are_kept_by_their_macros(void **state)
{
	(void)state;
	assert_ptr_equal(program_of(2), program_of(2));
	assert_ptr_not_equal(program_of(2), program_of(3));
	uint32_t values[64];
	struct gl_buffer b;
	for (uint32_t i = 0; i < 64; i++)
		values[i] = i;
	assert_int_equal(gl_buffer_init(&b, device, sizeof values, values, &err), STATUS_OK);
	gl_buffer_bind(&b, 0);
	glUseProgram(program_of(2)->name);
	glDispatchCompute(1, 1, 1);
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
	glUseProgram(program_of(3)->name);
	glDispatchCompute(1, 1, 1);
	assert_int_equal(gl_buffer_read(&b, device, 0, sizeof values, values, &err), STATUS_OK);
	for (uint32_t i = 0; i < 64; i++)
		assert_int_equal(values[i], 6 * i);
	gl_buffer_finish(&b, device);
}

static void no_more_programs_are_kept_than_the_limit(void **state)
{
	(void)state;
	struct gl_program *held_on = program_of(2);
	gl_program_hold(held_on);
	for (int i = 0; i < (int)GL_PROGRAMS_MAX + 20; i++)
		program_of(100 + i);
	unsigned count = 0, found = 0;
	for (const struct gl_program *p = device->programs; p; p = p->next, count++)
		found += p == held_on;
	assert_int_equal(count, GL_PROGRAMS_MAX);
	assert_int_equal(found, 1);
	assert_true(glIsProgram(held_on->name));
	gl_program_release(held_on);
}

static void broken_programs_say_so(void **state)
{
	(void)state;
	static const struct gl_source broken = {.name = "broken", .compute = "void main() { nonsense; }\n"};
	struct gl_defines defines = {0};
	struct gl_program *p = NULL;
	assert_int_equal(gl_program_get(device, &broken, &defines, &p, &err), STATUS_INTERNAL);
	assert_non_null(strstr(err.text, "broken"));
	// Mesa tells of it, others need not.
	mistakes = device->errors;
	for (int i = 0; i < 200; i++)
		gl_define(&defines, "MANY", "%d", i);
	assert_true(defines.full);
	assert_int_equal(gl_program_get(device, &source, &defines, &p, &err), STATUS_INTERNAL);
	assert_int_equal(gl_check(device, "a broken program", &err), STATUS_OK);
}

static void timers_count_passes(void **state)
{
	(void)state;
	struct gl_timer timer;
	struct gl_buffer b;
	assert_int_equal(gl_buffer_init(&b, device, 1u << 22, NULL, &err), STATUS_OK);
	gl_buffer_bind(&b, 0);
	gl_timer_init(&timer);
	glUseProgram(program_of(2)->name);
	for (uint32_t i = 0; i < 2 * GL_TIMER_PENDING; i++) {
		gl_timer_begin(&timer, i % 2 ? "odd" : "even");
		glDispatchCompute((1u << 20) / 64, 1, 1);
		gl_timer_end(&timer);
	}
	gl_timer_collect(&timer);
	assert_int_equal(timer.stage_count, 2);
	assert_string_equal(timer.stages[0].name, "even");
	assert_int_equal(timer.stages[0].passes, GL_TIMER_PENDING);
	assert_int_equal(timer.stages[1].passes, GL_TIMER_PENDING);
	// A million products take some time on any device.
	assert_true(timer.stages[0].us > 0);
	gl_timer_finish(&timer);
	gl_buffer_finish(&b, device);
}

static void the_driver_is_content(void **state)
{
	(void)state;
	assert_int_equal(held, 0);
	assert_int_equal(device->errors, mistakes);
	assert_false(device->lost);
	// And would have said so: a deliberate mistake is counted.
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1u << 20, 0);
	assert_int_equal(gl_check(device, "a mistake", &err), STATUS_DEVICE);
	assert_int_equal(device->errors, mistakes + 1);
}

int main(void)
{
	const struct gl_device_options options = {.software = true, .bytes = &held, .budget = &budget};
	setenv("CANDIL_VALIDATION", "1", 1);
	if (gl_device_create(&options, &device, &err) != STATUS_OK) {
		printf("skipped: %s\n", err.text);
		return SKIPPED;
	}
	const struct CMUnitTest tests[] = {cmocka_unit_test(buffers),
					   cmocka_unit_test(fresh_buffers_are_zero),
					   cmocka_unit_test(textures),
					   cmocka_unit_test(refusals_leave_nothing),
					   cmocka_unit_test(programs_are_kept_by_their_macros),
					   cmocka_unit_test(no_more_programs_are_kept_than_the_limit),
					   cmocka_unit_test(broken_programs_say_so),
					   cmocka_unit_test(timers_count_passes),
					   cmocka_unit_test(the_driver_is_content)};
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	devices_finish(&(struct devices){.gl = device});
	return failed;
}
