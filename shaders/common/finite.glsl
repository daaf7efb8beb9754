// Whether all components of a colour are finite.
#ifndef COMMON_FINITE_GLSL
#define COMMON_FINITE_GLSL

bool finite(vec3 c)
{
	// The test looks at the exponent bits, because a compiler may take isnan() to be always false.
	uvec3 e = floatBitsToUint(c) & 0x7f800000u;
	return all(notEqual(e, uvec3(0x7f800000u)));
}

#endif
