#include "server/loader/obj_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/loader/import_parts.h"
#include "server/loader/key_table.h"

// Keep the colour of the vertex added last; earlier ones without a colour are white.
static enum status add_colour(struct obj_points *p, const double *rgb, struct error *err)
{
	const bool first = p->colours == NULL;
	void *items = import_grown(p->colours, 0, p->position_room, &p->colour_room, sizeof *p->colours,
				   (size_t)LIMIT_VERTICES * 2, "vertices", err);
	if (!items)
		return err->code;
	p->colours = items;
	for (size_t i = 0; first && i + 1 < p->position_count; i++)
		for (int c = 0; c < 3; c++)
			p->colours[i][c] = -1; // none; obj_points_end makes it white
	for (int c = 0; c < 3; c++) {
		p->colours[p->position_count - 1][c] = rgb ? (float)fmax(rgb[c], 0) : -1;
		p->largest_colour = rgb ? fmax(p->largest_colour, rgb[c]) : p->largest_colour;
		p->has_broken_colour |= rgb && rgb[c] != floor(rgb[c]);
	}
	return STATUS_OK;
}

// v: x y z, then a weight, or a colour, or a colour and its opacity.
static enum status read_vertex(struct obj_points *p, struct import *im, struct obj_text *t, struct error *err)
{
	double numbers[8];
	int count;
	const bool sound = obj_text_numbers(t, 8, numbers, &count);
	if (count < 3)
		import_warn(im, "line %zu: a vertex lacks coordinates, so faces with it are left out", t->line);
	else if (!sound || count == 5 || count == 8)
		import_warn(im, "line %zu: what follows a vertex's place is no colour and is left out", t->line);
	if (count == 4 && numbers[3] != 1)
		import_ignore(im, "weights of vertices");
	if (count == 7 && numbers[6] != 1)
		import_ignore(im, "opacities of vertices");
	void *items = import_grown(p->positions, p->position_count, 1, &p->position_room, sizeof *p->positions,
				   LIMIT_VERTICES, "vertices", err);
	if (!items)
		return err->code;
	p->positions = items;
	for (int c = 0; c < 3; c++)
		p->positions[p->position_count][c] = count < 3 ? NAN : numbers[c];
	p->position_count++;
	const bool coloured = count == 6 || count == 7;
	return coloured || p->colours ? add_colour(p, coloured ? numbers + 3 : NULL, err) : STATUS_OK;
}

// vt and vn: a number that is missing is 0, as MTL has it; so the later ones keep their numbers whatever the line holds.
static void read_attribute(struct import *im, struct obj_text *t, int most, float *out)
{
	double numbers[3] = {0, 0, 0};
	int count;
	if (!obj_text_numbers(t, most, numbers, &count) || count == 0)
		import_warn(im, "line %zu: '%s' lacks numbers, which are taken as 0", t->line, most == 2 ? "vt" : "vn");
	for (int c = 0; c < most; c++)
		out[c] = c < count ? (float)numbers[c] : 0;
}

enum status obj_points_read(struct obj_points *p, struct import *im, struct obj_text *t, const struct obj_word *keyword,
			    bool *known, struct error *err)
{
	*known = true;
	if (obj_word_is(keyword, "v"))
		return read_vertex(p, im, t, err);
	if (obj_word_is(keyword, "vt")) {
		void *items = import_grown(p->uvs, p->uv_count, 1, &p->uv_room, sizeof *p->uvs, LIMIT_VERTICES,
					   "coordinates of maps", err);
		if (!items)
			return err->code;
		p->uvs = items;
		read_attribute(im, t, 2, p->uvs[p->uv_count++]);
	} else if (obj_word_is(keyword, "vn")) {
		void *items = import_grown(p->normals, p->normal_count, 1, &p->normal_room, sizeof *p->normals,
					   LIMIT_VERTICES, "normals", err);
		if (!items)
			return err->code;
		p->normals = items;
		read_attribute(im, t, 3, p->normals[p->normal_count++]);
	} else {
		*known = false;
	}
	return STATUS_OK;
}

static void mend_colours(struct obj_points *p, struct import *im)
{
	const bool bytes = p->largest_colour > 1 && p->largest_colour <= 255 && !p->has_broken_colour;
	if (bytes)
		import_warn(im, "the vertex colours are whole numbers above 1 and are taken as 0 to 255");
	else if (p->largest_colour > 1)
		import_warn(im, "vertex colours above 1 were clamped");
	for (size_t i = 0; i < p->position_count; i++)
		for (int c = 0; c < 3; c++)
			p->colours[i][c] = p->colours[i][c] < 0 ? 1 : fminf(p->colours[i][c] / (bytes ? 255.0f : 1.0f), 1);
}

// For each of `count` elements, that number of the distinct ones which it has. An element is `words` words of `items`, and
// as many as three of `more` unless that is NULL. *same becomes an array, freed by obj_points_finish.
static enum status number_distinct(const void *items, const void *more, size_t count, size_t words, uint32_t **same,
				   struct error *err)
{
	struct key_table distinct;
	enum status status = STATUS_OK;
	uint32_t *of = *same = malloc((count + 1) * sizeof **same);
	if (!of)
		return error_set(err, STATUS_MEMORY, "no memory for %zu vertices", count);
	key_table_init(&distinct, words + (more ? 3 : 0));
	for (size_t i = 0; i < count && status == STATUS_OK; i++) {
		uint32_t key[9];
		memcpy(key, (const uint32_t *)items + i * words, words * sizeof *key);
		if (more)
			memcpy(key + words, (const uint32_t *)more + i * 3, 3 * sizeof *key);
		status = key_table_number(&distinct, key, &of[i], err);
	}
	key_table_finish(&distinct);
	return status;
}

enum status obj_points_end(struct obj_points *p, struct import *im, struct error *err)
{
	if (p->colours)
		mend_colours(p, im);
	if (number_distinct(p->positions, p->colours, p->position_count, 6, &p->distinct_position, err) != STATUS_OK ||
	    number_distinct(p->uvs, NULL, p->uv_count, 2, &p->distinct_uv, err) != STATUS_OK)
		return err->code;
	return number_distinct(p->normals, NULL, p->normal_count, 3, &p->distinct_normal, err);
}

void obj_points_finish(struct obj_points *p)
{
	free(p->positions);
	free(p->colours);
	free(p->uvs);
	free(p->normals);
	free(p->distinct_position);
	free(p->distinct_uv);
	free(p->distinct_normal);
	*p = (struct obj_points){0};
}
