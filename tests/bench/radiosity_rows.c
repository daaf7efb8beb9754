#include "tests/bench/radiosity_rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/base/clock.h"
#include "server/worker/technique/radiosity/surfaces.h"

static struct error err;

// What the scenes have; code for masks would make rays slower.
static const struct plan matters = {
    .effects = 1u << candil_Effect_EFFECT_EMITTERS | 1u << candil_Effect_EFFECT_GLOSSY, .width = 1, .height = 1};

void row_need(enum status status, const struct error *e)
{
	if (status == STATUS_OK)
		return;
	fprintf(stderr, "FAIL: %s\n", e->text);
	exit(1);
}

static void need(enum status status)
{
	row_need(status, &err);
}

static void *allocate(size_t count, size_t size)
{
	void *p = calloc(count + 1, size);
	if (!p) {
		fprintf(stderr, "FAIL: out of memory\n");
		exit(1);
	}
	return p;
}

// ---- scenes -------------------------------------------------------------------------------------------------------------

static void make_surfaces(struct row_subject *s)
{
	const struct patch_scene of = {&matters, &s->scene, &s->elements, &s->buffers};
	bool covered = false;
	struct surfaces *pass;
	need(surfaces_create(&of, &covered, s->devices->vk, &pass, &err));
	need(surfaces_compile(pass, &err));
	while (!surfaces_finished(pass))
		need(surfaces_step(pass, 20000, &err));
	surfaces_destroy(pass);
	s->surfaces = allocate(s->elements.count, sizeof *s->surfaces);
	need(buffer_read(&s->buffers.surfaces, s->devices->vk, 0, s->elements.count * sizeof *s->surfaces, s->surfaces,
			 &err));
}

void row_subject_init(struct row_subject *s, struct devices *devices, const char *loader, const char *file, double edge,
		      uint32_t rows)
{
	memset(s, 0, sizeof *s);
	s->devices = devices;
	need(load_scene(loader, file, &s->loaded, &err));
	s->scene = (struct resident_scene){.blob = s->loaded.blob, .bytes = s->loaded.bytes, .fd = s->loaded.fd};
	blob_view_init(&s->scene.view, s->loaded.blob);
	need(elements_init(&s->elements, &s->scene.view, &(struct patch_options){.edge = edge}, &err));
	need(element_buffers_init(&s->buffers, &s->elements, true, devices->vk, &err));
	make_surfaces(s);
	const uint32_t patches = s->elements.patches.count;
	s->rows = rows > 0 && rows < patches ? rows : patches;
	s->list = allocate(s->rows, sizeof *s->list);
	for (uint32_t i = 0; i < s->rows; i++)
		s->list[i] = (uint32_t)((i + 0.5) * patches / s->rows);
}

void row_subject_cast(struct row_subject *s, const struct rays_options *options)
{
	const struct plan plan = {0};
	rays_destroy(s->rays);
	s->per_row = options->rays;
	need(rays_create(s->devices->vk, &s->scene, &plan, &s->elements, &s->buffers, options, &s->rays, &err));
}

void row_subject_finish(struct row_subject *s)
{
	rays_destroy(s->rays);
	free(s->list);
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

// ---- rows ---------------------------------------------------------------------------------------------------------------

// What makes rows: one of the two.
struct maker {
	struct hemicube *hemicube;
	struct rays *rays;
};

double row_samples(const struct row_method *m)
{
	return m->kind == ROW_RAYS ? m->size : 3.0 * m->size * m->size * m->origins;
}

static void maker_init(struct maker *maker, struct row_subject *s, const struct row_method *m)
{
	const struct rays_options rays = {.rays = m->size,
					  .barycentre = m->barycentre,
					  .mirrors = m->mirrors != HEMICUBE_MIRRORS_OFF,
					  .bounces = m->bounces};
	const struct hemicube_options hemicube = {
	    .pixels = m->size, .origins = m->origins, .middles = m->middles, .mirrors = m->mirrors, .bounces = m->bounces};
	struct gl_device *gl;
	memset(maker, 0, sizeof *maker);
	if (m->kind == ROW_RAYS) {
		need(rays_create(s->devices->vk, &s->scene, &matters, &s->elements, &s->buffers, &rays, &maker->rays, &err));
		need(rays_compile(maker->rays, &err));
		return;
	}
	need(devices_gl(s->devices, &gl, &err));
	need(hemicube_create(gl, &s->scene, &matters, &s->elements, &hemicube, &maker->hemicube, &err));
	if (m->mirrors != HEMICUBE_MIRRORS_OFF)
		need(hemicube_reflect(maker->hemicube, s->surfaces, &err));
	need(hemicube_compile(maker->hemicube, &err));
}

static void maker_rows(struct maker *maker, const uint32_t *list, uint32_t count, struct factors *factors)
{
	for (uint32_t done = 0, n; done < count; done += n) {
		n = maker->rays ? rays_batch(maker->rays, 1e6) : hemicube_batch(maker->hemicube, 1e6);
		n = n < count - done ? n : count - done;
		if (maker->rays)
			need(rays_rows(maker->rays, list + done, n, factors, &err));
		else
			need(hemicube_rows(maker->hemicube, list + done, n, factors, &err));
	}
}

// Of all threads.
static double processor_us(void)
{
	struct timespec t;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3;
}

struct row_cost row_make(struct row_subject *s, const struct row_method *method, struct factors *factors)
{
	struct maker maker;
	struct factors first;
	maker_init(&maker, s, method);
	// A row for nothing: whatever is made once has been made then.
	need(factors_init(&first, s->devices->vk, s->elements.count, &err));
	maker_rows(&maker, s->list, 1, &first);
	factors_finish(&first);
	need(factors_init(factors, s->devices->vk, s->elements.count, &err));
	const double wall = (double)clock_us(), processor = processor_us();
	maker_rows(&maker, s->list, s->rows, factors);
	const struct row_cost cost = {.processor_us = processor_us() - processor, .wall_us = (double)clock_us() - wall};
	rays_destroy(maker.rays);
	hemicube_destroy(maker.hemicube);
	return cost;
}

struct row_cost row_dense(struct row_subject *s, const struct row_method *method, float **rows)
{
	struct factors factors;
	const size_t side = s->elements.count;
	const struct row_cost cost = row_make(s, method, &factors);
	float *all = allocate(s->rows * side, sizeof *all);
	for (uint32_t i = 0; i < s->rows; i++) {
		uint32_t *columns;
		float *values;
		need(factors_read_row(&factors, s->list[i], &columns, &values, &err));
		for (uint32_t k = 0; k < factors.rows[s->list[i]].count; k++)
			all[i * side + columns[k]] = values[k];
		free(columns);
		free(values);
	}
	factors_finish(&factors);
	*rows = all;
	return cost;
}

struct row_error row_error_of(const struct row_subject *s, const float *rows, const float *control)
{
	struct row_error e = {0};
	const size_t side = s->elements.count;
	uint32_t count = 0;
	for (uint32_t i = 0; i < s->rows; i++) {
		double off = 0, sum = 0;
		for (size_t j = 0; j < side; j++) {
			off += fabs((double)rows[i * side + j] - (double)control[i * side + j]);
			sum += (double)control[i * side + j];
		}
		if (!(sum > 0))
			continue;
		e.mean += off / sum;
		e.most = fmax(e.most, off / sum);
		count++;
	}
	e.mean /= count > 0 ? count : 1;
	return e;
}
