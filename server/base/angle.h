// π, and angles in degrees as they are named by people.
#ifndef CANDIL_BASE_ANGLE_H
#define CANDIL_BASE_ANGLE_H

#define PI 3.14159265358979323846

#endif
