#include "server/loader/tangents.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/vec3.h"
#include "server/loader/key_table.h"

// The least area of a triangle in the map, as a share of the product of two of its edges. Below it, the direction of the
// tangent is noise.
#define SMALLEST_AREA 1e-12

// The words of a group's key: position, normal, coordinates and sign, which all corners of the group share.
#define GROUP_WORDS 9

struct group {
	double sum[3];
	float normal[3];
	float sign;
};

struct builder {
	const struct import *import;
	struct geometry *g;
	struct key_table keys; // keys of groups
	struct group *groups;
	size_t group_room;
	uint32_t *corner_group; // one for each corner of each triangle; NONE: nothing to do
	struct key_table homes; // (vertex, group) of corners that moved to another vertex
	uint32_t *holds; // for each old vertex the group whose tangent it holds
};

// A triangle with its texture coordinates in its normal map.
struct face {
	double edge[2][3]; // edges from corner 0
	double normal[3]; // unit
	double along_u[3]; // direction of growing u, any length
	double uv[3][2];
	bool mirrored; // mirrored in the map, with v pointing up
};

static void read_uv(const struct builder *b, const struct texture_info *map, uint32_t vertex, double uv[2])
{
	const float *raw = map->flags & TEXTURE_UV1 ? b->g->uv1[vertex].uv : b->g->vertices[vertex].uv;
	const double u = raw[0], v = raw[1];
	uv[0] = map->row_u[0] * u + map->row_u[1] * v + map->row_u[2];
	uv[1] = map->row_v[0] * u + map->row_v[1] * v + map->row_v[2];
}

// Fill in a face. False if the triangle has no direction in the map.
static bool find_face(const struct builder *b, const struct triangle *t, const struct texture_info *map, struct face *f)
{
	const float *p[3];
	double d[2][2];
	for (int k = 0; k < 3; k++) {
		p[k] = b->g->vertices[t->vertex[k]].position;
		read_uv(b, map, t->vertex[k], f->uv[k]);
	}
	for (int e = 0; e < 2; e++) {
		for (int c = 0; c < 3; c++)
			f->edge[e][c] = (double)p[e + 1][c] - (double)p[0][c];
		for (int c = 0; c < 2; c++)
			d[e][c] = f->uv[e + 1][c] - f->uv[0][c];
	}
	const double area = d[0][0] * d[1][1] - d[1][0] * d[0][1];
	if (!(fabs(area) > SMALLEST_AREA * hypot(d[0][0], d[0][1]) * hypot(d[1][0], d[1][1])))
		return false;
	f->mirrored = area > 0; // v grows downwards in a map that is seen from its front
	for (int c = 0; c < 3; c++) {
		const int c1 = (c + 1) % 3, c2 = (c + 2) % 3;
		f->normal[c] = f->edge[0][c1] * f->edge[1][c2] - f->edge[0][c2] * f->edge[1][c1];
		f->along_u[c] = (f->edge[0][c] * d[1][1] - f->edge[1][c] * d[0][1]) * (area < 0 ? -1 : 1);
	}
	return vec3_normalize(f->normal) && vec3_normalize(f->along_u);
}

static double corner_angle(const struct face *f, int k)
{
	double a[3], c[3];
	for (int i = 0; i < 3; i++) {
		a[i] = k == 0 ? f->edge[0][i] : k == 1 ? f->edge[1][i] - f->edge[0][i] : -f->edge[1][i];
		c[i] = k == 0 ? f->edge[1][i] : k == 1 ? -f->edge[0][i] : f->edge[0][i] - f->edge[1][i];
	}
	if (!vec3_normalize(a) || !vec3_normalize(c))
		return 0;
	return acos(fmin(1.0, fmax(-1.0, vec3_dot(a, c))));
}

static enum status find_group(struct builder *b, const struct vertex *v, const double uv[2], const float normal[3],
			      float sign, uint32_t *number, struct error *err)
{
	const float parts[GROUP_WORDS] = {v->position[0], v->position[1], v->position[2], normal[0], normal[1],
					  normal[2],      (float)uv[0],   (float)uv[1],   sign};
	uint32_t key[GROUP_WORDS];
	for (int i = 0; i < GROUP_WORDS; i++) {
		const float part = parts[i] + 0.0f; // no negative zero
		memcpy(&key[i], &part, sizeof part);
	}
	const uint32_t before = b->keys.count;
	if (key_table_number(&b->keys, key, number, err) != STATUS_OK)
		return err->code;
	if (b->keys.count == before)
		return STATUS_OK;
	if (*number >= b->group_room) {
		const size_t room = b->group_room ? b->group_room * 2 : 1024;
		struct group *bigger = realloc(b->groups, room * sizeof *bigger);
		if (!bigger)
			return error_set(err, STATUS_MEMORY, "no memory for %zu tangents", room);
		b->groups = bigger;
		b->group_room = room;
	}
	b->groups[*number] = (struct group){.normal = {normal[0], normal[1], normal[2]}, .sign = sign};
	return STATUS_OK;
}

static enum status add_corner(struct builder *b, const struct triangle *t, const struct face *f, int k, uint32_t *number,
			      struct error *err)
{
	const struct vertex *v = &b->g->vertices[t->vertex[k]];
	double normal[3] = {v->normal[0], v->normal[1], v->normal[2]}, along[3];
	if (!vec3_normalize(normal))
		memcpy(normal, f->normal, sizeof normal);
	const float rounded[3] = {(float)normal[0], (float)normal[1], (float)normal[2]};
	const bool turned = vec3_dot(normal, f->normal) < 0; // the normal points away from the face's front
	if (find_group(b, v, f->uv[k], rounded, f->mirrored != turned ? -1.0f : 1.0f, number, err) != STATUS_OK)
		return err->code;
	const double lean = vec3_dot(normal, f->along_u), angle = corner_angle(f, k);
	for (int c = 0; c < 3; c++)
		along[c] = f->along_u[c] - lean * normal[c];
	if (vec3_normalize(along))
		for (int c = 0; c < 3; c++)
			b->groups[*number].sum[c] += angle * along[c];
	return STATUS_OK;
}

