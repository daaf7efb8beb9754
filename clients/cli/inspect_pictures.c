#include "clients/cli/inspect_pictures.h"

#include <math.h>
#include <string.h>

static struct inspect_picture *add_picture(struct inspect_list *list, const char *kind, const char *show,
					   const struct candil_render_request *request)
{
	if (list->count == INSPECT_PICTURES_MAX)
		return NULL;
	struct inspect_picture *p = &list->pictures[list->count++];
	*p = (struct inspect_picture){.kind = kind, .show = show, .slice = INSPECT_NO_SLICE};
	p->width = request->width;
	p->height = request->height;
	return p;
}

void inspect_first(struct inspect_list *list, bool patches, const struct candil_render_request *request)
{
	// The last may be of nothing: of a row that no option names and nothing is in the middle of the picture for.
	static const char *const shows[] = {"albedo", "b", "e", INSPECT_SHOW_RESIDUAL, "id", "normal", INSPECT_SHOW_ROW};
	list->count = 0;
	if (!patches)
		add_picture(list, "view", "radiance", request);
	for (size_t i = 0; patches && i < sizeof(shows) / sizeof(shows[0]); i++)
		add_picture(list, INSPECT_PATCHES, shows[i], request);
}

void inspect_leave_out_factors(struct inspect_list *list)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; i < list->count; i++)
		if (strcmp(list->pictures[i].show, INSPECT_SHOW_ROW) != 0 &&
		    strcmp(list->pictures[i].show, INSPECT_SHOW_RESIDUAL) != 0)
			list->pictures[kept++] = list->pictures[i];
	list->count = kept;
}

double inspect_figure(const struct candil_done *done, const char *name)
{
	for (uint32_t i = 0; i < done->figure_count; i++)
		if (strcmp(done->figures[i].name, name) == 0)
			return done->figures[i].value;
	return NAN;
}

double inspect_white(const struct inspect_list *list, const struct inspect_picture *p)
{
	const struct candil_done *first = &list->pictures[0].done;
	const double most = inspect_figure(first, "b.most"), reflected = inspect_figure(first, "reflected.most");
	double white = 0;
	if (p == &list->pictures[0] || strcmp(p->kind, INSPECT_PATCHES) != 0)
		return 0;
	if (strcmp(p->show, "b") == 0)
		white = reflected > 0 ? reflected : most;
	if (strcmp(p->show, "e") == 0)
		white = most;
	if (strcmp(p->show, INSPECT_SHOW_RESIDUAL) == 0)
		white = inspect_figure(&p->done, "residual.most");
	return white > 0 ? white : 0;
}

struct grid {
	uint32_t sides[3];
	uint32_t middle[3]; // the cell in the middle of the scene's bounds
	uint32_t levels; // above the voxels
};

static bool axis_of(const struct candil_done *done, int axis, double middle, struct grid *grid)
{
	char name[] = "grid.x", low_name[] = "low.x";
	name[5] = low_name[4] = "xyz"[axis];
	const double side = inspect_figure(done, name);
	const double cell = floor((middle - inspect_figure(done, low_name)) / inspect_figure(done, "voxel"));
	if (!(side >= 1 && side <= 65536))
		return false;
	grid->sides[axis] = (uint32_t)side;
	grid->middle[axis] = cell > 0 ? (uint32_t)fmin(cell, side - 1) : 0; // without bounds it is NaN, which is not above 0
	return true;
}

static bool find_grid(const struct candil_done *done, const struct candil_scene_info *s, struct grid *grid)
{
	const double levels = inspect_figure(done, "levels");
	grid->levels = levels >= 0 && levels <= 16 ? (uint32_t)levels : 0;
	return axis_of(done, 0, 0.5 * (s->bounds_min.x + s->bounds_max.x), grid) &&
	       axis_of(done, 1, 0.5 * (s->bounds_min.y + s->bounds_max.y), grid) &&
	       axis_of(done, 2, 0.5 * (s->bounds_min.z + s->bounds_max.z), grid);
}

static void add_slices(struct inspect_list *list, const char *show, const struct grid *grid,
		       const struct candil_render_request *request)
{
	for (uint32_t axis = 0; axis < 3; axis++) {
		const uint32_t wide = grid->sides[axis == 0 ? 2 : 0], high = grid->sides[axis == 1 ? 2 : 1];
		const uint32_t across = request->width / wide, down = request->height / high;
		const uint32_t fit = across < down ? across : down, side = fit > 0 ? fit : 1;
		struct inspect_picture *p = add_picture(list, "slice", show, request);
		if (!p)
			return;
		p->axis = axis;
		p->slice = grid->middle[axis];
		p->width = side * wide;
		p->height = side * high;
	}
}

bool inspect_others(struct inspect_list *list, const struct candil_render_request *request,
		    const struct candil_scene_info *scene)
{
	struct grid grid;
	if (!find_grid(&list->pictures[0].done, scene, &grid))
		return false;
	// Pictures of light come first, one after the other, because the daemon keeps the light between them.
	for (uint32_t level = 1; level <= grid.levels; level++) {
		struct inspect_picture *p = add_picture(list, "level", "radiance", request);
		if (p)
			p->level = level;
	}
	add_slices(list, "radiance", &grid, request);
	add_picture(list, "view", "albedo", request);
	add_picture(list, "view", "normal", request);
	add_picture(list, "view", "coverage", request);
	add_slices(list, "coverage", &grid, request);
	return true;
}

bool inspect_name(const struct inspect_picture *p, const char *prefix, const char *extension, char *name, size_t capacity)
{
	int length;
	if (strcmp(p->kind, INSPECT_PATCHES) == 0)
		length = snprintf(name, capacity, "%s-%s.%s", prefix, p->show, extension);
	else if (p->slice != INSPECT_NO_SLICE)
		length = snprintf(name, capacity, "%s-slice-%c-%s.%s", prefix, "xyz"[p->axis], p -> show, extension);
	else if (p->level > 0)
		length = snprintf(name, capacity, "%s-level-%u-%s.%s", prefix, p->level, p->show, extension);
	else
		length = snprintf(name, capacity, "%s-view-%s.%s", prefix, p->show, extension);
	return length > 0 && (size_t)length < capacity;
}
