#include "server/report/pictures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/replace.h"

int pictures_find(const struct pictures *p, uint32_t view, const struct point *point)
{
	for (size_t i = 0; i < p->count; i++)
		if (p->shown[i].view == view && p->shown[i].point == point && p->shown[i].shot.picture)
			return (int)i;
	return -1;
}

// ---- which, and which part of them ----

static void show(struct pictures *p, uint32_t view, const struct point *point)
{
	for (size_t i = 0; i < p->count; i++)
		if (p->shown[i].view == view && p->shown[i].point == point)
			return;
	p->shown[p->count++] = (struct picture_shown){.point = point, .view = view};
}

static void choose(const struct figures *f, const struct judgement *j, struct pictures *p)
{
	for (uint32_t view = 0; view < j->view_count; view++) {
		if (!f->views[view].run)
			continue;
		show(p, view, NULL);
		for (size_t r = 0; r < j->views[view].row_count; r++)
			for (size_t t = 0; t < j->technique_count; t++)
				if (j->views[view].rows[r].points[t])
					show(p, view, j->views[view].rows[r].points[t]);
	}
}

// How much the shown pictures of a view differ from the reference in a tile.
static double difference_of(const struct figures *f, const struct pictures *p, uint32_t view, size_t tile)
{
	double sum = 0;
	for (size_t i = 0; i < p->count; i++) {
		const struct point *point = p->shown[i].point;
		const double reference = f->views[view].tiles[tile];
		if (p->shown[i].view == view && point)
			sum += fmin(1, fabs(point->tiles[tile] - reference) / (fabs(reference) + 0.1));
	}
	return sum;
}

// The part, of whole tiles, in which the sum of the differences is the largest.
static struct shot_crop find_part(const struct figures *f, const struct pictures *p, uint32_t view)
{
	const uint32_t across = p->width / f->tile ? p->width / f->tile : 1,
		       down = p->height / f->tile ? p->height / f->tile : 1;
	struct shot_crop part = {0, 0, p->width, p->height};
	double most = -1;
	for (uint32_t row = 0; row + down <= f->rows; row++)
		for (uint32_t column = 0; column + across <= f->columns; column++) {
			double sum = 0;
			for (uint32_t y = row; y < row + down; y++)
				for (uint32_t x = column; x < column + across; x++)
					sum += difference_of(f, p, view, (size_t)y * f->columns + x);
			if (sum > most) {
				most = sum;
				part.x = column * f->tile;
				part.y = row * f->tile;
			}
		}
	if (part.x + part.width > f->study->width)
		part.x = f->study->width - part.width;
	if (part.y + part.height > f->study->height)
		part.y = f->study->height - part.height;
	return part;
}

// ---- files ----

static void write_png(const struct figures *f, const struct study_run *run, const char *suffix, uint32_t width,
		      uint32_t height, const uint8_t *codes)
{
	struct error err;
	uint8_t *bytes = NULL;
	size_t size = 0;
	char *image = study_path(f->study, run->image, &err), *path = NULL;
	const char *dot = image ? strrchr(image, '.') : NULL, *slash = image ? strrchr(image, '/') : NULL;
	enum status s = STATUS_OK;
	if (!dot || dot < slash || strcmp(dot, ".png") == 0 ||
	    asprintf(&path, "%.*s%s.png", (int)(dot - image), image, suffix) < 0)
		s = error_set(&err, STATUS_IO, "an image without an ending of its own has no place for a PNG beside it");
	if (s == STATUS_OK)
		s = picture_encode("png", width, height, codes, &bytes, &size, &err);
	if (s == STATUS_OK)
		s = replace_file(path, 0666, bytes, size, &err);
	if (s != STATUS_OK)
		study_miss(f->study, run->id, "no PNG was written: %s", err.text);
	free(path);
	free(image);
	free(bytes);
}

static const struct study_run *run_of(const struct figures *f, const struct picture_shown *shown)
{
	return shown->point ? shown->point->shown : f->views[shown->view].run;
}

