#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/limits.h"
#include "server/scene/bvh_refit.h"
#include "server/worker/scenes/edit.h"

// From this ratio of the refitted tree's cost to the base's on, a note says so.
#define COST_WORTH_A_NOTE 2.0

struct geometry {
	const double *origin;
	struct vertex *vertices;
	struct vertex_tangent *tangents; // NULL: the scene has none
	struct triangle *triangles;
	uint8_t *done; // a bit a vertex: several triangles share one
};

// The transform from a node's place in the base to its place now, for vertices relative to the origin.
struct passage {
	struct transform map;
	struct transform_normals normals;
};

static bool move_position(const struct passage *p, const double origin[3], float position[3])
{
	double at[3];
	for (int c = 0; c < 3; c++)
		at[c] = origin[c] + (double)position[c];
	transform_point(&p->map, at, at);
	for (int c = 0; c < 3; c++) {
		const double v = at[c] - origin[c];
		if (!(fabs(v) <= LIMIT_COORDINATE))
			return false;
		position[c] = (float)v;
	}
	return true;
}

static void edit_make_unit(float v[3])
{
	double square = 0;
	for (int c = 0; c < 3; c++)
		square += (double)v[c] * (double)v[c];
	for (int c = 0; c < 3 && square > 0; c++)
		v[c] = (float)((double)v[c] / sqrt(square));
}

static bool move_vertex(const struct passage *p, struct geometry *g, uint32_t vertex)
{
	const uint8_t bit = (uint8_t)(1u << (vertex & 7u));
	if (g->done[vertex / 8] & bit)
		return true;
	g->done[vertex / 8] |= bit;
	struct vertex *v = &g->vertices[vertex];
	const double normal[3] = {(double)v->normal[0], (double)v->normal[1], (double)v->normal[2]};
	transform_normal(&p->normals, normal, v->normal);
	edit_make_unit(v->normal);
	if (g->tangents) {
		float *t = g->tangents[vertex].xyzw;
		const double tangent[4] = {(double)t[0], (double)t[1], (double)t[2], (double)t[3]};
		transform_tangent(&p->map, &p->normals, tangent, t);
		edit_make_unit(t);
	}
	return move_position(p, g->origin, v->position);
}

static enum status move_triangles(struct geometry *g, const struct scene_move *move, const struct scene_node *node,
				  const struct transform *world, struct error *err)
{
	struct passage p;
	struct transform back;
	if (move->triangle_count == 0)
		return STATUS_OK;
	if (!transform_invert(&node->world, &back))
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "node '%s' cannot be moved: its own transform flattens it, as a scale of 0 does",
				 node->name);
	p.map = transform_compose(world, &back);
	p.normals = transform_normals_of(&p.map);
	for (uint32_t i = 0; i < move->triangle_count; i++) {
		struct triangle *t = &g->triangles[move->first_triangle + i];
		for (int k = 0; k < 3; k++)
			if (!move_vertex(&p, g, t->vertex[k]))
				return error_set(err, STATUS_BAD_ARGUMENT,
						 "node '%s' cannot be moved there: it would reach beyond %g m", node->name,
						 LIMIT_COORDINATE);
		// A mirror turns a triangle's front to its back. Winding it the other way keeps the front.
		if (p.normals.determinant < 0) {
			const uint32_t second = t->vertex[1];
			t->vertex[1] = t->vertex[2];
			t->vertex[2] = second;
		}
	}
	return STATUS_OK;
}

static bool own_geometry(struct edited *e, struct geometry *g)
{
	const bool has_tangents = e->view.counts[BLOB_TANGENTS] > 0;
	g->origin = e->view.blob->origin;
	g->vertices = edit_own(e, BLOB_VERTICES, 0);
	g->triangles = edit_own(e, BLOB_TRIANGLES, 0);
	g->tangents = has_tangents ? edit_own(e, BLOB_TANGENTS, 0) : NULL;
	g->done = calloc(e->view.counts[BLOB_VERTICES] / 8u + 1u, 1);
	return g->vertices && g->triangles && (g->tangents || !has_tangents) && g->done;
}

