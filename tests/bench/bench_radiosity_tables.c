// The tables of Radiosum's thesis: what form factors cost, and how far they are off, by method and number of samples.
//
//   bench_radiosity_tables rows LOADER EDGE ROWS CONTROL SCENE...     hemicubes and rays by number of samples
//   bench_radiosity_tables mirrors LOADER EDGE ROWS CONTROL SCENE...  portals, hybrids and rays
//   bench_radiosity_tables full LOADER EDGE CONTROL SCENE...          all rows, and the radiosity that they give
//
// ROWS elements are spread evenly over all fronts, and CONTROL is the number of the rays of their control. Times are of all
// rows of a run, divided by their number; "all" is that for as many rows as there are fronts: extrapolated, but by `full`. A
// processor's time is that of all threads: two quiet processors take half as long. "middles" has the thesis's shares of
// pixels.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/worker/technique/radiosity/solver.h"
#include "tests/bench/radiosity_rows.h"

#define TWICE 16384 // samples up to which the better of two runs counts

static struct error err;

static double load_now(void)
{
	double load = NAN;
	FILE *f = fopen("/proc/loadavg", "r");
	if (f && fscanf(f, "%lf", &load) != 1)
		load = NAN;
	if (f)
		fclose(f);
	return load;
}

static const char *base_name(const char *path)
{
	const char *slash = strrchr(path, '/');
	return slash ? slash + 1 : path;
}

static struct row_method by_rays(uint32_t rays, bool barycentre)
{
	return (struct row_method){.name = barycentre ? "rays, barycentre" : "rays, area",
				   .kind = ROW_RAYS,
				   .size = rays,
				   .barycentre = barycentre};
}

static struct row_method by_hemicubes(uint32_t pixels, uint32_t origins)
{
	return (struct row_method){.name = "hemicube", .kind = ROW_HEMICUBE, .size = pixels, .origins = origins};
}

static void print_samples(const struct row_method *m)
{
	printf("| %s | ", m->name);
	if (m->kind == ROW_HEMICUBE && m->origins > 1)
		printf("%u² · 3 · %u = ", m->size, m->origins);
	else if (m->kind == ROW_HEMICUBE)
		printf("%u² · 3 = ", m->size);
	printf("%.0f | ", row_samples(m));
}

static void print_cost(const struct row_subject *s, const struct row_cost *cost)
{
	const double rows = s->rows, all = s->elements.patches.count;
	printf("%.0f | %.0f | %.2f | %.1f | ", cost->processor_us / rows, cost->wall_us / rows,
	       cost->processor_us * 1e-6 / rows * all, load_now());
}

#define COST_TITLES "processors' µs a row | wall µs a row | processors' s for all | load | "
#define COST_RULES "---: | ---: | ---: | ---: | "

// ---- rows ---------------------------------------------------------------------------------------------------------------

// The controls of a scene's rows.
struct controls {
	float *area, *barycentre; // the latter may be NULL
};

static void bench_method(struct row_subject *s, const struct row_method *m, const struct controls *c)
{
	float *rows;
	struct row_cost cost = row_dense(s, m, &rows);
	if (row_samples(m) <= TWICE) {
		free(rows);
		const struct row_cost again = row_dense(s, m, &rows);
		cost = again.processor_us < cost.processor_us ? again : cost;
	}
	print_samples(m);
	print_cost(s, &cost);
	const struct row_error e = row_error_of(s, rows, c->area);
	printf("%.4f | %.4f | ", e.mean, e.most);
	const bool there = c->barycentre && (m->kind == ROW_HEMICUBE ? m->origins == 1 : m->barycentre);
	if (there) {
		const struct row_error b = row_error_of(s, rows, c->barycentre);
		printf("%.4f | %.4f |\n", b.mean, b.most);
	} else {
		printf("| |\n");
	}
	fflush(stdout);
	free(rows);
}

// Make a control, and tell what it cost.
static float *control_of(struct row_subject *s, const struct row_method *m)
{
	float *rows;
	const struct row_cost cost = row_dense(s, m, &rows);
	print_samples(m);
	print_cost(s, &cost);
	printf("control | | | |\n");
	fflush(stdout);
	return rows;
}

