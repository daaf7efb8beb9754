// The device's traversal against Embree's, as an independent judge: the same rays, RTC_SCENE_FLAG_ROBUST, scenes given on
// the command line after the loader. Where surfaces coincide the two may name different triangles at one place; beyond that
// at most one ray in 100,000 may differ, and each of them must be a tie.
#include <embree3/rtcore.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/worker/devices.h"
#include "tests/support/cast.h"
#include "tests/support/load_scene.h"

#define RAYS (1u << 20)

static uint64_t random_state = 1;

static double random_unit(void)
{
	// PCG-XSH-RR's step (O'Neill 2014): good enough to aim rays.
	random_state = random_state * 6364136223846793005ull + 1442695040888963407ull;
	uint32_t x = (uint32_t)(((random_state >> 18) ^ random_state) >> 27);
	uint32_t rot = (uint32_t)(random_state >> 59);
	return ((x >> rot) | (x << (-rot & 31))) / 4294967296.0;
}

static void random_direction(float d[3])
{
	double z = 2 * random_unit() - 1, phi = 6.283185307179586 * random_unit(), r = sqrt(1 - z * z);
	d[0] = (float)(r * cos(phi));
	d[1] = (float)(r * sin(phi));
	d[2] = (float)z;
}

// A third from around the scene towards it, a third from triangles' surfaces, a third along axes through vertices and edges,
// where ties and exact grazes are.
static void make_ray(const struct blob_header *b, uint32_t i, struct cast_ray *r)
{
	const struct triangle *triangles = blob_section(b, BLOB_TRIANGLES);
	const struct vertex *vertices = blob_section(b, BLOB_VERTICES);
	const uint32_t count = blob_count(b, BLOB_TRIANGLES);
	const struct triangle *t = &triangles[(uint32_t)(random_unit() * count)];
	double w1 = random_unit(), w2 = random_unit() * (1 - w1);
	float on[3], extent = 0;
	for (int c = 0; c < 3; c++) {
		const float *v[3] = {vertices[t->vertex[0]].position, vertices[t->vertex[1]].position,
				     vertices[t->vertex[2]].position};
		on[c] = i % 3 == 2 ? v[0][c] : (float)(v[0][c] * (1 - w1 - w2) + v[1][c] * w1 + v[2][c] * w2);
		extent = fmaxf(extent, b->bounds_max[c] - b->bounds_min[c]);
	}
	random_direction(r->direction);
	if (i % 3 == 2)
		for (int c = 0; c < 3; c++)
			r->direction[c] = (uint32_t)c == i / 3 % 3 ? (i & 1 ? 1.0f : -1.0f) : 0.0f;
	for (int c = 0; c < 3; c++)
		r->origin[c] = i % 3 == 1 ? on[c] + 1e-3f * extent * r->direction[c] : on[c] - extent * r->direction[c];
	r->t_max = INFINITY;
}

// ---- is it a tie? -------------------------------------------------------------------------------------------------------
//
// Two correct tests in floats may differ where exact arithmetic could not help them: two surfaces at one distance, or a ray
// that passes an edge closer than a coordinate's rounding. Judged in doubles, from the vertices as they are.

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Distance of the ray's line from the segment a b, both relative to the origin and stripped of the part along the ray.
static double line_to_segment(const double a[3], const double b[3])
{
	double ab[3], p[3];
	for (int c = 0; c < 3; c++)
		ab[c] = b[c] - a[c];
	double l2 = dot(ab, ab), s = l2 > 0 ? -dot(a, ab) / l2 : 0;
	s = fmin(1, fmax(0, s));
	for (int c = 0; c < 3; c++)
		p[c] = a[c] + s * ab[c];
	return sqrt(dot(p, p));
}

static double line_to_outline(const struct blob_header *b, uint32_t id, const struct cast_ray *r)
{
	const struct triangle *t = (const struct triangle *)blob_section(b, BLOB_TRIANGLES) + id;
	const struct vertex *vertices = blob_section(b, BLOB_VERTICES);
	double d[3], v[3][3], least = INFINITY;
	for (int c = 0; c < 3; c++)
		d[c] = (double)r->direction[c];
	double length = sqrt(dot(d, d));
	for (int k = 0; k < 3; k++) {
		for (int c = 0; c < 3; c++)
			v[k][c] = (double)vertices[t->vertex[k]].position[c] - (double)r->origin[c];
		double along = dot(v[k], d) / (length * length);
		for (int c = 0; c < 3; c++)
			v[k][c] -= along * d[c];
	}
	for (int k = 0; k < 3; k++)
		least = fmin(least, line_to_segment(v[k], v[(k + 1) % 3]));
	return least;
}

