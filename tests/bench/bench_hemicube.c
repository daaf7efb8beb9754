// bench_hemicube LOADER EDGE ROWS SCENE...: rows of form factors by hemicubes beside rays of the same number, in one run.
//
// ROWS elements, spread over all fronts. `error` is half of the sum of what a row's factors are off those by CONTROL rays
// over the whole patch, the mean of all rows: the share of light that goes elsewhere. Times are the best of the rounds, in
// which both take turns, with putting rows into the matrix. On a software device time is what the processors spent, divided
// by their number.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/worker/devices.h"
#include "server/worker/technique/radiosity/hemicube.h"
#include "server/worker/technique/radiosity/rays.h"
#include "tests/bench/embree_rays.h"
#include "tests/support/load_scene.h"

#define ROWS_MOST 1024u
#define ROUNDS 3
#define CONTROL 1048576u
#define BOUNCES 10u

static struct error err;

static void must(enum status s)
{
	if (s == STATUS_OK)
		return;
	printf("FAIL: %s\n", err.text);
	exit(1);
}

// A scene, cut.
struct subject {
	struct devices *devices;
	struct gl_device *gl;
	struct resident_scene scene;
	struct loaded_scene loaded;
	struct elements elements;
	struct element_buffers buffers;
	uint32_t list[ROWS_MOST], rows;
	float *control; // by row and column
	struct radiosity_surface *surfaces; // what mirrors reflect
	uint32_t mirrors; // patches
};

static void find_mirrors(struct subject *s)
{
	const struct material *materials = scene_section(&s->scene, BLOB_MATERIALS);
	const uint32_t n = s->elements.patches.count;
	s->surfaces = calloc(s->elements.count, sizeof *s->surfaces);
	if (!s->surfaces)
		exit(1);
	for (uint32_t i = 0; i < n; i++) {
		struct patch p;
		patches_get(&s->elements.patches, i, &p);
		const struct material *m = &materials[p.material];
		if (m->metallic < 1 || m->roughness > 0)
			continue;
		s->mirrors++;
		for (int c = 0; c < 3; c++)
			s->surfaces[i].mirror[c] = s->surfaces[i + n].mirror[c] = m->albedo[c];
	}
	buffer_finish(&s->buffers.surfaces, s->devices->vk);
	must(buffer_init_with(&s->buffers.surfaces, s->devices->vk, s->surfaces, s->elements.count * sizeof *s->surfaces,
			      &err));
}

static void subject_init(struct subject *s, struct devices *devices, const char *loader, const char *file, double edge,
			 uint32_t rows)
{
	memset(s, 0, sizeof *s);
	s->devices = devices;
	s->rows = rows < ROWS_MOST ? rows : ROWS_MOST;
	must(devices_gl(devices, &s->gl, &err));
	must(load_scene(loader, file, &s->loaded, &err));
	s->scene = (struct resident_scene){.blob = s->loaded.blob, .bytes = s->loaded.bytes, .fd = s->loaded.fd};
	blob_view_init(&s->scene.view, s->loaded.blob);
	must(elements_init(&s->elements, &s->scene.view, &(struct patch_options){.edge = edge}, &err));
	must(element_buffers_init(&s->buffers, &s->elements, devices->vk, &err));
	find_mirrors(s);
	for (uint32_t i = 0; i < s->rows; i++)
		s->list[i] = (uint32_t)((i + 0.5) * s->elements.patches.count / s->rows);
}

static void subject_finish(struct subject *s)
{
	free(s->control);
	free(s->surfaces);
	element_buffers_finish(&s->buffers, s->devices->vk);
	elements_finish(&s->elements);
	while (s->scene.derived) {
		struct derived *d = s->scene.derived;
		s->scene.derived = d->next;
		d->destroy(d);
	}
	for (unsigned i = 0; i < BIND_SCENE_COUNT; i++)
		buffer_finish(&s->scene.buffers[i], s->devices->vk);
	loaded_scene_finish(&s->loaded);
}

static float *read_rows(const struct subject *s, const struct factors *f)
{
	float *all = calloc((size_t)s->rows * s->elements.count, sizeof *all);
	if (!all)
		exit(1);
	for (uint32_t i = 0; i < s->rows; i++) {
		uint32_t *columns;
		float *values;
		must(factors_read_row(f, s->list[i], &columns, &values, &err));
		for (uint32_t k = 0; k < f->rows[s->list[i]].count; k++)
			all[(size_t)i * s->elements.count + columns[k]] = values[k];
		free(columns);
		free(values);
	}
	return all;
}

// One of the two ways.
struct way {
	struct hemicube *hemicube;
	struct rays *rays;
};

// Time of a row, µs; and the rows, if `out` is not NULL.
static double run(struct subject *s, const struct way *way, float **out)
{
	struct factors factors;
	must(factors_init(&factors, s->devices->vk, s->elements.count, &err));
	if (way->rays)
		must(rays_compile(way->rays, &err));
	else
		must(hemicube_compile(way->hemicube, &err));
	const double start = bench_us(s->devices->vk->info.software);
	for (uint32_t done = 0, n; done < s->rows; done += n) {
		n = way->rays ? rays_batch(way->rays, 1e9) : hemicube_batch(way->hemicube, 1e9);
		n = n < s->rows - done ? n : s->rows - done;
		if (way->rays)
			must(rays_rows(way->rays, s->list + done, n, &factors, &err));
		else
			must(hemicube_rows(way->hemicube, s->list + done, n, &factors, &err));
	}
	const double us = bench_us(s->devices->vk->info.software) - start;
	if (out)
		*out = read_rows(s, &factors);
	factors_finish(&factors);
	return us / s->rows;
}

