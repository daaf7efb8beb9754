#include "server/worker/technique/radiosity/form_factor.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/base/vec3.h"
#include "server/worker/technique/radiosity/edge_pair.h"
#include "server/worker/technique/radiosity/gauss.h"

#define CUT_CORNERS (FORM_FACTOR_CORNERS * 3u / 2u) // a plane's cut adds one, and more where a polygon is not convex
#define HALVINGS 48u // one in another, at most
#define BY_AREA_ERROR 1e-8 // relative, of the product rules

// A polygon and what is often asked of it.
struct shape {
	double at[CUT_CORNERS][3];
	uint32_t corners;
	double normal[3]; // unit
	double area, center[3], radius; // of a ball around the center that contains it
};

// A product rule of Gauss's, and the distance from a polygon's middle, in its radii, from which on it keeps BY_AREA_ERROR.
static const struct {
	const struct gauss_rule *rule;
	double reach;
} product_rules[] = {{&gauss_2, 4000}, {&gauss_4, 12}, {&gauss_6, 3}};
#define POINTS 36u // of the longest

static void subtract(const double a[3], const double b[3], double out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = a[c] - b[c];
}

static double distance(const double a[3], const double b[3])
{
	double d[3];
	subtract(a, b, d);
	return sqrt(vec3_dot(d, d));
}

static void middle(const double a[3], const double b[3], double out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = 0.5 * (a[c] + b[c]);
}

// Twice the polygon's area, along its normal.
static void across(const double (*at)[3], uint32_t corners, double out[3])
{
	memset(out, 0, 3 * sizeof *out);
	for (uint32_t i = 1; i + 1 < corners; i++) {
		double u[3], v[3], w[3];
		subtract(at[i], at[0], u);
		subtract(at[i + 1], at[0], v);
		vec3_cross(u, v, w);
		for (int c = 0; c < 3; c++)
			out[c] += w[c];
	}
}

double form_factor_area(const struct form_polygon *p)
{
	double twice[3];
	across(p->at, p->corners, twice);
	return 0.5 * sqrt(vec3_dot(twice, twice));
}

// Find area and ball of a shape whose corners and normal are known.
static void measure(struct shape *s)
{
	double twice[3];
	across((const double(*)[3])s->at, s->corners, twice);
	s->area = 0.5 * vec3_dot(twice, s->normal);
	memset(s->center, 0, sizeof s->center);
	for (uint32_t i = 0; i < s->corners; i++)
		for (int c = 0; c < 3; c++)
			s->center[c] += s->at[i][c] / s->corners;
	s->radius = 0;
	for (uint32_t i = 0; i < s->corners; i++)
		s->radius = fmax(s->radius, distance(s->at[i], s->center));
}

// ---- by area ----------------------------------------------------------------------------------------------------------

// Points and weights of a product rule over a quad or triangle, as the bilinear map of a square. Returns their number.
static uint32_t spread(const struct shape *s, const struct gauss_rule *rule, double out[POINTS][4])
{
	const double(*v)[3] = s->at;
	const double *last = v[s->corners - 1];
	uint32_t n = 0;
	for (uint32_t i = 0; i < rule->points; i++) {
		for (uint32_t j = 0; j < rule->points; j++, n++) {
			double wx, wy, du[3], dv[3], d[3];
			const double x = 0.5 + 0.5 * gauss_node(rule, i, &wx), y = 0.5 + 0.5 * gauss_node(rule, j, &wy);
			for (int c = 0; c < 3; c++) {
				du[c] = (1 - y) * (v[1][c] - v[0][c]) + y * (v[2][c] - last[c]);
				dv[c] = (1 - x) * (last[c] - v[0][c]) + x * (v[2][c] - v[1][c]);
				out[n][c] =
				    (1 - y) * ((1 - x) * v[0][c] + x * v[1][c]) + y * ((1 - x) * last[c] + x * v[2][c]);
			}
			vec3_cross(du, dv, d);
			out[n][3] = 0.25 * wx * wy * vec3_dot(d, s->normal);
		}
	}
	return n;
}

static double by_area(const struct shape *a, const struct shape *b, const struct gauss_rule *of_a,
		      const struct gauss_rule *of_b)
{
	double p[POINTS][4], q[POINTS][4], sum = 0;
	const uint32_t n = spread(a, of_a, p), m = spread(b, of_b, q);
	for (uint32_t i = 0; i < n; i++) {
		for (uint32_t j = 0; j < m; j++) {
			double r[3];
			subtract(q[j], p[i], r);
			const double square = vec3_dot(r, r);
			sum -= p[i][3] * q[j][3] * vec3_dot(a->normal, r) * vec3_dot(b->normal, r) / (square * square);
		}
	}
	return sum / PI;
}

