// The verdict on a picture: shares of its pixels that are black, clipped or missed, as candil.proto defines them; and where
// that is likely a mistake, a sentence that says what to do. Pure functions, any thread; none fails.
#ifndef CANDIL_WORKER_VERDICT_H
#define CANDIL_WORKER_VERDICT_H

#include <stdbool.h>
#include <stddef.h>

#include "candil.pb.h"
#include "server/worker/image/codec.h"

// What a picture was made of, as far as a sentence about it must know.
struct verdict_about {
	bool surfaces; // the scene has some
	bool lamps; // some surface or light shines, and is simulated
	bool background; // what rays meet that leave the scene is not black
	bool background_lights; // and surfaces take light from it
	char lit_by_background[64]; // the techniques whose surfaces do, as a list in a sentence
	char off[64]; // kinds of light that the request switches off, as a list in a sentence; "": none
	bool outside; // the camera is outside of the scene's bounds
};

// How a frame becomes a file, as codec_encode takes it.
struct verdict_file {
	enum codec_format format;
	enum codec_view view;
	double exposure_ev;
};

// The shares of a frame, each counted, none estimated; and the sentence about it in `text`, "" where nothing looks like a
// mistake.
candil_Verdict verdict_of(const struct frame *frame, const struct verdict_file *file, const struct verdict_about *about,
			  char *text, size_t capacity);

#endif
