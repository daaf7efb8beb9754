#include "server/worker/image/verdict.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "protocol/limits.h"
#include "server/worker/image/view.h"

#define HALF_MAX 65504.0f // the largest half; the codec clips there
#define HALF_BLACK 0x1p-25f // what is at most this becomes 0 as a half: half of the smallest one, and a tie goes to even

// No view makes less than code 1 or as much as 1 of what is between these, after the exposure.
#define PLAIN_LEAST 0.01
#define PLAIN_MOST 0.9

#define DARK_SHARE 0.98 // of the pixels that see a surface: from this on the picture looks like a mistake
#define CLIPPED_SHARE 0.5 // of all pixels: likewise
#define SHOWN_SHARE 0.95 // of the pixels: so many does the exposure show that is advised
#define ADVICE_LEAST_EV 0.5 // a smaller change of the exposure is no advice
#define OCTAVE_BINS 8u // of the histogram, from the first three bits of the mantissa
#define BINS (256u * OCTAVE_BINS)

static float brightest(const float rgb[3])
{
	const float most = rgb[0] > rgb[1] ? rgb[0] : rgb[1];
	return most > rgb[2] ? most : rgb[2];
}

// How many pixels the file shows as black, how many clipped, and how many met a surface.
struct counts {
	uint64_t pixels, black, clipped, met, met_black;
};

struct look {
	bool black, clipped;
};

static struct look look_png(const struct verdict_file *file, double scale, const float rgb[3])
{
	const double most = brightest(rgb) * scale;
	if (!(most > 0))
		return (struct look){.black = true};
	if (most <= PLAIN_LEAST) {
		uint8_t code[3];
		view_srgb8(file->view, file->exposure_ev, rgb, code);
		return (struct look){.black = !code[0] && !code[1] && !code[2]};
	}
	if (most < PLAIN_MOST)
		return (struct look){0};
	double shown[3];
	view_apply(file->view, file->exposure_ev, rgb, shown);
	return (struct look){.clipped = shown[0] >= 1 || shown[1] >= 1 || shown[2] >= 1};
}

static struct look look_exr(const struct verdict_file *file, const float rgb[3])
{
	const bool half = file->format == CODEC_EXR_HALF;
	const float dark = half ? HALF_BLACK : 0;
	return (struct look){.black = fabsf(rgb[0]) <= dark && fabsf(rgb[1]) <= dark && fabsf(rgb[2]) <= dark,
			     .clipped = half && brightest(rgb) > HALF_MAX};
}

static struct counts count(const struct frame *f, const struct verdict_file *file)
{
	struct counts c = {.pixels = (uint64_t)f->width * f->height};
	const double scale = exp2(file->exposure_ev);
	for (uint64_t i = 0; i < c.pixels; i++) {
		const float *rgb = &f->radiance[3 * i];
		const struct look look = file->format == CODEC_PNG ? look_png(file, scale, rgb) : look_exr(file, rgb);
		c.black += look.black;
		c.clipped += look.clipped;
		c.met += f->met[i];
		c.met_black += f->met[i] && look.black;
	}
	return c;
}

// ---- the sentence -------------------------------------------------------------------------------------------------------

// The brightest channel that SHOWN_SHARE of the pixels do not exceed, to an eighth of an octave; 0 if it is next to nothing.
// `met`: of those that see a surface alone.
static double usual_most(const struct frame *f, bool met)
{
	uint64_t bins[BINS] = {0}, all = 0, seen = 0;
	const uint64_t pixels = (uint64_t)f->width * f->height;
	for (uint64_t i = 0; i < pixels; i++) {
		if (met && !f->met[i])
			continue;
		const float most = fmaxf(brightest(&f->radiance[3 * i]), 0);
		uint32_t bits;
		memcpy(&bits, &most, sizeof bits);
		bins[bits >> 20]++;
		all++;
	}
	for (uint32_t i = 0; i < BINS; i++) {
		seen += bins[i];
		if ((double)seen < SHOWN_SHARE * (double)all)
			continue;
		const uint32_t bits = (i + 1) << 20;
		float above;
		memcpy(&above, &bits, sizeof above);
		return i > 0 ? (double)above : 0;
	}
	return 0;
}

