#include "server/worker/technique/radiosity/hemicube_origin.h"

#include <math.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/base/vec3.h"

#define GOLDEN 0.6180339887498949

static double reversed(uint32_t bits)
{
	double value = 0;
	for (double digit = 0.5; bits; bits >>= 1, digit *= 0.5)
		value += bits & 1 ? digit : 0;
	return value;
}

static double fraction(double x)
{
	return x - floor(x);
}

static void barycentre(const struct form_polygon *p, double at[3])
{
	double area[2] = {0, 0};
	for (uint32_t k = 2; k < p->corners; k++) {
		double u[3], v[3], across[3];
		for (int c = 0; c < 3; c++) {
			u[c] = p->at[k - 1][c] - p->at[0][c];
			v[c] = p->at[k][c] - p->at[0][c];
		}
		vec3_cross(u, v, across);
		area[k - 2] = sqrt(vec3_dot(across, across));
	}
	const double all = area[0] + area[1], share = all > 0 ? area[0] / all : 1;
	const uint32_t last = p->corners - 1;
	for (int c = 0; c < 3; c++)
		at[c] = (p->at[0][c] + p->at[2][c] + share * p->at[1][c] + (1 - share) * p->at[last][c]) / 3;
}

// The place in a polygon for a point of the unit square, by a map that keeps areas: in one direction quads are cut into
// strips of equal areas, for the breadth of the strips changes linearly.
static void place(const struct form_polygon *p, double s, double t, double at[3])
{
	double v[4][3], low[3], high[3], a = 0, b = 0;
	memcpy(v, p->at, sizeof v);
	if (p->corners == 3)
		memcpy(v[3], v[2], sizeof v[3]);
	for (int c = 0; c < 3; c++) {
		low[c] = v[3][c] - v[0][c];
		high[c] = v[2][c] - v[1][c];
	}
	// Density along x of the map (x, y) to the quad: ∝ |across| at its ends, averaged over y.
	double bottom[3], top[3], n0[3], n1[3], n2[3], n3[3];
	for (int c = 0; c < 3; c++) {
		bottom[c] = v[1][c] - v[0][c];
		top[c] = v[2][c] - v[3][c];
	}
	vec3_cross(bottom, low, n0);
	vec3_cross(bottom, high, n1);
	vec3_cross(top, high, n2);
	vec3_cross(top, low, n3);
	const double d00 = sqrt(vec3_dot(n0, n0)), d10 = sqrt(vec3_dot(n1, n1));
	const double d11 = sqrt(vec3_dot(n2, n2)), d01 = sqrt(vec3_dot(n3, n3));
	a = 0.5 * (d00 + d01);
	b = 0.5 * (d10 + d11);
	// ∫0^x a + (b − a) x = s (a + b) / 2
	const double whole = 0.5 * s * (a + b), root = sqrt(fmax(a * a + 2 * (b - a) * whole, 0));
	const double x = a + root > 0 ? 2 * whole / (a + root) : s;
	const double e = d00 + (d10 - d00) * x, f = d01 + (d11 - d01) * x;
	const double part = 0.5 * t * (e + f), other = sqrt(fmax(e * e + 2 * (f - e) * part, 0));
	const double y = e + other > 0 ? 2 * part / (e + other) : t;
	for (int c = 0; c < 3; c++)
		at[c] = (1 - y) * ((1 - x) * v[0][c] + x * v[1][c]) + y * ((1 - x) * v[3][c] + x * v[2][c]);
}

// How far off the plane rounding may lift what is in it, at this place.
static double lift_of(const struct elements *e, const struct patch *p, const double at[3])
{
	const struct patch_face *face = &e->patches.faces.list[p->face];
	double error = 0, reach = 0;
	for (int k = 0; k < 4 && face->corner[k] != NONE; k++) {
		const float *corner = e->patches.vertices[face->corner[k]].position;
		double own = 0, away = 0;
		for (int c = 0; c < 3; c++) {
			own += fabs(p->normal[c] * (double)corner[c]);
			away += ((double)corner[c] - at[c]) * ((double)corner[c] - at[c]);
		}
		error = fmax(error, own);
		reach = fmax(reach, sqrt(away));
	}
	return HEMICUBE_OFFSET_ERROR * error + HEMICUBE_TILT_ERROR * reach;
}

static void make_frame(const double side[3], double angle, struct hemicube_origin *out)
{
	double x[3], y[3];
	const double along = vec3_dot(side, out->z);
	for (int c = 0; c < 3; c++)
		x[c] = side[c] - along * out->z[c];
	if (!vec3_normalize(x)) {
		const int least = fabs(out->z[0]) < 0.6 ? 0 : 1;
		for (int c = 0; c < 3; c++)
			x[c] = (c == least) - out->z[least] * out->z[c];
		vec3_normalize(x);
	}
	vec3_cross(out->z, x, y);
	for (int c = 0; c < 3; c++) {
		out->x[c] = cos(angle) * x[c] + sin(angle) * y[c];
		out->y[c] = cos(angle) * y[c] - sin(angle) * x[c];
	}
}

void hemicube_origin_get(const struct elements *e, uint32_t element, uint32_t i, uint32_t count, struct hemicube_origin *out)
{
	const bool back = element >= e->patches.count;
	const uint32_t at = back ? element - e->patches.count : element;
	struct patch p;
	double side[3];
	patches_get(&e->patches, at, &p);
	if (count == 1)
		barycentre(&p.shape, out->at);
	else
		place(&p.shape, (i + 0.5) / count, fraction(reversed(i) + 0.5 / count), out->at);
	const double lift = lift_of(e, &p, out->at);
	for (int c = 0; c < 3; c++) {
		out->z[c] = back ? -p.normal[c] : p.normal[c];
		out->at[c] += lift * out->z[c];
		side[c] = p.shape.at[1][c] - p.shape.at[0][c];
	}
	make_frame(side, 0.5 * PI * fraction(GOLDEN * (1.0 + at) + GOLDEN * GOLDEN * i), out);
}
