// The constant π, for conversions between degrees and radians, and cosines of small angles.
#ifndef CANDIL_BASE_ANGLE_H
#define CANDIL_BASE_ANGLE_H

#include <math.h>

#define PI 3.14159265358979323846

// 1 − cos of an angle in radians, as 2 sin² of its half: a small angle keeps its digits.
static inline double angle_spread(double angle)
{
	const double half = sin(0.5 * angle);
	return 2 * half * half;
}

#endif
