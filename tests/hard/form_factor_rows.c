// Measures form factors in configurations whose factors are known, for the page of hard cases: a line for each, as JSON. By
// contour integrals and by rays, each twice, in other slices. 77: there is no device.
#include "tests/gpu/traced_mesh.h"

#include <stdio.h>
#include <stdlib.h>

#include "server/base/angle.h"
#include "server/worker/devices.h"
#include "server/worker/technique/radiosity/analytic.h"
#include "server/worker/technique/radiosity/rays.h"
#include "tests/unit/form_factor_scenes.h"

#define FACING 0.19982489569838738 // unit squares, face to face at distance 1
#define RAYS 16384u // of an element
#define BODY_RAYS 1024u // of one of many
#define HIDDEN_RAYS 1024u // between pairs that are partly hidden

static struct device *device;
static struct mesh m;
static const struct plan plain = {.width = 1, .height = 1};

// ---- scenes -----------------------------------------------------------------------------------------------------------

static void add_polygon(const struct form_polygon *p)
{
	double u[3], v[3];
	for (int c = 0; c < 3; c++) {
		u[c] = p->at[1][c] - p->at[0][c];
		v[c] = p->at[3][c] - p->at[0][c];
	}
	add_quad(&m, p->at[0], u, v, 0);
}

// Triangles turned round from the first on.
static void turn_from(uint32_t first)
{
	for (uint32_t i = first; i < m.count; i++) {
		const uint32_t v = m.triangles[i].vertex[0];
		m.triangles[i].vertex[0] = m.triangles[i].vertex[1];
		m.triangles[i].vertex[1] = v;
	}
}

static void add_facing_squares(double size)
{
	add_quad(&m, (const double[3]){0, 0, 0}, (const double[3]){size, 0, 0}, (const double[3]){0, size, 0}, 0);
	add_quad(&m, (const double[3]){0, 0, size}, (const double[3]){0, size, 0}, (const double[3]){size, 0, 0}, 0);
}

static void on_ball(double radius, uint32_t i, uint32_t j, uint32_t rings, double out[3])
{
	const double theta = PI * i / rings, phi = PI * (j % (2 * rings)) / rings;
	out[0] = radius * sin(theta) * cos(phi);
	out[1] = radius * sin(theta) * sin(phi);
	out[2] = radius * cos(theta);
}

static void add_ball(double radius, uint32_t rings)
{
	for (uint32_t i = 0; i < rings; i++)
		for (uint32_t j = 0; j < 2 * rings; j++) {
			double p[4][3];
			on_ball(radius, i, j, rings, p[0]);
			on_ball(radius, i + 1, j, rings, p[1]);
			on_ball(radius, i + 1, j + 1, rings, p[2]);
			on_ball(radius, i, j + 1, rings, p[3]);
			if (i + 1 < rings)
				add(&m, p[0], p[1], p[2], 0);
			if (i > 0)
				add(&m, p[0], p[2], p[3], 0);
		}
}

// A disc as a fan of the disc's area; its front is up or down.
static void add_disc(double height, uint32_t corners, bool up)
{
	const double radius = sqrt(2 * PI / (corners * sin(2 * PI / corners))), middle[3] = {0, 0, height};
	for (uint32_t i = 0; i < corners; i++) {
		const double a = 2 * PI * i / corners, b = 2 * PI * (i + 1) / corners;
		const double p[3] = {radius * cos(a), radius * sin(a), height},
			     q[3] = {radius * cos(b), radius * sin(b), height};
		add(&m, middle, up ? p : q, up ? q : p, 0);
	}
}

// ---- matrices ---------------------------------------------------------------------------------------------------------

enum way { ANALYTIC, BY_RAYS };

static void need(enum status s, const struct error *err)
{
	if (s == STATUS_OK)
		return;
	fprintf(stderr, "%s\n", err->text);
	exit(1);
}

static void make_rows(struct traced_mesh *t, enum way way, uint32_t slice, struct factors *f)
{
	const struct patch_scene of = {&plain, &t->scene, &t->elements, &t->buffers};
	const struct rays_options o = {.rays = t->elements.count > 20 ? BODY_RAYS : RAYS};
	struct analytic *a = NULL;
	struct rays *r = NULL;
	struct error err;
	need(way == ANALYTIC ? analytic_create(&of, HIDDEN_RAYS, device, &a, &err)
			     : rays_create(device, &t->scene, &plain, &t->elements, &t->buffers, &o, &r, &err),
	     &err);
	for (uint32_t i = 0; i < t->elements.count; i++) {
		uint32_t list[2] = {i, i + 1}, n = i + 1 < t->elements.count && slice > 1 ? 2 : 1;
		if (way == BY_RAYS) {
			need(rays_rows(r, list, n, f, &err), &err);
			i += n - 1;
			continue;
		}
		analytic_begin(a, i);
		while (!analytic_finished(a))
			need(analytic_step(a, slice, f, &err), &err);
	}
	analytic_destroy(a);
	rays_destroy(r);
}

