// What the matrix of form factors and its solvers cost: rows taken out of a dense buffer, and solutions of random matrices.
// With any argument the largest, which takes a minute, is left out.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/base/clock.h"
#include "server/worker/devices.h"
#include "server/worker/technique/radiosity/factors_check.h"
#include "server/worker/technique/radiosity/factors_project.h"
#include "server/worker/technique/radiosity/solver.h"
#include "server/worker/vk/device.h"

#define UNIT 0x1p30

static struct error err;
static uint32_t seed = 1;

static uint32_t draw(void)
{
	seed = seed * 747796405u + 2891336453u;
	const uint32_t word = ((seed >> ((seed >> 28) + 4)) ^ seed) * 277803737u;
	return word >> 22 ^ word;
}

static void need(enum status s)
{
	if (s == STATUS_OK)
		return;
	fprintf(stderr, "%s\n", err.text);
	exit(1);
}

// Of all threads, in µs.
static double processor_us(void)
{
	struct timespec t;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3;
}

// ---- rows from a dense buffer
// ---------------------------------------------------------------------------------------------

static void bench_pack(struct device *device, uint32_t side, uint32_t entries, uint32_t batch, bool on_host)
{
	struct factors f;
	uint32_t *words = calloc((size_t)side * batch, sizeof *words);
	struct factors_put *rows = calloc(batch, sizeof *rows);
	double best = INFINITY;
	if (!words || !rows)
		exit(1);
	for (uint32_t k = 0; k < batch; k++)
		for (uint32_t n = 0; n < entries; n++)
			words[(size_t)k * side + draw() % side] = draw();
	for (uint32_t k = 0; k < batch; k++)
		rows[k].element = k;
	for (int turn = 0; turn < 5; turn++) {
		struct buffer dense;
		need(factors_init(&f, device, side, &err));
		f.packs_on_host = f.packs_on_host && on_host;
		need(buffer_init_with(&dense, device, words, (uint64_t)side * batch * 4, &err));
		const double start = processor_us();
		need(factors_put_dense(&f, &dense, UNIT, rows, batch, &err));
		best = fmin(best, processor_us() - start);
		buffer_finish(&dense, device);
		factors_finish(&f);
	}
	printf("| %u | %u | %s | %.1f |\n", side, entries, on_host ? "host" : "shader", best / batch);
	free(words);
	free(rows);
}

// ---- solutions
// --------------------------------------------------------------------------------------------------------------

// Replace a row's values by what so many rays find of it.
static void sample(float *values, uint32_t count, uint32_t rays)
{
	double *sums = malloc((count + 1) * sizeof *sums);
	if (!sums)
		exit(1);
	sums[0] = 0;
	for (uint32_t k = 0; k < count; k++)
		sums[k + 1] = sums[k] + (double)values[k];
	memset(values, 0, count * sizeof *values);
	for (uint32_t ray = 0; ray < rays; ray++) {
		const double at = sums[count] * ((double)ray + draw() * 0x1p-32) / rays;
		uint32_t low = 0, high = count;
		while (low + 1 < high) {
			const uint32_t middle = (low + high) / 2;
			*(sums[middle] <= at ? &low : &high) = middle;
		}
		values[low] += 1.0f / (float)rays;
	}
	free(sums);
}

// A closed room whose every patch sees `entries` others, with symmetric factors: patch i sees i + d and i - d for random d,
// all rows alike; or what `rays` find of them (0: exact). Elements of the patches' backs have no rows.
static void fill_matrix(struct factors *f, uint32_t patches, uint32_t entries, uint32_t rays)
{
	uint8_t *seen = calloc(patches, 1);
	float *weight = calloc(patches, sizeof *weight), *values = malloc(entries * sizeof *values);
	uint32_t *columns = malloc(entries * sizeof *columns), n = 0;
	if (!seen || !weight || !values || !columns)
		exit(1);
	double sum = 0;
	while (n < entries) {
		const uint32_t d = 1 + draw() % (patches / 2 - 1);
		if (seen[d])
			continue;
		weight[d] = weight[patches - d] = (float)(1 + draw() % 1000);
		seen[d] = seen[patches - d] = 1;
		sum += 2.0 * (double)weight[d];
		n += 2;
	}
	for (uint32_t i = 0; i < patches; i++) {
		const struct factors_put row = {.element = i};
		n = 0;
		for (uint32_t j = 0, d = i == 0 ? 0 : patches - i; j < patches; j++, d = d + 1 == patches ? 0 : d + 1)
			if (seen[d]) {
				columns[n] = j;
				values[n++] = (float)((double)weight[d] / sum);
			}
		if (rays > 0) {
			sample(values, n, rays);
			uint32_t kept = 0;
			for (uint32_t k = 0; k < n; k++)
				if (values[k] > 0) {
					columns[kept] = columns[k];
					values[kept++] = values[k];
				}
			n = kept;
		}
		need(factors_put_row(f, &row, columns, values, n, &err));
	}
	free(seen);
	free(weight);
	free(values);
	free(columns);
}

