// Vulkan pipelines are kept by their constants, no more of them than the limit, and none goes that is in use.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "server/worker/devices.h"
#include "server/worker/vk/pipeline.h"
#include "shaders/error_comp.h"
#include "shaders/shared/pt.h"

#define SKIPPED 77

static struct device *device;
static struct error err;

static const struct shader shader = {.name = "error",
				     .code = shader_error_comp,
				     .bytes = sizeof shader_error_comp,
				     .bindings = BIND_MOST,
				     .push_bytes = sizeof(struct error_push)};

static struct pipeline *pipeline_of(uint32_t constant)
{
	struct pipeline *p = NULL;
	struct constants constants = {0};
	constants_set(&constants, 0, constant);
	assert_int_equal(pipeline_get(device, &shader, &constants, &p, &err), STATUS_OK);
	return p;
}

static unsigned kept(void)
{
	unsigned n = 0;
	for (const struct pipeline *p = device->pipelines; p; p = p->next)
		n++;
	return n;
}

static void they_are_kept_by_their_constants(void **state)
{
	(void)state;
	struct pipeline *two = pipeline_of(2);
	assert_ptr_not_equal(two, pipeline_of(3));
	assert_ptr_equal(two, pipeline_of(2));
}

static void no_more_are_kept_than_the_limit(void **state)
{
	(void)state;
	struct buffer buffer;
	struct binding_set set;
	assert_int_equal(buffer_init(&buffer, device, 64, BUFFER_DEVICE, &err), STATUS_OK);
	const struct buffer *buffers[BIND_MOST] = {&buffer};
	struct pipeline *in_use = pipeline_of(0);
	assert_int_equal(binding_set_init(&set, device, in_use, buffers, &buffer, &err), STATUS_OK);
	pipeline_of(1);
	struct pipeline *often = pipeline_of(2);
	often->warm = true;
	for (uint32_t i = 3; i < PIPELINES_MAX + 20; i++) {
		pipeline_of(i);
		// Nobody holds this one, but it is asked for all the time.
		assert_true(pipeline_of(2)->warm);
		assert_true(kept() <= PIPELINES_MAX);
	}
	assert_int_equal(kept(), PIPELINES_MAX);
	in_use->warm = true;
	assert_true(pipeline_of(0)->warm);
	assert_int_equal(in_use->users, 1);
	binding_set_finish(&set, device);
	assert_int_equal(in_use->users, 0);
	// Now it can go as any other.
	for (uint32_t i = 0; i < PIPELINES_MAX; i++)
		pipeline_of(1000 + i);
	assert_false(pipeline_of(0)->warm);
	buffer_finish(&buffer, device);
	assert_int_equal(atomic_load(&device->validation_errors), 0);
}

static void what_has_no_room_is_refused(void **state)
{
	(void)state;
	struct pipeline *p = NULL;
	struct shader wide = shader;
	wide.bindings = BIND_MOST + 1;
	assert_int_equal(pipeline_get(device, &wide, NULL, &p, &err), STATUS_INTERNAL);
	struct shader texels = shader;
	texels.texels = (1u << (BIND_TEXELS_MOST + 1)) - 1;
	assert_int_equal(pipeline_get(device, &texels, NULL, &p, &err), STATUS_INTERNAL);
	struct constants many = {0};
	for (uint32_t i = 0; i <= PIPELINE_CONSTANTS_MAX; i++)
		constants_set(&many, i, 1);
	assert_int_equal(pipeline_get(device, &shader, &many, &p, &err), STATUS_INTERNAL);
	assert_null(p);
}

int main(void)
{
	const struct device_options options = {0};
	if (device_create(&options, &device, &err) != STATUS_OK) {
		printf("skipped: %s\n", err.text);
		return SKIPPED;
	}
	const struct CMUnitTest tests[] = {cmocka_unit_test(they_are_kept_by_their_constants),
					   cmocka_unit_test(no_more_are_kept_than_the_limit),
					   cmocka_unit_test(what_has_no_room_is_refused)};
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	devices_finish(&(struct devices){.vk = device});
	return failed;
}
