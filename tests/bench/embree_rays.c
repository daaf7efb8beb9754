#include "tests/bench/embree_rays.h"

#include <math.h>
#include <pthread.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "server/base/clock.h"

struct share {
	RTCScene scene;
	const struct cast_ray *rays;
	uint32_t first, last, width;
	bool any;
	uint32_t hits;
};

uint32_t bench_processors(void)
{
	const long n = sysconf(_SC_NPROCESSORS_ONLN);
	return n < 1 ? 1 : n < (long)EMBREE_THREADS ? (uint32_t)n : EMBREE_THREADS;
}

double bench_us(bool by_processor)
{
	struct timespec t;
	if (!by_processor)
		return (double)clock_us();
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return ((double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3) / bench_processors();
}

#define TRACE(WIDTH, valid, s, context, i) \
	do { \
		struct RTCRayHit##WIDTH h; \
		memset(&h, 0, sizeof h); \
		for (int k = 0; k < (WIDTH); k++) { \
			const struct cast_ray *r = &(s)->rays[(i) + (uint32_t)k]; \
			h.ray.org_x[k] = r->origin[0], h.ray.org_y[k] = r->origin[1], h.ray.org_z[k] = r->origin[2]; \
			h.ray.dir_x[k] = r->direction[0], h.ray.dir_y[k] = r->direction[1], \
			h.ray.dir_z[k] = r->direction[2]; \
			h.ray.tfar[k] = r->t_max; \
			h.ray.mask[k] = ~0u; \
			h.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID; \
		} \
		if ((s)->any) \
			rtcOccluded##WIDTH(valid, (s)->scene, context, &h.ray); \
		else \
			rtcIntersect##WIDTH(valid, (s)->scene, context, &h); \
		for (int k = 0; k < (WIDTH); k++) \
			(s)->hits += (s)->any ? h.ray.tfar[k] < 0 : h.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID; \
	} while (0)

static void *run_share(void *argument)
{
	struct share *s = argument;
	int valid[16];
	struct RTCIntersectContext context;
	rtcInitIntersectContext(&context);
	memset(valid, 0xFF, sizeof valid);
	for (uint32_t i = s->first; i + s->width <= s->last; i += s->width) {
		if (s->width == 8)
			TRACE(8, valid, s, &context, i);
		else
			TRACE(16, valid, s, &context, i);
	}
	return NULL;
}

void embree_rays(RTCScene scene, const struct cast_ray *rays, uint32_t count, uint32_t width, bool any, uint32_t *hits)
{
	pthread_t thread[EMBREE_THREADS];
	struct share shares[EMBREE_THREADS];
	const uint32_t threads = bench_processors(), packets = count / width;
	for (uint32_t t = 0; t < threads; t++) {
		const uint32_t first = (uint32_t)((uint64_t)packets * t / threads * width);
		const uint32_t last = (uint32_t)((uint64_t)packets * (t + 1) / threads * width);
		shares[t] = (struct share){scene, rays, first, last, width, any, 0};
		pthread_create(&thread[t], NULL, run_share, &shares[t]);
	}
	*hits = 0;
	for (uint32_t t = 0; t < threads; t++) {
		pthread_join(thread[t], NULL);
		*hits += shares[t].hits;
	}
}