enum verdict { SAME_PLACE, TIE, UNEXPLAINED };

static enum verdict judge_difference(const struct blob_header *b, const struct cast_ray *r, const struct cast_hit *ours,
				     const struct RTCRayHit *theirs)
{
	const bool judged = theirs->hit.geomID != RTC_INVALID_GEOMETRY_ID;
	const double ours_t = ours->id != NONE ? (double)ours->t : INFINITY;
	const double theirs_t = judged ? (double)theirs->ray.tfar : INFINITY;
	double scale = 0;
	for (int c = 0; c < 3; c++)
		scale = fmax(scale, fmax(fabs((double)r->origin[c]),
					 fmax(fabs((double)b->bounds_min[c]), fabs((double)b->bounds_max[c]))));
	const double rounding = 9.5367431640625e-07 * scale; // 2⁻²⁰: the error bound that the shaders work with
	if (fabs(ours_t - theirs_t) <= rounding)
		return SAME_PLACE;
	// The nearer hit is the one that the other side did not see: by a hair's breadth past an edge, or behind the origin.
	const uint32_t nearer = ours_t < theirs_t ? ours->id : theirs->hit.primID;
	const bool hair = line_to_outline(b, nearer, r) <= rounding || fmin(ours_t, theirs_t) <= rounding;
	return hair ? TIE : UNEXPLAINED;
}

// [0]: rays of every kind that a renderer casts; [1]: rays aimed at vertices along an axis, all of them on edges.
struct tally {
	uint32_t rays[2], hits[2], same_place[2], differ[2], unexplained[2], any_differs;
};

static void compare(const struct blob_header *b, RTCScene judge, const struct cast_ray *rays, const struct cast_hit *hits,
		    struct tally *t)
{
	for (uint32_t i = 0; i < RAYS; i++) {
		const struct RTCRayHit h = cast_judge_hit(judge, &rays[i]);
		const uint32_t judged = h.hit.geomID != RTC_INVALID_GEOMETRY_ID ? h.hit.primID : NONE;
		const int kind = i % 3 == 2;
		t->rays[kind]++;
		t->hits[kind] += hits[i].id != NONE;
		if (judged == hits[i].id)
			continue;
		const enum verdict v = judge_difference(b, &rays[i], &hits[i], &h);
		t->same_place[kind] += v == SAME_PLACE;
		t->differ[kind] += v != SAME_PLACE;
		if (v != UNEXPLAINED)
			continue;
		t->unexplained[kind]++;
		printf("  ray %u: device %d t %.9g, embree %d t %.9g\n", i, (int)hits[i].id, (double)hits[i].t, (int)judged,
		       (double)h.ray.tfar);
	}
}

struct arrays {
	struct cast_ray *rays, *segments;
	struct cast_hit *hits, *any;
};

// For any-hit: rays without end, segments that stop short of the closest hit, segments that just reach it, and lanes without
// a ray, side by side in every packet.
static void make_segments(const struct cast_ray *rays, const struct cast_hit *closest, struct cast_ray *segments)
{
	for (uint32_t i = 0; i < RAYS; i++) {
		const float t = closest[i].id != NONE ? closest[i].t : 1.0f;
		segments[i] = rays[i];
		segments[i].t_max = i % 4 == 0 ? INFINITY : i % 4 == 1 ? 0.999f * t : i % 4 == 2 ? 1.001f * t : -1.0f;
	}
}

// Whether an any-hit ray of make_segments must have found something.
static bool must_find(uint32_t i, const struct cast_hit *closest)
{
	return closest->id != NONE && i % 4 % 2 == 0;
}

