#include "server/worker/technique/common/resolve.h"

#include <string.h>

#include "server/worker/technique/common/scene_params.h"
#include "shaders/shared/bindings.h"
#include "shaders/shared/scene_params.h"

// Count the samples of each half: even ones belong to half A, odd ones to half B.
static void count_halves(uint32_t first, uint32_t samples, double counts[2])
{
	const uint32_t even = first % 2 == 0 ? (samples + 1) / 2 : samples / 2;
	counts[0] = even;
	counts[1] = samples - even;
}

void resolver_init(struct resolver *r, uint32_t first_sample, uint32_t samples, uint32_t tiles, uint32_t more)
{
	*r = (struct resolver){.tiles = tiles};
	count_halves(first_sample, samples, r->counts[0]);
	count_halves(first_sample, samples + more, r->counts[1]);
}

static double sum_of(const float *pair)
{
	return (double)pair[0] + (double)pair[1];
}

// Radiance that light paths brought to a channel of a pixel in a half, W/(m² sr).
static double film_of(const struct resolver *r, const uint32_t *film, int half, int channel)
{
	const uint32_t *part = film + 2 * (3 * half + channel);
	return film ? r->film_units[half] * ((double)part[1] * 4294967296.0 + (double)part[0]) : 0;
}

static void resolve_pixel(const struct resolver *r, const float *sums, const uint32_t *film, const double counts[2],
			  float *radiance)
{
	const double total = counts[0] + counts[1];
	for (int c = 0; c < 3; c++) {
		const double a = sum_of(sums + 2 * c) + counts[0] * film_of(r, film, 0, c);
		const double b = sum_of(sums + 6 + 2 * c) + counts[1] * film_of(r, film, 1, c);
		radiance[c] = total > 0 ? (float)((a + b) / total) : 0;
	}
}

void resolve_sums(const struct resolver *r, const float *sums, uint32_t first_row, uint32_t rows, struct frame *frame)
{
	const uint32_t tiles_x = tiles_over(frame->width);
	const uint32_t *film = r->film;
	for (uint32_t y = first_row; y < first_row + rows; y++)
		for (uint32_t x = 0; x < frame->width; x++) {
			const uint32_t tile = y / TILE_SIDE * tiles_x + x / TILE_SIDE;
			resolve_pixel(r, sums, film, r->counts[tile < r->tiles],
				      frame->radiance + 3 * ((uint64_t)y * frame->width + x));
			sums += ACCUMULATOR_FLOATS;
			film = film ? film + sizeof(struct film_pixel) / sizeof *film : NULL;
		}
}

void resolve_aovs(const uint32_t *words, uint32_t first_row, uint32_t rows, struct frame *f)
{
	const uint64_t first = (uint64_t)first_row * f->width, count = (uint64_t)rows * f->width;
	for (uint64_t i = first; i < first + count; i++, words += AOV_WORDS) {
		if (f->depth)
			memcpy(&f->depth[i], words, sizeof(float));
		if (f->normal)
			memcpy(&f->normal[3 * i], words + 1, 3 * sizeof(float));
		if (f->albedo)
			memcpy(&f->albedo[3 * i], words + 4, 3 * sizeof(float));
		if (f->id)
			f->id[i] = words[7];
	}
}

uint64_t met_bytes(uint32_t width, uint32_t height)
{
	return (uint64_t)tiles_over(width) * tiles_over(height) * MET_WORDS * sizeof(uint32_t);
}

void resolve_met(const uint32_t *met, struct frame *f)
{
	const uint32_t tiles_x = tiles_over(f->width);
	for (uint32_t y = 0; y < f->height; y++)
		for (uint32_t x = 0; x < f->width; x++) {
			const uint32_t tile = y / TILE_SIDE * tiles_x + x / TILE_SIDE;
			// As tile_pixel of shaders/common/tile.glsl orders them: blocks of 4 × 2.
			const uint32_t block = y % TILE_SIDE / 2 * 2 + x % TILE_SIDE / 4;
			const uint32_t lane = block * 8 + y % 2 * 4 + x % 4;
			f->met[(uint64_t)y * f->width + x] = met[tile * MET_WORDS + lane / 32] >> lane % 32 & 1u;
		}
}