static struct way by_rays(struct subject *s, uint32_t rays, bool mirrors)
{
	const struct plan plan = {0};
	const struct rays_options options = {.rays = rays, .mirrors = mirrors, .bounces = mirrors ? BOUNCES : 0};
	struct way way = {0};
	must(rays_create(s->devices->vk, &s->scene, &plan, &s->elements, &s->buffers, &options, &way.rays, &err));
	return way;
}

static struct way by_hemicubes(struct subject *s, uint32_t pixels, uint32_t origins, enum hemicube_mirrors mirrors)
{
	const struct plan plan = {0};
	const struct hemicube_options options = {.pixels = pixels,
						 .origins = origins,
						 .mirrors = mirrors,
						 .bounces = mirrors == HEMICUBE_MIRRORS_OFF ? 0 : BOUNCES};
	struct way way = {0};
	must(hemicube_create(s->gl, &s->scene, &plan, &s->elements, &options, &way.hemicube, &err));
	must(hemicube_reflect(way.hemicube, s->surfaces, &err));
	return way;
}

static void end(struct way *way)
{
	rays_destroy(way->rays);
	hemicube_destroy(way->hemicube);
}

static double error_of(const struct subject *s, const float *rows)
{
	double sum = 0;
	for (size_t i = 0; i < (size_t)s->rows * s->elements.count; i++)
		sum += fabs((double)(rows[i] - s->control[i]));
	return 0.5 * sum / s->rows;
}

static void bench(struct subject *s, uint32_t pixels, uint32_t origins)
{
	struct way ways[2] = {by_hemicubes(s, pixels, origins, HEMICUBE_MIRRORS_OFF),
			      by_rays(s, 3 * pixels * pixels * origins, false)};
	double best[2] = {INFINITY, INFINITY}, error[2];
	for (int round = 0; round < ROUNDS; round++)
		for (int k = 0; k < 2; k++) {
			float *rows = NULL;
			best[k] = fmin(best[k], run(s, &ways[k], round == 0 ? &rows : NULL));
			if (rows)
				error[k] = error_of(s, rows);
			free(rows);
		}
	printf("| %u² · %u | %u | %.0f | %.0f | %.2f | %.4f | %.4f |\n", pixels, origins, 3 * pixels * pixels * origins,
	       best[0], best[1], best[1] / best[0], error[0], error[1]);
	fflush(stdout);
	end(&ways[0]);
	end(&ways[1]);
}

static void bench_mirrors(struct subject *s, uint32_t pixels)
{
	struct way ways[] = {by_hemicubes(s, pixels, 1, HEMICUBE_MIRRORS_OFF),
			     by_hemicubes(s, pixels, 1, HEMICUBE_MIRRORS_PORTAL),
			     by_hemicubes(s, pixels, 1, HEMICUBE_MIRRORS_HYBRID), by_rays(s, 3 * pixels * pixels, true)};
	double best[4] = {INFINITY, INFINITY, INFINITY, INFINITY};
	for (int round = 0; round < ROUNDS; round++)
		for (int k = 0; k < 4; k++)
			best[k] = fmin(best[k], run(s, &ways[k], NULL));
	printf("| %u | %u² | %.0f | %.0f | %.0f | %.0f |\n", s->mirrors, pixels, best[0], best[1], best[2], best[3]);
	for (int k = 0; k < 4; k++)
		end(&ways[k]);
}

int main(int argc, char **argv)
{
	static const struct {
		uint32_t pixels, origins;
	} all[] = {{32, 1}, {64, 1}, {128, 1}, {256, 1}, {16, 4}, {16, 16}, {32, 4}, {32, 16}, {64, 16}};
	struct devices devices = {0};
	if (argc < 5) {
		fprintf(stderr, "usage: bench_hemicube LOADER EDGE ROWS SCENE...\n");
		return 1;
	}
	must(device_create(&(struct device_options){0}, &devices.vk, &err));
	for (int i = 4; i < argc; i++) {
		static struct subject s;
		subject_init(&s, &devices, argv[1], argv[i], atof(argv[2]), (uint32_t)atoi(argv[3]));
		if (s.mirrors > 0) {
			printf("\n%s: %u patches, %u rows\n\n| mirrors | pixels | without, µs a row | portals | rays from "
			       "pixels | "
			       "rays |\n| ---: | --- | ---: | ---: | ---: | ---: |\n",
			       argv[i], s.elements.patches.count, s.rows);
			bench_mirrors(&s, 64);
			subject_finish(&s);
			continue;
		}
		struct way control = by_rays(&s, CONTROL, false);
		run(&s, &control, &s.control);
		end(&control);
		printf("\n%s: %u patches, %u triangles, %u rows\n\n", argv[i], s.elements.patches.count,
		       scene_count(&s.scene, BLOB_TRIANGLES), s.rows);
		printf("| pixels · origins | samples | hemicube µs a row | rays µs a row | rays over hemicube | error, "
		       "hemicube | "
		       "error, rays |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n");
		for (size_t k = 0; k < sizeof all / sizeof *all; k++)
			bench(&s, all[k].pixels, all[k].origins);
		subject_finish(&s);
	}
	devices_finish(&devices);
	return 0;
}
