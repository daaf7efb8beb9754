// Voxels' light by rays where the device has no room for a while: a call that is repeated counts no bounce twice.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/worker/devices.h"
#include "server/worker/gl/settle.h"
#include "server/worker/technique/vct/vct_volume.h"
#include "tests/gpu/display_room.h"

#define SKIPPED 77
#define BOUNCES 3u

static uint64_t device_bytes, device_budget = 1ull << 32;
static struct gl_device *device;
static uint32_t views_until_full; // calls of vct_landed_view until the one that fails; UINT32_MAX: none does

// The linker calls these for vct_landed_view.
enum status __real_vct_landed_view(struct vct_landed *landed, const struct voxels *voxels, const struct gl_buffer *sent,
				   struct error *err);
enum status __wrap_vct_landed_view(struct vct_landed *landed, const struct voxels *voxels, const struct gl_buffer *sent,
				   struct error *err);

enum status __wrap_vct_landed_view(struct vct_landed *landed, const struct voxels *voxels, const struct gl_buffer *sent,
				   struct error *err)
{
	if (views_until_full-- == 0)
		return error_set(err, STATUS_MEMORY, "the device's memory is full");
	return __real_vct_landed_view(landed, voxels, sent, err);
}

// Make the volume of a box that shines, calling again where memory is short; its entries' irradiance, which the caller
// frees.
static uint8_t *light_of(uint32_t views, uint64_t *bytes, uint32_t *failed)
{
	const struct vct_volume_options options = {.voxels = {.resolution = 16},
						   .effects = 1u << candil_Effect_EFFECT_EMITTERS |
							      1u << candil_Effect_EFFECT_BOUNCES,
						   .bounces = BOUNCES,
						   .cones = 6,
						   .rays = 4,
						   .unmarched = 1,
						   .points = 2,
						   .shadows = 1};
	struct room r;
	struct vct_volume *v;
	struct error err = {0};
	room_init(&r, ROOM_BOX, 1);
	room_shine(&r);
	r.plan.effects = options.effects;
	views_until_full = views;
	if (vct_volume_acquire(&r.model.scene, device, &r.plan, &options, &v, &err) != STATUS_OK)
		fail_msg("%s", err.text);
	*failed = 0;
	while (!vct_volume_finished(v)) {
		const enum status s = vct_volume_step(v, NULL, 1000000, &err);
		if (s != STATUS_OK && s != STATUS_MEMORY)
			fail_msg("%s", err.text);
		*failed += s == STATUS_MEMORY;
	}
	*bytes = v->total.bytes;
	uint8_t *total = malloc(*bytes);
	assert_non_null(total);
	assert_int_equal(gl_buffer_read(&v->total, device, 0, *bytes, total, &err), STATUS_OK);
	vct_volume_release(v);
	room_finish(&r);
	return total;
}

static void every_bounce_counts_once(void **state)
{
	(void)state;
	uint64_t expected_bytes;
	uint32_t failed;
	uint8_t *expected = light_of(UINT32_MAX, &expected_bytes, &failed);
	assert_int_equal(failed, 0);
	// What is looked up is viewed before each of the gatherings, which bring all bounces but the first, and at the end.
	for (uint32_t i = 0; i < BOUNCES; i++) {
		uint64_t bytes;
		uint8_t *total = light_of(i, &bytes, &failed);
		assert_int_equal(failed, 1);
		assert_int_equal(bytes, expected_bytes);
		assert_memory_equal(total, expected, bytes);
		free(total);
	}
	free(expected);
}

int main(void)
{
	const struct gl_device_options options = {.software = true, .bytes = &device_bytes, .budget = &device_budget};
	struct error err;
	if (gl_device_create(&options, &device, &err) != STATUS_OK || gl_settle_prepare(device, &err) != STATUS_OK) {
		print_message("skipped: %s\n", err.text);
		return SKIPPED;
	}
	const struct CMUnitTest tests[] = {cmocka_unit_test(every_bounce_counts_once)};
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	const int errors = device->errors > 0;
	devices_finish(&(struct devices){.gl = device});
	return failed + errors + (device_bytes != 0);
}
