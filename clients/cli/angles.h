// The command line has angles in degrees, the functions of math.h take radians.
#ifndef CANDIL_CLI_ANGLES_H
#define CANDIL_CLI_ANGLES_H

#define ANGLES_PI 3.14159265358979323846

static inline double angles_radians(double degrees)
{
	return degrees * ANGLES_PI / 180.0;
}

#endif
