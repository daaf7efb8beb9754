// Rows of form factors by hemicubes, for tests: made by both devices, and read back as a dense matrix.
#ifndef CANDIL_TESTS_HEMICUBE_RESULT_H
#define CANDIL_TESTS_HEMICUBE_RESULT_H

#include "tests/gpu/patch_model.h"

#include "server/worker/technique/radiosity/hemicube.h"

extern struct gl_device *gl;

// Open both devices. False: one is missing, and the test is skipped.
bool hemicube_test_begin(void);
int hemicube_test_end(void); // number of failures: of the devices' checks, and of memory that is left

// Rows [first, first + count) of a matrix.
struct hemicube_result {
	uint32_t first, count, side;
	float *values; // by row and column
	float *escaped, *cut; // by row
};

// Make rows, `batch` at a time at most, 0: as many as there can be.
struct hemicube_result hemicube_result_make(struct patch_model *model, const struct hemicube_options *options,
					    uint32_t first, uint32_t count, uint32_t batch);
struct hemicube_result hemicube_result_of(struct patch_model *model, const struct radiosity_surface *surfaces,
					  const struct hemicube_options *options, uint32_t first, uint32_t count,
					  uint32_t batch);
void hemicube_result_finish(struct hemicube_result *result);

static inline double factor_at(const struct hemicube_result *r, uint32_t row, uint32_t column)
{
	return (double)r->values[(size_t)(row - r->first) * r->side + column];
}

// Of a row's entries, what escaped and what was cut off.
double hemicube_result_sum(const struct hemicube_result *result, uint32_t row);

// The mean over a row's hemicubes of the form factor from their points to what of a polygon is there: `visible` tells that,
// and may be NULL. Polygons are seen from their fronts.
typedef void visible_part(const double from[3], struct form_polygon *polygon);
double mean_from_origins(const struct patch_model *model, uint32_t element, uint32_t origins,
			 const struct form_polygon *polygon, visible_part *visible);

#endif
