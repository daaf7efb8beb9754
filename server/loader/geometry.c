#include "server/loader/geometry.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/vec3.h"
#include "server/loader/tangents.h"

#define ORIGIN_EXTENTS 16.0

// The least length of a triangle's cross product, twice its area in m². Below it, the square of the normal's length
// underflows in a float.
#define SMALLEST_CROSS 1e-18

static bool sound(const double p[3])
{
	for (int i = 0; i < 3; i++)
		if (!(fabs(p[i]) <= LIMIT_COORDINATE)) // false for NaN too
			return false;
	return true;
}

// Update the ends of the nodes' triangles while triangles are dropped. Called before each triangle `i` of the old
// numbering, and once at the end; `kept` is the number of triangles kept so far.
static void end_nodes(struct import *im, size_t *node, size_t i, size_t kept)
{
	while (*node < im->node_count && im->nodes[*node].triangle_end <= i)
		im->nodes[(*node)++].triangle_end = kept;
}

// Drop triangles that are not finite, in place, and find the bounds of the rest.
static void drop_non_finite(struct import *im, double min[3], double max[3])
{
	size_t kept = 0, node = 0;
	for (size_t i = 0; i < im->triangle_count; i++) {
		end_nodes(im, &node, i, kept);
		const struct triangle t = im->triangles[i];
		const double *p[3];
		for (int k = 0; k < 3; k++)
			p[k] = im->vertices[t.vertex[k]].position;
		if (!sound(p[0]) || !sound(p[1]) || !sound(p[2])) {
			im->info->dropped_non_finite++;
			continue;
		}
		for (int k = 0; k < 9; k++) {
			min[k % 3] = fmin(min[k % 3], p[k / 3][k % 3]);
			max[k % 3] = fmax(max[k % 3], p[k / 3][k % 3]);
		}
		im->triangles[kept++] = t;
	}
	end_nodes(im, &node, im->triangle_count, kept);
	im->triangle_count = kept;
}

static void choose_origin(const double min[3], const double max[3], double origin[3])
{
	double extent = 0, reach = 0;
	for (int i = 0; i < 3; i++) {
		extent = fmax(extent, max[i] - min[i]);
		reach = fmax(reach, fabs(0.5 * (min[i] + max[i])));
	}
	memset(origin, 0, 3 * sizeof *origin);
	if (!(extent > 0) || !(reach > ORIGIN_EXTENTS * extent))
		return;
	// The grid is coarser where the middle would not fit a float's 24 bits otherwise.
	double grid = exp2(floor(log2(extent)));
	while (reach / grid > 8388608.0)
		grid *= 2;
	for (int i = 0; i < 3; i++)
		origin[i] = grid * round(0.5 * (min[i] + max[i]) / grid);
}

static void round_vertex(const struct import_vertex *from, const double origin[3], struct vertex *to)
{
	double length = 0;
	for (int i = 0; i < 3; i++) {
		to->position[i] = (float)(from->position[i] - origin[i]);
		length += (double)from->normal[i] * from->normal[i];
	}
	length = sqrt(length);
	const bool usable = length > 1e-20 && isfinite(length);
	for (int i = 0; i < 3; i++)
		to->normal[i] = usable ? (float)(from->normal[i] / length) : 0.0f;
	for (int i = 0; i < 2; i++)
		to->uv[i] = isfinite(from->uv[i]) ? from->uv[i] : 0.0f;
}

static bool has_area(const struct vertex *vertices, const struct triangle *t)
{
	double n[3];
	vec3_across(vertices[t->vertex[0]].position, vertices[t->vertex[1]].position, vertices[t->vertex[2]].position, n);
	return fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2]))) >= SMALLEST_CROSS;
}

// The file's tangent, normalised. Without a normal, a surface is flat and its tangent is ignored, as the specification
// requires.
static struct vertex_tangent round_tangent(const struct import_vertex *v, const struct import_extra *extra)
{
	struct vertex_tangent out = {{0}};
	double length = 0;
	for (int i = 0; i < 3; i++)
		length += (double)extra->tangent[i] * extra->tangent[i];
	length = sqrt(length);
	const bool has_normal = v->normal[0] != 0 || v->normal[1] != 0 || v->normal[2] != 0;
	if (!has_normal || extra->tangent[3] == 0 || !(length > 1e-20) || !isfinite(length))
		return out;
	for (int i = 0; i < 3; i++)
		out.xyzw[i] = (float)(extra->tangent[i] / length);
	out.xyzw[3] = extra->tangent[3];
	return out;
}

static void round_extra(const struct import *im, size_t vertex, struct geometry *g)
{
	static const struct import_extra none = {.color = {1, 1, 1, 1}};
	const struct import_extra *extra = vertex < im->extra_count ? &im->extras[vertex] : &none;
	const uint32_t to = g->vertex_count;
	for (int i = 0; i < 2 && g->uv1; i++)
		g->uv1[to].uv[i] = isfinite(extra->uv1[i]) ? extra->uv1[i] : 0.0f;
	if (g->colors)
		memcpy(g->colors[to].rgba, extra->color, sizeof extra->color);
	if (g->tangents)
		g->tangents[to] = round_tangent(&im->vertices[vertex], extra);
}

