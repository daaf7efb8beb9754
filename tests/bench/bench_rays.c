// bench_rays LOADER SCENE...: rays a second of the device's walks beside Embree's, on the same rays, in one run.
//
// Three kinds as a path tracer casts them, 2^18 of each: primary rays from outside of the scene in blocks of 4 × 2 pixels,
// cosine-distributed rays from where those hit, and any-hit segments from there to random points of the scene's box.
// Embree's are rtcIntersect8 and rtcOccluded8 over the rays in the same order, on as many threads as there are processors.
// Each figure is the best of the rounds, which other work on the machine disturbed least; the three contestants take turns
// within a round, so that drift hits all alike. On a software device time is what the processors spent, divided by their
// number: the wall clock's on a machine that does nothing else.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/worker/devices.h"
#include "tests/bench/embree_rays.h"
#include "tests/support/cast.h"
#include "tests/support/load_scene.h"

#define SIDE 512u
#define RAYS (SIDE * SIDE)
#define ROUNDS 9

enum kind { PRIMARY, SECONDARY, SHADOW, KINDS };
static const char *const kind_names[KINDS] = {"primary", "secondary", "any-hit"};

static double random_unit(void)
{
	static uint64_t state = 1;
	state = state * 6364136223846793005ull + 1442695040888963407ull;
	return (double)(state >> 40) / 16777216.0;
}

// ---- rays ---------------------------------------------------------------------------------------------------------------

static void primary_ray(const struct blob_header *b, uint32_t i, struct cast_ray *r)
{
	// 4 × 2 blocks, as the path tracer's tiles.
	const uint32_t block = i / 8, x = block % (SIDE / 4) * 4 + i % 4, y = block / (SIDE / 4) * 2 + i / 4 % 2;
	const struct blob_camera *camera = blob_section(b, BLOB_CAMERAS);
	float center[3], extent = 0;
	for (int c = 0; c < 3; c++) {
		center[c] = 0.5f * (b->bounds_min[c] + b->bounds_max[c]);
		extent = fmaxf(extent, b->bounds_max[c] - b->bounds_min[c]);
	}
	const double u = (2 * (x + 0.5) / SIDE - 1), v = (1 - 2 * (y + 0.5) / SIDE);
	if (blob_count(b, BLOB_CAMERAS) > 0 && camera->vfov_degrees > 0) {
		const double half = tan(camera->vfov_degrees * PI / 360);
		const double *f = camera->forward, *up = camera->up;
		const double right[3] = {f[1] * up[2] - f[2] * up[1], f[2] * up[0] - f[0] * up[2],
					 f[0] * up[1] - f[1] * up[0]};
		for (int c = 0; c < 3; c++) {
			r->origin[c] = (float)(camera->eye[c] - b->origin[c]);
			r->direction[c] = (float)(f[c] + half * (u * right[c] + v * up[c]));
		}
	} else {
		const float eye[3] = {center[0] + 0.3f * extent, center[1] + 0.2f * extent, center[2] + 1.2f * extent};
		const float to[3] = {center[0] - eye[0] + (float)(0.5 * u) * extent,
				     center[1] - eye[1] + (float)(0.5 * v) * extent, center[2] - eye[2]};
		memcpy(r->origin, eye, sizeof eye);
		memcpy(r->direction, to, sizeof to);
	}
	r->t_max = INFINITY;
}

static void normal_of(const struct blob_header *b, uint32_t id, const float towards[3], double n[3])
{
	const struct triangle *t = (const struct triangle *)blob_section(b, BLOB_TRIANGLES) + id;
	const struct vertex *v = blob_section(b, BLOB_VERTICES);
	double e[2][3], l = 0, facing = 0;
	for (int c = 0; c < 3; c++)
		for (int k = 0; k < 2; k++)
			e[k][c] = (double)v[t->vertex[k + 1]].position[c] - (double)v[t->vertex[0]].position[c];
	for (int c = 0; c < 3; c++) {
		n[c] = e[0][(c + 1) % 3] * e[1][(c + 2) % 3] - e[0][(c + 2) % 3] * e[1][(c + 1) % 3];
		l += n[c] * n[c];
		facing += n[c] * (double)towards[c];
	}
	for (int c = 0; c < 3; c++)
		n[c] *= (facing > 0 ? -1 : 1) / sqrt(l);
}

// From where a primary ray hit: a cosine-distributed direction (the normal plus a point of the unit sphere), and a segment.
static void next_rays(const struct blob_header *b, const struct cast_ray *p, const struct cast_hit *h,
		      struct cast_ray *secondary, struct cast_ray *shadow)
{
	double n[3] = {0, 0, 1}, z = 2 * random_unit() - 1, phi = 6.283185307179586 * random_unit(), s = sqrt(1 - z * z);
	const double sphere[3] = {s * cos(phi), s * sin(phi), z};
	const double t = h->id != NONE ? (double)h->t : 1;
	if (h->id != NONE)
		normal_of(b, h->id, p->direction, n);
	for (int c = 0; c < 3; c++) {
		const double extent = (double)b->bounds_max[c] - (double)b->bounds_min[c];
		const double on = (double)p->origin[c] + t * (double)p->direction[c] + 1e-4 * n[c];
		const double to = (double)b->bounds_min[c] + random_unit() * extent;
		secondary->origin[c] = shadow->origin[c] = (float)on;
		secondary->direction[c] = (float)(n[c] + 0.999 * sphere[c]);
		shadow->direction[c] = (float)(to - on);
	}
	secondary->t_max = INFINITY;
	shadow->t_max = 1;
}