// The shortest rule for a shape, seen from as near as `away`; NULL: none is long enough.
static const struct gauss_rule *rule_for(const struct shape *s, double away)
{
	for (size_t i = 0; i < sizeof product_rules / sizeof *product_rules; i++)
		if (s->corners <= 4 && away >= product_rules[i].reach * s->radius)
			return product_rules[i].rule;
	return NULL;
}

// ---- by contour -------------------------------------------------------------------------------------------------------

static uint32_t edges_of(const struct shape *s, struct edge out[CUT_CORNERS])
{
	uint32_t n = 0;
	for (uint32_t i = 0; i < s->corners; i++) {
		struct edge *e = &out[n];
		memcpy(e->from, s->at[i], sizeof e->from);
		subtract(s->at[(i + 1) % s->corners], e->from, e->along);
		e->length = sqrt(vec3_dot(e->along, e->along));
		n += vec3_normalize(e->along);
	}
	return n;
}

static struct bounded by_contour(const struct shape *a, const struct shape *b)
{
	struct edge p[CUT_CORNERS], q[CUT_CORNERS];
	struct bounded sum = {0, 0};
	const uint32_t n = edges_of(a, p), m = edges_of(b, q);
	const double reach = a->radius + b->radius;
	for (uint32_t i = 0; i < n; i++) {
		for (uint32_t j = 0; j < m; j++) {
			const struct bounded s = edge_pair(&p[i], &q[j], reach);
			sum.value += s.value;
			sum.error += s.error;
		}
	}
	return (struct bounded){sum.value / (2 * PI), sum.error / (2 * PI)};
}

// ---- pieces -----------------------------------------------------------------------------------------------------------

// Halve a shape: across its longer sides, or a corner off where it has more than four.
static void halve(const struct shape *s, struct shape out[2])
{
	out[0] = out[1] = *s;
	if (s->corners > 4) {
		out[0].corners = 4;
		out[1].corners = s->corners - 2;
		memcpy(out[1].at[1], s->at[3], (s->corners - 3) * sizeof s->at[0]);
	} else {
		double side[4], cut[2][3];
		for (uint32_t i = 0; i < s->corners; i++)
			side[i] = distance(s->at[i], s->at[(i + 1) % s->corners]);
		uint32_t k = 0;
		if (s->corners == 3) {
			for (uint32_t i = 1; i < 3; i++)
				k = side[i] > side[k] ? i : k;
			middle(s->at[k], s->at[(k + 1) % 3], cut[0]);
			memcpy(out[0].at[(k + 1) % 3], cut[0], sizeof cut[0]);
			memcpy(out[1].at[k], cut[0], sizeof cut[0]);
		} else {
			k = side[1] + side[3] > side[0] + side[2];
			middle(s->at[k], s->at[k + 1], cut[0]);
			middle(s->at[k + 2], s->at[(k + 3) % 4], cut[1]);
			memcpy(out[0].at[k + 1], cut[0], sizeof cut[0]);
			memcpy(out[0].at[k + 2], cut[1], sizeof cut[1]);
			memcpy(out[1].at[k], cut[0], sizeof cut[0]);
			memcpy(out[1].at[(k + 3) % 4], cut[1], sizeof cut[1]);
		}
	}
	measure(&out[0]);
	measure(&out[1]);
}

static struct bounded between(const struct shape *a, const struct shape *b, double enough, uint32_t depth, uint32_t *pairs)
{
	const double apart = distance(a->center, b->center);
	const struct gauss_rule *of_a = rule_for(a, apart - b->radius), *of_b = rule_for(b, apart - a->radius);
	++*pairs;
	if (of_a && of_b) {
		const double value = by_area(a, b, of_a, of_b);
		return (struct bounded){value, BY_AREA_ERROR * fabs(value)};
	}
	const struct bounded whole = by_contour(a, b);
	enough = fmax(enough, FORM_FACTOR_TOLERANCE * (whole.value - whole.error));
	if (whole.error <= enough || depth == HALVINGS || *pairs >= FORM_FACTOR_PAIRS)
		return whole;
	// What is rounded in one half has nothing to do with the other's: each may be off by √½ of what both may.
	const double each = 0.7 * enough;
	const bool cut_a = a->radius >= b->radius;
	struct shape half[2];
	halve(cut_a ? a : b, half);
	const struct bounded first = between(cut_a ? &half[0] : a, cut_a ? b : &half[0], each, depth + 1, pairs);
	const struct bounded second = between(cut_a ? &half[1] : a, cut_a ? b : &half[1], each, depth + 1, pairs);
	return (struct bounded){first.value + second.value, first.error + second.error};
}

// ---- horizons ---------------------------------------------------------------------------------------------------------

