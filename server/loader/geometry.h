// The geometry of a blob out of an import's: origin, float positions, sound triangles only. One thread.
#ifndef CANDIL_LOADER_GEOMETRY_H
#define CANDIL_LOADER_GEOMETRY_H

#include "server/loader/import.h"

struct geometry {
	double origin[3];
	struct vertex *vertices;
	struct vertex_uv1 *uv1; // these three: one a vertex, or NULL
	struct vertex_color *colors;
	struct vertex_tangent *tangents;
	struct triangle *triangles;
	uint32_t vertex_count, triangle_count;
	float min[3], max[3]; // relative to origin; zero without a triangle
};

// Positions are stored relative to an origin. It is the world's zero unless the scene lies so far from there that floats
// would lose digits that matter: once the middle of the bounds is more than 16 extents away (four bits of 24 gone), the
// origin moves to the middle, rounded to a multiple of the power of two below the extent. So a scene moved by a round offset
// keeps its positions bit for bit, and the origin itself is exact in a float and in every sum with one.
//
// The second coordinates are there if some texture is looked up by them, the colours if one is not white, the tangents if a
// triangle that stays has a normal map (tangents.h).
//
// Frees the import's vertices and triangles.
enum status geometry_build(struct import *import, struct geometry *out, struct error *err);

void geometry_finish(struct geometry *geometry);

#endif
