// The constant π, for conversions between degrees and radians.
#ifndef CANDIL_BASE_ANGLE_H
#define CANDIL_BASE_ANGLE_H

#define PI 3.14159265358979323846

#endif
