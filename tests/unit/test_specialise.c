// A specialised module has no specialization constant left, nor the code that the constants leave dead, and is valid.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>
#include <spirv-tools/libspirv.h>

#include "protocol/names.h"
#include "server/worker/vk/specialise.h"
#include "shaders/light_comp.h"
#include "shaders/path_comp.h"
#include "shaders/shared/pt.h"

#define HEADER_WORDS 5
#define OP_DECORATE 71
#define DECORATION_SPEC_ID 1
#define OP_SPEC_CONSTANT_TRUE 48 // the first of five operations on specialization constants
#define OP_SPEC_CONSTANT_OP 52 // the last

static unsigned spec_constants(const uint32_t *code, size_t words)
{
	unsigned count = 0;
	for (size_t i = HEADER_WORDS; i < words; i += code[i] >> 16) {
		const uint32_t op = code[i] & 0xffffu;
		assert_true(code[i] >> 16 > 0);
		count += op >= OP_SPEC_CONSTANT_TRUE && op <= OP_SPEC_CONSTANT_OP;
		count += op == OP_DECORATE && code[i + 2] == DECORATION_SPEC_ID;
	}
	return count;
}

// Bytes of a module whose effects are all on or all off. It is checked on the way.
static size_t specialised(const uint32_t *code, size_t bytes, uint32_t on)
{
	uint32_t ids[EFFECT_COUNT + 1], values[EFFECT_COUNT + 1];
	for (uint32_t i = 0; i < EFFECT_COUNT; i++) {
		ids[i] = i;
		values[i] = on;
	}
	ids[EFFECT_COUNT] = SPEC_LAMPS_BY;
	values[EFFECT_COUNT] = 0;
	size_t out_bytes;
	uint32_t *out = specialise(code, bytes, ids, values, EFFECT_COUNT + 1, &out_bytes);
	assert_non_null(out);
	assert_true(spec_constants(code, bytes / sizeof *code) > 0);
	assert_int_equal(spec_constants(out, out_bytes / sizeof *out), 0);
	struct spv_context_t *context = spvContextCreate(SPV_ENV_VULKAN_1_2);
	struct spv_const_binary_t binary = {out, out_bytes / sizeof *out};
	assert_int_equal(spvValidate(context, &binary, NULL), SPV_SUCCESS);
	spvContextDestroy(context);
	free(out);
	return out_bytes;
}

static void what_is_switched_off_goes(void **state)
{
	(void)state;
	assert_true(specialised(shader_path_comp, sizeof shader_path_comp, 0) * 2 <
		    specialised(shader_path_comp, sizeof shader_path_comp, 1));
	assert_true(specialised(shader_light_comp, sizeof shader_light_comp, 0) * 2 <
		    specialised(shader_light_comp, sizeof shader_light_comp, 1));
}

static void what_is_no_module_is_refused(void **state)
{
	(void)state;
	size_t bytes;
	assert_null(specialise(shader_path_comp, sizeof shader_path_comp / 2, NULL, NULL, 0, &bytes));
	assert_null(specialise(shader_path_comp, 0, NULL, NULL, 0, &bytes));
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_switched_off_goes),
					   cmocka_unit_test(what_is_no_module_is_refused)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
