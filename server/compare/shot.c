#include "server/compare/shot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/compare/heat.h"
#include "server/compare/page/comparer.js.h"
#include "server/compare/page/style.css.h"
#include "server/worker/image/view.h"

// False colours in so many steps: fewer of them make smaller files, and none of it can be seen.
#define STEPS 40.0

static void heat_of(double position, uint8_t codes[3])
{
	heat_colour(floor(position * STEPS + 0.5) / STEPS, codes);
}

static void map_colour(float value, bool logarithmic, uint8_t codes[3])
{
	static const uint8_t left_out[3] = {0x77, 0x77, 0x77}, broken[3] = {0, 0xff, 0};
	if (value < 0)
		memcpy(codes, value == -1.0f ? left_out : broken, 3);
	else
		heat_of(logarithmic ? heat_position((double)value) : (double)value, codes);
}

enum status shot_make(const struct picture *a, const struct picture *reference, double exposure_ev, double mask_above,
		      float *error, struct shot *shot, struct error *err)
{
	const size_t pixels = (size_t)a->width * a->height;
	float *maps = malloc(2 * pixels * sizeof *maps);
	*shot = (struct shot){.width = a->width, .height = a->height};
	shot->picture = malloc(3 * pixels);
	shot->error = reference ? malloc(3 * pixels) : NULL;
	shot->flip = reference ? malloc(3 * pixels) : NULL;
	enum status s = STATUS_OK;
	if (!maps || !shot->picture || (reference && (!shot->error || !shot->flip)))
		s = error_set(err, STATUS_MEMORY, "no memory to draw a picture");
	if (s == STATUS_OK && reference)
		s = comparison_make(a, reference, mask_above, &shot->comparison, maps, maps + pixels, err);
	for (size_t i = 0; i < pixels && s == STATUS_OK; i++) {
		view_srgb8(CODEC_VIEW_NONE, a->is_display ? 0 : exposure_ev, a->rgb + 3 * i, shot->picture + 3 * i);
		if (!reference)
			continue;
		map_colour(maps[i], true, shot->error + 3 * i);
		map_colour(maps[pixels + i], false, shot->flip + 3 * i);
	}
	if (s == STATUS_OK && reference && error)
		memcpy(error, maps, pixels * sizeof *maps);
	free(maps);
	return s;
}

void shot_finish(struct shot *shot)
{
	free(shot->picture);
	free(shot->error);
	free(shot->flip);
	*shot = (struct shot){0};
}

enum status shot_rule(struct html *html, const char *name, unsigned number, const char *format, uint32_t width,
		      uint32_t height, const uint8_t *codes, struct error *err)
{
	uint8_t *bytes = NULL;
	size_t size = 0;
	const enum status s = picture_encode(format, width, height, codes, &bytes, &size, err);
	if (s != STATUS_OK)
		return s;
	html_put(html, ".%s%u{background-image:url(", name, number);
	html_data(html, strcmp(format, "png") == 0 ? "image/png" : "image/jpeg", bytes, size);
	html_raw(html, ")}\n");
	free(bytes);
	return STATUS_OK;
}

static enum status crop_rule(struct html *html, const char *name, unsigned number, const char *format,
			     const struct shot *shot, struct shot_crop crop, const uint8_t *codes, struct error *err)
{
	uint8_t *part = malloc(3 * (size_t)crop.width * crop.height);
	if (!part)
		return error_set(err, STATUS_MEMORY, "no memory for a part of a picture");
	for (uint32_t y = 0; y < crop.height; y++)
		memcpy(part + 3 * (size_t)y * crop.width, codes + 3 * ((size_t)(crop.y + y) * shot->width + crop.x),
		       3 * (size_t)crop.width);
	const enum status s = shot_rule(html, name, number, format, crop.width, crop.height, part, err);
	free(part);
	return s;
}

enum status shot_css(struct html *html, unsigned number, const struct shot *shot, struct shot_crop crop, struct error *err)
{
	enum status s = crop_rule(html, "p", number, "jpeg", shot, crop, shot->picture, err);
	if (s == STATUS_OK && shot->error)
		s = crop_rule(html, "e", number, "png", shot, crop, shot->error, err);
	if (s == STATUS_OK && shot->flip)
		s = crop_rule(html, "f", number, "png", shot, crop, shot->flip, err);
	return s;
}

void shot_figure(struct html *html, unsigned number, uint32_t width, uint32_t height, bool has_maps, const char *title,
		 const char *caption)
{
	html_put(html, "<figure class=\"shot\" data-shot=\"%u\" data-title=\"%s\" data-maps=\"%d\" style=\"--w:%u;--h:%u\">",
		 number, title, has_maps, width, height);
	html_put(html, "<div class=\"pic p%u\" role=\"img\" aria-label=\"%s\"></div>", number, title);
	if (has_maps) {
		html_put(html, "<div class=\"pic e%u\" role=\"img\" aria-label=\"relative error of %s\"></div>", number,
			 title);
		html_put(html, "<div class=\"pic f%u\" role=\"img\" aria-label=\"FLIP of %s\"></div>", number, title);
	}
	html_put(html, "<figcaption><b>%s</b> %s</figcaption></figure>\n", title, caption);
}

void shot_legend(struct html *html)
{
	uint8_t c[3];
	html_raw(html, "<p class=\"legend\"><span class=\"scale\" style=\"background:linear-gradient(90deg");
	for (int i = 0; i <= 12; i++) {
		heat_colour(i / 12.0, c);
		html_put(html, ",rgb(%d %d %d)", c[0], c[1], c[2]);
	}
	html_put(html,
		 ")\"></span> relative error of a pixel from %g (dark) to %g (pale), logarithmic; FLIP from 0 to 1</p>\n",
		 HEAT_LOW, HEAT_HIGH);
}

void shot_style(struct html *html)
{
	html_raw(html, page_style);
}

void shot_script(struct html *html)
{
	html_raw(html, page_comparer);
}
