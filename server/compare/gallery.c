#include "server/compare/gallery.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/compare/page/compare.html.h"
#include "server/compare/shot.h"

#define REFERENCE 1

struct gallery {
	char *const *files;
	int count;
	struct shot *shots;
	double exposure_ev;
	struct error *err;
	enum status status;
};

// The exposure that shows the mean of a picture of radiance at a middle grey.
static double exposure_of(const struct picture *p)
{
	double sum = 0;
	const size_t values = 3 * (size_t)p->width * p->height;
	for (size_t i = 0; i < values; i++)
		sum += isfinite(p->rgb[i]) ? fmax(0, (double)p->rgb[i]) : 0;
	return sum > 0 ? fmin(fmax(log2(0.2 * (double)values / sum), -LIMIT_EXPOSURE_EV), LIMIT_EXPOSURE_EV) : 0;
}

// A file's name without its folders, unless another of the page has the same.
static const char *name_of(const struct gallery *g, int i)
{
	const char *slash = strrchr(g->files[i], '/'), *name = slash ? slash + 1 : g->files[i];
	for (int k = 0; k < g->count; k++) {
		const char *other = strrchr(g->files[k], '/');
		if (k != i && strcmp(other ? other + 1 : g->files[k], name) == 0)
			return g->files[i];
	}
	return name;
}

static void write_title(struct html *html, const void *context)
{
	const struct gallery *g = context;
	for (int i = 0; i < g->count; i++)
		if (i != REFERENCE)
			html_put(html, "%s%s", i == 0 ? "" : ", ", name_of(g, i));
	html_put(html, " beside %s", name_of(g, REFERENCE));
}

static void write_style(struct html *html, const void *context)
{
	struct gallery *g = (struct gallery *)context;
	shot_style(html);
	for (int i = 0; i < g->count && g->status == STATUS_OK; i++) {
		const struct shot *s = &g->shots[i];
		g->status = shot_css(html, (unsigned)i, s, (struct shot_crop){0, 0, s->width, s->height}, g->err);
	}
}

static void write_table(struct html *html, const void *context)
{
	const struct gallery *g = context;
	html_put(html,
		 "<div class=\"wide\"><table><caption>Beside %s</caption><thead><tr><th>picture<th>RMSE<th>relMSE<th>mean "
		 "difference"
		 "<th>largest<th>FLIP<th>FLIP, largest<th>pixels<th>left out</tr></thead><tbody>\n",
		 g->files[REFERENCE]);
	for (int i = 0; i < g->count; i++) {
		const struct metrics *m = &g->shots[i].comparison.metrics;
		const struct flip *f = &g->shots[i].comparison.flip;
		if (i != REFERENCE)
			html_put(html, "<tr><td>%s<td>%.4g<td>%.4g<td>%+.4g<td>%.4g<td>%.4g<td>%.4g<td>%zu<td>%zu</tr>\n",
				 g->files[i], m->rmse, m->relmse, m->mean_difference, m->max_abs, f->mean, f->max,
				 (size_t)m->pixels, (size_t)m->width * m->height - (size_t)m->pixels);
	}
	html_raw(html, "</tbody></table></div>\n");
}

static void write_shots(struct html *html, const void *context)
{
	const struct gallery *g = context;
	char caption[64];
	for (int i = 0; i < g->count; i++) {
		const struct shot *s = &g->shots[i];
		snprintf(caption, sizeof caption, "relMSE %.3g, FLIP %.3g", s->comparison.metrics.relmse,
			 s->comparison.flip.mean);
		shot_figure(html, (unsigned)i, s->width, s->height, i != REFERENCE, name_of(g, i),
			    i == REFERENCE ? "the reference" : caption);
	}
}

static void write_legend(struct html *html, const void *context)
{
	const struct gallery *g = context;
	shot_legend(html);
	html_put(html,
		 "<p class=\"legend\">Radiance is shown at %+.1f EV, which makes the reference's mean a middle grey, and "
		 "clipped.</p>\n",
		 g->exposure_ev);
}

static void write_script(struct html *html, const void *context)
{
	(void)context;
	shot_script(html);
}

// Average the codes of a shot down, so that it fits the page.
static void shrink(struct shot *s)
{
	uint8_t *const maps[3] = {s->picture, s->error, s->flip};
	const uint32_t longer = s->width > s->height ? s->width : s->height;
	const uint32_t by = (longer + GALLERY_SIDE - 1) / GALLERY_SIDE;
	const uint32_t width = s->width / by ? s->width / by : 1, height = s->height / by ? s->height / by : 1;
	if (by == 1)
		return;
	for (int k = 0; k < 3 && maps[k]; k++)
		for (uint32_t y = 0; y < height; y++)
			for (uint32_t x = 0; x < width; x++)
				for (uint32_t c = 0; c < 3; c++) {
					uint32_t sum = 0, count = 0;
					for (uint32_t j = y * by; j < (y + 1) * by && j < s->height; j++)
						for (uint32_t i = x * by; i < (x + 1) * by && i < s->width; i++, count++)
							sum += maps[k][3 * ((size_t)j * s->width + i) + c];
					maps[k][3 * ((size_t)y * width + x) + c] = (uint8_t)((sum + count / 2) / count);
				}
	s->width = width;
	s->height = height;
}

static enum status make_shots(struct gallery *g, double mask_above, struct error *err)
{
	struct picture reference = {0};
	enum status s = picture_read(g->files[REFERENCE], &reference, err);
	g->exposure_ev = s == STATUS_OK ? exposure_of(&reference) : 0;
	for (int i = 0; i < g->count && s == STATUS_OK; i++) {
		struct picture a = {0}, r = {0};
		s = picture_read(g->files[i], &a, err);
		// metrics_fit may scale the reference down, so that each picture has one of its own.
		if (s == STATUS_OK && i != REFERENCE)
			s = picture_read(g->files[REFERENCE], &r, err);
		if (s == STATUS_OK && i != REFERENCE)
			s = metrics_fit(&a, &r, err);
		if (s == STATUS_OK)
			s = shot_make(&a, i == REFERENCE ? NULL : &r, g->exposure_ev, mask_above, NULL, &g->shots[i], err);
		if (s == STATUS_OK)
			shrink(&g->shots[i]);
		picture_finish(&a);
		picture_finish(&r);
	}
	picture_finish(&reference);
	return s;
}

enum status gallery_write(const char *path, char *const *files, int count, double mask_above, struct error *err)
{
	static const struct html_slot slots[] = {
	    {"title", write_title},   {"style", write_style},   {"table", write_table}, {"shots", write_shots},
	    {"legend", write_legend}, {"script", write_script}, {NULL, NULL},
	};
	struct html html = {0};
	struct gallery g = {.files = files, .count = count, .err = err};
	g.shots = calloc((size_t)count, sizeof *g.shots);
	enum status s = g.shots ? STATUS_OK : error_set(err, STATUS_MEMORY, "no memory for a page");
	if (s == STATUS_OK)
		s = make_shots(&g, mask_above, err);
	if (s == STATUS_OK)
		s = html_init(&html, err);
	if (s == STATUS_OK) {
		html_template(&html, page_compare, slots, &g);
		s = g.status;
	}
	if (s == STATUS_OK)
		s = html_save(&html, path, err);
	html_finish(&html);
	for (int i = 0; g.shots && i < count; i++)
		shot_finish(&g.shots[i]);
	free(g.shots);
	return s;
}
