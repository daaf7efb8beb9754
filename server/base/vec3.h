// Vectors of three doubles, for code on the CPU that needs products. Any thread. No function fails except where noted.
#ifndef CANDIL_BASE_VEC3_H
#define CANDIL_BASE_VEC3_H

#include <math.h>
#include <stdbool.h>

static inline double vec3_dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// `out` must not be one of the operands.
static inline void vec3_cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

// Normalise in place. False, and v unchanged, if its length is zero or its square is not finite as a double.
// (transform_normalize handles any length.)
static inline bool vec3_normalize(double v[3])
{
	const double length = sqrt(vec3_dot(v, v));
	if (!(length > 0) || !isfinite(length))
		return false;
	for (int i = 0; i < 3; i++)
		v[i] /= length;
	return true;
}

// A vector perpendicular to the triangle a, b, c, on the side where its corners run counter-clockwise. Its length is twice
// the triangle's area.
static inline void vec3_across(const float a[3], const float b[3], const float c[3], double out[3])
{
	double u[3], v[3];
	for (int i = 0; i < 3; i++) {
		u[i] = (double)b[i] - (double)a[i];
		v[i] = (double)c[i] - (double)a[i];
	}
	vec3_cross(u, v, out);
}

#endif
