// Views of a solution: a value of each element, to be shown as it is (display.h's `plain`), and the element in a pixel. Host
// only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_DISPLAY_VIEWS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_DISPLAY_VIEWS_H

#include "server/worker/plan/plan.h"
#include "server/worker/technique/radiosity/elements.h"

// What a view shows.
enum display_view {
	DISPLAY_VIEW_B, // radiosity, W/m²
	DISPLAY_VIEW_E, // emitted exitance, W/m²
	DISPLAY_VIEW_ALBEDO, // diffuse reflectance
	DISPLAY_VIEW_ID, // a colour that no other element has
	DISPLAY_VIEW_NORMAL, // 0.5 + 0.5 × the normal of the side
	DISPLAY_VIEW_RESIDUAL, // magnitude of what the solver has left over (residual.h), W/m²
	DISPLAY_VIEW_ROW // form factors of one element to each, over the largest of them, grey
};

// What views are made of, by element; only what the view reads must be there.
struct display_source {
	const struct elements *elements;
	const struct radiosity_surface *surfaces; // B, E, ALBEDO
	const float *irradiance; // B: 3 each, W/m²
	const float *residual; // RESIDUAL: 3 each, W/m²
	const uint32_t *columns; // ROW: of the row's entries
	const float *factors; // ROW: their values
	uint32_t entries; // ROW
};

// Fill in 3 floats of each element.
void display_view_fill(enum display_view view, const struct display_source *source, float *values);

// The element that the ray through the point (x, y) of the image meets first, in pixels from its top left corner, whatever
// alpha cuts out. NONE: it meets nothing.
uint32_t display_element_seen(const struct elements *elements, const struct blob_view *scene, const struct plan *plan,
			      double x, double y);

#endif