// Convert the vertices that some triangle uses; the order of the file is kept. `place` maps old indices to new ones.
static void round_vertices(struct import *im, struct geometry *g, uint32_t *place)
{
	memset(place, 0xFF, im->vertex_count * sizeof *place);
	for (size_t i = 0; i < im->triangle_count; i++)
		for (int k = 0; k < 3; k++)
			place[im->triangles[i].vertex[k]] = 0;
	for (size_t i = 0; i < im->vertex_count; i++) {
		if (place[i] == NONE)
			continue;
		place[i] = g->vertex_count;
		round_extra(im, i, g);
		round_vertex(&im->vertices[i], g->origin, &g->vertices[g->vertex_count++]);
	}
}

static void keep_triangles_with_area(struct import *im, struct geometry *g, const uint32_t *place)
{
	size_t node = 0;
	for (size_t i = 0; i < im->triangle_count; i++) {
		end_nodes(im, &node, i, g->triangle_count);
		struct triangle t = im->triangles[i];
		for (int k = 0; k < 3; k++)
			t.vertex[k] = place[t.vertex[k]];
		if (has_area(g->vertices, &t))
			g->triangles[g->triangle_count++] = t;
		else
			im->info->dropped_degenerate++;
	}
	end_nodes(im, &node, im->triangle_count, g->triangle_count);
}

static void find_bounds(struct geometry *g)
{
	for (uint32_t i = 0; i < g->triangle_count; i++)
		for (int k = 0; k < 9; k++) {
			const float v = g->vertices[g->triangles[i].vertex[k / 3]].position[k % 3];
			g->min[k % 3] = i == 0 && k < 3 ? v : fminf(g->min[k % 3], v);
			g->max[k % 3] = i == 0 && k < 3 ? v : fmaxf(g->max[k % 3], v);
		}
}

static bool wants_uv1(const struct import *im)
{
	for (size_t i = 0; i < im->texture_count; i++)
		if (im->textures[i].flags & TEXTURE_UV1)
			return true;
	return false;
}

static bool wants_colors(const struct import *im)
{
	for (size_t i = 0; i < im->extra_count; i++)
		for (int c = 0; c < 4; c++)
			if (im->extras[i].color[c] != 1.0f)
				return true;
	return false;
}

static bool wants_tangents(const struct import *im)
{
	for (size_t i = 0; i < im->triangle_count && im->material_count > 0; i++)
		if (import_tangent_map(&im->materials[im->triangles[i].material]) != NONE)
			return true;
	return false;
}

// Allocate the arrays. False if there is no memory.
static bool allocate(const struct import *im, struct geometry *g)
{
	const size_t count = im->vertex_count + 1;
	g->vertices = malloc(count * sizeof *g->vertices);
	g->triangles = malloc((im->triangle_count + 1) * sizeof *g->triangles);
	g->uv1 = wants_uv1(im) ? malloc(count * sizeof *g->uv1) : NULL;
	g->colors = wants_colors(im) ? malloc(count * sizeof *g->colors) : NULL;
	g->tangents = wants_tangents(im) ? malloc(count * sizeof *g->tangents) : NULL;
	return g->vertices && g->triangles && (g->uv1 || !wants_uv1(im)) && (g->colors || !wants_colors(im)) &&
	       (g->tangents || !wants_tangents(im));
}

enum status geometry_build(struct import *im, struct geometry *g, struct error *err)
{
	double min[3] = {INFINITY, INFINITY, INFINITY}, max[3] = {-INFINITY, -INFINITY, -INFINITY};
	enum status status = STATUS_OK;

	*g = (struct geometry){0};
	drop_non_finite(im, min, max);
	if (im->triangle_count > 0)
		choose_origin(min, max, g->origin);
	uint32_t *place = malloc((im->vertex_count + 1) * sizeof *place);
	if (!place || !allocate(im, g)) {
		status = error_set(err, STATUS_MEMORY, "no memory for %zu vertices", im->vertex_count);
		goto out;
	}
	round_vertices(im, g, place);
	keep_triangles_with_area(im, g, place);
	find_bounds(g);
	if (g->tangents)
		status = tangents_build(im, g, err);
out:
	free(place);
	free(im->vertices);
	free(im->triangles);
	free(im->extras);
	im->extras = NULL;
	im->extra_count = im->extra_room = 0;
	im->vertices = NULL;
	im->triangles = NULL;
	im->vertex_count = im->vertex_room = im->triangle_count = im->triangle_room = 0;
	if (status != STATUS_OK)
		geometry_finish(g);
	return status;
}

void geometry_finish(struct geometry *g)
{
	free(g->vertices);
	free(g->triangles);
	free(g->uv1);
	free(g->colors);
	free(g->tangents);
	*g = (struct geometry){0};
}