static void bench_rows(struct row_subject *s, uint32_t control)
{
	printf("| method | samples | " COST_TITLES
	       "Ep | Em | Ep by barycentre | Em by barycentre |\n| --- | ---: | " COST_RULES
	       "---: | ---: | ---: | ---: |\n");
	const struct row_method area = by_rays(control, false), barycentre = by_rays(control, true);
	const struct controls c = {.area = control_of(s, &area), .barycentre = control_of(s, &barycentre)};
	for (uint32_t pixels = 32; pixels <= 256; pixels *= 2) {
		const uint32_t samples = 3 * pixels * pixels;
		const struct row_method methods[] = {by_hemicubes(pixels, 1), by_rays(samples, false),
						     by_rays(samples, true)};
		for (size_t k = 0; k < sizeof methods / sizeof *methods; k++)
			bench_method(s, &methods[k], &c);
		if (pixels == 32) {
			struct row_method middles = by_hemicubes(pixels, 1);
			middles.name = "hemicube, middles";
			middles.middles = true;
			bench_method(s, &middles, &c);
		}
	}
	free(c.area);
	free(c.barycentre);
}

// ---- mirrors ------------------------------------------------------------------------------------------------------------

static void bench_mirrors(struct row_subject *s, uint32_t control)
{
	static const struct {
		const char *name;
		enum row_kind kind;
		enum hemicube_mirrors mirrors;
	} ways[] = {{"hemicube, portal", ROW_HEMICUBE, HEMICUBE_MIRRORS_PORTAL},
		    {"hemicube, hybrid", ROW_HEMICUBE, HEMICUBE_MIRRORS_HYBRID},
		    {"rays, area", ROW_RAYS, HEMICUBE_MIRRORS_HYBRID}};
	printf("| method | samples | " COST_TITLES
	       "Ep | Em | Ep by barycentre | Em by barycentre |\n| --- | ---: | " COST_RULES
	       "---: | ---: | ---: | ---: |\n");
	struct row_method truth = by_rays(control, false), middle = by_rays(control, true);
	truth.mirrors = middle.mirrors = HEMICUBE_MIRRORS_HYBRID;
	truth.bounces = middle.bounces = HEMICUBE_PORTALS_MOST;
	const struct controls c = {.area = control_of(s, &truth), .barycentre = control_of(s, &middle)};
	for (uint32_t pixels = 32; pixels <= 128; pixels *= 2)
		for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
			struct row_method m =
			    ways[k].kind == ROW_RAYS ? by_rays(3 * pixels * pixels, false) : by_hemicubes(pixels, 1);
			m.name = ways[k].name;
			m.mirrors = ways[k].mirrors;
			m.bounces = HEMICUBE_PORTALS_MOST;
			bench_method(s, &m, &c);
		}
	free(c.area);
	free(c.barycentre);
}

// ---- all rows -----------------------------------------------------------------------------------------------------------

// Radiosity of all elements, the sum of the three channels. The caller frees it.
static float *solve(const struct row_subject *s, const struct factors *factors)
{
	const size_t side = s->elements.count;
	float *all = calloc(13 * side, sizeof *all);
	if (!all)
		exit(1);
	float *exitance = all, *albedo = all + 3 * side, *none = all + 6 * side, *h = all + 9 * side,
	      *area = all + 12 * side;
	for (size_t i = 0; i < side; i++) {
		for (size_t c = 0; c < 3; c++) {
			exitance[3 * i + c] = (float)PI * s->surfaces[i].emission[c];
			albedo[3 * i + c] = s->surfaces[i].albedo[c];
		}
		area[i] = s->elements.shapes[i % s->elements.patches.count].area;
	}
	const struct solver_problem problem = {.factors = factors,
					       .exitance = exitance,
					       .albedo = albedo,
					       .irradiance = none,
					       .area = area,
					       .way = SOLVER_JACOBI,
					       .residual = 1e-6,
					       .iterations = 1000};
	struct solver *solver;
	row_need(solver_create(&problem, s->devices->vk, &solver, &err), &err);
	while (!solver_finished(solver))
		row_need(solver_step(solver, 20000, &err), &err);
	row_need(solver_read(solver, h, &err), &err);
	solver_destroy(solver);
	float *b = calloc(side, sizeof *b);
	if (!b)
		exit(1);
	for (size_t i = 0; i < 3 * side; i++)
		b[i / 3] += exitance[i] + albedo[i] * h[i];
	free(all);
	return b;
}

