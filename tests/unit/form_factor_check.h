// What the tests of form factors share.
#ifndef CANDIL_TESTS_FORM_FACTOR_CHECK_H
#define CANDIL_TESTS_FORM_FACTOR_CHECK_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdbool.h>

#include "server/base/vec3.h"
#include "server/worker/technique/radiosity/form_factor.h"

// A1 F12, whose bound must be a millionth of it.
static inline double exchange(const struct form_polygon *a, const struct form_polygon *b)
{
	double error;
	const double sum = form_factor_exchange(a, b, 0, &error);
	assert_true(error >= 0 && error <= 1e-6 * fmax(sum, 0));
	return sum;
}

static inline void check_close(const char *name, double is, double should, double relative)
{
	if (!(fabs(is - should) <= relative * fabs(should)))
		fail_msg("%s: %.17g, not %.17g, %.2g off", name, is, should, is / should - 1);
}

// A turn of space, a scale and a shift.
static inline struct form_polygon placed(const struct form_polygon *p, const double axis[3], double angle, double scale,
					 double shift)
{
	struct form_polygon out = *p;
	for (uint32_t i = 0; i < p->corners; i++) {
		double cross[3];
		vec3_cross(axis, p->at[i], cross);
		const double along = vec3_dot(axis, p->at[i]);
		for (int c = 0; c < 3; c++)
			out.at[i][c] =
			    scale * (cos(angle) * p->at[i][c] + sin(angle) * cross[c] + (1 - cos(angle)) * along * axis[c]) +
			    shift * (c + 1);
	}
	return out;
}

static inline double distance(const double a[3], const double b[3])
{
	const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
	return sqrt(vec3_dot(d, d));
}

// Even in 0 … 1.
static inline double noise(uint32_t *state)
{
	*state = *state * 1664525u + 1013904223u;
	return (double)(*state >> 8) / 16777216;
}

#endif
