// bench_factors LOADER EDGE RAYS SCENE...: rows of form factors by rays beside Embree's rate on the same rays, in one
// run.
//
// ROWS elements, spread over all fronts, send RAYS rays each. `rows` is rays_trace: making the rays, walking the tree,
// finding elements, counting. `rows + put` also puts them into the sparse matrix. `walk` is the traversal alone, on a list
// of the same rays. Embree's are rtcIntersect8 and rtcIntersect16 over that list, in the same order, on as many threads as
// there are processors. Each figure is the best of the rounds, in which they take turns. On a software device time is what
// the processors spent, divided by their number.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/worker/vk/command.h"
#include "shaders/factor_dump_comp.h"
#include "shaders/shared/factor_rays.h"
#include "tests/bench/embree_rays.h"
#include "tests/bench/radiosity_rows.h"
#include "tests/support/cast.h"

#define ROWS 256u
#define ROUNDS 9

static const struct shader dump_shader = {.name = "factor_dump",
					  .code = shader_factor_dump_comp,
					  .bytes = sizeof shader_factor_dump_comp,
					  .bindings = BIND_FACTOR_COUNT,
					  .texels = TRACE_TEXELS,
					  .push_bytes = sizeof(struct factor_push)};

static struct error err;

static void must(enum status s)
{
	row_need(s, &err);
}

