// The sampler's points are what they claim: every power-of-two block is a (0, m, 2)-net in base 2, different pixels, halves
// and sets are unrelated, and the difference of two halves' means estimates the error of their common mean.
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "server/base/angle.h"
#include "shaders/sampling_comp.h"
#include "tests/gpu/run_shader.h"

#define POINTS 1024u
#define BITS 10u

static const struct shader shader = {
    .name = "sampling", .code = shader_sampling_comp, .bytes = sizeof shader_sampling_comp, .bindings = 2, .push_bytes = 16};

static uint32_t points[POINTS][2];

static enum status get(struct shader_run *run, uint32_t pixel, uint32_t half, uint32_t set, struct error *err)
{
	const uint32_t push[4] = {pixel, half, set, 7};
	enum status s = shader_run_dispatch(run, push, sizeof push, POINTS / 64, err);
	return s == STATUS_OK ? buffer_read(&run->out, run->device, 0, sizeof points, points, err) : s;
}

// Every elementary interval of area 2^-m, m the block's bits, holds exactly one point of each block of 2^m.
static uint32_t net_violations(void)
{
	uint32_t bad = 0;
	for (uint32_t m = 1; m <= BITS; m++)
		for (uint32_t block = 0; block < POINTS >> m; block++)
			for (uint32_t kx = 0; kx <= m; kx++) {
				uint8_t seen[POINTS] = {0};
				for (uint32_t i = block << m; i < (block + 1) << m; i++) {
					uint32_t x = kx ? points[i][0] >> (32 - kx) : 0;
					uint32_t y = m - kx ? points[i][1] >> (32 - (m - kx)) : 0;
					bad += seen[x << (m - kx) | y]++ != 0;
				}
			}
	return bad;
}

static double mean_of(uint32_t count)
{
	// A smooth function with a known integral over the square: sin(pi x) · y² has 2/(3 pi).
	double sum = 0;
	for (uint32_t i = 0; i < count; i++) {
		double x = (points[i][0] + 0.5) / 4294967296.0, y = (points[i][1] + 0.5) / 4294967296.0;
		sum += sin(PI * x) * y * y;
	}
	return sum / count;
}

int main(void)
{
	struct shader_run run;
	struct error err;
	uint32_t unused = 0, bad = 0;
	enum status s = shader_run_init(&run, &shader, &unused, sizeof unused, sizeof points, &err);
	if (s == STATUS_DEVICE) {
		printf("skipped: %s\n", err.text);
		return 77;
	}
	for (uint32_t set = 0; set < 8 && s == STATUS_OK; set++) {
		s = get(&run, 5 + set, set & 1, set, &err);
		bad += net_violations();
	}
	// Estimated over true squared error, over many pixels, of 16 samples a half.
	double estimated = 0, actual = 0, correlation = 0;
	const double truth = 2 / (3 * PI);
	for (uint32_t pixel = 0; pixel < 400 && s == STATUS_OK; pixel++) {
		s = get(&run, pixel, 0, 3, &err);
		double a = mean_of(16) - truth;
		if (s == STATUS_OK)
			s = get(&run, pixel, 1, 3, &err);
		double b = mean_of(16) - truth;
		estimated += 0.25 * (a - b) * (a - b);
		actual += 0.25 * (a + b) * (a + b);
		correlation += a * b;
	}
	shader_run_finish(&run);
	if (s != STATUS_OK) {
		printf("FAIL: %s\n", err.text);
		return 1;
	}
	double ratio = estimated / actual;
	printf("net violations: %u; estimated over true squared error of two halves: %.3f; their correlation: %.3g of the "
	       "variance\n",
	       bad, ratio, correlation / (2 * actual));
	return bad == 0 && ratio > 0.7 && ratio < 1.4 ? 0 : 1;
}
