// The list of the pictures that `candil inspect` makes of a scene's voxels or patches.
#ifndef CANDIL_CLI_INSPECT_PICTURES_H
#define CANDIL_CLI_INSPECT_PICTURES_H

#include "clients/cli/cli.h"

#define INSPECT_PICTURES_MAX 32u
#define INSPECT_NO_SLICE UINT32_MAX
#define INSPECT_PATCHES "patches" // kind of the pictures of patches
#define INSPECT_SHOW_ROW "row" // what the picture of one row of form factors shows
#define INSPECT_SHOW_RESIDUAL "residual" // what a solver left over, which form factors tell

struct inspect_picture {
	const char *kind; // "view", "slice" or "level"; of patches "patches"
	const char *show; // value of the option "show"
	uint32_t level;
	uint32_t axis; // of a slice: 0 x, 1 y, 2 z
	uint32_t slice; // its cell; INSPECT_NO_SLICE: the camera's view
	uint32_t width, height; // pixels
	uint64_t bytes; // of the image
	double white; // of light of patches in a PNG, W/m²: what is shown as 1; 0: values are as they are
	struct candil_done done;
};

struct inspect_list {
	struct inspect_picture pictures[INSPECT_PICTURES_MAX];
	uint32_t count;
};

// Begin the list. Of patches these are all pictures, and no light is in the first. Of voxels it is the first one, the view
// of the radiance, and the figures of its answer say what else there is.
void inspect_first(struct inspect_list *list, bool patches, const struct candil_render_request *request);

// Leave out the pictures of patches that are of form factors. Call it before any but the first is made.
void inspect_leave_out_factors(struct inspect_list *list);

// Add all others of voxels, once the first is done. A cell of a slice is a whole number of pixels, and a slice has no more
// pixels than the request asks for, unless the grid has more cells. false: the figures tell of no grid.
bool inspect_others(struct inspect_list *list, const struct candil_render_request *request,
		    const struct candil_scene_info *scene);

// Of a picture of patches' light, the value that is to be white, as far as the figures of the first picture, which is
// another, or its own tell: the largest, but that lamps in a picture of B are lighter. 0: they do not, or it shows no light.
double inspect_white(const struct inspect_list *list, const struct inspect_picture *picture);

// The value of the figure with this name; NaN: there is none.
double inspect_figure(const struct candil_done *done, const char *name);

// Write the name of a picture's file, for example "PREFIX-slice-x-radiance.png", "PREFIX-albedo.png". false: it does not
// fit.
bool inspect_name(const struct inspect_picture *picture, const char *prefix, const char *extension, char *name,
		  size_t capacity);

#endif
