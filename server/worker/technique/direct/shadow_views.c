#include "server/worker/technique/direct/shadow_views.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/limits.h"
#include "server/base/vec3.h"

_Static_assert(SHADOW_LIGHTS_MAX == LIMIT_MAP_LIGHTS && SHADOW_MAPS_MAX == SHADOW_LIGHTS_MAX * SHADOW_FACES,
	       "every light that may have maps has room for them");

struct frame3 {
	double eye[3], x[3], y[3], z[3];
};

static void shadow_views_make_unit(double v[3])
{
	if (!vec3_normalize(v))
		memcpy(v, (const double[3]){0, 0, 1}, 3 * sizeof *v);
}

// Make a frame of axes that looks along `z`, which is normalised.
static void look(struct frame3 *f, const double z[3])
{
	memcpy(f->z, z, sizeof f->z);
	shadow_views_make_unit(f->z);
	const double aside[3] = {fabs(f->z[0]) < 0.6, fabs(f->z[0]) >= 0.6, 0};
	vec3_cross(aside, f->z, f->x);
	shadow_views_make_unit(f->x);
	vec3_cross(f->z, f->x, f->y);
}

static double diagonal(const struct blob_view *scene)
{
	double sum = 0;
	for (int i = 0; i < 3; i++) {
		const double side = (double)scene->bounds_max[i] - (double)scene->bounds_min[i];
		sum += side * side;
	}
	return sqrt(sum);
}

static void middle(const struct blob_view *scene, double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = 0.5 * ((double)scene->bounds_min[i] + (double)scene->bounds_max[i]);
}

// Express a corner of the scene's bounds in a frame.
static void corner_in(const struct frame3 *f, const struct blob_view *scene, unsigned corner, double out[3])
{
	double d[3];
	for (int i = 0; i < 3; i++)
		d[i] = (double)(corner >> i & 1u ? scene->bounds_max[i] : scene->bounds_min[i]) - f->eye[i];
	out[0] = vec3_dot(d, f->x);
	out[1] = vec3_dot(d, f->y);
	out[2] = vec3_dot(d, f->z);
}

static void shadow_views_put(struct shadow_map *m, const struct frame3 *f, const double half[2], double near, double range,
			     uint32_t side)
{
	const double margin = 1 + 4.0 / side;
	for (int i = 0; i < 3; i++) {
		m->eye[i] = (float)f->eye[i];
		m->x[i] = (float)f->x[i];
		m->y[i] = (float)f->y[i];
		m->z[i] = (float)f->z[i];
	}
	m->near = (float)near;
	m->range = (float)range;
	m->half_x = (float)(half[0] * margin);
	m->half_y = (float)(half[1] * margin);
}

static void put_directional(struct shadow_map *m, const struct punctual_light *light, const struct blob_view *scene,
			    uint32_t side)
{
	const double z[3] = {(double)light->direction[0], (double)light->direction[1], (double)light->direction[2]};
	const double least = fmax(1e-3 * diagonal(scene), 1e-30);
	double half[2] = {least, least}, deep = least;
	struct frame3 f;
	middle(scene, f.eye);
	look(&f, z);
	for (unsigned i = 0; i < 8; i++) {
		double p[3];
		corner_in(&f, scene, i, p);
		half[0] = fmax(half[0], fabs(p[0]));
		half[1] = fmax(half[1], fabs(p[1]));
		deep = fmax(deep, fabs(p[2]));
	}
	deep *= 1.01;
	for (int i = 0; i < 3; i++)
		f.eye[i] -= deep * f.z[i];
	shadow_views_put(m, &f, half, 0, 2 * deep, side);
}

// The tangents of the half angles under which f->eye sees the scene's bounds. False: they are too wide for one map.
static bool shadow_views_fits(struct frame3 *f, const struct blob_view *scene, double half[2])
{
	double to[3];
	middle(scene, to);
	for (int i = 0; i < 3; i++)
		to[i] -= f->eye[i];
	look(f, to);
	half[0] = half[1] = 1e-6;
	for (unsigned i = 0; i < 8; i++) {
		double p[3];
		corner_in(f, scene, i, p);
		if (!(p[2] > 0))
			return false;
		half[0] = fmax(half[0], fabs(p[0]) / p[2]);
		half[1] = fmax(half[1], fabs(p[1]) / p[2]);
	}
	return fmax(half[0], half[1]) <= SHADOW_WIDEST;
}

