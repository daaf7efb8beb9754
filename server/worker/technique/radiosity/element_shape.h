// An element as a polygon in double precision, its front the element's side. Host only, any thread; nothing fails.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_ELEMENT_SHAPE_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_ELEMENT_SHAPE_H

#include "server/worker/technique/radiosity/elements.h"

// An element as a polygon.
struct element_shape {
	struct form_polygon polygon;
	double normal[3]; // unit, on the element's side
	double middle[3]; // mean of the corners
	double radius; // of a sphere about the middle that holds it, metres
	double area; // m²
};

// Make that of an element, below the count.
void element_shape_get(const struct elements *elements, uint32_t element, struct element_shape *out);

// Whether a part of each may be in front of the other's plane: if not, their form factor is 0.
bool element_shapes_face(const struct element_shape *a, const struct element_shape *b);

#endif
