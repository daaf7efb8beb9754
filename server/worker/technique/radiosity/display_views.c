#include "server/worker/technique/radiosity/display_views.h"

#include <math.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/base/vec3.h"

// ---- values -------------------------------------------------------------------------------------------------------------

static void spread(const float *one, uint32_t count, float *values)
{
	for (uint32_t i = 0; i < count; i++)
		values[3 * (size_t)i] = values[3 * (size_t)i + 1] = values[3 * (size_t)i + 2] = one[i];
}

static void fill_light(enum display_view view, const struct display_source *s, float *values)
{
	for (uint32_t i = 0; i < s->elements->count; i++)
		for (uint32_t c = 0; c < 3; c++) {
			const struct radiosity_surface *of = &s->surfaces[i];
			const float m = (float)PI * of->emission[c];
			values[3 * (size_t)i + c] = view == DISPLAY_VIEW_ALBEDO ? of->albedo[c]
						    : view == DISPLAY_VIEW_E
							? m
							: m + of->albedo[c] * s->irradiance[3 * (size_t)i + c];
		}
}

static void fill_normals(const struct elements *e, float *values)
{
	for (uint32_t i = 0; i < e->patches.count; i++) {
		struct patch patch;
		patches_get(&e->patches, i, &patch);
		for (uint32_t c = 0; c < 3; c++) {
			const float n = (float)patch.normal[c];
			values[3 * (size_t)i + c] = 0.5f + 0.5f * n;
			values[3 * ((size_t)i + e->patches.count) + c] = 0.5f - 0.5f * n;
		}
	}
}

// Of Wellons' lowbias32, as in common/sampling.glsl, no two numbers have the same value. Its bits are cut into three colours
// that are not black.
static void fill_ids(uint32_t count, float *values)
{
	for (uint32_t i = 0; i < count; i++) {
		uint32_t x = i;
		x ^= x >> 16;
		x *= 0x7feb352du;
		x ^= x >> 15;
		x *= 0x846ca68bu;
		x ^= x >> 16;
		values[3 * (size_t)i] = ((float)(x & 2047u) + 128) / 2176;
		values[3 * (size_t)i + 1] = ((float)(x >> 11 & 2047u) + 128) / 2176;
		values[3 * (size_t)i + 2] = ((float)(x >> 22) + 64) / 1088;
	}
}

static void fill_row(const struct display_source *s, float *values)
{
	float most = 0;
	memset(values, 0, 3 * (size_t)s->elements->count * sizeof *values);
	for (uint32_t k = 0; k < s->entries; k++)
		most = fmaxf(most, s->factors[k]);
	for (uint32_t k = 0; most > 0 && k < s->entries; k++) {
		const float one = s->factors[k] / most;
		spread(&one, 1, values + 3 * (size_t)s->columns[k]);
	}
}

void display_view_fill(enum display_view view, const struct display_source *s, float *values)
{
	switch (view) {
	case DISPLAY_VIEW_B:
	case DISPLAY_VIEW_E:
	case DISPLAY_VIEW_ALBEDO:
		fill_light(view, s, values);
		break;
	case DISPLAY_VIEW_ID:
		fill_ids(s->elements->count, values);
		break;
	case DISPLAY_VIEW_NORMAL:
		fill_normals(s->elements, values);
		break;
	case DISPLAY_VIEW_RESIDUAL:
		memcpy(values, s->residual, 3 * (size_t)s->elements->count * sizeof *values);
		break;
	case DISPLAY_VIEW_ROW:
		fill_row(s, values);
		break;
	}
}

// ---- the element in a pixel
// -----------------------------------------------------------------------------------------------

struct display_ray {
	double origin[3], direction[3];
};

static struct display_ray ray_of(const struct plan *plan, const double zero[3], double x, double y)
{
	const struct plan_camera *c = &plan->camera;
	const double right = 2 * x / plan->width - 1, up = 1 - 2 * y / plan->height;
	struct display_ray r;
	for (int i = 0; i < 3; i++) {
		const double plane = right * c->right[i] + up * c->up[i];
		r.origin[i] = c->eye[i] - zero[i] + (c->orthographic ? plane : 0);
		r.direction[i] = c->forward[i] + (c->orthographic ? 0 : plane);
	}
	return r;
}

static void minus(const float *a, const double b[3], double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = (double)a[i] - b[i];
}

// Möller and Trumbore 1997, "Fast, minimum storage ray/triangle intersection". *t falls to the distance of a nearer hit.
static bool meets(const struct display_ray *r, const struct vertex *const v[3], double *t, double uv[2], bool *front)
{
	double first[3], one[3], two[3], p[3], q[3];
	minus(v[0]->position, r->origin, first);
	minus(v[1]->position, r->origin, one);
	minus(v[2]->position, r->origin, two);
	for (int i = 0; i < 3; i++) {
		one[i] -= first[i];
		two[i] -= first[i];
		first[i] = -first[i];
	}
	vec3_cross(r->direction, two, p);
	vec3_cross(first, one, q);
	const double det = vec3_dot(one, p);
	const double u = vec3_dot(first, p) / det, w = vec3_dot(r->direction, q) / det, at = vec3_dot(two, q) / det;
	if (det == 0 || !(u >= 0 && w >= 0 && u + w <= 1 && at > 0 && at < *t))
		return false;
	*t = at;
	uv[0] = u;
	uv[1] = w;
	*front = det > 0;
	return true;
}

uint32_t display_element_seen(const struct elements *elements, const struct blob_view *scene, const struct plan *plan,
			      double x, double y)
{
	const struct display_ray ray = ray_of(plan, scene->blob->origin, x, y);
	const struct vertex *vertices = scene->sections[BLOB_VERTICES];
	const struct triangle *triangles = scene->sections[BLOB_TRIANGLES];
	double t = INFINITY, uv[2] = {0, 0};
	uint32_t found = NONE;
	bool front = false;
	for (uint32_t i = 0; i < scene->counts[BLOB_TRIANGLES]; i++) {
		const uint32_t *k = triangles[i].vertex;
		const struct vertex *const v[3] = {&vertices[k[0]], &vertices[k[1]], &vertices[k[2]]};
		if (meets(&ray, v, &t, uv, &front))
			found = i;
	}
	return found == NONE ? NONE : elements_at(elements, found, uv, front);
}
