#include "server/loader/mtl_notes.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

// Statements that are ignored, with a note, if present.
static const char *const left_out[] = {
    "map_Ns", "map_d", "disp", "decal", "refl", "map_Ka", "Ps", "map_Pr", "map_Pm", "map_Ps", "aniso", "anisor",
};

// A line: its keyword and up to three numbers after it.
struct line {
	char keyword[16];
	const char *rest;
	size_t rest_bytes;
	double numbers[3];
	int number_count;
};

static bool is_blank(char c)
{
	return c == ' ' || c == '\t' || c == '\r';
}

static void read_numbers(struct line *line)
{
	char text[96];
	const size_t bytes = line->rest_bytes < sizeof text - 1 ? line->rest_bytes : sizeof text - 1;
	memcpy(text, line->rest, bytes);
	text[bytes] = 0;
	char *at = text;
	for (line->number_count = 0; line->number_count < 3; line->number_count++) {
		char *end;
		line->numbers[line->number_count] = strtod(at, &end);
		if (end == at)
			return;
		at = end;
	}
}

static struct line split_line(const char *text, size_t bytes)
{
	struct line line = {0};
	size_t at = 0, used = 0;
	while (at < bytes && is_blank(text[at]))
		at++;
	while (at < bytes && !is_blank(text[at])) {
		if (used + 1 < sizeof line.keyword)
			line.keyword[used++] = text[at];
		at++;
	}
	while (at < bytes && is_blank(text[at]))
		at++;
	while (bytes > at && is_blank(text[bytes - 1]))
		bytes--;
	line.rest = text + at;
	line.rest_bytes = bytes - at;
	read_numbers(&line);
	return line;
}

static enum status note_add(struct mtl_notes *notes, const struct line *line, struct error *err)
{
	if (notes->count >= LIMIT_MATERIALS)
		return error_set(err, STATUS_SCENE_LIMIT, "the MTL files define more than %u materials", LIMIT_MATERIALS);
	if (notes->count == notes->room) {
		const size_t room = notes->room * 2 + 16;
		struct mtl_note *bigger = realloc(notes->notes, room * sizeof *bigger);
		if (!bigger)
			return error_set(err, STATUS_MEMORY, "no memory for %zu materials", room);
		notes->notes = bigger;
		notes->room = room;
	}
	char *name = strndup(line->rest, line->rest_bytes);
	if (!name)
		return error_set(err, STATUS_MEMORY, "no memory for a material's name");
	notes->notes[notes->count++] = (struct mtl_note){.name = name, .illum = -1, .bump = 1, .dissolve = 1};
	return STATUS_OK;
}

static bool is_bump(const char *keyword)
{
	return strcasecmp(keyword, "map_bump") == 0 || strcasecmp(keyword, "bump") == 0 || strcasecmp(keyword, "norm") == 0;
}

static bool is_map(const char *keyword)
{
	return strcasecmp(keyword, "map_Kd") == 0 || strcasecmp(keyword, "map_Ke") == 0 ||
	       strcasecmp(keyword, "map_Ks") == 0 || is_bump(keyword);
}

// Whether a map has one of the options -o, -s and -t, which move, scale and rotate it.
static bool has_map_option(const struct line *line)
{
	for (size_t i = 0; i + 2 < line->rest_bytes; i++)
		if (line->rest[i] == '-' && (i == 0 || is_blank(line->rest[i - 1])) && is_blank(line->rest[i + 2]) &&
		    strchr("ost", line->rest[i + 1]))
			return true;
	return false;
}

static void note_ignored(struct import *import, const struct line *line)
{
	const char *k = line->keyword;
	if (is_map(k) && has_map_option(line))
		import_ignore(import, "map options -o -s -t");
	for (size_t i = 0; i < sizeof left_out / sizeof left_out[0]; i++)
		if (strcasecmp(k, left_out[i]) == 0)
			import_ignore(import, left_out[i]);
}

// The number after -bm.
static double bump_multiplier(const struct line *line)
{
	for (size_t i = 0; i + 4 < line->rest_bytes; i++)
		if ((i == 0 || is_blank(line->rest[i - 1])) && strncmp(line->rest + i, "-bm", 3) == 0 &&
		    is_blank(line->rest[i + 3])) {
			const struct line number = {.rest = line->rest + i + 4, .rest_bytes = line->rest_bytes - i - 4};
			struct line read = number;
			read_numbers(&read);
			if (read.number_count > 0)
				return read.numbers[0];
		}
	return 1.0;
}