// The radiance that a view shows as 1, at exposure 0, of a grey.
static double white_of(enum codec_view view)
{
	return view == CODEC_VIEW_FILMIC ? 5.6 : 1;
}

// The exposure that shows a radiance as white, in tenths of a stop. A request may be unable to ask for it.
static double advised_ev(double most, enum codec_view view)
{
	return floor(10 * log2(white_of(view) / most)) / 10;
}

// There is light, and next to none of it comes from the surfaces that the camera sees.
static void note_dark_surfaces(const struct frame *f, const struct verdict_file *file, const struct verdict_about *about,
			       const struct counts *c, char *text, size_t capacity)
{
	const double most = usual_most(f, true);
	if (most > 0 && file->format == CODEC_PNG && advised_ev(most, file->view) > LIMIT_EXPOSURE_EV)
		snprintf(text, capacity, "too dark for every exposure: make the light stronger");
	else if (most > 0 && file->format == CODEC_PNG)
		snprintf(text, capacity, "too dark to be seen at this exposure: exposure %+.1f shows it",
			 advised_ev(most, file->view));
	else if (most > 0)
		snprintf(text, capacity, "too dark for 16 bits: take 32 bits");
	// Before a background that is seen, black surfaces are a silhouette.
	else if (about->background && c->black - c->met_black < c->pixels - c->met)
		return;
	else
		snprintf(
		    text, capacity,
		    "no light comes from what the camera sees: %s: look from another place; lamps shine from their front",
		    about->outside
			? "it stands outside of the scene and may see walls from behind, or what reflects none"
			: "it may stand inside of a body, behind a wall or in a shadow, or see what reflects none");
}

static void note_dark(const struct frame *f, const struct verdict_file *file, const struct verdict_about *about,
		      const struct counts *c, char *text, size_t capacity)
{
	if (about->lamps || about->background_lights)
		note_dark_surfaces(f, file, about, c, text, capacity);
	else if (about->off[0])
		snprintf(text, capacity, "all is black, because nothing gives light; switched off: %s", about->off);
	else if (about->background)
		snprintf(text, capacity,
			 "all surfaces are black: this technique takes no light from a background: add a light, or take %s",
			 about->lit_by_background);
	else
		snprintf(text, capacity,
			 "all is black, because nothing gives light: add a light or a background, or ask for default light");
}

static void note(const struct frame *f, const struct verdict_file *file, const struct verdict_about *about,
		 const struct counts *c, char *text, size_t capacity)
{
	const double clipped = (double)c->clipped / (double)c->pixels;
	if (!about->surfaces) {
		snprintf(text, capacity, "there is nothing to be seen: the scene has no surface");
	} else if (c->met == 0) {
		snprintf(
		    text, capacity,
		    "the camera looks at no surface: turn it to the scene, whose bounds candil describe tells, or move it");
	} else if ((double)c->met_black >= DARK_SHARE * (double)c->met) {
		note_dark(f, file, about, c, text, capacity);
	} else if (clipped >= CLIPPED_SHARE && file->format == CODEC_PNG) {
		const double ev = advised_ev(usual_most(f, false), file->view);
		if (ev <= file->exposure_ev - ADVICE_LEAST_EV && ev >= -LIMIT_EXPOSURE_EV)
			snprintf(text, capacity, "%.0f %% of the pixels are brighter than white: exposure %+.1f shows them",
				 100 * clipped, ev);
	} else if (clipped >= CLIPPED_SHARE) {
		snprintf(text, capacity, "%.0f %% of the pixels exceed what 16 bits hold: take 32 bits", 100 * clipped);
	}
}

candil_Verdict verdict_of(const struct frame *f, const struct verdict_file *file, const struct verdict_about *about,
			  char *text, size_t capacity)
{
	const struct counts c = count(f, file);
	const double pixels = (double)c.pixels;
	text[0] = '\0';
	if (!f->diagram)
		note(f, file, about, &c, text, capacity);
	return (candil_Verdict){.black = (double)c.black / pixels,
				.clipped = (double)c.clipped / pixels,
				.missed = f->diagram ? 0 : (double)(c.pixels - c.met) / pixels};
}
