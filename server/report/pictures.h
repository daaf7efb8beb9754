// The pictures of a report: of every view the reference and the points of its rows, each with its maps, and the bias of
// every technique's most accurate point. They are written as PNGs beside the EXR files that they show: NAME.png,
// NAME-error.png, NAME-flip.png, NAME-bias.png. On the page each is a part, the same of all of a view: that in which the
// techniques differ most. One thread.
#ifndef CANDIL_REPORT_PICTURES_H
#define CANDIL_REPORT_PICTURES_H

#include "server/compare/shot.h"
#include "server/report/judge.h"

#define PICTURES_SIDE 320u // of a part, pixels, at most
#define PICTURES_SIDE_LEAST 64u
#define PICTURES_BYTES (1700u * 1024u) // of all on the page; the parts are made smaller until they fit

struct picture_shown {
	const struct point *point; // NULL: the reference
	uint32_t view;
	struct shot shot; // of the part
};

struct pictures {
	struct picture_shown *shown; // number i has the rules .pi, .ei and .fi
	size_t count;
	uint32_t width, height; // of a part
	struct shot_crop *parts; // of each view
	struct html css;
	size_t left_out; // shots that found no room: then all of them
};

// Draw and write them. What cannot be drawn or written is noted by study_miss. STATUS_MEMORY alone fails.
enum status pictures_make(const struct figures *figures, const struct judgement *judgement, struct pictures *pictures,
			  struct error *err);
void pictures_finish(struct pictures *pictures); // a zeroed one is fine

// The number of the picture of a point, or of a view's reference where `point` is NULL. -1: it is not on the page.
int pictures_find(const struct pictures *pictures, uint32_t view, const struct point *point);

// The scale of the maps of bias, as a legend.
void pictures_bias_legend(struct html *html);

#endif
