#include "server/worker/technique/vct/vct_cones.h"

#include <math.h>

#include "server/base/angle.h"

#define RINGS_MAX 4

static const struct {
	uint32_t count;
	uint32_t rings[RINGS_MAX]; // cones in each, from the middle out
} sets[] = {{6, {0}}, {9, {1, 8}}, {16, {1, 5, 10}}, {32, {1, 6, 10, 15}}};

uint32_t vct_cones_count(uint32_t wanted)
{
	const uint32_t last = sizeof sets / sizeof *sets - 1;
	for (uint32_t i = 0; i < last; i++)
		if (sets[i].count >= wanted)
			return sets[i].count;
	return sets[last].count;
}

static void cones_put(float cone[4], float tangent[4], double radius, double phi, double weight, double tan_half)
{
	cone[0] = (float)(radius * cos(phi));
	cone[1] = (float)(radius * sin(phi));
	cone[2] = (float)sqrt(1 - radius * radius);
	cone[3] = (float)weight;
	tangent[0] = (float)tan_half;
	tangent[1] = tangent[2] = tangent[3] = 0;
}

static void fill_six(float cone[VCT_CONES_MAX][4], float tangent[VCT_CONES_MAX][4])
{
	cones_put(cone[0], tangent[0], 0, 0, 0.25, tan(PI / 6));
	for (uint32_t i = 1; i < 6; i++)
		cones_put(cone[i], tangent[i], sin(PI / 3), 2 * PI * i / 5, 0.15, tan(PI / 6));
}

// Fill in the cones of one ring, which has `n` of all `count` shares; `inner` shares lie within it.
static void fill_ring(uint32_t inner, uint32_t n, uint32_t count, uint32_t ring, float cone[][4], float tangent[][4])
{
	const double area0 = (double)inner / count, area1 = (double)(inner + n) / count;
	const double radius = n == 1 ? 0 : sqrt(0.5 * (area0 + area1));
	// A share's solid angle is 2π (cos θ0 − cos θ1) / n, with sin² θ the area within; that of a cone is 2π (1 − cos).
	const double omega = (sqrt(1 - area0) - sqrt(1 - area1)) / n;
	const double tan_half = tan(acos(1 - omega));
	for (uint32_t i = 0; i < n; i++)
		cones_put(cone[i], tangent[i], radius, 2 * PI * (i + 0.5 * (ring & 1)) / n, 1.0 / count, tan_half);
}

void vct_cones_fill(uint32_t count, float cone[VCT_CONES_MAX][4], float tangent[VCT_CONES_MAX][4])
{
	uint32_t set = 0;
	while (sets[set].count != count)
		set++;
	if (set == 0) {
		fill_six(cone, tangent);
		return;
	}
	uint32_t done = 0;
	for (uint32_t ring = 0; ring < RINGS_MAX && sets[set].rings[ring] > 0; ring++) {
		fill_ring(done, sets[set].rings[ring], count, ring, cone + done, tangent + done);
		done += sets[set].rings[ring];
	}
}