// All factors, by row; the caller frees them.
static double *matrix(struct traced_mesh *t, enum way way, uint32_t slice)
{
	struct factors f;
	struct error err;
	const size_t n = t->elements.count;
	double *all = calloc(n * n, sizeof *all);
	need(all ? factors_init(&f, device, t->elements.count, &err) : error_set(&err, STATUS_MEMORY, "out of memory"),
	     &err);
	make_rows(t, way, slice, &f);
	for (uint32_t i = 0; i < n; i++) {
		uint32_t *columns;
		float *values;
		need(factors_read_row(&f, i, &columns, &values, &err), &err);
		for (uint32_t k = 0; k < f.rows[i].count; k++)
			all[i * n + columns[k]] = (double)values[k];
		free(columns);
		free(values);
	}
	factors_finish(&f);
	return all;
}

// The elements of a scene, all their factors, and the number of triangles before which patches belong to the first body.
struct known {
	struct traced_mesh t;
	double *factor;
	bool same_bits;
	uint32_t first_of_second;
};

static void known_init(struct known *k, enum way way, double edge, uint32_t first_of_second)
{
	traced_mesh_init(&k->t, device, &m, edge);
	const size_t n = k->t.elements.count;
	k->factor = matrix(&k->t, way, 1000000);
	double *again = matrix(&k->t, way, 1);
	k->same_bits = !memcmp(k->factor, again, n * n * sizeof *again);
	k->first_of_second = first_of_second;
	free(again);
}

static void known_finish(struct known *k)
{
	free(k->factor);
	traced_mesh_finish(&k->t);
}

// From the fronts of one body to those of another, which may be the same.
static double between(const struct known *k, bool from_second, bool to_second)
{
	const struct patches *p = &k->t.elements.patches;
	double sum = 0, area = 0;
	for (uint32_t i = 0; i < p->count; i++) {
		struct patch a, b;
		patches_get(p, i, &a);
		if ((a.triangle[0] >= k->first_of_second) != from_second)
			continue;
		area += a.area;
		for (uint32_t j = 0; j < p->count; j++) {
			patches_get(p, j, &b);
			if ((b.triangle[0] >= k->first_of_second) == to_second)
				sum += a.area * k->factor[(size_t)i * k->t.elements.count + j];
		}
	}
	return sum / area;
}

// Of all fronts' rows the sum that is farthest from 1.
static double worst_row(const struct known *k)
{
	double worst = 1;
	const size_t n = k->t.elements.count;
	for (size_t i = 0; i < n / 2; i++) {
		double sum = 0;
		for (size_t j = 0; j < n; j++)
			sum += k->factor[i * n + j];
		if (fabs(sum - 1) > fabs(worst - 1))
			worst = sum;
	}
	return worst;
}

static void tell(const struct known *k, const char *name, enum way way, double value, double should, const char *from,
		 double tolerance)
{
	const bool many = k->t.elements.count > 20;
	printf("{\"case\": \"%s, by %s\", \"value\": %.17g, \"expected\": %.17g, \"source\": \"%s\", \"tolerance\": %.3g, "
	       "\"same_bits\": %s}\n",
	       name,
	       way == ANALYTIC ? "contour"
	       : many          ? "1,024 rays"
			       : "16,384 rays",
	       value, should, from, tolerance, k->same_bits ? "true" : "false");
}

// ---- cases ------------------------------------------------------------------------------------------------------------

// Relative: twice the standard error of independent rays.
static double error_of_rays(double f)
{
	return 2 * sqrt((1 - f) / (f * RAYS));
}

static void closed_forms(void)
{
	for (size_t i = 0; i < sizeof expected_of_floats / sizeof *expected_of_floats; i++) {
		const struct expected *e = &expected_of_floats[i];
		const double f = e->exchange / form_factor_area(&e->a);
		for (enum way way = ANALYTIC; way <= BY_RAYS; way++) {
			// What few rays would find, and what is between the planes that rays are moved off to begin, is not
			// for rays.
			if (way == BY_RAYS && (f < 0.01 || f > 0.99 || strstr(e->name, "needle")))
				continue;
			struct known k;
			start(&m);
			add_polygon(&e->a);
			add_polygon(&e->b);
			known_init(&k, way, INFINITY, 2);
			tell(&k, e->name, way, between(&k, false, true), f,
			     "closed form in 50 digits, and a quadrature by area",
			     way == ANALYTIC ? 1e-6 : error_of_rays(f));
			known_finish(&k);
		}
	}
}

