// Sums of floats that lose nothing which a float could show: a pair is a float and what it lacks. Products are made exact by
// cutting factors to half a float's digits (Dekker 1971, "A floating-point technique for extending the available precision"),
// because a device need not fuse a product with a sum.
#ifndef RADIOSITY_PAIRS_GLSL
#define RADIOSITY_PAIRS_GLSL

// The upper 12 of 24 digits. What it leaves of x, x - upper(x), has as few.
vec3 upper(vec3 x)
{
	return uintBitsToFloat(floatBitsToUint(x) & 0xFFFFF000u);
}

// a + b; `lost` is what rounding takes of it (Knuth).
vec3 two_sum(vec3 a, vec3 b, out vec3 lost)
{
	precise vec3 s = a + b;
	precise vec3 part = s - a;
	precise vec3 rest = (a - (s - part)) + (b - part);
	lost = rest;
	return s;
}

// Make `hi` the rounded sum again.
void settle_pair(inout vec3 hi, inout vec3 lo)
{
	precise vec3 s = hi + lo;
	precise vec3 rest = lo - (s - hi);
	hi = s;
	lo = rest;
}

// Add f times x to a pair; x consists of its upper digits and the rest.
void add_product(inout vec3 hi, inout vec3 lo, float f, vec3 x, vec3 rest)
{
	precise vec3 high = upper(vec3(f));
	precise vec3 low = vec3(f) - high;
	precise vec3 first = high * x; // 12 times 12 digits: exact
	vec3 lost;
	hi = two_sum(hi, first, lost);
	precise vec3 second = low * x; // exact
	precise vec3 third = f * rest;
	precise vec3 sum = lo + (lost + (second + third));
	lo = sum;
}

#endif
