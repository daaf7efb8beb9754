// Makes a blob's geometry from an import: an origin, float positions, and only usable triangles. One thread.
#ifndef CANDIL_LOADER_GEOMETRY_H
#define CANDIL_LOADER_GEOMETRY_H

#include "server/loader/import.h"

struct geometry {
	double origin[3];
	struct vertex *vertices;
	struct vertex_uv1 *uv1; // this and the next two: one element a vertex, or NULL
	struct vertex_color *colors;
	struct vertex_tangent *tangents;
	struct triangle *triangles;
	uint32_t vertex_count, triangle_count;
	float min[3], max[3]; // metres, relative to the origin; zero without a triangle
};

// Build the geometry. Positions are stored relative to an origin, which is the world's zero unless the scene lies so far
// away that floats would lose digits that matter. If the middle of the bounds is more than 16 extents away (four bits of 24
// lost), the origin is the middle, rounded to a multiple of the power of two below the extent. So a scene that is moved by
// a round offset keeps its positions bit for bit. The origin itself is exact in a float and in every sum with one.
//
// The second texture coordinates exist if a texture uses them, the colours if one is not white, the tangents if a triangle
// that is kept has a normal map (tangents.h).
//
// The import's vertices, extras and triangles are freed. *out must be given to geometry_finish, after a failure too.
// STATUS_MEMORY; failures of tangents_build.
enum status geometry_build(struct import *import, struct geometry *out, struct error *err);

// Free the arrays.
void geometry_finish(struct geometry *geometry);

#endif
