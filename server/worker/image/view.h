// From scene-linear radiance to 8-bit sRGB: exposure, a view transform, clipping, the sRGB curve. Pure functions, any
// thread; none fails.
//
//   VIEW_NONE      clip at 1
//   VIEW_REINHARD  the colour divided by 1 + its Rec.709 luminance (Reinhard et al., "Photographic tone reproduction for
//                  digital images", 2002, the simple operator): keeps the hue; a saturated light may still clip
//   VIEW_FILMIC    John Hable's curve ("Filmic tonemapping for real-time rendering", SIGGRAPH 2010 course notes), on each
//                  channel by itself, with exposure bias 2 and linear white 11.2: a soft shoulder and toe
//
// A negative value counts as 0, NaN as 0, +infinity as the largest float.
#ifndef CANDIL_WORKER_VIEW_H
#define CANDIL_WORKER_VIEW_H

#include <stdint.h>

#include "server/worker/image/codec.h"

// The name of a view transform: "none", "reinhard", "filmic". Static.
const char *view_name(enum codec_view view);

// Apply exposure and view transform to a radiance: `out` is the display-linear colour, 0…1 in each channel, of
// `rgb` · 2^exposure_ev.
void view_apply(enum codec_view view, double exposure_ev, const float rgb[3], double out[3]);

// The sRGB curve (IEC 61966-2-1) of x, clipped to 0…1.
double view_srgb_encode(double x);

// Its inverse.
double view_srgb_decode(double v);

// As view_apply, then encoded by the sRGB curve and rounded to the nearest of 256 codes.
void view_srgb8(enum codec_view view, double exposure_ev, const float rgb[3], uint8_t out[3]);

// The same for many pixels: the least value of each code, found once, in the place of a power for each channel.
#define VIEW_CELLS 4096u
struct view_table {
	enum codec_view view;
	double scale;
	double least[257]; // display-linear, of each code, ascending; beyond the last one: infinity
	uint8_t code[VIEW_CELLS + 1]; // of the least value in each part of 0…1
};

// Takes as long as some thousand pixels do by view_srgb8.
void view_table_init(struct view_table *table, enum codec_view view, double exposure_ev);

// As view_srgb8 by the table's view and exposure, with the same codes.
void view_table_srgb8(const struct view_table *table, const float rgb[3], uint8_t out[3]);

#endif
