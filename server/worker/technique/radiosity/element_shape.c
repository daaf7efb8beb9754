#include "server/worker/technique/radiosity/element_shape.h"

#include <string.h>

#include "server/base/vec3.h"

void element_shape_get(const struct elements *e, uint32_t element, struct element_shape *out)
{
	struct patch patch;
	const bool back = element >= e->patches.count;
	patches_get(&e->patches, back ? element - e->patches.count : element, &patch);
	const uint32_t n = out->polygon.corners = patch.shape.corners;
	memset(out->middle, 0, sizeof out->middle);
	for (uint32_t k = 0; k < n; k++) {
		memcpy(out->polygon.at[k], patch.shape.at[back ? n - 1 - k : k], sizeof out->polygon.at[k]);
		for (int c = 0; c < 3; c++)
			out->middle[c] += out->polygon.at[k][c] / n;
	}
	out->radius = 0;
	for (uint32_t k = 0; k < n; k++) {
		double r[3];
		for (int c = 0; c < 3; c++)
			r[c] = out->polygon.at[k][c] - out->middle[c];
		out->radius = fmax(out->radius, sqrt(vec3_dot(r, r)));
	}
	for (int c = 0; c < 3; c++)
		out->normal[c] = back ? -patch.normal[c] : patch.normal[c];
	out->area = patch.area;
}

// Whether a corner is in front of a plane. What is on it but for rounding may or may not be: form_factor_exchange decides.
static bool reaches(const struct element_shape *s, const struct element_shape *plane)
{
	for (uint32_t k = 0; k < s->polygon.corners; k++) {
		double r[3];
		for (int c = 0; c < 3; c++)
			r[c] = s->polygon.at[k][c] - plane->middle[c];
		if (vec3_dot(r, plane->normal) > 0)
			return true;
	}
	return false;
}

bool element_shapes_face(const struct element_shape *a, const struct element_shape *b)
{
	return reaches(a, b) && reaches(b, a);
}
