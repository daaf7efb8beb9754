#include "server/worker/technique/radiosity/ray_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"

#define DIMENSIONS 4
#define CURVE_BITS 16u

// A ray, and where it is on the curve.
struct sorted {
	uint32_t place;
	struct table_ray ray;
};

// Where a cell of a square of 2^CURVE_BITS by as many is on Hilbert's curve.
static uint32_t hilbert(uint32_t x, uint32_t y)
{
	uint32_t place = 0;
	for (uint32_t s = 1u << (CURVE_BITS - 1); s > 0; s >>= 1) {
		const uint32_t right = (x & s) != 0, up = (y & s) != 0;
		place += s * s * (3 * right ^ up);
		if (up)
			continue;
		if (right) {
			x = ~x;
			y = ~y;
		}
		const uint32_t swapped = x;
		x = y;
		y = swapped;
	}
	return place;
}

static int by_place(const void *a, const void *b)
{
	const struct sorted *p = a, *q = b;
	if (p->place != q->place)
		return p->place < q->place ? -1 : 1;
	return memcmp(&p->ray, &q->ray, sizeof p->ray);
}

static enum status sort(struct sorted *of, uint32_t count, struct table_ray **rays, struct error *err)
{
	*rays = malloc(count * sizeof **rays);
	if (!*rays)
		return error_set(err, STATUS_MEMORY, "out of memory");
	qsort(of, count, sizeof *of, by_place);
	for (uint32_t i = 0; i < count; i++)
		(*rays)[i] = of[i].ray;
	return STATUS_OK;
}

// The direction numbers of a dimension, v_k = m_k 2^(32 - k): m_k of a recurrence by a primitive polynomial of this degree,
// whose inner coefficients are the bits of `inner`.
static void directions(uint32_t degree, uint32_t inner, const uint32_t *first, uint32_t v[32])
{
	for (uint32_t k = 0; k < 32; k++) {
		if (k < degree || degree == 0) {
			v[k] = (degree == 0 ? 1u : first[k]) << (31 - k);
			continue;
		}
		v[k] = v[k - degree] ^ v[k - degree] >> degree;
		for (uint32_t i = 1; i < degree; i++)
			if (inner >> (degree - 1 - i) & 1u)
				v[k] ^= v[k - i];
	}
}

enum status ray_table_sobol(uint32_t count, struct table_ray **rays, struct error *err)
{
	uint32_t v[DIMENSIONS][32];
	struct sorted *of = calloc(count, sizeof *of);
	*rays = NULL;
	if (!of)
		return error_set(err, STATUS_MEMORY, "out of memory");
	directions(0, 0, NULL, v[0]);
	directions(1, 0, (const uint32_t[]){1}, v[1]);
	directions(2, 1, (const uint32_t[]){1, 3}, v[2]);
	directions(3, 1, (const uint32_t[]){1, 3, 1}, v[3]);
	for (uint32_t i = 0; i < count; i++) {
		uint32_t *w = of[i].ray.word;
		for (uint32_t k = 0; k < 32; k++)
			for (int d = 0; i >> k & 1u && d < DIMENSIONS; d++)
				w[d] ^= v[d][k];
		of[i].place = hilbert(w[0] >> (32 - CURVE_BITS), w[1] >> (32 - CURVE_BITS));
	}
	const enum status s = sort(of, count, rays, err);
	free(of);
	return s;
}

// Cells within the next ring's inner circle, of `left` within its outer one. Areas are in cells, so that a circle around n
// has the radius √(n/π); the ring is as wide as a square cell.
static uint32_t within(uint32_t left)
{
	const double inner = sqrt(left / PI) - 1;
	return inner > 0 ? (uint32_t)(PI * inner * inner + 0.5) : 0;
}

enum status ray_table_cells(uint32_t count, struct table_ray **rays, struct error *err)
{
	struct sorted *of = calloc(count, sizeof *of);
	uint32_t n = 0;
	*rays = NULL;
	if (!of)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t left = count; left > 0;) {
		const uint32_t inner = within(left), ring = left - inner;
		const double radius = ring == 1 ? 0 : sqrt((left + (double)inner) / (2.0 * count));
		for (uint32_t k = 0; k < ring; k++, n++) {
			const double angle = 2 * PI * (k + 0.5) / ring, most = (1u << CURVE_BITS) - 1;
			const double x = radius * cos(angle), y = radius * sin(angle);
			const float at[2] = {(float)x, (float)y};
			memcpy(of[n].ray.word, at, sizeof at);
			of[n].place = hilbert((uint32_t)(most * (x + 1) / 2), (uint32_t)(most * (y + 1) / 2));
		}
		left = inner;
	}
	const enum status s = sort(of, count, rays, err);
	free(of);
	return s;
}
