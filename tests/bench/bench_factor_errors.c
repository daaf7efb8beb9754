// bench_factor_errors LOADER EDGE CONTROL SCENE...: how far rows of form factors by rays are from those by CONTROL rays.
//
// A row's error is Σ_j |F_ij - C_ij| / Σ_j C_ij; its mean and its largest over ROWS rows are told. `area`: rays from
// all of the patch, beside a control of the same kind. `barycentre`: rays from its middle, beside that control, which tells
// what the middle is not the patch, and beside one from the middle. `of chance`: the root of Σ (F - C)² over what
// independent rays would have, Σ C (1 - C) / rays.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/bench/radiosity_rows.h"

#define ROWS 256u // spread evenly over the fronts of all patches

static struct error err;

// Rows by some options, all in memory.
static float *rows_of(struct row_subject *s, const struct rays_options *options)
{
	const uint32_t side = s->elements.count;
	float *rows = malloc((size_t)s->rows * side * sizeof *rows);
	uint32_t *words = malloc(side * sizeof *words);
	if (!rows || !words)
		exit(1);
	row_subject_cast(s, options);
	for (uint32_t i = 0; i < s->rows; i++) {
		row_need(rays_trace(s->rays, &s->list[i], 1, &err), &err);
		row_need(buffer_read(rays_dense(s->rays), s->devices->vk, 0, side * sizeof *words, words, &err), &err);
		for (uint32_t j = 0; j < side; j++)
			rows[(size_t)i * side + j] = (float)(words[j] / rays_unit(s->rays));
		row_need(rays_clear(s->rays, &err), &err);
	}
	free(words);
	return rows;
}

static void compare(const struct row_subject *s, const char *name, uint32_t rays, const float *rows, const float *control)
{
	const uint32_t side = s->elements.count;
	double mean = 0, most = 0, squares = 0, chance = 0;
	for (uint32_t i = 0; i < s->rows; i++) {
		double off = 0, sum = 0;
		for (size_t j = (size_t)i * side; j < (size_t)(i + 1) * side; j++) {
			const double c = (double)control[j], d = (double)rows[j] - c;
			off += fabs(d);
			sum += c;
			squares += d * d;
			chance += c * (1 - c) / rays;
		}
		const double error = sum > 0 ? off / sum : 0;
		mean += error / s->rows;
		most = fmax(most, error);
	}
	printf("| %s | %u | %.4f | %.4f | %.2f |\n", name, rays, mean, most, sqrt(squares / chance));
	fflush(stdout);
}

static void bench(struct row_subject *s, uint32_t control)
{
	static const uint32_t counts[] = {3072, 49512};
	struct rays_options o = {.rays = control};
	float *area = rows_of(s, &o);
	o.barycentre = true;
	float *middle = rows_of(s, &o);
	printf("| rays start | rays | mean error | largest | of chance |\n| --- | ---: | ---: | ---: | ---: |\n");
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
		o = (struct rays_options){.rays = counts[i]};
		float *rows = rows_of(s, &o);
		compare(s, "all over the patch", o.rays, rows, area);
		free(rows);
		o.barycentre = true;
		rows = rows_of(s, &o);
		compare(s, "in the barycentre", o.rays, rows, area);
		compare(s, "in the barycentre, control too", o.rays, rows, middle);
		free(rows);
	}
	compare(s, "control in the barycentre", control, middle, area);
	free(area);
	free(middle);
}

int main(int argc, char **argv)
{
	struct devices devices = {0};
	if (argc < 5) {
		fprintf(stderr, "usage: bench_factor_errors LOADER EDGE CONTROL SCENE...\n");
		return 2;
	}
	if (device_create(&(struct device_options){0}, &devices.vk, &err) != STATUS_OK) {
		printf("skipped: %s\n", err.text);
		return 77;
	}
	for (int i = 4; i < argc; i++) {
		struct row_subject s;
		row_subject_init(&s, &devices, argv[1], argv[i], strtod(argv[2], NULL), ROWS);
		printf("\n%s, %u patches, control %s rays\n\n", argv[i], s.elements.patches.count, argv[3]);
		bench(&s, (uint32_t)strtoul(argv[3], NULL, 10));
		row_subject_finish(&s);
	}
	devices_finish(&devices);
	return 0;
}
