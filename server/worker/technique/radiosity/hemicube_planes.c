#include "server/worker/technique/radiosity/hemicube_planes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/luminance.h"
#include "server/base/vec3.h"

#define SIDE_COMPONENT 0.3 // some component of a unit vector is more

// A face that reflects.
struct mirror_face {
	double normal[3], offset;
	double error;
	uint32_t face;
};

static double share_of(const struct radiosity_surface *s)
{
	const double share = luminance(s->mirror);
	return share > 0 ? fmin(share, 1) : 0;
}

static uint32_t corners_of(const struct elements *e, uint32_t face, const float *corners[4])
{
	const struct patch_face *f = &e->patches.faces.list[face];
	uint32_t count = 0;
	for (; count < 4 && f->corner[count] != NONE; count++)
		corners[count] = e->patches.vertices[f->corner[count]].position;
	return count;
}

static double height(const double normal[3], const float *corner)
{
	return normal[0] * (double)corner[0] + normal[1] * (double)corner[1] + normal[2] * (double)corner[2];
}

// Normals of the two sides of a plane become one, where rounding does not forbid it.
static void choose_side(double normal[3])
{
	int c = 0;
	while (c < 2 && fabs(normal[c]) < SIDE_COMPONENT)
		c++;
	for (int i = 0; normal[c] < 0 && i < 3; i++)
		normal[i] = -normal[i];
}

static struct mirror_face measure(const struct elements *e, uint32_t face)
{
	struct mirror_face m = {.face = face};
	const float *corners[4];
	const uint32_t count = corners_of(e, face, corners);
	vec3_across(corners[0], corners[1], corners[2], m.normal);
	vec3_normalize(m.normal);
	choose_side(m.normal);
	for (uint32_t k = 0; k < count; k++) {
		double own = 0;
		for (int c = 0; c < 3; c++)
			own += fabs(m.normal[c] * (double)corners[k][c]);
		m.offset += height(m.normal, corners[k]) / count;
		m.error = fmax(m.error, HEMICUBE_OFFSET_ERROR * own);
	}
	return m;
}

static int by_offset(const void *a, const void *b)
{
	const struct mirror_face *p = a, *q = b;
	if (p->offset != q->offset)
		return p->offset < q->offset ? -1 : 1;
	return p->face < q->face ? -1 : p->face > q->face;
}

static bool is_in(const struct elements *e, const struct mirror_face *m, const struct hemicube_plane *plane)
{
	const float *corners[4];
	const uint32_t count = corners_of(e, m->face, corners);
	const double most = 0.25 * fmin(m->error, plane->error);
	for (uint32_t k = 0; k < count; k++)
		if (!(fabs(height(plane->normal, corners[k]) - plane->offset) <= most))
			return false;
	return vec3_dot(plane->normal, m->normal) > 0.5;
}

static void put_into(const struct elements *e, const struct mirror_face *m, struct hemicube_plane *plane)
{
	const float *corners[4];
	const uint32_t count = corners_of(e, m->face, corners);
	plane->error = fmax(plane->error, m->error);
	for (uint32_t k = 0; k < count; k++) {
		double away = 0;
		for (int c = 0; c < 3; c++)
			away += ((double)corners[k][c] - plane->at[c]) * ((double)corners[k][c] - plane->at[c]);
		plane->radius = fmax(plane->radius, sqrt(away));
	}
}

// Find each face's plane: `of` gets its number + 1, by face. Faces are sorted by offset, so those of a plane are near each
// other, and planes that are too low for a face are too low for all behind it.
static void group(struct hemicube_planes *p, const struct elements *e, const struct mirror_face *faces, uint32_t count,
		  uint32_t *of)
{
	uint32_t low = 0;
	for (uint32_t i = 0; i < count; i++) {
		const struct mirror_face *m = &faces[i];
		while (low < p->count && p->list[low].offset < m->offset - m->error - p->list[low].error)
			low++;
		uint32_t k = low;
		while (k < p->count && !is_in(e, m, &p->list[k]))
			k++;
		if (k == p->count) {
			const float *corners[4];
			struct hemicube_plane *next = &p->list[p->count++];
			corners_of(e, m->face, corners);
			*next = (struct hemicube_plane){.offset = m->offset, .error = m->error};
			memcpy(next->normal, m->normal, sizeof next->normal);
			for (int c = 0; c < 3; c++)
				next->at[c] = (double)corners[0][c];
		}
		put_into(e, m, &p->list[k]);
		of[m->face] = k + 1;
	}
}

enum status hemicube_planes_init(struct hemicube_planes *p, const struct elements *e,
				 const struct radiosity_surface *surfaces, struct error *err)
{
	const uint32_t faces = e->patches.faces.count, patches = e->patches.count;
	uint32_t count = 0, *of = calloc(faces + 1, sizeof *of);
	struct mirror_face *found = NULL;
	*p = (struct hemicube_planes){.mirrors = calloc(e->count + 1, sizeof *p->mirrors)};
	enum status s = of && p->mirrors ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; s == STATUS_OK && i < e->count; i++) {
		uint32_t *face = &of[e->shapes[i % patches].face];
		p->mirrors[i].share = (float)share_of(&surfaces[i]);
		count += p->mirrors[i].share > 0 && !*face;
		*face |= p->mirrors[i].share > 0;
	}
	if (s == STATUS_OK && count > 0) {
		found = malloc(count * sizeof *found);
		p->list = calloc(count, sizeof *p->list);
		s = found && p->list ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	}
	if (s == STATUS_OK && count > 0) {
		count = 0;
		for (uint32_t i = 0; i < faces; i++)
			if (of[i])
				found[count++] = measure(e, i);
		qsort(found, count, sizeof *found, by_offset);
		group(p, e, found, count, of);
	}
	for (uint32_t i = 0; s == STATUS_OK && i < e->count; i++)
		p->mirrors[i].plane = p->mirrors[i].share > 0 ? of[e->shapes[i % patches].face] : 0;
	free(found);
	free(of);
	if (s != STATUS_OK)
		hemicube_planes_finish(p);
	return s;
}

void hemicube_planes_finish(struct hemicube_planes *p)
{
	free(p->list);
	free(p->mirrors);
	*p = (struct hemicube_planes){0};
}
