#include "server/report/bias.h"

#include <math.h>
#include <stdlib.h>

#include "server/base/luminance.h"

void bias_tiles(const struct figures *f, const struct picture *picture, double *tiles)
{
	for (uint32_t row = 0; row < f->rows; row++)
		for (uint32_t column = 0; column < f->columns; column++) {
			const uint32_t right = (column + 1) * f->tile, bottom = (row + 1) * f->tile;
			const uint32_t x1 = right < picture->width ? right : picture->width;
			const uint32_t y1 = bottom < picture->height ? bottom : picture->height;
			double sum = 0;
			for (uint32_t y = row * f->tile; y < y1; y++)
				for (uint32_t x = column * f->tile; x < x1; x++) {
					const double l = luminance(picture->rgb + 3 * ((size_t)y * picture->width + x));
					sum += isfinite(l) ? l : 0;
				}
			const double pixels = (double)(x1 - column * f->tile) * (double)(y1 - row * f->tile);
			tiles[(size_t)row * f->columns + column] = sum / pixels;
		}
}

// The value of a tile over the seeds of a point: the mean, and the variance of one seed's.
static void over_seeds(const struct figures *f, const struct point *p, size_t tile, double *mean, double *variance)
{
	const size_t tiles = (size_t)f->columns * f->rows;
	double sum = 0, squares = 0;
	for (size_t s = 0; s < p->seeds; s++)
		sum += p->tiles[s * tiles + tile];
	*mean = sum / (double)p->seeds;
	for (size_t s = 0; s < p->seeds; s++)
		squares += (p->tiles[s * tiles + tile] - *mean) * (p->tiles[s * tiles + tile] - *mean);
	*variance = p->seeds > 1 ? squares / (double)(p->seeds - 1) : 0;
}

// The point whose seeds say how much noise the view's reference has: made as the reference was, but for the samples; of
// several that with the most. NULL: there is none. Another depth or a clamp would have another variance.
static const struct point *noise_of_view(const struct figures *f, uint32_t view)
{
	const struct study_run *reference = f->views[view].run;
	const struct point *best = NULL;
	for (size_t i = 0; i < f->point_count && reference; i++) {
		const struct point *p = &f->points[i];
		if (p->runs[0].view == view && p->noise && p->runs[0].samples > 0 && reference->samples > 0 &&
		    study_same_but_samples(&p->runs[0], reference) && (!best || p->runs[0].samples > best->runs[0].samples))
			best = p;
	}
	return best;
}

static enum status find(const struct figures *f, struct point *p, const struct point *noise, double *values,
			struct error *err)
{
	const struct reference *reference = &f->views[p->runs[0].view];
	const size_t tiles = (size_t)f->columns * f->rows;
	const double ratio = noise->runs[0].samples / reference->run->samples;
	size_t by_chance = 0;
	p->bias.difference = calloc(tiles, sizeof *p->bias.difference);
	p->bias.biased = calloc(tiles, sizeof *p->bias.biased);
	if (!p->bias.difference || !p->bias.biased)
		return error_set(err, STATUS_MEMORY, "no memory for a map of bias");
	for (size_t t = 0; t < tiles; t++) {
		double mean, variance, ignored, of_noise;
		over_seeds(f, p, t, &mean, &variance);
		over_seeds(f, noise, t, &ignored, &of_noise);
		struct sample_mean a = {mean, variance / (double)p->seeds, (double)p->seeds - 1};
		struct sample_mean b = {reference->tiles[t], of_noise * ratio, (double)noise->seeds - 1};
		if (p == noise) { // one variance stands for both means
			a.variance += b.variance;
			b.variance = 0;
		}
		values[t] = statistics_welch(a, b);
		by_chance += values[t] < BIAS_ALPHA;
		p->bias.difference[t] = (float)((mean - b.value) / (fabs(b.value) + 0.1));
	}
	p->bias.tiles = (uint32_t)tiles;
	p->bias.by_chance = (double)by_chance / (double)tiles;
	p->bias.share = (double)statistics_discoveries(values, tiles, BIAS_ALPHA, p->bias.biased) / (double)tiles;
	return STATUS_OK;
}

enum status bias_find(struct figures *f, struct error *err)
{
	double *values = calloc((size_t)f->columns * f->rows, sizeof *values);
	enum status s = values ? STATUS_OK : error_set(err, STATUS_MEMORY, "no memory for a map of bias");
	for (size_t i = 0; i < f->point_count && s == STATUS_OK; i++) {
		struct point *p = &f->points[i];
		const struct point *noise = noise_of_view(f, p->runs[0].view);
		// A picture that is there once says nothing about its own noise.
		if (noise && p->seeds > 1)
			s = find(f, p, noise, values, err);
	}
	free(values);
	return s;
}
