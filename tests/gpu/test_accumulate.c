// The accumulator stays exact to one part in a million after ten million samples a half, fireflies included.
#include <math.h>
#include <stdint.h>
#include <stdio.h>

#include "shaders/accumulate_comp.h"
#include "shaders/shared/bindings.h"
#include "tests/gpu/run_shader.h"

#define PIXELS 8u
#define SAMPLES 20000000u
#define PER_DISPATCH 20000u

static const struct shader shader = {.name = "accumulate",
				     .code = shader_accumulate_comp,
				     .bytes = sizeof shader_accumulate_comp,
				     .bindings = 2,
				     .push_bytes = 8};

// What a plain float sum would have made of it: shows that the test can fail.
static double plain_float_error(float v)
{
	float sum = 0;
	double exact = 0;
	for (uint32_t n = 0; n < SAMPLES; n += 2) {
		float x = n % 1000 == 0 ? v * 1e6f : v;
		sum += x;
		exact += (double)x;
	}
	return fabs((double)sum / exact - 1);
}

int main(void)
{
	float values[PIXELS * 3], sums[PIXELS * ACCUMULATOR_FLOATS];
	struct shader_run run;
	struct error err;
	for (uint32_t i = 0; i < PIXELS * 3; i++)
		values[i] = 0.1f + 0.37f * (float)i;
	enum status s = shader_run_init(&run, &shader, values, sizeof values, sizeof sums, &err);
	if (s == STATUS_DEVICE) {
		printf("skipped: %s\n", err.text);
		return 77;
	}
	for (uint32_t first = 0; first < SAMPLES && s == STATUS_OK; first += PER_DISPATCH) {
		const uint32_t push[2] = {first, PER_DISPATCH};
		s = shader_run_dispatch(&run, push, sizeof push, 1, &err);
	}
	if (s == STATUS_OK)
		s = buffer_read(&run.out, run.device, 0, sizeof sums, sums, &err);
	shader_run_finish(&run);
	if (s != STATUS_OK) {
		printf("FAIL: %s\n", err.text);
		return 1;
	}
	double worst = 0;
	for (uint32_t p = 0; p < PIXELS; p++)
		for (uint32_t half = 0; half < 2; half++)
			for (uint32_t c = 0; c < 3; c++) {
				const float *pair = sums + p * ACCUMULATOR_FLOATS + half * 6 + 2 * c;
				double exact = 0;
				for (uint32_t n = half; n < SAMPLES; n += 2)
					exact += (double)(n % 1000 == 0 ? values[p * 3 + c] * 1e6f : values[p * 3 + c]);
				worst = fmax(worst, fabs(((double)pair[0] + (double)pair[1]) / exact - 1));
			}
	double plain = plain_float_error(values[0]);
	printf("worst relative error after %u samples a half: %.2g (a plain float sum: %.2g)\n", SAMPLES / 2, worst, plain);
	return worst <= 1e-6 && plain > 1e-6 ? 0 : 1;
}
