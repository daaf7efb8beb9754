#include "server/loader/obj_faces.h"

#include <stdlib.h>
#include <string.h>

#include "server/loader/import_parts.h"

// A face's corner: indices from 0, NONE where there is none.
struct obj_corner {
	uint32_t position, uv, normal, vertex;
};

#define KEY_WORDS 5

void obj_faces_init(struct obj_faces *f, struct import *im, const struct obj_points *points)
{
	*f = (struct obj_faces){.import = im, .points = points};
	key_table_init(&f->vertices, KEY_WORDS);
}

void obj_faces_finish(struct obj_faces *f)
{
	key_table_finish(&f->vertices);
	obj_polygon_finish(&f->polygon);
	free(f->corners);
	*f = (struct obj_faces){0};
}

// Read an index from *at, and move *at behind it. 0 if there is none. Beyond any list, it stays so.
static int64_t read_index(const char **at)
{
	const char *c = *at;
	const bool minus = *c == '-';
	int64_t value = 0;
	c += *c == '-' || *c == '+';
	const char *digits = c;
	for (; *c >= '0' && *c <= '9'; c++)
		value = value < INT32_MAX ? value * 10 + (*c - '0') : value;
	*at = c > digits ? c : *at;
	return minus ? -value : value;
}

// Whether an index names one of `count` elements, `before` of which stand before the face. *out becomes its number from 0.
static bool resolve(int64_t index, size_t count, size_t before, uint32_t *out)
{
	const int64_t from_zero = index > 0 ? index - 1 : index + (int64_t)before;
	if (index == 0 || from_zero < 0 || from_zero >= (int64_t)count)
		return false;
	*out = (uint32_t)from_zero;
	return true;
}

// Resolve what is not needed: an index that names nothing is left out, and told where the file has such a list.
static uint32_t attribute(struct obj_faces *f, int64_t index, size_t count, size_t before, size_t line)
{
	uint32_t out;
	if (resolve(index, count, before, &out))
		return out;
	if (index != 0 && !f->told_attribute) {
		import_warn(f->import,
			    "line %zu: a face names coordinates or normals that are not there; it is drawn without", line);
		f->told_attribute = true;
	}
	return NONE;
}

// Read "7", "7/8", "7//9" or "7/8/9".
static enum status read_corner(struct obj_faces *f, const struct obj_word *word, const struct obj_counts *before,
			       size_t line, struct obj_corner *corner, struct error *err)
{
	int64_t index[3] = {0, 0, 0};
	const char *at = word->at, *end = at + word->size;
	for (int k = 0; k < 3; k++) {
		index[k] = read_index(&at);
		if (at == end || *at != '/' || k == 2)
			break;
		at++;
	}
	if (at != end)
		return error_set(err, STATUS_SCENE_INVALID, "'%.*s' is no corner of a face",
				 word->size < 40 ? (int)word->size : 40, word->at);
	const struct obj_points *p = f->points;
	if (!resolve(index[0], p->position_count, before->positions, &corner->position))
		return error_set(err, STATUS_SCENE_INVALID, "a face names vertex %.*s, but the file has %zu",
				 word->size < 40 ? (int)word->size : 40, word->at, p->position_count);
	corner->uv = attribute(f, index[1], p->uv_count, before->uvs, line);
	corner->normal = attribute(f, index[2], p->normal_count, before->normals, line);
	return STATUS_OK;
}

static void place(const struct import *im, const double from[3], double out[3])
{
	out[0] = from[0];
	out[1] = im->z_up ? from[2] : from[1];
	out[2] = im->z_up ? -from[1] : from[2];
}

