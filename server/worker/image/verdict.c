#include "server/worker/image/verdict.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

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

static void judge_png(const struct verdict_file *file, double scale, const float rgb[3], uint64_t *black, uint64_t *clipped)
{
	const double most = brightest(rgb) * scale;
	if (!(most > 0)) {
		++*black;
	} else if (most <= PLAIN_LEAST) {
		uint8_t code[3];
		view_srgb8(file->view, file->exposure_ev, rgb, code);
		*black += !code[0] && !code[1] && !code[2];
	} else if (most >= PLAIN_MOST) {
		double shown[3];
		view_apply(file->view, file->exposure_ev, rgb, shown);
		*clipped += shown[0] >= 1 || shown[1] >= 1 || shown[2] >= 1;
	}
}

candil_Verdict verdict_of(const struct frame *f, const struct verdict_file *file)
{
	const uint64_t pixels = (uint64_t)f->width * f->height;
	const double scale = exp2(file->exposure_ev);
	const bool half = file->format == CODEC_EXR_HALF;
	const float dark = half ? HALF_BLACK : 0;
	uint64_t black = 0, clipped = 0;
	for (uint64_t i = 0; i < pixels; i++) {
		const float *rgb = &f->radiance[3 * i];
		if (file->format == CODEC_PNG) {
			judge_png(file, scale, rgb, &black, &clipped);
			continue;
		}
		black += fabsf(rgb[0]) <= dark && fabsf(rgb[1]) <= dark && fabsf(rgb[2]) <= dark;
		clipped += half && brightest(rgb) > HALF_MAX;
	}
	return (candil_Verdict){.black = (double)black / (double)pixels,
				.clipped = (double)clipped / (double)pixels,
				.missed = f->diagram ? 0 : (double)f->missed_pixels / (double)pixels};
}

// ---- the sentence -------------------------------------------------------------------------------------------------------

// The brightest channel that SHOWN_SHARE of the pixels do not exceed, to an eighth of an octave; 0 if it is next to nothing.
static double usual_most(const struct frame *f)
{
	uint64_t bins[BINS] = {0}, seen = 0;
	const uint64_t pixels = (uint64_t)f->width * f->height;
	for (uint64_t i = 0; i < pixels; i++) {
		const float most = fmaxf(brightest(&f->radiance[3 * i]), 0);
		uint32_t bits;
		memcpy(&bits, &most, sizeof bits);
		bins[bits >> 20]++;
	}
	for (uint32_t i = 0; i < BINS; i++) {
		seen += bins[i];
		if ((double)seen < SHOWN_SHARE * (double)pixels)
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

// The exposure that shows what the picture has, in tenths of a stop.
static double advised_ev(const struct frame *f, enum codec_view view)
{
	return floor(10 * log2(white_of(view) / usual_most(f))) / 10;
}

static void note_dark(const struct frame *f, const struct verdict_file *file, const struct verdict_about *about, char *text,
		      size_t capacity)
{
	const bool lit = about->lamps || about->background_lights;
	const double most = usual_most(f);
	if (!lit && about->off[0])
		snprintf(text, capacity, "all is black, because nothing gives light; switched off: %s", about->off);
	else if (!lit && about->background)
		snprintf(text, capacity,
			 "all surfaces are black: this technique takes no light from a background: add a light, or take pt");
	else if (!lit)
		snprintf(text, capacity,
			 "all is black, because nothing gives light: add a light or a background, or ask for default light");
	else if (file->format == CODEC_PNG && most > 0 && isfinite(most))
		snprintf(text, capacity, "too dark to be seen at this exposure: exposure %+.1f shows it",
			 advised_ev(f, file->view));
	else
		snprintf(text, capacity, "no light comes from what the camera sees: %s: look from another place",
			 about->outside ? "it stands outside of the scene and may see walls from behind"
					: "it may stand inside of a body, behind a wall or in a shadow");
}

void verdict_note(const struct frame *f, const struct verdict_file *file, const struct verdict_about *about,
		  const candil_Verdict *v, char *text, size_t capacity)
{
	const double sees = 1 - v->missed;
	// A ray that misses sees black, unless there is a background.
	const double dark = about->background ? v->black : v->black - v->missed;
	text[0] = '\0';
	if (f->diagram)
		return;
	if (!about->surfaces) {
		snprintf(text, capacity, "there is nothing to be seen: the scene has no surface");
	} else if (!(sees > 0)) {
		snprintf(
		    text, capacity,
		    "the camera looks at no surface: turn it to the scene, whose bounds candil describe tells, or move it");
	} else if (dark >= DARK_SHARE * sees) {
		note_dark(f, file, about, text, capacity);
	} else if (v->clipped >= CLIPPED_SHARE && file->format == CODEC_PNG) {
		const double ev = advised_ev(f, file->view);
		if (ev <= file->exposure_ev - ADVICE_LEAST_EV)
			snprintf(text, capacity, "%.0f %% of the pixels are brighter than white: exposure %+.1f shows them",
				 100 * v->clipped, ev);
	} else if (v->clipped >= CLIPPED_SHARE) {
		snprintf(text, capacity, "%.0f %% of the pixels exceed what 16 bits hold: take 32 bits", 100 * v->clipped);
	}
}
