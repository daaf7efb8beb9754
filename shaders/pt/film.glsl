// The film accumulates the contributions of light paths to pixels, in any order. Sums are integers, so the same paths give
// the same bits. A fraction is rounded up with a probability equal to its size: the dimmest light of a picture becomes
// noise but is not lost.
#ifndef PATH_FILM_GLSL
#define PATH_FILM_GLSL

#include "pt/lens.glsl"
#include "shared/pt.h"

layout(std430, set = 0, binding = BIND_FILM) buffer Film {
	film_pixel film[];
};

// Chooses one of the pixels whose filter covers the point `at`, with probability proportional to the filter's weight;
// `share` is the sum of all weights.
ivec2 film_choose(vec2 at, float chance, out float share)
{
	ivec2 here = ivec2(floor(at));
	share = 1.0;
	if (FILTER == FILTER_BOX)
		return here;
	share = 0.0;
	for (int i = 0; i < 25; i++)
		share += filter_density(at - vec2(here + ivec2(i % 5, i / 5) - 2) - 0.5);
	ivec2 chosen = here;
	float left = chance * share;
	bool found = false;
	for (int i = 0; i < 25; i++) {
		ivec2 pixel = here + ivec2(i % 5, i / 5) - 2;
		left -= filter_density(at - vec2(pixel) - 0.5);
		chosen = !found && left < 0.0 ? pixel : chosen;
		found = found || left < 0.0;
	}
	return chosen;
}

// Adds `value`, in the film's units; `up` is uniform in [0, 1). True if the sum overflows.
bool film_add(uint pixel, uint part, float value, float up)
{
	float high = floor(value * 2.3283064365386963e-10);   // 2⁻³²
	float rest = max(value - high * 4294967296.0, 0.0);
	float low = floor(rest);
	low += up < rest - low ? 1.0 : 0.0;
	uint more = low >= 4294967296.0 ? 0u : uint(low);
	uint carry = uint(high) + (low >= 4294967296.0 ? 1u : 0u);
	if (more != 0u) {
		uint before = atomicAdd(film[pixel].parts[2u * part], more);
		carry += before + more < before ? 1u : 0u;
	}
	if (carry == 0u)
		return false;
	return atomicAdd(film[pixel].parts[2u * part + 1u], carry) >= FILM_FULL;
}

#endif
