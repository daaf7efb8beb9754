// Which pixels have met a surface: a bit a pixel behind the counters, from which the host knows those that missed. Include it
// after the block that declares `met`.
#ifndef COMMON_MET_GLSL
#define COMMON_MET_GLSL

// Notes that a sample of a pixel met a surface. `tile` counts the image's tiles, `lane` the pixels in it. Most pixels have
// their bit from their first sample on, and an atomic operation less afterwards.
void met_note(uint tile, uint lane)
{
	uint word = tile * MET_WORDS + (lane >> 5);
	uint bit = 1u << (lane & 31u);
	if ((met[word] & bit) == 0u)
		atomicOr(met[word], bit);
}

#endif
