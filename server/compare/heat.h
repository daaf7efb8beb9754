// A false-colour scale for errors: from near black through violet, red and orange to pale yellow. Equal steps of the
// argument are equal steps of perceived lightness (L of Oklab: Björn Ottosson, "A perceptual color space for image
// processing", 2020). So lightness alone tells the order of two colours, in greyscale and for colour-blind people too. Any
// thread; cannot fail.
#ifndef CANDIL_COMPARE_HEAT_H
#define CANDIL_COMPARE_HEAT_H

#include <stdint.h>

// The scale is logarithmic in a pixel's relative error (the root of its relMSE) between these bounds.
#define HEAT_LOW 1e-3
#define HEAT_HIGH 1.0

// The colour of t as sRGB codes. t is clamped to 0…1.
void heat_colour(double t, uint8_t codes[3]);

// The position of a relative error on the scale, 0…1.
double heat_position(double error);

#endif