static void put_faces(struct shadow_map *m, struct frame3 *f, double near, uint32_t side)
{
	const double half[2] = {1, 1};
	for (unsigned face = 0; face < SHADOW_FACES; face++) {
		double z[3] = {0};
		z[face / 2] = face % 2 ? -1 : 1;
		look(f, z);
		shadow_views_put(&m[face], f, half, near, 0, side);
	}
}

// Put the views of a point light or a wide spot; returns how many.
static uint32_t put_point(struct shadow_map *m, const struct punctual_light *light, const struct blob_view *scene,
			  uint32_t side)
{
	const double near = fmax(SHADOW_NEAREST * diagonal(scene), 1e-30);
	const double cosine = 1 - (double)light->outer;
	const double cone =
	    light->kind == LIGHT_SPOT && cosine > 0 ? sqrt((1 + cosine) * (double)light->outer) / cosine : INFINITY;
	struct frame3 f;
	double half[2];
	for (int i = 0; i < 3; i++)
		f.eye[i] = (double)light->position[i];
	if (shadow_views_fits(&f, scene, half) && fmax(half[0], half[1]) <= cone) {
		shadow_views_put(m, &f, half, near, 0, side);
		return 1;
	}
	if (!(cone <= SHADOW_WIDEST)) {
		put_faces(m, &f, near, side);
		return SHADOW_FACES;
	}
	const double z[3] = {(double)light->direction[0], (double)light->direction[1], (double)light->direction[2]};
	half[0] = half[1] = fmax(cone, 1e-6);
	look(&f, z);
	shadow_views_put(m, &f, half, near, 0, side);
	return 1;
}

// The strongest light that has no map yet. NONE: all have one.
static uint32_t strongest(const struct blob_view *scene, const uint32_t *first)
{
	const struct punctual_light *lights = scene->sections[BLOB_LIGHTS];
	uint32_t best = NONE;
	for (uint32_t i = 0; i < scene->counts[BLOB_LIGHTS]; i++)
		if (first[i] == NONE && (best == NONE || lights[i].pmf > lights[best].pmf))
			best = i;
	return best;
}

enum status shadow_views_init(struct shadow_views *v, const struct blob_view *scene, uint32_t side, struct error *err)
{
	const struct punctual_light *lights = scene->sections[BLOB_LIGHTS];
	const uint32_t count = scene->counts[BLOB_LIGHTS];
	memset(v, 0, sizeof *v);
	v->first = malloc((count + 1u) * sizeof *v->first);
	if (!v->first)
		return error_set(err, STATUS_MEMORY, "out of memory");
	memset(v->first, 0xff, (count + 1u) * sizeof *v->first);
	for (uint32_t i = 0; i < SHADOW_LIGHTS_MAX; i++) {
		const uint32_t at = strongest(scene, v->first);
		uint32_t maps = 1;
		if (at == NONE)
			break;
		if (lights[at].kind == LIGHT_DIRECTIONAL)
			put_directional(&v->maps[v->count], &lights[at], scene, side);
		else
			maps = put_point(&v->maps[v->count], &lights[at], scene, side);
		v->first[at] = v->count | (maps == SHADOW_FACES ? SHADOW_CUBE : 0);
		v->count += maps;
	}
	return STATUS_OK;
}

void shadow_views_finish(struct shadow_views *v)
{
	free(v->first);
	*v = (struct shadow_views){0};
}

uint32_t shadow_views_count(const struct blob_view *scene)
{
	struct shadow_views views;
	struct error err;
	uint32_t count = SHADOW_MAPS_MAX;
	if (shadow_views_init(&views, scene, 1, &err) == STATUS_OK)
		count = views.count;
	shadow_views_finish(&views);
	return count;
}