// The rays of all rows, as the device makes them.
static struct cast_ray *dump(const struct row_subject *s)
{
	struct device *d = s->devices->vk;
	const uint32_t count = s->rows * s->per_row;
	const struct factor_push push = {.patches = s->elements.patches.count, .rays = s->per_row};
	const struct buffer *buffers[BIND_MOST] = {NULL};
	struct cast_ray *rays = malloc(count * sizeof *rays);
	struct pipeline *pipeline;
	struct binding_set set;
	struct constants none = {0};
	struct buffer out, list;
	if (!rays)
		exit(1);
	must(buffer_init(&out, d, count * sizeof *rays, BUFFER_DEVICE, &err));
	constants_set_effects(&none, 0);
	must(pipeline_get(d, &dump_shader, &none, &pipeline, &err));
	rays_fill(s->rays, buffers);
	must(buffer_init_with(&list, d, s->list, s->rows * sizeof *s->list, &err));
	buffers[BIND_FACTOR_ROWS] = &list;
	buffers[BIND_FACTOR_DENSE] = &out;
	must(binding_set_init(&set, d, pipeline, buffers, &out, &err));
	must(command_begin(d, &err));
	vkCmdBindPipeline(d->commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->handle);
	vkCmdBindDescriptorSets(d->commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->layout, 0, 1, &set.set, 0, NULL);
	vkCmdPushConstants(d->commands, pipeline->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
	vkCmdDispatch(d->commands, (s->per_row + FACTOR_LANES - 1) / FACTOR_LANES, s->rows, 1);
	command_barrier(d);
	must(command_finish(d, &err));
	must(buffer_read(&out, d, 0, count * sizeof *rays, rays, &err));
	binding_set_finish(&set, d);
	buffer_finish(&out, d);
	buffer_finish(&list, d);
	return rays;
}

static double run_rows(struct row_subject *s, bool put)
{
	struct factors factors;
	const double start = bench_us(s->devices->vk->info.software);
	double cleared = 0;
	if (put)
		must(factors_init(&factors, s->devices->vk, s->elements.count, &err));
	for (uint32_t done = 0, n; done < s->rows; done += n) {
		n = rays_batch(s->rays, 1e9);
		n = n < s->rows - done ? n : s->rows - done;
		if (put) {
			must(rays_rows(s->rays, s->list + done, n, &factors, &err));
			continue;
		}
		must(rays_trace(s->rays, s->list + done, n, &err));
		const double traced = bench_us(s->devices->vk->info.software);
		must(rays_clear(s->rays, &err));
		cleared += bench_us(s->devices->vk->info.software) - traced;
	}
	const double us = bench_us(s->devices->vk->info.software) - start - cleared;
	if (put)
		factors_finish(&factors);
	return s->rows * (double)s->per_row / us;
}

// Seconds of the rows of all fronts, from rays_create on: in processors' time over their number, where the host's part,
// which runs on one of them alone, counts whole.
static double build_all(struct row_subject *s, const struct rays_options *options)
{
	const bool software = s->devices->vk->info.software;
	struct factors factors;
	uint32_t list[4096];
	double put = 0;
	const double start = bench_us(software);
	row_subject_cast(s, options);
	must(factors_init(&factors, s->devices->vk, s->elements.count, &err));
	for (uint32_t done = 0, n; done < s->elements.patches.count; done += n) {
		n = rays_batch(s->rays, 100e3);
		n = n < s->elements.patches.count - done ? n : s->elements.patches.count - done;
		for (uint32_t i = 0; i < n; i++)
			list[i] = done + i;
		must(rays_trace(s->rays, list, n, &err));
		const double traced = bench_us(software);
		must(factors_put_dense(&factors, rays_dense(s->rays), rays_unit(s->rays), rays_lost(s->rays), n, &err));
		put += bench_us(software) - traced;
	}
	const double us = bench_us(software) - start;
	factors_finish(&factors);
	return (us + (software ? put * (bench_processors() - 1) : 0)) / 1e6;
}

static double run_walk(struct row_subject *s, struct cast *cast)
{
	const double start = bench_us(s->devices->vk->info.software);
	must(cast_run(cast, false, &err));
	return s->rows * (double)s->per_row / (bench_us(s->devices->vk->info.software) - start);
}

static double run_embree(const struct row_subject *s, RTCScene judge, const struct cast_ray *rays, uint32_t width)
{
	uint32_t hits;
	const uint32_t count = s->rows * s->per_row;
	const double start = bench_us(s->devices->vk->info.software);
	embree_rays(judge, rays, count, width, false, &hits);
	return count / (bench_us(s->devices->vk->info.software) - start);
}

// Distances along a ray, equal but for rounding.
static bool same_place(const struct cast_ray *r, float a, float b)
{
	const float reach = fmaxf(fabsf(r->origin[0]), fmaxf(fabsf(r->origin[1]), fabsf(r->origin[2])));
	return a == b || fabsf(a - b) < 1e-4f * b + 2e-6f * reach;
}

// The share of rays, of some, that end elsewhere by Embree: they are the same rays.
static double differ(const struct cast_ray *rays, uint32_t count, struct cast *cast, RTCScene judge)
{
	struct cast_hit *hits = malloc(count * sizeof *hits);
	uint32_t n = 0;
	if (!hits)
		exit(1);
	must(cast_read(cast, hits, &err));
	for (uint32_t i = 0; i < count; i += 97)
		n += !same_place(&rays[i], cast_judge_hit(judge, &rays[i]).ray.tfar,
				 hits[i].id == NONE ? INFINITY : hits[i].t);
	free(hits);
	return n * 97.0 / count;
}

static double most(double a, double b)
{
	return a > b ? a : b;
}

static void bench_scene(struct row_subject *s, RTCDevice embree, const char *name)
{
	RTCScene judge = cast_judge(embree, s->loaded.blob);
	struct cast cast;
	double best[5] = {0};
	run_rows(s, false); // learns how many turns a lane may do
	struct cast_ray *rays = dump(s);
	must(cast_init(&cast, s->devices->vk, &s->scene, rays, s->rows * s->per_row, s->devices->vk->info.packets, &err));
	run_walk(s, &cast);
	for (int i = 0; i < ROUNDS; i++) {
		best[0] = most(best[0], run_embree(s, judge, rays, 8));
		best[1] = most(best[1], run_embree(s, judge, rays, 16));
		best[2] = most(best[2], run_walk(s, &cast));
		best[3] = most(best[3], run_rows(s, false));
		best[4] = most(best[4], run_rows(s, true));
	}
	const double e = most(best[0], best[1]);
	printf("| %s | %u | %u | %.2f | %.2f | %.2f | %.2f | %.2f | %.0f %% | %.0f %% | %.0f %% | %.1e | %.2f |\n", name,
	       s->elements.patches.count, s->per_row, best[0], best[1], best[2], best[3], best[4], 100 * best[2] / e,
	       100 * best[3] / e, 100 * best[4] / e, differ(rays, s->rows * s->per_row, &cast, judge),
	       build_all(s, &(struct rays_options){.rays = s->per_row}));
	fflush(stdout);
	cast_finish(&cast);
	rtcReleaseScene(judge);
	free(rays);
}

int main(int argc, char **argv)
{
	struct devices devices = {0};
	if (argc < 5) {
		fprintf(stderr, "usage: bench_factors LOADER EDGE RAYS SCENE...\n");
		return 2;
	}
	if (device_create(&(struct device_options){0}, &devices.vk, &err) != STATUS_OK) {
		printf("skipped: %s\n", err.text);
		return 77;
	}
	RTCDevice embree = rtcNewDevice(NULL);
	printf("device: %s; millions of rays a second\n\n", devices.vk->info.name);
	printf("| scene | patches | rays | Embree 8 | Embree 16 | walk | rows | rows + put | walk / Embree | rows / Embree "
	       "| rows + put "
	       "/ Embree | differ | all rows, s |\n"
	       "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
	for (int i = 4; i < argc; i++) {
		struct row_subject s;
		row_subject_init(&s, &devices, argv[1], argv[i], strtod(argv[2], NULL), ROWS);
		row_subject_cast(&s, &(struct rays_options){.rays = (uint32_t)strtoul(argv[3], NULL, 10)});
		bench_scene(&s, embree, strrchr(argv[i], '/') ? strrchr(argv[i], '/') + 1 : argv[i]);
		row_subject_finish(&s);
	}
	rtcReleaseDevice(embree);
	devices_finish(&devices);
	return 0;
}
