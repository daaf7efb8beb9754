// Pictures of a page, and the comparer that slides and flips between them: what `candil compare --html` writes, and the
// report of a study has for each of its rows. A shot is a picture as it is shown, and what each pixel has of error and FLIP
// beside a reference, in false colours. One thread.
//
// On the page a shot is rules of CSS, .pN the picture, .eN the error, .fN FLIP, so that it is there once and shown anywhere,
// also without scripts. A strip lists shots; page/comparer.js puts the comparer before it.
#ifndef CANDIL_COMPARE_SHOT_H
#define CANDIL_COMPARE_SHOT_H

#include "server/compare/comparison.h"
#include "server/compare/html.h"

struct shot {
	uint32_t width, height;
	uint8_t *picture, *error, *flip; // sRGB codes; the latter two NULL for the reference itself
	struct comparison comparison; // beside the reference
};

// A part of a shot, in pixels.
struct shot_crop {
	uint32_t x, y, width, height;
};

// Make the shot of `a`. Radiance is shown times 2^exposure_ev and clipped, what a display shows as it is. `reference` NULL:
// it is the reference. `error`, unless it is NULL, receives metrics_compare's map. Failures are those of comparison_make.
enum status shot_make(const struct picture *a, const struct picture *reference, double exposure_ev, double mask_above,
		      float *error, struct shot *shot, struct error *err);
void shot_finish(struct shot *shot); // a zeroed one is fine

// Write the rules of shot number `number`, of which `crop` is shown. STATUS_MEMORY, STATUS_ENCODE.
enum status shot_css(struct html *html, unsigned number, const struct shot *shot, struct shot_crop crop, struct error *err);

// A rule of its own: a picture behind everything of class `name`.
enum status shot_rule(struct html *html, const char *name, unsigned number, const char *format, uint32_t width,
		      uint32_t height, const uint8_t *codes, struct error *err);

// The figure of a shot in a strip: `title` in bold, `caption` below it. `has_maps`: it has rules .eN and .fN too.
void shot_figure(struct html *html, unsigned number, uint32_t width, uint32_t height, bool has_maps, const char *title,
		 const char *caption);

// The scale of the maps, as a legend.
void shot_legend(struct html *html);

// Style and script of strips and comparers, for a page's own style and script elements.
void shot_style(struct html *html);
void shot_script(struct html *html);

#endif
