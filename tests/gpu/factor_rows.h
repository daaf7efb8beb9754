// Rows of form factors by rays, read back, for tests.
#ifndef CANDIL_TESTS_FACTOR_ROWS_H
#define CANDIL_TESTS_FACTOR_ROWS_H

#include <stdlib.h>

#include "server/worker/technique/radiosity/rays.h"
#include "tests/gpu/traced_mesh.h"

// All rows of a mesh: counts[i · side + j] / unit = F_ij.
struct factor_rows {
	uint32_t side;
	double unit;
	uint32_t *counts;
	struct factors_put *lost; // by row
};

// Make them, `batch` rows at a time, with these effects.
static inline struct factor_rows factor_rows_with(struct traced_mesh *t, const struct rays_options *options, uint32_t batch,
						  uint32_t effects)
{
	const struct plan plan = {.effects = effects};
	struct error err = {0};
	struct rays *rays;
	enum status s = rays_create(t->device, &t->scene, &plan, &t->elements, &t->buffers, options, &rays, &err);
	if (s != STATUS_OK)
		fail_msg("%s", err.text);
	struct factor_rows f = {.side = t->elements.count, .unit = rays_unit(rays)};
	f.counts = calloc((size_t)f.side * f.side, sizeof *f.counts);
	f.lost = calloc(f.side, sizeof *f.lost);
	uint32_t *list = calloc(f.side, sizeof *list);
	assert_true(f.counts && f.lost && list);
	for (uint32_t i = 0; i < f.side; i++)
		list[i] = i;
	for (uint32_t i = 0; i < f.side; i += batch) {
		const uint32_t n = f.side - i < batch ? f.side - i : batch;
		if (rays_trace(rays, list + i, n, &err) != STATUS_OK)
			fail_msg("%s", err.text);
		assert_int_equal(buffer_read(rays_dense(rays), t->device, 0, (uint64_t)n * f.side * sizeof(uint32_t),
					     f.counts + (size_t)i * f.side, &err),
				 STATUS_OK);
		memcpy(f.lost + i, rays_lost(rays), n * sizeof *f.lost);
		assert_int_equal(rays_clear(rays, &err), STATUS_OK);
	}
	free(list);
	rays_destroy(rays);
	return f;
}

static inline struct factor_rows factor_rows_of(struct traced_mesh *t, const struct rays_options *options, uint32_t batch)
{
	return factor_rows_with(t, options, batch, 0);
}

static inline void factor_rows_finish(struct factor_rows *f)
{
	free(f->counts);
	free(f->lost);
}

static inline double factor(const struct factor_rows *f, uint32_t i, uint32_t j)
{
	return f->counts[(size_t)i * f->side + j] / f->unit;
}

// The standard error of a factor by so many independent rays: a bound for the set that is used.
static inline double standard_error(double f, uint32_t rays)
{
	return sqrt(f * (1 - f) / rays);
}

#endif
