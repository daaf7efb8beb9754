// The film: where light paths leave what they bring to the camera, a pixel at a time and in any order. It is summed in whole
// numbers, so the same paths make the same bits. A remainder below one is rounded up as often as its size says: a picture's
// dimmest light is not lost, it is noise.
#ifndef PATH_FILM_GLSL
#define PATH_FILM_GLSL

#include "pt/lens.glsl"

layout(std430, set = 0, binding = BIND_FILM) buffer Film {
	film_pixel film[];
};

// One of the pixels whose filter takes something at `at`, by how much each takes; `share` is the sum of all.
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

// `value` in the film's units, `up` uniform in [0, 1). True: the sum is too large.
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
