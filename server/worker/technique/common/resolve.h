// Resolving: from a technique's sums over samples to a picture. Host only, any thread. Radiance is in W/(m² sr). Nothing
// here fails or allocates.
#ifndef CANDIL_WORKER_TECHNIQUE_RESOLVE_H
#define CANDIL_WORKER_TECHNIQUE_RESOLVE_H

#include <stdint.h>

#include "server/worker/image/frame.h"

// A picture on its way. Even samples are half A, odd ones half B.
struct resolver {
	uint32_t tiles; // the image's first tiles, which have more samples
	double counts[2][2]; // samples of half A and B: [0] of all other tiles, [1] of those first ones
	const uint32_t
	    *film; // what light paths brought to the rows to come: struct film_pixel a pixel; NULL: none. The caller sets it
	double film_units[2]; // radiance of one of its numbers in half A and B. The caller sets it
};

// Begin a picture of which every pixel has `samples` samples from index `first_sample` on, and those in the first `tiles`
// tiles of the image `more` samples on top.
void resolver_init(struct resolver *resolver, uint32_t first_sample, uint32_t samples, uint32_t tiles, uint32_t more);

// Fill rows [first_row, first_row + rows) of frame->radiance from their sums, which are ACCUMULATOR_FLOATS floats a pixel as
// in shaders/common/accumulate.glsl.
void resolve_sums(const struct resolver *resolver, const float *sums, uint32_t first_row, uint32_t rows,
		  struct frame *frame);

// Fill rows of the AOVs that the frame has, from AOV_WORDS words a pixel.
void resolve_aovs(const uint32_t *words, uint32_t first_row, uint32_t rows, struct frame *frame);

// Bytes of the bits that tell which pixels met a surface: MET_WORDS words for each tile of the picture.
uint64_t met_bytes(uint32_t width, uint32_t height);

// Fill frame->met from such bits.
void resolve_met(const uint32_t *met, struct frame *frame);

#endif