static enum status cut(uint8_t **codes, uint32_t width, struct shot_crop part, struct error *err)
{
	uint8_t *small = *codes ? malloc(3 * (size_t)part.width * part.height) : NULL;
	if (*codes && !small)
		return error_set(err, STATUS_MEMORY, "no memory for a part of a picture");
	for (uint32_t y = 0; small && y < part.height; y++)
		memcpy(small + 3 * (size_t)y * part.width, *codes + 3 * ((size_t)(part.y + y) * width + part.x),
		       3 * (size_t)part.width);
	free(*codes);
	*codes = small;
	return STATUS_OK;
}

// Draw one, write its files and keep the part.
static enum status draw(const struct figures *f, struct pictures *p, struct picture_shown *shown, struct error *err)
{
	const struct reference *reference = &f->views[shown->view];
	const struct study_run *run = run_of(f, shown);
	const struct shot_crop part = p->parts[shown->view];
	struct picture picture;
	struct shot *s = &shown->shot;
	if (figures_picture(f->study, run, &picture, err) != STATUS_OK ||
	    shot_make(&picture, shown->point ? &reference->picture : NULL, reference->exposure_ev, (double)INFINITY, NULL, s,
		      err) != STATUS_OK) {
		picture_finish(&picture);
		shot_finish(s);
		study_miss(f->study, run->id, "it is not shown: %s", err->text);
		return err->code == STATUS_MEMORY ? STATUS_MEMORY : STATUS_OK;
	}
	picture_finish(&picture);
	write_png(f, run, "", s->width, s->height, s->picture);
	if (s->error)
		write_png(f, run, "-error", s->width, s->height, s->error);
	if (s->flip)
		write_png(f, run, "-flip", s->width, s->height, s->flip);
	enum status status = cut(&s->picture, s->width, part, err);
	if (status == STATUS_OK)
		status = cut(&s->error, s->width, part, err);
	if (status == STATUS_OK)
		status = cut(&s->flip, s->width, part, err);
	s->width = part.width;
	s->height = part.height;
	return status;
}

// ---- bias ----

// Grey: not told from noise. Blue: darker than the reference, orange: brighter; pale from 1 %, full at 100 % of it.
static void bias_colour(bool biased, double difference, uint8_t codes[3])
{
	static const double ends[2][2][3] = {{{190, 212, 238}, {8, 60, 130}}, {{250, 216, 178}, {166, 62, 0}}};
	const double t = fmin(fmax(log10(fabs(difference) / 0.01) / 2, 0), 1);
	for (int c = 0; c < 3; c++) {
		const double *const pair[2] = {ends[difference > 0][0], ends[difference > 0][1]};
		codes[c] = (uint8_t)(biased ? pair[0][c] + t * (pair[1][c] - pair[0][c]) : 128);
	}
}

void pictures_bias_legend(struct html *html)
{
	uint8_t c[3];
	html_raw(html, "<p class=\"legend\"><span class=\"scale\" style=\"background:linear-gradient(90deg");
	for (int i = -4; i <= 4; i++) {
		bias_colour(i != 0, i < 0 ? -0.01 * pow(10, -(i + 1) / 1.5) : 0.01 * pow(10, (i - 1) / 1.5), c);
		html_put(html, ",rgb(%d %d %d)", c[0], c[1], c[2]);
	}
	html_raw(html, ")\"></span> blue: darker than the reference, by 100 % to 1 %; grey: not told from noise; orange: "
		       "brighter, by 1 % "
		       "to 100 %</p>\n");
}

