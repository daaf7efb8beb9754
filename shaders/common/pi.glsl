#ifndef COMMON_PI_GLSL
#define COMMON_PI_GLSL

const float PI = 3.14159265358979323846;

#endif
