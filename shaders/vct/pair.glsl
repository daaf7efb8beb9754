// Two cells behind each other, looked at along their axis.
#ifndef VCT_PAIR_GLSL
#define VCT_PAIR_GLSL

// Coverage in a, coverage × radiance in rgb. The nearer, and what it leaves of the farther: halfway between both hiding the same
// part of the face and hiding parts side by side.
vec4 pair(vec4 near, vec4 far)
{
	float apart = min(far.a, 1.0 - near.a);
	float alike = max(far.a - near.a, 0.0);
	float rest = 0.5 * (apart + alike);
	return near + (far.a > 0.0 ? far * (rest / far.a) : vec4(0.0));
}

#endif
