#include "server/worker/technique/radiosity/edge_pair.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

#include "server/base/vec3.h"
#include "server/worker/technique/radiosity/gauss.h"

#define ROUNDING (2 * DBL_EPSILON) // of a sum of logarithms, beside the sizes of its terms
#define TOUCHING 0x1p-18 // of an edge's length: what is left so near a singularity is below rounding

// Two edges, the shorter one first.
struct edges {
	const struct edge *p, *q;
	double sine; // of their angle
	double unit; // square of the distance whose logarithm is 0
};

// Where the point at t of the first edge is beside the second: the second's ends along it, as seen from the point, and the
// square of the point's distance from its line.
struct beside {
	double a, b, h2;
};

static struct beside see(const struct edges *e, double t)
{
	double w[3];
	for (int c = 0; c < 3; c++)
		w[c] = e->q->from[c] - e->p->from[c] - t * e->p->along[c];
	const double a = vec3_dot(w, e->q->along);
	for (int c = 0; c < 3; c++)
		w[c] -= a * e->q->along[c];
	return (struct beside){a, a + e->q->length, vec3_dot(w, w)};
}

// ∫ ln r along an edge, from a point, which may be an end of it.
static double log_along(struct beside s, double length, double unit)
{
	const double a2 = s.h2 + s.a * s.a, b2 = s.h2 + s.b * s.b, h = sqrt(s.h2);
	const double at_a = a2 > 0 ? s.a * log(a2 / unit) : 0, at_b = b2 > 0 ? s.b * log(b2 / unit) : 0;
	return 0.5 * (at_b - at_a) - length + h * atan2(length * h, s.h2 + s.a * s.b);
}

// ∫∫ ln r over an interval of the first edge and all of the second. As a function of the place on the first edge, the inner
// integral is singular where r is 0 at an end of the second, for complex places too, and has a kink where the edges cross.
// Twice the half of the interval away from these, 12 points have 13 digits.
static double log_over(const struct edges *e, double from, double to)
{
	const double mid = 0.5 * (from + to), half = 0.5 * (to - from);
	double sum = 0;
	const struct beside s = see(e, mid);
	double free = sqrt(s.h2 + fmin(s.a * s.a, s.b * s.b));
	if (s.a < 0 && s.b > 0 && e->sine > 1e-14)
		free = fmin(free, sqrt(s.h2) / e->sine);
	if (free < 2 * half && half > TOUCHING * e->p->length)
		return log_over(e, from, mid) + log_over(e, mid, to);
	for (uint32_t i = 0; i < gauss_12.points; i++) {
		double weight;
		const double t = mid + half * gauss_node(&gauss_12, i, &weight);
		sum += weight * log_along(see(e, t), e->q->length, e->unit);
	}
	return half * sum;
}

struct bounded edge_pair(const struct edge *p, const struct edge *q, double unit)
{
	double cross[3], size = 0;
	const double cosine = vec3_dot(p->along, q->along), area = p->length * q->length;
	for (int c = 0; c < 3; c++)
		size += fabs(p->along[c] * q->along[c]);
	if (size == 0)
		return (struct bounded){0, 0};
	vec3_cross(p->along, q->along, cross);
	const bool shorter = p->length <= q->length;
	const struct edges e = {shorter ? p : q, shorter ? q : p, sqrt(vec3_dot(cross, cross)), unit * unit};
	const double logs = fabs(cosine) > DBL_EPSILON ? log_over(&e, 0, e.p->length) : 0;
	return (struct bounded){cosine * logs, size * ROUNDING * (fabs(logs) + area)};
}