static enum status group_corners(struct builder *b, struct error *err)
{
	const struct geometry *g = b->g;
	for (uint32_t i = 0; i < g->triangle_count; i++) {
		const struct triangle *t = &g->triangles[i];
		const uint32_t map = import_tangent_map(&b->import->materials[t->material]);
		struct face face;
		if (map == NONE || !find_face(b, t, &b->import->textures[map], &face))
			continue;
		for (int k = 0; k < 3; k++)
			if (g->tangents[t->vertex[k]].xyzw[3] == 0 &&
			    add_corner(b, t, &face, k, &b->corner_group[(size_t)i * 3 + (size_t)k], err) != STATUS_OK)
				return err->code;
	}
	return STATUS_OK;
}

// The first group at a vertex keeps it. Corners of other groups move to new vertices, numbered after the old ones.
static enum status move_corners(struct builder *b, struct error *err)
{
	struct geometry *g = b->g;
	for (size_t i = 0; i < (size_t)g->triangle_count * 3; i++) {
		uint32_t *vertex = &g->triangles[i / 3].vertex[i % 3], home;
		const uint32_t group = b->corner_group[i];
		if (group == NONE)
			continue;
		if (b->holds[*vertex] == NONE)
			b->holds[*vertex] = group;
		if (b->holds[*vertex] == group)
			continue;
		const uint32_t key[2] = {*vertex, group};
		if (key_table_number(&b->homes, key, &home, err) != STATUS_OK)
			return err->code;
		if (b->homes.count > LIMIT_VERTICES - g->vertex_count)
			return error_set(err, STATUS_SCENE_LIMIT,
					 "with tangents the scene has more than %u vertices; simplify it", LIMIT_VERTICES);
		*vertex = g->vertex_count + home;
	}
	return STATUS_OK;
}

// Grow an array to `count` elements. False if there is no memory.
#define GROW(array) ((bigger = realloc((array), count * sizeof *(array))) && ((array) = bigger, true))

static enum status copy_vertices(struct builder *b, struct error *err)
{
	struct geometry *g = b->g;
	const size_t count = (size_t)g->vertex_count + b->homes.count;
	void *bigger;
	if (b->homes.count == 0)
		return STATUS_OK;
	if (!GROW(g->vertices) || !GROW(g->tangents) || (g->uv1 && !GROW(g->uv1)) || (g->colors && !GROW(g->colors)))
		return error_set(err, STATUS_MEMORY, "no memory for %zu vertices", count);
	for (uint32_t i = 0; i < b->homes.count; i++) {
		const uint32_t from = b->homes.keys[i * 2], to = g->vertex_count + i;
		g->vertices[to] = g->vertices[from];
		if (g->uv1)
			g->uv1[to] = g->uv1[from];
		if (g->colors)
			g->colors[to] = g->colors[from];
	}
	return STATUS_OK;
}

static void set_tangent(const struct builder *b, uint32_t group, struct vertex_tangent *out)
{
	const struct group *from = &b->groups[group];
	const double normal[3] = {from->normal[0], from->normal[1], from->normal[2]};
	double tangent[3];
	const double lean = vec3_dot(normal, from->sum);
	for (int c = 0; c < 3; c++)
		tangent[c] = from->sum[c] - lean * normal[c];
	*out = (struct vertex_tangent){{0}};
	if (!vec3_normalize(tangent))
		return;
	for (int c = 0; c < 3; c++)
		out->xyzw[c] = (float)tangent[c];
	out->xyzw[3] = from->sign;
}

static enum status build(struct builder *b, struct error *err)
{
	struct geometry *g = b->g;
	const uint32_t old_count = g->vertex_count;
	if (group_corners(b, err) != STATUS_OK || move_corners(b, err) != STATUS_OK || copy_vertices(b, err) != STATUS_OK)
		return err->code;
	for (uint32_t i = 0; i < old_count; i++)
		if (b->holds[i] != NONE)
			set_tangent(b, b->holds[i], &g->tangents[i]);
	for (uint32_t i = 0; i < b->homes.count; i++)
		set_tangent(b, b->homes.keys[i * 2 + 1], &g->tangents[old_count + i]);
	g->vertex_count += b->homes.count;
	return STATUS_OK;
}

enum status tangents_build(const struct import *import, struct geometry *g, struct error *err)
{
	struct builder b = {.import = import, .g = g};
	const size_t corners = (size_t)g->triangle_count * 3;
	enum status status = STATUS_MEMORY;

	key_table_init(&b.keys, GROUP_WORDS);
	key_table_init(&b.homes, 2);
	b.corner_group = malloc((corners + 1) * sizeof *b.corner_group);
	b.holds = malloc(((size_t)g->vertex_count + 1) * sizeof *b.holds);
	if (!b.corner_group || !b.holds) {
		error_set(err, STATUS_MEMORY, "no memory for the tangents of %u triangles", g->triangle_count);
		goto out;
	}
	memset(b.corner_group, 0xFF, corners * sizeof *b.corner_group);
	memset(b.holds, 0xFF, (size_t)g->vertex_count * sizeof *b.holds);
	status = build(&b, err);
out:
	key_table_finish(&b.keys);
	key_table_finish(&b.homes);
	free(b.groups);
	free(b.corner_group);
	free(b.holds);
	return status;
}