static void bench_way(struct device *device, const struct factors *f, const struct solver_problem *of, const char *name)
{
	struct solver *solver;
	float *h = malloc(3ull * f->side * sizeof *h);
	const uint64_t begin = clock_us();
	need(solver_create(of, device, &solver, &err));
	const uint64_t start = clock_us();
	const double work = processor_us();
	uint64_t longest = 0;
	while (!solver_finished(solver)) {
		const uint64_t before = clock_us();
		need(solver_step(solver, 20000, &err));
		longest = clock_us() - before > longest ? clock_us() - before : longest;
	}
	const double end = (double)clock_us(), worked = processor_us() - work;
	need(h ? solver_read(solver, h, &err) : STATUS_MEMORY);
	printf("| %u | %.1f | %s | %u | %.1f | %.0f | %.0f | %.0f | %.0f | %.1g |\n", f->side / 2, (double)f->entries * 1e-6,
	       name, solver_iterations(solver), worked * 1e-3 / solver_iterations(solver), worked * 1e-3,
	       (end - (double)start) * 1e-3, (double)(start - begin) * 1e-3, (double)longest * 1e-3,
	       solver_residual(solver));
	solver_destroy(solver);
	free(h);
}

static void bench_solve(struct device *device, uint32_t patches, uint32_t entries, uint32_t rays, double least)
{
	struct factors f;
	const uint32_t side = 2 * patches;
	float *exitance = calloc(3ull * side, sizeof *exitance), *albedo = calloc(3ull * side, sizeof *albedo);
	float *irradiance = calloc(3ull * side, sizeof *irradiance), *area = calloc(side, sizeof *area);
	if (!exitance || !albedo || !irradiance || !area)
		exit(1);
	need(factors_init(&f, device, side, &err));
	fill_matrix(&f, patches, entries, rays);
	for (uint32_t i = 0; i < 3 * side; i++) {
		albedo[i] = (float)(least + (0.9 - least) * draw() * 0x1p-32);
		exitance[i] = i < 3 * patches / 100 ? 100 : 0;
	}
	for (uint32_t i = 0; i < side; i++)
		area[i] = 1;
	struct solver_problem p = {.factors = &f,
				   .exitance = exitance,
				   .albedo = albedo,
				   .irradiance = irradiance,
				   .area = area,
				   .residual = 1e-6,
				   .iterations = 1000};
	static const char *const names[3] = {"Jacobi", "Gauss-Seidel", "gradient"};
	for (int way = 0; way < 3; way++) {
		p.way = (enum solver_way)way;
		bench_way(device, &f, &p, names[way]);
	}
	struct factors_report report;
	const double start = processor_us();
	need(factors_check(&f, area, &report, &err));
	const double checked = processor_us();
	struct factors_projection projection;
	need(factors_projection_init(&projection, &f, area, NULL, &(struct factors_wish){true, true}, &err));
	while (!factors_projection_finished(&projection))
		need(factors_projection_step(&projection, 20000, &err));
	factors_projection_finish(&projection);
	fprintf(stderr, "%u patches: processors' ms to check %.0f, to project %.0f; reciprocity %.2g, %.2g\n", patches,
		(checked - start) * 1e-3, (processor_us() - checked) * 1e-3, report.reciprocity_most,
		report.reciprocity_mean);
	factors_finish(&f);
	free(exitance);
	free(albedo);
	free(irradiance);
	free(area);
}

int main(int argc, char **argv)
{
	(void)argv;
	const struct device_options options = {0};
	struct device *device;
	need(device_create(&options, &device, &err));
	printf("| columns | entries | by | processors' µs a row |\n| ---: | ---: | --- | ---: |\n");
	for (int on_host = 0; on_host < 2; on_host++)
		for (uint32_t entries = 400; entries <= 1600; entries *= 4)
			bench_pack(device, 25800, entries, 300, on_host);
	printf("\n| patches | million entries | solver | products | processors' ms each | in all | ms | "
	       "ms to begin | ms the longest slice of 20 | residual |\n"
	       "| ---: | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
	bench_solve(device, 12900, 1500, 0, 0.1);
	bench_solve(device, 12900, 1500, 0, 0.7);
	bench_solve(device, 12900, 1500, 3072, 0.7);
	bench_solve(device, 12900, 1500, 300, 0.7);
	if (argc < 2)
		bench_solve(device, 62000, 1500, 0, 0.1);
	devices_finish(&(struct devices){.vk = device});
	return 0;
}
