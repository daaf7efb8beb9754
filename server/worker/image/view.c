#include "server/worker/image/view.h"

#include <float.h>
#include <math.h>

#define NEAR 1e-9 // relative: by how much sRGB's decoding misses the inverse of its encoding, and more

const char *view_name(enum codec_view view)
{
	switch (view) {
	case CODEC_VIEW_REINHARD:
		return "reinhard";
	case CODEC_VIEW_FILMIC:
		return "filmic";
	case CODEC_VIEW_NONE:
		break;
	}
	return "none";
}

// NaN becomes 0, too: both comparisons with it are false.
static double clip(double x, double top)
{
	return x > 0 ? (x < top ? x : top) : 0;
}

// Hable's rational curve, with its parameters by his names.
static double hable(double x)
{
	const double shoulder = 0.15, linear = 0.50, linear_angle = 0.10, toe = 0.20, toe_numerator = 0.02,
		     toe_denominator = 0.30;
	double top = x * (shoulder * x + linear_angle * linear) + toe * toe_numerator;
	double bottom = x * (shoulder * x + linear) + toe * toe_denominator;
	return top / bottom - toe_numerator / toe_denominator;
}

static double filmic(double x)
{
	const double bias = 2, white = 11.2;
	// Past the white point the curve clips anyway. Stopping there keeps x² from overflowing.
	return hable(clip(bias * x, white)) / hable(white);
}

static void apply(enum codec_view view, double scale, const float rgb[3], double out[3])
{
	double c[3];
	for (int i = 0; i < 3; i++)
		c[i] = clip(clip((double)rgb[i], FLT_MAX) * scale, FLT_MAX);
	double divisor = 1 + 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
	for (int i = 0; i < 3; i++) {
		double x = c[i];
		if (view == CODEC_VIEW_REINHARD)
			x /= divisor;
		else if (view == CODEC_VIEW_FILMIC)
			x = filmic(x);
		out[i] = clip(x, 1);
	}
}

void view_apply(enum codec_view view, double exposure_ev, const float rgb[3], double out[3])
{
	apply(view, exp2(exposure_ev), rgb, out);
}

double view_srgb_encode(double x)
{
	x = clip(x, 1);
	return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
}

double view_srgb_decode(double v)
{
	v = clip(v, 1);
	return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static uint8_t code_of(double x)
{
	return (uint8_t)lround(255 * view_srgb_encode(x));
}

void view_srgb8(enum codec_view view, double exposure_ev, const float rgb[3], uint8_t out[3])
{
	double linear[3];
	view_apply(view, exposure_ev, rgb, linear);
	for (int i = 0; i < 3; i++)
		out[i] = code_of(linear[i]);
}

// The least x that has the code, between two that are as near to it as the inverse of the curve is exact.
static double least_of(unsigned code)
{
	const double near = view_srgb_decode((code - 0.5) / 255);
	double below = near * (1 - NEAR), least = near * (1 + NEAR);
	for (double middle = 0.5 * (below + least); middle > below && middle < least; middle = 0.5 * (below + least)) {
		if (code_of(middle) < code)
			below = middle;
		else
			least = middle;
	}
	return least;
}

void view_table_init(struct view_table *table, enum codec_view view, double exposure_ev)
{
	table->view = view;
	table->scale = exp2(exposure_ev);
	table->least[0] = 0;
	for (unsigned code = 1; code < 256; code++)
		table->least[code] = least_of(code);
	table->least[256] = (double)INFINITY;
	uint8_t code = 0;
	for (unsigned i = 0; i <= VIEW_CELLS; i++) {
		while ((double)i / VIEW_CELLS >= table->least[code + 1])
			code++;
		table->code[i] = code;
	}
}

void view_table_srgb8(const struct view_table *table, const float rgb[3], uint8_t out[3])
{
	double linear[3];
	apply(table->view, table->scale, rgb, linear);
	for (int i = 0; i < 3; i++) {
		uint8_t code = table->code[(unsigned)(linear[i] * VIEW_CELLS)];
		while (linear[i] >= table->least[code + 1])
			code++;
		out[i] = code;
	}
}