// What the radiosity of fronts that do not shine is off: its mean and greatest relative error, and the mean over areas.
static void print_light_error(const struct row_subject *s, const float *b, const float *control)
{
	double mean = 0, most = 0, off = 0, sum = 0;
	uint32_t count = 0;
	for (uint32_t i = 0; i < s->elements.patches.count; i++) {
		const double should = (double)control[i], by = fabs((double)b[i] - should);
		const double area = (double)s->elements.shapes[i].area;
		if (s->surfaces[i].emission[0] > 0 || !(should > 0))
			continue;
		mean += by / should;
		most = fmax(most, by / should);
		off += by * area;
		sum += should * area;
		count++;
	}
	printf("%.5f | %.5f | %.5f |\n", mean / (count > 0 ? count : 1), most, off / sum);
	fflush(stdout);
}

// Make all rows and what light they give; print all but what that is off.
static float *full(struct row_subject *s, const struct row_method *m)
{
	struct factors factors;
	const struct row_cost cost = row_make(s, m, &factors);
	float *b = solve(s, &factors);
	print_samples(m);
	print_cost(s, &cost);
	printf("%.1f | ", (double)factors.entries * 1e-6);
	factors_finish(&factors);
	return b;
}

static void bench_full(struct row_subject *s, uint32_t control)
{
	printf("| method | samples | " COST_TITLES
	       "million entries | B, mean | B, most | B by area |\n| --- | ---: | " COST_RULES
	       "---: | ---: | ---: | ---: |\n");
	const struct row_method truth = by_rays(control, false);
	float *c = full(s, &truth);
	printf("control | | |\n");
	for (uint32_t pixels = 32; pixels <= 64; pixels *= 2) {
		const uint32_t samples = 3 * pixels * pixels;
		const struct row_method methods[] = {by_hemicubes(pixels, 1), by_rays(samples, false),
						     by_rays(samples, true)};
		for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
			float *b = full(s, &methods[k]);
			print_light_error(s, b, c);
			free(b);
		}
	}
	free(c);
}

static int usage(void)
{
	fprintf(stderr, "usage: bench_radiosity_tables rows|mirrors LOADER EDGE ROWS CONTROL SCENE...\n"
			"       bench_radiosity_tables full LOADER EDGE CONTROL SCENE...\n");
	return 2;
}

int main(int argc, char **argv)
{
	const bool all = argc > 1 && !strcmp(argv[1], "full"), mirrors = argc > 1 && !strcmp(argv[1], "mirrors");
	const int first = all ? 5 : 6;
	struct devices devices = {0};
	if (argc <= first || (!all && !mirrors && strcmp(argv[1], "rows") != 0))
		return usage();
	if (device_create(&(struct device_options){0}, &devices.vk, &err) != STATUS_OK) {
		printf("skipped: %s\n", err.text);
		return 77;
	}
	const uint32_t control = (uint32_t)strtoul(argv[first - 1], NULL, 10);
	for (int i = first; i < argc; i++) {
		struct row_subject s;
		row_subject_init(&s, &devices, argv[2], argv[i], strtod(argv[3], NULL),
				 all ? 0 : (uint32_t)strtoul(argv[4], NULL, 10));
		printf("\n%s: %u patches, %u rows; %s\n\n", base_name(argv[i]), s.elements.patches.count, s.rows,
		       devices.vk->info.name);
		if (all)
			bench_full(&s, control);
		else if (mirrors)
			bench_mirrors(&s, control);
		else
			bench_rows(&s, control);
		row_subject_finish(&s);
	}
	devices_finish(&devices);
	return 0;
}
