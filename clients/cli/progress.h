// The bar on standard error, while it is a terminal; nothing otherwise.
#ifndef CANDIL_CLI_PROGRESS_H
#define CANDIL_CLI_PROGRESS_H

#include <stdbool.h>

#include "clients/libcandil/candil.h"

struct progress {
	bool shown; // whether to draw at all
	bool drawn;
};

void progress_init(struct progress *progress, bool quiet);
void progress_say(struct progress *progress, const char *what);
void progress_draw(struct progress *progress, const struct candil_progress *at);
// The same over many images.
void progress_images(struct progress *progress, double fraction, uint32_t done, uint32_t images);
void progress_clear(struct progress *progress);

#endif
