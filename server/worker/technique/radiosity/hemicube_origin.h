// Where the hemicubes of an element stand: points spread evenly over its patch, and for each a frame. Host only, any thread,
// no state.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_HEMICUBE_ORIGIN_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_HEMICUBE_ORIGIN_H

#include "server/worker/technique/radiosity/elements.h"

// Rounding of places, as a share of coordinates: OFFSET_ERROR of shaders/common/surface.glsl. And of normals and frames, as
// a share of distances.
#define HEMICUBE_OFFSET_ERROR 9.5367431640625e-07
#define HEMICUBE_TILT_ERROR (HEMICUBE_OFFSET_ERROR / 4)

// A hemicube's point, metres relative to the blob's origin, and its frame, of which z is the element's normal.
struct hemicube_origin {
	double at[3];
	double x[3], y[3], z[3];
};

// Origin `i` of `count` of an element. One alone is the patch's barycentre; more are Hammersley's set (1960), moved by half
// a step. They lie off the patch, on the element's side, by what rounding may lift of its own plane: so what is in that
// plane is below the horizon, and nothing else is cut off. Each frame is turned about its normal by another angle, so that
// the edges of pixels, and their errors, are in other places.
void hemicube_origin_get(const struct elements *elements, uint32_t element, uint32_t i, uint32_t count,
			 struct hemicube_origin *out);

#endif
