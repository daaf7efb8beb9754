// Whether a colour is one.
#ifndef COMMON_FINITE_GLSL
#define COMMON_FINITE_GLSL

bool finite(vec3 c)
{
	// By exponent bits: a compiler may take isnan() for always false.
	uvec3 e = floatBitsToUint(c) & 0x7f800000u;
	return all(notEqual(e, uvec3(0x7f800000u)));
}

#endif
