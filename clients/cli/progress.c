#include "clients/cli/progress.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "clients/cli/cli.h"

#define BAR 30

void progress_init(struct progress *progress, bool quiet)
{
	progress->shown = !quiet && isatty(STDERR_FILENO) == 1;
	progress->drawn = false;
}

void progress_say(struct progress *progress, const char *what)
{
	if (!progress->shown)
		return;
	fprintf(stderr, "\r\033[K%s", what);
	fflush(stderr);
	progress->drawn = true;
}

static void make_bar(char bar[BAR + 1], double fraction)
{
	int filled = fraction > 0.0 ? (int)(fraction * BAR) : 0;
	memset(bar, '.', BAR);
	memset(bar, '#', (size_t)(filled < BAR ? filled : BAR));
	bar[BAR] = '\0';
}

void progress_images(struct progress *progress, double fraction, uint32_t done, uint32_t images)
{
	char line[160], bar[BAR + 1];
	make_bar(bar, fraction);
	snprintf(line, sizeof(line), "[%s] %3.0f %%  %" PRIu32 "/%" PRIu32 " images", bar, fraction * 100.0, done, images);
	progress_say(progress, line);
}

void progress_draw(struct progress *progress, const struct candil_progress *at)
{
	char line[200], bar[BAR + 1], error[48] = "";
	make_bar(bar, at->fraction);
	if (at->estimated_relmse > 0 && at->relmse_high >= 0)
		snprintf(error, sizeof(error), "  error %.1e (to %.1e)", at->estimated_relmse, at->relmse_high);
	else if (at->estimated_relmse > 0)
		snprintf(error, sizeof(error), "  error %.1e or more", at->estimated_relmse);
	const double seconds = (double)at->elapsed_us * 1e-6;
	if (at->samples_done == 0 && strcmp(at->stage, "render") != 0 && at->stage[0]) {
		snprintf(line, sizeof(line), "[%s] %s  %.1f s", bar, at->stage, seconds);
		progress_say(progress, line);
		return;
	}
	snprintf(line, sizeof(line), "[%s] %3.0f %%  %" PRIu32 "/%" PRIu32 " sample%s%s  %.1f s", bar, at->fraction * 100.0,
		 at->samples_done, at->samples, cli_s(at->samples), error, seconds);
	progress_say(progress, line);
}

void progress_clear(struct progress *progress)
{
	if (progress->drawn)
		fputs("\r\033[K", stderr);
	progress->drawn = false;
}
