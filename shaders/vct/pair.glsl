// Combines two cells, one behind the other along an axis.
#ifndef VCT_PAIR_GLSL
#define VCT_PAIR_GLSL

// Coverage is in a, coverage × radiance in rgb. The result is the near cell plus the visible part of the far one, halfway
// between two cases: both hide the same part of the face, or parts side by side.
vec4 pair(vec4 near, vec4 far)
{
	float apart = min(far.a, 1.0 - near.a);
	float alike = max(far.a - near.a, 0.0);
	float rest = 0.5 * (apart + alike);
	return near + (far.a > 0.0 ? far * (rest / far.a) : vec4(0.0));
}

#endif
