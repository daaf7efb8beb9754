// Which tiles of a point's pictures differ from the reference by more than noise: struct bias of figures.h says how. One
// thread.
#ifndef CANDIL_REPORT_BIAS_H
#define CANDIL_REPORT_BIAS_H

#include "server/report/figures.h"

// The mean luminance of every tile of a picture of the study's size, row by row; pixels that are not finite count as 0.
void bias_tiles(const struct figures *figures, const struct picture *picture, double *tiles);

// Fill in the bias of all points. STATUS_MEMORY.
enum status bias_find(struct figures *figures, struct error *err);

#endif
