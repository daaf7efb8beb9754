// What candil wrote into a picture of where it came from, and what of two pictures makes their difference another thing than
// an error. One thread for each picture.
#ifndef CANDIL_COMPARE_ORIGIN_H
#define CANDIL_COMPARE_ORIGIN_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define ORIGIN_WARNINGS_MAX 3u
#define ORIGIN_WARNING_BYTES 256u

// Texts are "" where the file does not tell.
struct origin {
	char scene[64]; // the scene's hash
	char view[4 * 64 + 1]; // eye, direction, up and projection
	char technique[16];
	char made_of[32]; // pixels that were rendered, where a deadline left time for fewer than the picture has
	uint64_t seed, first_sample, samples; // samples 0: not told
};

// Write what there is to say of two pictures that are compared. Returns how many sentences there are.
unsigned origin_compare(const struct origin *a, const struct origin *b,
			char warnings[ORIGIN_WARNINGS_MAX][ORIGIN_WARNING_BYTES]);

#ifdef __cplusplus
}
#endif

#endif
