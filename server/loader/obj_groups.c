#include "server/loader/obj_groups.h"

#include <stdlib.h>
#include <string.h>

#include "server/loader/import_parts.h"

// Triangles in the order of the file that belong to one group; they end where the next run begins.
struct obj_run {
	uint32_t group;
	size_t first;
};

void obj_groups_init(struct obj_groups *g)
{
	*g = (struct obj_groups){0};
	key_table_init(&g->names, KEY_TEXT_WORDS);
}

void obj_groups_finish(struct obj_groups *g)
{
	for (size_t i = 0; i < g->text_count; i++)
		free(g->texts[i]);
	free(g->texts);
	free(g->runs);
	free(g->next);
	key_table_finish(&g->names);
	*g = (struct obj_groups){0};
}

void obj_groups_name(struct obj_groups *g, char *name)
{
	free(g->next);
	g->next = name;
}

static enum status begin_run(struct obj_groups *g, size_t first, struct error *err)
{
	uint32_t key[KEY_TEXT_WORDS], number;
	key_of_text(g->next, key);
	if (key_table_number(&g->names, key, &number, err) != STATUS_OK)
		return err->code;
	void *items = import_grown(g->runs, g->run_count, 1, &g->run_room, sizeof *g->runs, LIMIT_TRIANGLES, "groups", err);
	if (!items)
		return err->code;
	g->runs = items;
	if (number == g->text_count) {
		items = import_grown(g->texts, number, 1, &g->text_room, sizeof *g->texts, LIMIT_NODES, "groups", err);
		if (!items)
			return err->code;
		g->texts = items;
		g->texts[g->text_count++] = g->next;
	} else {
		free(g->next);
	}
	g->next = NULL;
	g->runs[g->run_count++] = (struct obj_run){number, first};
	return STATUS_OK;
}

enum status obj_groups_current(struct obj_groups *g, const struct import *im, uint32_t *number, struct error *err)
{
	if (!g->next && g->run_count == 0) {
		g->next = strdup("defaultobject");
		if (!g->next)
			return error_set(err, STATUS_MEMORY, "no memory for a group's name");
	}
	if (g->next && begin_run(g, im->triangle_count, err) != STATUS_OK)
		return err->code;
	*number = g->runs[g->run_count - 1].group;
	return STATUS_OK;
}

// Order the triangles by group. ends[i] holds the number of triangles of the groups before i, and then their end.
static enum status sort_triangles(const struct obj_groups *g, struct import *im, size_t *ends, struct error *err)
{
	struct triangle *sorted = malloc((im->triangle_count + 1) * sizeof *sorted);
	if (!sorted)
		return error_set(err, STATUS_MEMORY, "no memory for %zu triangles", im->triangle_count);
	for (size_t i = 0; i < g->run_count; i++) {
		const size_t first = g->runs[i].first;
		const size_t last = i + 1 < g->run_count ? g->runs[i + 1].first : im->triangle_count;
		if (last > first)
			memcpy(sorted + ends[g->runs[i].group], im->triangles + first, (last - first) * sizeof *sorted);
		ends[g->runs[i].group] += last - first;
	}
	free(im->triangles);
	im->triangles = sorted;
	im->triangle_room = im->triangle_count + 1;
	return STATUS_OK;
}

enum status obj_groups_end(struct obj_groups *g, struct import *im, struct error *err)
{
	if (g->run_count == 0)
		return STATUS_OK;
	size_t *ends = calloc(g->text_count + 1, sizeof *ends);
	if (!ends)
		return error_set(err, STATUS_MEMORY, "no memory for %zu groups", g->text_count);
	for (size_t i = 0; i < g->run_count; i++)
		ends[g->runs[i].group + 1] +=
		    (i + 1 < g->run_count ? g->runs[i + 1].first : im->triangle_count) - g->runs[i].first;
	for (size_t i = 1; i <= g->text_count; i++)
		ends[i] += ends[i - 1];
	enum status status = sort_triangles(g, im, ends, err);
	for (size_t i = 0; i < g->text_count && status == STATUS_OK; i++) {
		status = import_add_node(im, g->texts[i], &transform_identity, &transform_no_parts, NONE, err);
		if (status == STATUS_OK)
			im->nodes[im->node_count - 1].triangle_end = ends[i];
	}
	free(ends);
	return status;
}