// Read three numbers, or one that stands for all three.
static void note_colour(const struct line *line, double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = line->number_count == 0 ? 0 : line->numbers[line->number_count == 3 ? i : 0];
}

// Ni, d, Tr and Tf. Many exporters write Tr 1 for opaque surfaces, so Tr 1 alone means nothing.
static void note_clearness(struct mtl_note *note, const struct line *line)
{
	const char *k = line->keyword;
	if (line->number_count == 0)
		return;
	if (strcasecmp(k, "Ni") == 0) {
		note->ior = line->numbers[0];
	} else if (strcmp(k, "d") == 0) {
		note->dissolve = line->numbers[0];
		note->has_dissolve = true;
	} else if (strcasecmp(k, "Tr") == 0 && !note->has_dissolve && line->numbers[0] < 1) {
		note->dissolve = 1 - line->numbers[0];
	} else if (strcasecmp(k, "Tf") == 0) {
		note->has_filter = true;
		note_colour(line, note->filter);
	}
}

// The statements of physically based exporters. False for any other keyword.
static bool note_physical(struct mtl_note *note, const struct line *line)
{
	const struct {
		const char *keyword;
		double *value;
		bool *has;
	} keys[] = {{"Pr", &note->roughness, &note->has_roughness},
		    {"Pm", &note->metallic, &note->has_metallic},
		    {"Pc", &note->coat, NULL},
		    {"Pcr", &note->coat_roughness, NULL},
		    {"Pdr", &note->diffuse_roughness, NULL},
		    {"Pp", &note->priority, NULL}};
	for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
		if (strcasecmp(line->keyword, keys[i].keyword) == 0) {
			*keys[i].value = line->number_count > 0 ? line->numbers[0] : 0;
			if (keys[i].has)
				*keys[i].has = line->number_count > 0;
			return true;
		}
	return false;
}

static void note_property(struct mtl_note *note, const struct line *line)
{
	const char *k = line->keyword;
	if (strcasecmp(k, "Kd") == 0) {
		note->has_diffuse = true;
	} else if (strcasecmp(k, "Ks") == 0) {
		note_colour(line, note->specular);
	} else if (strcasecmp(k, "Ns") == 0 && line->number_count > 0) {
		note->exponent = line->numbers[0];
		note->has_exponent = true;
	} else if (strcasecmp(k, "illum") == 0 && line->number_count > 0) {
		note->illum = line->numbers[0] >= 0 && line->numbers[0] <= 10 ? (int)line->numbers[0] : -1;
	} else if (is_bump(k)) {
		note->bump = bump_multiplier(line);
	} else if (!note_physical(note, line)) {
		note_clearness(note, line);
	}
}

enum status mtl_notes_scan(struct mtl_notes *notes, struct import *import, const struct file_bytes *bytes, struct error *err)
{
	const char *at = (const char *)bytes->data, *end = at + bytes->size;
	while (at < end) {
		const char *stop = memchr(at, '\n', (size_t)(end - at));
		if (!stop)
			stop = end;
		const struct line line = split_line(at, (size_t)(stop - at));
		if (strcasecmp(line.keyword, "newmtl") == 0) {
			if (note_add(notes, &line, err) != STATUS_OK)
				return err->code;
		} else if (notes->count > 0) {
			note_property(&notes->notes[notes->count - 1], &line);
		}
		note_ignored(import, &line);
		at = stop + 1;
	}
	return STATUS_OK;
}

const struct mtl_note *mtl_notes_find(const struct mtl_notes *notes, const char *name)
{
	for (size_t i = notes->count; i-- > 0;)
		if (strcmp(notes->notes[i].name, name) == 0)
			return &notes->notes[i];
	return NULL;
}

void mtl_notes_finish(struct mtl_notes *notes)
{
	for (size_t i = 0; i < notes->count; i++)
		free(notes->notes[i].name);
	free(notes->notes);
	*notes = (struct mtl_notes){0};
}
