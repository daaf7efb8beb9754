#include "server/compare/heat.h"

#include <math.h>
#include <stdbool.h>

#include "server/base/angle.h"
#include "server/worker/image/view.h"

static double mix(double a, double b, double t)
{
	return a + (b - a) * t;
}

// Convert Oklab to linear sRGB, with the matrices of the publication.
static void from_oklab(double lightness, double a, double b, double rgb[3])
{
	double l = lightness + 0.3963377774 * a + 0.2158037573 * b;
	double m = lightness - 0.1055613458 * a - 0.0638541728 * b;
	double s = lightness - 0.0894841775 * a - 1.2914855480 * b;
	l = l * l * l;
	m = m * m * m;
	s = s * s * s;
	rgb[0] = 4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s;
	rgb[1] = -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s;
	rgb[2] = -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s;
}

static bool in_gamut(const double rgb[3])
{
	for (int c = 0; c < 3; c++)
		if (rgb[c] < 0 || rgb[c] > 1)
			return false;
	return true;
}

void heat_colour(double t, uint8_t codes[3])
{
	t = t > 0 ? (t < 1 ? t : 1) : 0;
	double lightness = mix(0.13, 0.97, t);
	double hue = mix(-75, 105, t) * PI / 180; // violet through red to yellow
	double rgb[3];
	// The most colourful colour of this lightness and hue within the screen's gamut, up to a chroma of 0.2.
	for (double chroma = 0.2; chroma >= 0; chroma -= 0.002) {
		from_oklab(lightness, chroma * cos(hue), chroma * sin(hue), rgb);
		if (in_gamut(rgb))
			break;
	}
	for (int c = 0; c < 3; c++)
		codes[c] = (uint8_t)lround(255 * view_srgb_encode(rgb[c]));
}

double heat_position(double error)
{
	if (!(error > HEAT_LOW))
		return 0;
	return fmin(1, log(error / HEAT_LOW) / log(HEAT_HIGH / HEAT_LOW));
}