// ---- the comparison -----------------------------------------------------------------------------------------------------

static bool by_processor; // time is the processors'

static double embree_run(RTCScene scene, const struct cast_ray *rays, bool any, uint32_t *hits)
{
	const double start = bench_us(by_processor);
	embree_rays(scene, rays, RAYS, 8, any, hits);
	return RAYS / (bench_us(by_processor) - start);
}

static double best(const double *values)
{
	double most = 0;
	for (int i = 0; i < ROUNDS; i++)
		most = fmax(most, values[i]);
	return most;
}

static double device_run(struct cast *cast, bool any, struct error *err)
{
	const double start = bench_us(by_processor);
	if (cast_run(cast, any, err) != STATUS_OK) {
		printf("FAIL: %s\n", err->text);
		exit(1);
	}
	return RAYS / (bench_us(by_processor) - start);
}

static void must(enum status s, const struct error *err)
{
	if (s == STATUS_OK)
		return;
	printf("FAIL: %s\n", err->text);
	exit(1);
}

static void bench_kind(struct device *device, struct resident_scene *scene, RTCScene judge, const struct cast_ray *rays,
		       enum kind kind)
{
	static struct cast_hit found[RAYS];
	double embree[ROUNDS], single[ROUNDS], packet[ROUNDS];
	const bool any = kind == SHADOW;
	struct cast s, p;
	struct error err;
	uint32_t hits = 0, ours = 0;
	must(cast_init(&s, device, scene, rays, RAYS, false, &err), &err);
	must(cast_init(&p, device, scene, rays, RAYS, device->info.packets, &err), &err);
	device_run(&s, any, &err);
	device_run(&p, any, &err);
	for (int i = 0; i < ROUNDS; i++) {
		embree[i] = embree_run(judge, rays, any, &hits);
		single[i] = device_run(&s, any, &err);
		packet[i] = device_run(&p, any, &err);
	}
	must(cast_read(&p, found, &err), &err);
	for (uint32_t i = 0; i < RAYS; i++)
		ours += found[i].id != NONE;
	const double e = best(embree), a = best(single), b = best(packet);
	printf("| %s | %.2f | %.2f | %.2f | %.0f %% | %.0f %% | %.1f %% / %.1f %% |\n", kind_names[kind], e, a, b,
	       100 * a / e, 100 * b / e, 100.0 * ours / RAYS, 100.0 * hits / RAYS);
	cast_finish(&s);
	cast_finish(&p);
}

static void bench_scene(struct device *device, RTCDevice embree, const char *loader, const char *file)
{
	static struct cast_ray rays[KINDS][RAYS];
	static struct cast_hit hits[RAYS];
	struct loaded_scene loaded;
	struct error err;
	must(load_scene(loader, file, &loaded, &err), &err);
	struct resident_scene scene = {.blob = loaded.blob, .bytes = loaded.bytes, .fd = loaded.fd};
	blob_view_init(&scene.view, loaded.blob);
	RTCScene judge = cast_judge(embree, loaded.blob);
	for (uint32_t i = 0; i < RAYS; i++)
		primary_ray(loaded.blob, i, &rays[PRIMARY][i]);
	struct cast cast;
	must(cast_init(&cast, device, &scene, rays[PRIMARY], RAYS, false, &err), &err);
	must(cast_run(&cast, false, &err), &err);
	must(cast_read(&cast, hits, &err), &err);
	cast_finish(&cast);
	for (uint32_t i = 0; i < RAYS; i++)
		next_rays(loaded.blob, &rays[PRIMARY][i], &hits[i], &rays[SECONDARY][i], &rays[SHADOW][i]);
	printf("\n%s, %u triangles, millions of rays a second\n\n", file, blob_count(loaded.blob, BLOB_TRIANGLES));
	printf("| rays | Embree 8-wide | single | packet | single / Embree | packet / Embree | hit: ours / Embree |\n");
	printf("| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n");
	for (int k = 0; k < KINDS; k++)
		bench_kind(device, &scene, judge, rays[k], (enum kind)k);
	rtcReleaseScene(judge);
	for (unsigned i = 0; i < BIND_SCENE_COUNT; i++)
		buffer_finish(&scene.buffers[i], device);
	loaded_scene_finish(&loaded);
}

int main(int argc, char **argv)
{
	struct device *device;
	struct error err;
	const struct device_options options = {0};
	if (argc < 3) {
		fprintf(stderr, "usage: bench_rays LOADER SCENE...\n");
		return 2;
	}
	if (device_create(&options, &device, &err) != STATUS_OK) {
		printf("skipped: %s\n", err.text);
		return 77;
	}
	RTCDevice embree = rtcNewDevice(NULL);
	by_processor = device->info.software;
	printf("device: %s\n", device->info.name);
	for (int i = 2; i < argc; i++)
		bench_scene(device, embree, argv[1], argv[i]);
	rtcReleaseDevice(embree);
	devices_finish(&(struct devices){.vk = device});
	return 0;
}
