// A false-colour scale for errors: from near black through violet, red and orange to pale yellow. Equal steps of the
// argument are equal steps of perceived lightness (L of Oklab: Björn Ottosson, "A perceptual color space for image
// processing", 2020), so the order of two colours can be told by brightness alone, in grey and by the colour-blind too.
#ifndef CANDIL_COMPARE_HEAT_H
#define CANDIL_COMPARE_HEAT_H

#include <stdint.h>

// The scale is logarithmic in the pixel's relative error (the root of its relMSE) between these two.
#define HEAT_LOW 1e-3
#define HEAT_HIGH 1.0

// sRGB codes of t, 0…1 (clipped).
void heat_colour(double t, uint8_t codes[3]);

// Where an error lies on the scale, 0…1.
double heat_position(double error);

#endif
