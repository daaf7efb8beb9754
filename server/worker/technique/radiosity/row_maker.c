#include "server/worker/technique/radiosity/row_maker.h"

#include <stdlib.h>

#include "server/base/clock.h"
#include "server/worker/technique/radiosity/analytic.h"
#include "server/worker/technique/radiosity/hemicube.h"
#include "server/worker/technique/radiosity/imported.h"
#include "server/worker/technique/radiosity/rays.h"

#define IMPORTED_BATCH 1024u // rows

struct row_maker {
	struct row_options options;
	struct patch_scene of;
	struct rays *rays;
	struct hemicube *hemicube;
	bool reflects; // the hemicube knows what reflects
	const struct radiosity_surface *surfaces; // by element
	struct analytic *analytic;
	struct imported_rows *imported;
	const uint32_t *elements; // that were begun
	uint32_t count, next; // by contour integrals, and of a file: the row that is worked on
	bool begun; // that row is
};

static struct hemicube_options hemicube_of(const struct row_options *o)
{
	const enum hemicube_mirrors on = o->portals ? HEMICUBE_MIRRORS_PORTAL : HEMICUBE_MIRRORS_HYBRID;
	return (struct hemicube_options){.pixels = o->pixels,
					 .origins = o->origins,
					 .mirrors = o->mirrors ? on : HEMICUBE_MIRRORS_OFF,
					 .bounces = o->bounces};
}

static struct rays_options rays_of(const struct row_options *o)
{
	return (struct rays_options){.rays = o->rays, .mirrors = o->mirrors, .bounces = o->bounces};
}

enum status row_maker_create(const struct patch_scene *of, const struct row_options *options,
			     const struct radiosity_surface *surfaces, struct device *device, struct gl_device *gl,
			     struct row_maker **maker, struct error *err)
{
	struct row_maker *m = calloc(1, sizeof *m);
	enum status s = STATUS_OK;
	if (!m)
		return error_set(err, STATUS_MEMORY, "out of memory");
	*m = (struct row_maker){.options = *options, .of = *of, .surfaces = surfaces, .reflects = !options->mirrors};
	const struct rays_options rays = rays_of(options);
	const struct hemicube_options hemicube = hemicube_of(options);
	if (options->way == ROWS_BY_HEMISPHERE)
		s = rays_create(device, of->scene, of->plan, of->elements, of->buffers, &rays, &m->rays, err);
	else if (options->way == ROWS_BY_HEMICUBE)
		s = hemicube_create(gl, of->scene, of->plan, of->elements, &hemicube, &m->hemicube, err);
	if (s == STATUS_OK && options->way == ROWS_BY_CONTOUR)
		s = analytic_create(of, options->rays, device, &m->analytic, err);
	if (s == STATUS_OK && options->way == ROWS_IMPORTED)
		s = imported_rows_create(&of->plan->imported, of->elements, &m->imported, err);
	if (s == STATUS_OK)
		*maker = m;
	else
		row_maker_destroy(m);
	return s;
}

void row_maker_destroy(struct row_maker *m)
{
	if (!m)
		return;
	rays_destroy(m->rays);
	hemicube_destroy(m->hemicube);
	analytic_destroy(m->analytic);
	imported_rows_destroy(m->imported);
	free(m);
}

enum status row_maker_compile(struct row_maker *m, struct error *err)
{
	enum status s = m->rays ? rays_compile(m->rays, err) : STATUS_OK;
	if (s == STATUS_OK && m->hemicube)
		s = hemicube_compile(m->hemicube, err);
	if (s == STATUS_OK && m->analytic)
		s = analytic_compile(m->analytic, err);
	return s;
}

uint32_t row_maker_batch(const struct row_maker *m, double budget_us)
{
	if (m->imported)
		return IMPORTED_BATCH;
	return m->rays ? rays_batch(m->rays, budget_us) : m->hemicube ? hemicube_batch(m->hemicube, budget_us) : 1;
}

void row_maker_begin(struct row_maker *m, const uint32_t *elements, uint32_t count)
{
	m->elements = elements;
	m->count = count;
	m->next = 0;
	m->begun = false;
}

static enum status step_contour(struct row_maker *m, uint32_t budget_us, struct factors *factors, bool *done,
				struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = STATUS_OK;
	do {
		if (!m->begun)
			analytic_begin(m->analytic, m->elements[m->next]);
		m->begun = true;
		s = analytic_step(m->analytic, budget_us, factors, err);
		if (s == STATUS_OK && analytic_finished(m->analytic)) {
			m->begun = false;
			m->next++;
		}
	} while (s == STATUS_OK && m->next < m->count && clock_us() - start < budget_us);
	*done = m->next == m->count;
	return s;
}

static enum status step_imported(struct row_maker *m, uint32_t budget_us, struct factors *factors, bool *done,
				 struct error *err)
{
	const uint64_t start = clock_us();
	enum status s = STATUS_OK;
	do {
		s = imported_rows_put(m->imported, m->elements[m->next], factors, err);
		m->next += s == STATUS_OK;
	} while (s == STATUS_OK && m->next < m->count && clock_us() - start < budget_us);
	*done = m->next == m->count;
	return s;
}

enum status row_maker_step(struct row_maker *m, uint32_t budget_us, struct factors *factors, bool *done, struct error *err)
{
	enum status s = STATUS_OK;
	if (m->imported)
		return step_imported(m, budget_us, factors, done, err);
	if (m->options.way == ROWS_BY_CONTOUR)
		return step_contour(m, budget_us, factors, done, err);
	if (m->hemicube && !m->reflects) {
		s = hemicube_reflect(m->hemicube, m->surfaces, err);
		m->reflects = s == STATUS_OK;
	}
	if (s != STATUS_OK)
		return s;
	if (m->hemicube)
		s = hemicube_rows(m->hemicube, m->elements, m->count, factors, err);
	else
		s = rays_rows(m->rays, m->elements, m->count, factors, err);
	*done = s == STATUS_OK;
	return s;
}

uint64_t row_maker_bytes(const struct row_scene *scene, const struct row_options *options)
{
	const struct hemicube_options hemicube = hemicube_of(options);
	const struct rays_options rays = rays_of(options);
	uint64_t bytes = 0;
	if (options->way == ROWS_BY_HEMISPHERE)
		bytes += rays_bytes(scene->patches, scene->faces, &rays);
	if (options->way == ROWS_BY_HEMICUBE)
		bytes += hemicube_bytes(scene->triangles, scene->patches, &hemicube);
	if (options->way == ROWS_BY_CONTOUR)
		bytes += analytic_bytes(scene->faces, options->rays);
	return bytes;
}