static enum status draw_bias(const struct figures *f, const struct judgement *j, struct pictures *p, struct error *err)
{
	const size_t tiles = (size_t)f->columns * f->rows;
	uint8_t *codes = malloc(3 * tiles);
	enum status s = codes ? STATUS_OK : error_set(err, STATUS_MEMORY, "no memory for a map of bias");
	for (uint32_t view = 0; view < j->view_count && s == STATUS_OK; view++)
		for (size_t t = 0; t < j->technique_count && s == STATUS_OK; t++) {
			const struct point *best = judge_best(f, view, j->techniques[t].name);
			if (!best || best->bias.tiles == 0)
				continue;
			for (size_t i = 0; i < tiles; i++)
				bias_colour(best->bias.biased[i], (double)best->bias.difference[i], codes + 3 * i);
			if (best->shown)
				write_png(f, best->shown, "-bias", f->columns, f->rows, codes);
			s = shot_rule(&p->css, "b", (unsigned)(view * JUDGE_TECHNIQUES + t), "png", f->columns, f->rows,
				      codes, err);
		}
	free(codes);
	return s;
}

// ---- the page's share ----

// Write the rules of all parts, `side` pixels wide at most, from the middle of what was cut.
static enum status write_rules(struct pictures *p, uint32_t side, struct error *err)
{
	enum status s = STATUS_OK;
	const uint32_t width = p->width < side ? p->width : side, height = p->height < side ? p->height : side;
	const struct shot_crop middle = {(p->width - width) / 2, (p->height - height) / 2, width, height};
	for (size_t i = 0; i < p->count && s == STATUS_OK; i++)
		if (p->shown[i].shot.picture)
			s = shot_css(&p->css, (unsigned)i, &p->shown[i].shot, middle, err);
	if (s == STATUS_OK && html_size(&p->css) <= PICTURES_BYTES) {
		for (uint32_t view = 0; view < p->shown[p->count - 1].view + 1; view++)
			p->parts[view] =
			    (struct shot_crop){p->parts[view].x + middle.x, p->parts[view].y + middle.y, width, height};
		p->width = width;
		p->height = height;
	}
	return s;
}

static enum status fit(const struct figures *f, const struct judgement *j, struct pictures *p, struct error *err)
{
	enum status s = STATUS_OK;
	for (uint32_t side = PICTURES_SIDE; s == STATUS_OK; side = side * 4 / 5) {
		html_finish(&p->css);
		s = html_init(&p->css, err);
		if (s == STATUS_OK)
			s = draw_bias(f, j, p, err);
		if (s != STATUS_OK || p->count == 0)
			return s;
		if (side < PICTURES_SIDE_LEAST) {
			p->left_out = p->count;
			p->count = 0;
			study_miss(f->study, NULL, "%zu pictures find no room on the page; they are PNGs in the folder",
				   p->left_out);
			return s;
		}
		s = write_rules(p, side, err);
		if (s == STATUS_OK && html_size(&p->css) <= PICTURES_BYTES)
			return s;
	}
	return s;
}

enum status pictures_make(const struct figures *f, const struct judgement *j, struct pictures *p, struct error *err)
{
	const struct study *study = f->study;
	*p = (struct pictures){.width = study->width < PICTURES_SIDE ? study->width : PICTURES_SIDE,
			       .height = study->height < PICTURES_SIDE ? study->height : PICTURES_SIDE};
	p->shown = calloc((size_t)study->views * (1 + 2 * JUDGE_TARGETS * JUDGE_TECHNIQUES), sizeof *p->shown);
	p->parts = calloc(study->views, sizeof *p->parts);
	if (!p->shown || !p->parts)
		return error_set(err, STATUS_MEMORY, "no memory for the pictures");
	choose(f, j, p);
	for (uint32_t view = 0; view < study->views; view++)
		if (f->views[view].run)
			p->parts[view] = find_part(f, p, view);
	enum status s = STATUS_OK;
	for (size_t i = 0; i < p->count && s == STATUS_OK; i++)
		s = draw(f, p, &p->shown[i], err);
	return s == STATUS_OK ? fit(f, j, p, err) : s;
}

void pictures_finish(struct pictures *p)
{
	for (size_t i = 0; p->shown && i < p->count + p->left_out; i++)
		shot_finish(&p->shown[i].shot);
	free(p->shown);
	free(p->parts);
	html_finish(&p->css);
	*p = (struct pictures){0};
}