static void nothing_and_hidden(enum way way)
{
	static const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, down[3] = {0, 0, -1}, far[3] = {3, 4, 0};
	static const struct {
		const char *name;
		const double *at, *u, *v;
	} dark[] = {{"side by side in one plane", x, x, y},
		    {"apart in one plane", far, x, y},
		    {"back to back", down, y, x},
		    {"one behind the other", down, x, y}};
	struct known k;
	for (size_t i = 0; i < sizeof dark / sizeof *dark; i++) {
		start(&m);
		add_quad(&m, o, x, y, 0);
		add_quad(&m, dark[i].at, dark[i].u, dark[i].v, 0);
		known_init(&k, way, INFINITY, 2);
		tell(&k, dark[i].name, way, between(&k, false, true), 0, "neither sees the other's front", 0);
		known_finish(&k);
	}
	for (int all = 0; all < 2; all++) {
		start(&m);
		add_facing_squares(1);
		const uint32_t screen = m.count;
		add_quad(&m, (const double[3]){-1, -1, 0.5}, (const double[3]){all ? 3 : 1.5, 0, 0},
			 (const double[3]){0, 3, 0}, 0);
		known_init(&k, way, INFINITY, 2);
		const double f = k.factor[1];
		tell(&k, all ? "squares with a screen between" : "squares half hidden by a screen", way, f,
		     all ? 0 : FACING / 2,
		     all ? "the screen hides all" : "half of all lines pass the screen, by symmetry; a share by rays",
		     all               ? 0
		     : way == ANALYTIC ? 1e-2
				       : error_of_rays(FACING / 2));
		assert_true(screen == 4);
		known_finish(&k);
	}
}

static void sizes(enum way way)
{
	static const double all[] = {1e-3, 1, 1e3, 1e6};
	for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
		struct known k;
		char name[80];
		start(&m);
		add_facing_squares(all[i]);
		known_init(&k, way, INFINITY, 2);
		snprintf(name, sizeof name, "squares of %g m face each other", all[i]);
		tell(&k, name, way, between(&k, false, true), FACING, "Howell C-11",
		     way == ANALYTIC ? 2e-7 : error_of_rays(FACING));
		known_finish(&k);
	}
}

static void bodies(enum way way)
{
	struct known k;
	start(&m);
	add_box(&m, (const double[3]){0, 0, 0}, (const double[3]){1, 1, 1}, 0.4, 0);
	turn_from(0);
	const uint32_t second = m.count;
	known_init(&k, way, 0.25, second);
	tell(&k, "a closed cube of 96 patches, its worst row", way, worst_row(&k), 1, "all light arrives", 1e-6);
	known_finish(&k);

	start(&m);
	add_box(&m, (const double[3]){0, 0, 0}, (const double[3]){1, 1, 1}, 0, 0);
	add_box(&m, (const double[3]){1, 0, 0}, (const double[3]){1, 1, 1}, 0, 0);
	turn_from(0);
	known_init(&k, way, 0.5, 12);
	tell(&k, "from a room to the room beside it, a wall in common", way, between(&k, false, true), 0, "both are closed",
	     0);
	known_finish(&k);

	start(&m);
	add_ball(0.5, 4);
	const uint32_t inner = m.count;
	add_ball(1, 4);
	turn_from(inner);
	known_init(&k, way, INFINITY, inner);
	tell(&k, "from a ball to the ball around it, twice as wide", way, between(&k, false, true), 1, "all light arrives",
	     1e-6);
	tell(&k, "from a ball to the ball within, half as wide", way, between(&k, true, false), 0.25,
	     "the ratio of their areas", way == ANALYTIC ? 1e-6 : 5e-3);
	known_finish(&k);

	start(&m);
	add_disc(0, 64, true);
	const uint32_t upper = m.count;
	add_disc(1, 64, false);
	known_init(&k, way, INFINITY, upper);
	tell(&k, "discs face each other, a radius apart", way, between(&k, false, true), (3 - sqrt(5)) / 2,
	     "Howell C-41; the discs have 64 corners", way == ANALYTIC ? 1e-3 : 1e-2);
	known_finish(&k);
}

int main(void)
{
	struct error err;
	if (device_create(&(struct device_options){0}, &device, &err) != STATUS_OK) {
		fprintf(stderr, "skipped: %s\n", err.text);
		return 77;
	}
	printf("{\"device\": \"%s\"}\n", device->info.name);
	closed_forms();
	for (enum way way = ANALYTIC; way <= BY_RAYS; way++) {
		nothing_and_hidden(way);
		sizes(way);
		bodies(way);
	}
	devices_finish(&(struct devices){.vk = device});
	return 0;
}
