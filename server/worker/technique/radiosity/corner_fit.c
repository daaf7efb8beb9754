#include "server/worker/technique/radiosity/corner_fit.h"

#include <math.h>

#include "server/base/vec3.h"

#define RIDGE 1e-7 // of the spread in all directions: where there is none, as across a plane, the slope is 0

// Sums over the samples, of which the first is the origin of values.
struct sums {
	double weight[CORNER_FIT_MOST], middle[3], mean[3];
	double spread[3][3]; // second moments of places about the middle
	double slope[3][3]; // the same of values (first index) and places
	double whole[3]; // and of values
};

static void take_means(struct sums *s, const float place[3], const struct corner_sample *samples, uint32_t count)
{
	double whole = 0;
	for (uint32_t i = 0; i < count; i++) {
		double d2 = 0;
		for (int k = 0; k < 3; k++) {
			const double d = (double)samples[i].at[k] - (double)place[k];
			d2 += d * d;
		}
		s->weight[i] = d2 > 0 ? 1 / d2 : 0;
		whole += s->weight[i];
	}
	for (uint32_t i = 0; i < count; i++) {
		s->weight[i] = whole > 0 && isfinite(whole) ? s->weight[i] / whole : 0;
		for (int k = 0; k < 3; k++) {
			s->middle[k] += s->weight[i] * ((double)samples[i].at[k] - (double)place[k]);
			s->mean[k] += s->weight[i] * ((double)samples[i].light[k] - (double)samples[0].light[k]);
		}
	}
}

static void take_moments(struct sums *s, const float place[3], const struct corner_sample *samples, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		double d[3];
		for (int k = 0; k < 3; k++)
			d[k] = (double)samples[i].at[k] - (double)place[k] - s->middle[k];
		for (int k = 0; k < 3; k++) {
			const double q = (double)samples[i].light[k] - (double)samples[0].light[k] - s->mean[k];
			s->whole[k] += s->weight[i] * q * q;
			for (int j = 0; j < 3; j++) {
				s->spread[k][j] += s->weight[i] * d[k] * d[j];
				s->slope[k][j] += s->weight[i] * q * d[j];
			}
		}
	}
}

// The inverse of a symmetric matrix. False: it has none.
static bool invert(double (*m)[3], double (*out)[3])
{
	for (int k = 0; k < 3; k++)
		vec3_cross(m[(k + 1) % 3], m[(k + 2) % 3], out[k]);
	const double determinant = vec3_dot(m[0], out[0]);
	for (int k = 0; k < 9; k++)
		out[k / 3][k % 3] /= determinant;
	return determinant > 0;
}

// R² of a channel, adjusted for the three numbers that a linear function on a surface has.
static double explained(double share, uint32_t count)
{
	return fmin(fmax(1 - (1 - share) * (count - 1) / (count - 3), 0), 1);
}

static double bounded(double value, int channel, const struct corner_sample *samples, uint32_t count)
{
	double low = INFINITY, high = -INFINITY;
	for (uint32_t i = 0; i < count; i++) {
		low = fmin(low, (double)samples[i].light[channel]);
		high = fmax(high, (double)samples[i].light[channel]);
	}
	const double beyond = CORNER_FIT_BEYOND * fmin(high - low, low);
	return fmin(fmax(value, low - beyond), high + beyond);
}

void corner_fit(const float place[3], const struct corner_sample *samples, uint32_t count, float values[3])
{
	struct sums s = {0};
	double inverse[3][3];
	take_means(&s, place, samples, count);
	take_moments(&s, place, samples, count);
	const double spread = s.spread[0][0] + s.spread[1][1] + s.spread[2][2];
	for (int k = 0; k < 3; k++)
		s.spread[k][k] += RIDGE * spread;
	if (count < CORNER_FIT_LEAST || !invert(s.spread, inverse))
		return;
	for (int k = 0; k < 3; k++) {
		double slope[3];
		for (int j = 0; j < 3; j++)
			slope[j] = vec3_dot(inverse[j], s.slope[k]);
		const double own = (double)values[k], share = s.whole[k] > 0 ? vec3_dot(slope, s.slope[k]) / s.whole[k] : 0;
		const double fitted = (double)samples[0].light[k] + s.mean[k] - vec3_dot(slope, s.middle);
		values[k] = (float)bounded(own + explained(share, count) * (fitted - own), k, samples, count);
	}
}