static enum status add_vertex(struct obj_faces *f, const struct obj_corner *c, struct error *err)
{
	struct import_vertex v = {0};
	const struct obj_points *p = f->points;
	place(f->import, p->positions[c->position], v.position);
	for (int i = 0; i < 3; i++)
		v.position[i] *= f->import->unit;
	if (c->normal != NONE) {
		const double given[3] = {p->normals[c->normal][0], p->normals[c->normal][1], p->normals[c->normal][2]};
		double turned[3];
		place(f->import, given, turned);
		for (int i = 0; i < 3; i++)
			v.normal[i] = (float)turned[i];
	}
	if (c->uv != NONE) {
		v.uv[0] = p->uvs[c->uv][0];
		v.uv[1] = 1.0f - p->uvs[c->uv][1]; // our row 0 is at the top
	}
	const enum status status = import_add_vertex(f->import, &v, err);
	if (status != STATUS_OK || !p->colours)
		return status;
	struct import_extra extra = {.color = {0, 0, 0, 1}};
	memcpy(extra.color, p->colours[c->position], sizeof p->colours[0]);
	return import_set_extra(f->import, &extra, err);
}

static enum status number_corner(struct obj_faces *f, struct obj_corner *c, uint32_t material, uint32_t group,
				 struct error *err)
{
	const struct obj_points *p = f->points;
	const uint32_t key[KEY_WORDS] = {p->distinct_position[c->position], c->uv == NONE ? NONE : p->distinct_uv[c->uv],
					 c->normal == NONE ? NONE : p->distinct_normal[c->normal], material, group};
	const uint32_t before = f->vertices.count;
	if (key_table_number(&f->vertices, key, &c->vertex, err) != STATUS_OK)
		return err->code;
	return c->vertex < before ? STATUS_OK : add_vertex(f, c, err);
}

static enum status read_corners(struct obj_faces *f, struct obj_text *t, const struct obj_counts *before, uint32_t *count,
				struct error *err)
{
	struct obj_word word;
	for (*count = 0; obj_text_word(t, &word); ++*count) {
		void *items = import_grown(f->corners, *count, 1, &f->corner_room, sizeof *f->corners, LIMIT_TRIANGLES,
					   "corners of a face", err);
		if (!items)
			return err->code;
		f->corners = items;
		if (read_corner(f, &word, before, t->line, &f->corners[*count], err) != STATUS_OK)
			return err->code;
	}
	return STATUS_OK;
}

// Add the triangles of the face in `corners`.
static enum status add_face(struct obj_faces *f, uint32_t count, uint32_t material, struct error *err)
{
	if (obj_polygon_reserve(&f->polygon, count, err) != STATUS_OK)
		return err->code;
	f->polygon.count = count;
	for (uint32_t i = 0; i < count; i++)
		memcpy(f->polygon.corners[i], f->points->positions[f->corners[i].position], sizeof f->polygon.corners[i]);
	if (obj_polygon_cut(&f->polygon, err) != STATUS_OK)
		return err->code;
	for (uint32_t i = 0; i + 2 < count; i++) {
		struct triangle t = {.material = material};
		for (int k = 0; k < 3; k++)
			t.vertex[k] = f->corners[f->polygon.triangles[i][k]].vertex;
		if (import_add_triangle(f->import, &t, err) != STATUS_OK)
			return err->code;
	}
	return STATUS_OK;
}

enum status obj_faces_read(struct obj_faces *f, struct obj_text *t, const struct obj_counts *before, uint32_t material,
			   uint32_t group, bool is_smooth, struct error *err)
{
	uint32_t count;
	bool lacks_normals = false;
	if (read_corners(f, t, before, &count, err) != STATUS_OK)
		return err->code;
	if (count < 3) {
		import_ignore(f->import, count == 2 ? "lines" : "points");
		return STATUS_OK;
	}
	for (uint32_t i = 0; i < count; i++) {
		if (number_corner(f, &f->corners[i], material, group, err) != STATUS_OK)
			return err->code;
		lacks_normals |= f->corners[i].normal == NONE;
	}
	if (is_smooth && lacks_normals)
		import_ignore(f->import, "smoothing groups");
	return add_face(f, count, material, err);
}