// Cut off what is below a plane. A corner within `slack` of it is on it. Returns the number of corners that are left; 0:
// nothing is above.
static uint32_t cut(const double (*at)[3], const double *height, const double *slack, uint32_t corners,
		    double out[CUT_CORNERS][3])
{
	double h[FORM_FACTOR_CORNERS];
	uint32_t n = 0;
	bool above = false;
	for (uint32_t i = 0; i < corners; i++) {
		h[i] = fabs(height[i]) <= slack[i] ? 0 : height[i];
		above |= h[i] > 0;
	}
	for (uint32_t i = 0; i < corners && above; i++) {
		const uint32_t k = (i + 1) % corners;
		if (h[i] >= 0)
			memcpy(out[n++], at[i], sizeof at[i]);
		if ((h[i] < 0) != (h[k] < 0) && h[i] != 0 && h[k] != 0) {
			for (int c = 0; c < 3; c++)
				out[n][c] = at[i][c] + h[i] / (h[i] - h[k]) * (at[k][c] - at[i][c]);
			n++;
		}
	}
	return n;
}

// Take a polygon relative to `origin`, scaled by 2^-exponent. False: it has no area.
static bool take(const struct form_polygon *p, const double origin[3], int exponent, struct shape *s)
{
	s->corners = p->corners;
	for (uint32_t i = 0; i < p->corners; i++)
		for (int c = 0; c < 3; c++)
			s->at[i][c] = ldexp(p->at[i][c] - origin[c], -exponent);
	across((const double(*)[3])s->at, s->corners, s->normal);
	if (!vec3_normalize(s->normal))
		return false;
	measure(s);
	return true;
}

// What of a shape is in front of another's plane, which the rounding of corners tilts. `rounding`: of a corner.
static bool in_front(const struct shape *s, const struct shape *of, double rounding, struct shape *out)
{
	double height[FORM_FACTOR_CORNERS], slack[FORM_FACTOR_CORNERS];
	for (uint32_t i = 0; i < s->corners; i++) {
		double r[3];
		subtract(s->at[i], of->center, r);
		height[i] = vec3_dot(of->normal, r);
		slack[i] = rounding * (1 + sqrt(vec3_dot(r, r)) * of->radius / of->area);
	}
	*out = *s;
	out->corners = cut((const double(*)[3])s->at, height, slack, s->corners, out->at);
	if (out->corners < 3)
		return false;
	measure(out);
	return out->area > 0;
}

double form_factor_exchange(const struct form_polygon *a, const struct form_polygon *b, double enough, double *error)
{
	struct shape p, q, seen_p, seen_q;
	const double *origin = form_factor_area(a) <= form_factor_area(b) ? a->at[0] : b->at[0];
	double far = 0, extent = 0;
	int exponent;
	for (uint32_t i = 0; i < a->corners + b->corners; i++) {
		for (int c = 0; c < 3; c++) {
			const double x = i < a->corners ? a->at[i][c] : b->at[i - a->corners][c];
			if (!isfinite(x - origin[c])) {
				*error = INFINITY;
				return NAN;
			}
			far = fmax(far, fabs(x));
			extent = fmax(extent, fabs(x - origin[c]));
		}
	}
	frexp(extent, &exponent);
	*error = 0;
	const double rounding = ldexp(4 * DBL_EPSILON * far, -exponent);
	if (!take(a, origin, exponent, &p) || !take(b, origin, exponent, &q) || !in_front(&p, &q, rounding, &seen_p) ||
	    !in_front(&q, &p, rounding, &seen_q))
		return 0;
	uint32_t pairs = 0;
	struct bounded sum = between(&seen_p, &seen_q, ldexp(enough, -2 * exponent), 0, &pairs);
	*error = ldexp(sum.error, 2 * exponent);
	return ldexp(sum.value, 2 * exponent);
}

double form_factor_at(const double at[3], const double normal[3], const struct form_polygon *polygon)
{
	static const double none[FORM_FACTOR_CORNERS];
	double ray[FORM_FACTOR_CORNERS][3], height[FORM_FACTOR_CORNERS], seen[CUT_CORNERS][3], sum = 0;
	for (uint32_t i = 0; i < polygon->corners; i++) {
		subtract(polygon->at[i], at, ray[i]);
		height[i] = vec3_dot(ray[i], normal);
	}
	const uint32_t n = cut((const double(*)[3])ray, height, none, polygon->corners, seen);
	for (uint32_t i = 0; i < n; i++) {
		double cross[3];
		const double *v = seen[i], *w = seen[(i + 1) % n];
		vec3_cross(w, v, cross);
		const double length = sqrt(vec3_dot(cross, cross));
		if (length > 0)
			sum += atan2(length, vec3_dot(v, w)) * vec3_dot(cross, normal) / length;
	}
	return sum / (2 * PI);
}