static void find_bounds(struct edited *e)
{
	const struct vertex *vertices = e->view.sections[BLOB_VERTICES];
	const struct triangle *triangles = e->view.sections[BLOB_TRIANGLES];
	float min[3] = {INFINITY, INFINITY, INFINITY}, max[3] = {-INFINITY, -INFINITY, -INFINITY};
	if (e->view.counts[BLOB_TRIANGLES] == 0)
		return;
	for (uint32_t i = 0; i < e->view.counts[BLOB_TRIANGLES]; i++)
		for (int k = 0; k < 3; k++) {
			const float *p = vertices[triangles[i].vertex[k]].position;
			for (int c = 0; c < 3; c++) {
				min[c] = p[c] < min[c] ? p[c] : min[c];
				max[c] = p[c] > max[c] ? p[c] : max[c];
			}
		}
	memcpy(e->view.bounds_min, min, sizeof min);
	memcpy(e->view.bounds_max, max, sizeof max);
}

static enum status refit(struct edited *e, struct error *err)
{
	const struct vertex *vertices = e->view.sections[BLOB_VERTICES];
	const struct triangle *triangles = e->view.sections[BLOB_TRIANGLES];
	const uint32_t count = e->view.counts[BLOB_NODES];
	const double before = bvh_cost(e->view.sections[BLOB_NODES], count);
	struct leaf_triangle *leaves = edit_own(e, BLOB_LEAF_TRIANGLES, 0);
	struct bvh_node *nodes = edit_own(e, BLOB_NODES, 0);
	if (!leaves || !nodes)
		return error_set(err, STATUS_MEMORY, "no memory for %u triangles", e->view.counts[BLOB_TRIANGLES]);
	for (uint32_t i = 0; i < e->view.counts[BLOB_LEAF_TRIANGLES]; i++) {
		const uint32_t *corner = triangles[leaves[i].id].vertex;
		memcpy(leaves[i].v0, vertices[corner[0]].position, sizeof leaves[i].v0);
		memcpy(leaves[i].v1, vertices[corner[1]].position, sizeof leaves[i].v1);
		memcpy(leaves[i].v2, vertices[corner[2]].position, sizeof leaves[i].v2);
	}
	bvh_refit(nodes, count, leaves);
	const double after = bvh_cost(nodes, count);
	e->cost_ratio = before > 0 && after > 0 ? after / before : 1;
	if (e->cost_ratio > COST_WORTH_A_NOTE)
		snprintf(
		    e->note, sizeof e->note,
		    "nodes have moved so far that rays cost about %.1f times what they did; load the scene with them there "
		    "to have it quicker",
		    e->cost_ratio);
	return STATUS_OK;
}

enum status edit_geometry(struct edited *e, const struct transform *world, struct error *err)
{
	const struct scene_node *nodes = e->view.sections[BLOB_SCENE_NODES];
	uint32_t triangles = 0;
	struct geometry g = {0};
	for (uint32_t i = 0; i < e->move_count; i++)
		triangles += e->moves[i].triangle_count > 0;
	if (triangles == 0)
		return STATUS_OK;
	enum status status = own_geometry(e, &g)
				 ? STATUS_OK
				 : error_set(err, STATUS_MEMORY, "no memory for %u vertices", e->view.counts[BLOB_VERTICES]);
	for (uint32_t i = 0; i < e->move_count && status == STATUS_OK; i++) {
		const uint32_t node = e->moves[i].node;
		status = move_triangles(&g, &e->moves[i], &nodes[node], &world[node], err);
	}
	free(g.done);
	if (status == STATUS_OK)
		status = refit(e, err);
	if (status == STATUS_OK)
		find_bounds(e);
	return status;
}
