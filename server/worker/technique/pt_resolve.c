#include "server/worker/technique/pt_resolve.h"

#include "shaders/shared/bindings.h"

// Even samples belong to half A, odd ones to half B.
static void count_halves(uint32_t first, uint32_t samples, double counts[2])
{
	const uint32_t even = first % 2 == 0 ? (samples + 1) / 2 : samples / 2;
	counts[0] = even;
	counts[1] = samples - even;
}

static double sum_of(const float *pair)
{
	return (double)pair[0] + (double)pair[1];
}

void pt_resolve(const float *sums, const struct pt_progress *progress, struct frame *frame)
{
	const uint32_t tiles_x = (frame->width + TILE_SIDE - 1) / TILE_SIDE;
	double counts[2][2];   // [has the tile one more][half]
	count_halves(progress->first_sample, progress->samples, counts[0]);
	count_halves(progress->first_sample, progress->samples + 1, counts[1]);
	double error = 0;
	uint64_t known = 0;
	for (uint32_t y = 0; y < frame->height; y++)
		for (uint32_t x = 0; x < frame->width; x++) {
			const uint64_t i = (uint64_t)y * frame->width + x;
			const uint32_t tile = y / TILE_SIDE * tiles_x + x / TILE_SIDE;
			const double *n = counts[tile < progress->tiles];
			for (int c = 0; c < 3; c++) {
				const double a = sum_of(sums + i * ACCUMULATOR_FLOATS + 2 * c);
				const double b = sum_of(sums + i * ACCUMULATOR_FLOATS + 6 + 2 * c);
				const double total = n[0] + n[1];
				const double mean = total > 0 ? (a + b) / total : 0;
				frame->radiance[3 * i + (uint64_t)c] = (float)mean;
				if (n[0] > 0 && n[1] > 0) {
					const double half = 0.5 * (a / n[0] - b / n[1]);
					error += half * half / (mean * mean + 0.01);
					known++;
				}
			}
		}
	frame->estimated_relmse = known ? error / (double)known : -1;
}
