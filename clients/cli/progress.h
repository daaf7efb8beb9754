// The progress bar on standard error. Where that is no terminal, and with --quiet, nothing is drawn.
#ifndef CANDIL_CLI_PROGRESS_H
#define CANDIL_CLI_PROGRESS_H

#include <stdbool.h>

#include "clients/libcandil/candil.h"

struct progress {
	bool shown; // whether to draw at all
	bool drawn; // a bar is on the screen
};

void progress_init(struct progress *progress, bool quiet);

// Draw a few words, the state of one render, or that of many images, in place of what is drawn.
void progress_say(struct progress *progress, const char *what);
void progress_draw(struct progress *progress, const struct candil_progress *at);
void progress_images(struct progress *progress, double fraction, uint32_t done, uint32_t images);

// Remove what is drawn.
void progress_clear(struct progress *progress);

#endif
