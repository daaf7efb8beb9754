// What `candil inspect` shows of a scene's voxels: the list of its pictures.
#ifndef CANDIL_CLI_INSPECT_PICTURES_H
#define CANDIL_CLI_INSPECT_PICTURES_H

#include "clients/cli/cli.h"

#define INSPECT_PICTURES_MAX 32u
#define INSPECT_NO_SLICE UINT32_MAX

struct inspect_picture {
	const char *kind; // "view", "slice" or "level"
	const char *show; // value of the option "show"
	uint32_t level;
	uint32_t axis; // of a slice: 0 x, 1 y, 2 z
	uint32_t slice; // its cell; INSPECT_NO_SLICE: the camera's view
	uint32_t width, height; // pixels
	uint64_t bytes; // of the image
	struct candil_done done;
};

struct inspect_list {
	struct inspect_picture pictures[INSPECT_PICTURES_MAX];
	uint32_t count;
};

// The first picture of the list, the view of the radiance, whose figures say what else there is.
void inspect_first(struct inspect_list *list, const struct candil_render_request *request);

// All others, once the first is done: slices through the middle of the scene's bounds, one cell a whole number of pixels and
// no more pixels than the request has, unless the grid has more cells. false: the figures tell of no grid.
bool inspect_others(struct inspect_list *list, const struct candil_render_request *request,
		    const struct candil_scene_info *scene);

// A figure by its name; NaN if it was not told.
double inspect_figure(const struct candil_done *done, const char *name);

// "PREFIX-slice-x-radiance.png". false: it does not fit.
bool inspect_name(const struct inspect_picture *picture, const char *prefix, const char *extension, char *name,
		  size_t capacity);

#endif
