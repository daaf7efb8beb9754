// bench_hemicube LOADER EDGE ROWS SCENE...: rows of form factors by hemicubes beside rays of the same number, in one run.
//
// ROWS elements, spread over all fronts. `error` is half of the sum of what a row's factors are off those by CONTROL rays
// over the whole patch, the mean of all rows: the share of light that goes elsewhere. Times are the best of the rounds, in
// which both take turns, with putting rows into the matrix. On a software device time is what the processors spent, divided
// by their number.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/bench/embree_rays.h"
#include "tests/bench/radiosity_rows.h"

#define ROUNDS 3
#define CONTROL 1048576u
#define BOUNCES 10u

static struct row_method by_rays(uint32_t rays, bool mirrors)
{
	return (struct row_method){.kind = ROW_RAYS,
				   .size = rays,
				   .mirrors = mirrors ? HEMICUBE_MIRRORS_HYBRID : HEMICUBE_MIRRORS_OFF,
				   .bounces = mirrors ? BOUNCES : 0};
}

static struct row_method by_hemicubes(uint32_t pixels, uint32_t origins, enum hemicube_mirrors mirrors)
{
	return (struct row_method){.kind = ROW_HEMICUBE,
				   .size = pixels,
				   .origins = origins,
				   .mirrors = mirrors,
				   .bounces = mirrors == HEMICUBE_MIRRORS_OFF ? 0 : BOUNCES};
}

// Time of a row, µs.
static double row_us(const struct row_subject *s, struct row_cost cost)
{
	return (s->devices->vk->info.software ? cost.processor_us / bench_processors() : cost.wall_us) / s->rows;
}

static double error_of(const struct row_subject *s, const float *rows, const float *control)
{
	double sum = 0;
	for (size_t i = 0; i < (size_t)s->rows * s->elements.count; i++)
		sum += fabs((double)(rows[i] - control[i]));
	return 0.5 * sum / s->rows;
}

static void bench(struct row_subject *s, const float *control, uint32_t pixels, uint32_t origins)
{
	const uint32_t samples = 3 * pixels * pixels * origins;
	const struct row_method ways[2] = {by_hemicubes(pixels, origins, HEMICUBE_MIRRORS_OFF), by_rays(samples, false)};
	double best[2] = {INFINITY, INFINITY}, error[2];
	for (int round = 0; round < ROUNDS; round++)
		for (int k = 0; k < 2; k++) {
			float *rows;
			best[k] = fmin(best[k], row_us(s, row_dense(s, &ways[k], &rows)));
			error[k] = error_of(s, rows, control);
			free(rows);
		}
	printf("| %u² · %u | %u | %.0f | %.0f | %.2f | %.4f | %.4f |\n", pixels, origins, samples, best[0], best[1],
	       best[1] / best[0], error[0], error[1]);
	fflush(stdout);
}

static void bench_mirrors(struct row_subject *s, uint32_t mirrors, uint32_t pixels)
{
	const struct row_method ways[] = {
	    by_hemicubes(pixels, 1, HEMICUBE_MIRRORS_OFF), by_hemicubes(pixels, 1, HEMICUBE_MIRRORS_PORTAL),
	    by_hemicubes(pixels, 1, HEMICUBE_MIRRORS_HYBRID), by_rays(3 * pixels * pixels, true)};
	double best[4] = {INFINITY, INFINITY, INFINITY, INFINITY};
	for (int round = 0; round < ROUNDS; round++)
		for (int k = 0; k < 4; k++) {
			struct factors factors;
			best[k] = fmin(best[k], row_us(s, row_make(s, &ways[k], &factors)));
			factors_finish(&factors);
		}
	printf("| %u | %u² | %.0f | %.0f | %.0f | %.0f |\n", mirrors, pixels, best[0], best[1], best[2], best[3]);
}

static uint32_t count_mirrors(const struct row_subject *s)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < s->elements.patches.count; i++)
		count += s->surfaces[i].mirror[0] > 0 || s->surfaces[i].mirror[1] > 0 || s->surfaces[i].mirror[2] > 0;
	return count;
}

static void bench_scene(struct row_subject *s, const char *file)
{
	static const struct {
		uint32_t pixels, origins;
	} all[] = {{32, 1}, {64, 1}, {128, 1}, {256, 1}, {16, 4}, {16, 16}, {32, 4}, {32, 16}, {64, 16}};
	const uint32_t mirrors = count_mirrors(s);
	const struct row_method method = by_rays(CONTROL, false);
	float *control;
	printf("\n%s: %u patches, %u triangles, %u rows\n\n", file, s->elements.patches.count,
	       scene_count(&s->scene, BLOB_TRIANGLES), s->rows);
	if (mirrors > 0) {
		printf("| mirrors | pixels | without, µs a row | portals | rays from pixels | rays |\n"
		       "| ---: | --- | ---: | ---: | ---: | ---: |\n");
		bench_mirrors(s, mirrors, 64);
		return;
	}
	row_dense(s, &method, &control);
	printf("| pixels · origins | samples | hemicube µs a row | rays µs a row | rays over hemicube | error, hemicube | "
	       "error, rays |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n");
	for (size_t k = 0; k < sizeof all / sizeof *all; k++)
		bench(s, control, all[k].pixels, all[k].origins);
	free(control);
}

int main(int argc, char **argv)
{
	struct devices devices = {0};
	struct error err;
	if (argc < 5) {
		fprintf(stderr, "usage: bench_hemicube LOADER EDGE ROWS SCENE...\n");
		return 1;
	}
	row_need(device_create(&(struct device_options){0}, &devices.vk, &err), &err);
	for (int i = 4; i < argc; i++) {
		struct row_subject s;
		row_subject_init(&s, &devices, argv[1], argv[i], atof(argv[2]), (uint32_t)atoi(argv[3]));
		bench_scene(&s, argv[i]);
		row_subject_finish(&s);
	}
	devices_finish(&devices);
	return 0;
}
