#include "server/worker/technique/deferred/deferred_cover.h"

#include <math.h>

#include "server/base/vec3.h"

// The image plane as the rasteriser sees it (shaders/deferred/visibility.vert.glsl), rows counted from the band's first.
struct screen {
	double eye[3], forward[3], right[3], up[3]; // right and up: scaled so that the image is −1…1
	bool orthographic;
	double width, height, first_row, rows; // pixels
};

static struct screen screen_of(const struct plan *plan, const struct blob_view *view, uint32_t first_row, uint32_t rows)
{
	const struct plan_camera *c = &plan->camera;
	const double right = vec3_dot(c->right, c->right), up = vec3_dot(c->up, c->up);
	struct screen s = {.orthographic = c->orthographic,
			   .width = plan->width,
			   .height = plan->height,
			   .first_row = first_row,
			   .rows = rows};
	for (int i = 0; i < 3; i++) {
		s.eye[i] = c->eye[i] - view->blob->origin[i];
		s.forward[i] = c->forward[i];
		s.right[i] = c->right[i] / right;
		s.up[i] = c->up[i] / up;
	}
	return s;
}

// Pixels of the box around a triangle that are within the band.
static double pixels_of(const struct screen *s, const struct vertex *vertices, const struct triangle *t)
{
	double low[2] = {s->width, s->rows}, high[2] = {0, 0};
	int behind = 0;
	for (int k = 0; k < 3; k++) {
		double p[3];
		for (int c = 0; c < 3; c++)
			p[c] = (double)vertices[t->vertex[k]].position[c] - s->eye[c];
		const double w = s->orthographic ? 1 : vec3_dot(p, s->forward);
		if (!(w > 0)) {
			behind++;
			continue;
		}
		const double at[2] = {0.5 * s->width * (1 + vec3_dot(p, s->right) / w),
				      0.5 * s->height * (1 - vec3_dot(p, s->up) / w) - s->first_row};
		for (int c = 0; c < 2; c++) {
			low[c] = fmin(low[c], at[c]);
			high[c] = fmax(high[c], at[c]);
		}
	}
	if (behind > 0)
		return behind == 3 ? 0 : s->width * s->rows;
	const double wide = fmin(high[0], s->width) - fmax(low[0], 0), tall = fmin(high[1], s->rows) - fmax(low[1], 0);
	return wide > 0 && tall > 0 ? wide * tall : 0;
}

uint32_t deferred_drawable(const struct plan *plan, const struct resident_scene *scene, uint32_t first_row, uint32_t rows,
			   uint32_t first, uint32_t count, double *cost)
{
	const struct screen s = screen_of(plan, &scene->view, first_row, rows);
	const struct vertex *vertices = scene_section(scene, BLOB_VERTICES);
	const struct triangle *triangles = scene_section(scene, BLOB_TRIANGLES);
	const double most = *cost;
	uint32_t n = 0;
	*cost = 0;
	while (n < count) {
		const double more = DEFERRED_TRIANGLE_COST + pixels_of(&s, vertices, &triangles[first + n]);
		if (n > 0 && *cost + more > most)
			break;
		*cost += more;
		n++;
	}
	return n;
}
