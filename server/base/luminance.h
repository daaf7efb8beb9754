// Luminance of linear Rec.709 light, in the unit of its components: Rec. ITU-R BT.709, E_Y.
#ifndef CANDIL_BASE_LUMINANCE_H
#define CANDIL_BASE_LUMINANCE_H

static inline double luminance_of(double r, double g, double b)
{
	return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

static inline double luminance(const float rgb[3])
{
	return luminance_of((double)rgb[0], (double)rgb[1], (double)rgb[2]);
}

#endif