static bool test_walk(struct device *device, struct resident_scene *resident, RTCScene judge, struct arrays *a, bool packet,
		      const char *file)
{
	struct error err = {0};
	struct tally t = {0};
	struct cast cast;
	enum status s = cast_init(&cast, device, resident, a->rays, RAYS, packet, &err);
	if (s == STATUS_OK) {
		s = cast_run(&cast, false, &err);
		if (s == STATUS_OK)
			s = cast_read(&cast, a->hits, &err);
		cast_finish(&cast);
	}
	if (s == STATUS_OK) {
		make_segments(a->rays, a->hits, a->segments);
		s = cast_init(&cast, device, resident, a->segments, RAYS, packet, &err);
	}
	if (s == STATUS_OK) {
		s = cast_run(&cast, true, &err);
		if (s == STATUS_OK)
			s = cast_read(&cast, a->any, &err);
		cast_finish(&cast);
	}
	if (s == STATUS_OK)
		compare(resident->blob, judge, a->rays, a->hits, &t);
	for (uint32_t i = 0; s == STATUS_OK && i < RAYS; i++)
		t.any_differs += must_find(i, &a->hits[i]) != (a->any[i].id != NONE);
	const uint32_t allowed = t.rays[0] / 100000;
	bool good = s == STATUS_OK && t.hits[0] > RAYS / 3 && t.differ[0] <= allowed && t.unexplained[0] == 0 &&
		    t.unexplained[1] == 0 && t.any_differs == 0;
	printf("%s %s, %s: %u triangles; %u rays, %u hit, %u at the same place another triangle, %u differ (%u allowed), %u "
	       "unexplained; "
	       "%u rays on edges, %u hit, %u same place, %u differ, %u unexplained; %u any-hits differ %s\n",
	       good ? "ok" : "FAIL", file, packet ? "packets" : "single rays", blob_count(resident->blob, BLOB_TRIANGLES),
	       t.rays[0], t.hits[0], t.same_place[0], t.differ[0], allowed, t.unexplained[0], t.rays[1], t.hits[1],
	       t.same_place[1], t.differ[1], t.unexplained[1], t.any_differs, s == STATUS_OK ? "" : err.text);
	return good;
}

static bool test_scene(struct device *device, RTCDevice embree, const char *loader, const char *file)
{
	struct loaded_scene scene;
	struct error err = {0};
	if (load_scene(loader, file, &scene, &err) != STATUS_OK) {
		printf("FAIL %s: %s\n", file, err.text);
		return false;
	}
	struct resident_scene resident = {.blob = scene.blob, .bytes = scene.bytes, .fd = scene.fd};
	blob_view_init(&resident.view, scene.blob);
	struct arrays a = {malloc(RAYS * sizeof *a.rays), malloc(RAYS * sizeof *a.segments), malloc(RAYS * sizeof *a.hits),
			   malloc(RAYS * sizeof *a.any)};
	struct cast_hit *single = malloc(RAYS * sizeof *single);
	bool good = a.rays && a.segments && a.hits && a.any && single;
	for (uint32_t i = 0; good && i < RAYS; i++)
		make_ray(scene.blob, i, &a.rays[i]);
	RTCScene judge = cast_judge(embree, scene.blob);
	good = good && test_walk(device, &resident, judge, &a, false, file);
	if (good && device->info.packets) {
		memcpy(single, a.hits, RAYS * sizeof *single);
		good = test_walk(device, &resident, judge, &a, true, file);
		// Not almost the same: the same, t and barycentrics to the bit.
		const bool same = !memcmp(single, a.hits, RAYS * sizeof *single);
		printf("%s %s: packets and single rays find the same\n", same ? "ok" : "FAIL", file);
		good = good && same;
	}
	rtcReleaseScene(judge);
	for (unsigned i = 0; i < BIND_SCENE_COUNT; i++)
		buffer_finish(&resident.buffers[i], device);
	loaded_scene_finish(&scene);
	free(a.rays);
	free(a.segments);
	free(a.hits);
	free(a.any);
	free(single);
	return good;
}

int main(int argc, char **argv)
{
	struct device *device;
	struct error err;
	bool good = argc > 2;
	const struct device_options options = {0};
	if (device_create(&options, &device, &err) != STATUS_OK) {
		printf("skipped: %s\n", err.text);
		return 77;
	}
	RTCDevice embree = rtcNewDevice(NULL);
	for (int i = 2; i < argc; i++)
		good = test_scene(device, embree, argv[1], argv[i]) && good;
	rtcReleaseDevice(embree);
	devices_finish(&(struct devices){.vk = device});
	return good ? 0 : 1;
}
