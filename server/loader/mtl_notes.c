#include "server/loader/mtl_notes.h"

#include <stdlib.h>
#include <string.h>

#include "server/loader/import_parts.h"

// Statements without effect here, which are told. Ka and map_Ka have none anywhere: no light is ambient.
static const char *const left_out[] = {
    "map_Ka", "map_Ns", "map_Tr", "map_Tf",  "map_opacity", "disp",    "map_disp", "decal",  "refl", "map_refl",
    "Ps",     "map_Ps", "map_Pc", "map_Pcr", "map_RMA",     "map_ORM", "aniso",    "anisor", "Km",
};

// The same of statements that no picture of light shows.
static const char *const passed_over[] = {"map_aat", "sharpness"};

static const struct {
	const char *keyword;
	enum mtl_map_kind kind;
} map_keywords[] = {
    {"map_Kd", MTL_DIFFUSE},   {"map_Ke", MTL_EMISSION}, {"map_emissive", MTL_EMISSION}, {"map_Ks", MTL_SPECULAR},
    {"map_Bump", MTL_BUMPS},   {"bump", MTL_BUMPS},      {"norm", MTL_NORMALS},          {"map_Kn", MTL_NORMALS},
    {"map_norm", MTL_NORMALS}, {"map_d", MTL_DISSOLVE},  {"map_Pr", MTL_ROUGHNESS},      {"map_Pm", MTL_METALLIC},
};

// The file that is read.
struct reader {
	struct mtl_notes *notes;
	struct import *import;
	const char *file, *folder;
	struct obj_text text;
	struct obj_word keyword;
	uint32_t current; // the material that statements belong to; NONE: none
	bool has_begun; // a material
};

void mtl_notes_init(struct mtl_notes *notes)
{
	*notes = (struct mtl_notes){0};
	key_table_init(&notes->names, KEY_TEXT_WORDS);
}

void mtl_notes_finish(struct mtl_notes *notes)
{
	for (size_t i = 0; i < notes->count; i++) {
		free(notes->notes[i].name);
		for (int k = 0; k < MTL_MAPS; k++)
			free(notes->notes[i].maps[k].file);
	}
	for (size_t i = 0; i < notes->folder_count; i++)
		free(notes->folders[i]);
	free(notes->folders);
	free(notes->notes);
	key_table_finish(&notes->names);
	*notes = (struct mtl_notes){0};
}

static enum status add_note(struct mtl_notes *notes, const char *name, struct error *err)
{
	void *items = import_grown(notes->notes, notes->count, 1, &notes->room, sizeof *notes->notes, LIMIT_MATERIALS,
				   "materials", err);
	if (!items)
		return err->code;
	notes->notes = items;
	char *own = strdup(name);
	if (!own)
		return error_set(err, STATUS_MEMORY, "no memory for a material's name");
	notes->notes[notes->count++] = (struct mtl_note){.name = own, .illum = -1, .dissolve = 1};
	return STATUS_OK;
}

enum status mtl_notes_number(struct mtl_notes *notes, const char *name, uint32_t *number, struct error *err)
{
	uint32_t key[KEY_TEXT_WORDS];
	key_of_text(name, key);
	if (key_table_number(&notes->names, key, number, err) != STATUS_OK)
		return err->code;
	return *number < notes->count ? STATUS_OK : add_note(notes, name, err);
}

static void tell_malformed(struct reader *r, const char *what)
{
	import_warn(r->import, "%.60s, line %zu: '%.*s' %s and is left out", r->file, r->text.line,
		    r->keyword.size < 20 ? (int)r->keyword.size : 20, r->keyword.at, what);
}

// The linear RGB of CIE's X, Y and Z, by sRGB's primaries.
static void rgb_of_xyz(double c[3])
{
	const double x = c[0], y = c[1], z = c[2];
	c[0] = 3.2404542 * x - 1.5371385 * y - 0.4985314 * z;
	c[1] = -0.9692660 * x + 1.8760108 * y + 0.0415560 * z;
	c[2] = 0.0556434 * x - 0.2040259 * y + 1.0572252 * z;
}

// Read a colour: three numbers, or one that stands for all three. False, with a word about it, if there is none.
static bool read_colour(struct reader *r, double out[3])
{
	struct obj_text ahead = r->text;
	struct obj_word word;
	const bool any = obj_text_word(&ahead, &word), xyz = any && obj_word_is(&word, "xyz");
	if (any && obj_word_is(&word, "spectral")) {
		tell_malformed(r, "names a file of a spectrum");
		return false;
	}
	if (xyz)
		r->text = ahead;
	double numbers[3];
	int count;
	if (!obj_text_numbers(&r->text, 3, numbers, &count) || (count != 1 && count != 3)) {
		tell_malformed(r, count == 2 ? "has two numbers, not one or three," : "has no colour");
		return false;
	}
	for (int i = 0; i < 3; i++)
		out[i] = numbers[count == 3 ? i : 0];
	if (xyz)
		rgb_of_xyz(out);
	return true;
}

static bool read_number(struct reader *r, double *out)
{
	int count;
	double number;
	if (!obj_text_numbers(&r->text, 1, &number, &count) || count == 0) {
		tell_malformed(r, "has no number");
		return false;
	}
	*out = number;
	return true;
}

// Kd, Ke, Ks and Tf. False for any other keyword.
static bool note_colours(struct reader *r, struct mtl_note *note)
{
	const struct {
		const char *keyword;
		double *value;
		bool *has;
	} keys[] = {{"Kd", note->diffuse, &note->has_diffuse},
		    {"Ke", note->emission, &note->has_emission},
		    {"Ks", note->specular, &note->has_specular},
		    {"Tf", note->filter, &note->has_filter}};
	for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
		if (obj_word_is(&r->keyword, keys[i].keyword)) {
			*keys[i].has |= read_colour(r, keys[i].value);
			return true;
		}
	return false;
}

// Single numbers, those of physically based exporters among them. False for any other keyword.
static bool note_numbers(struct reader *r, struct mtl_note *note)
{
	const struct {
		const char *keyword;
		double *value;
		bool *has;
	} keys[] = {{"Ns", &note->exponent, &note->has_exponent},
		    {"Ni", &note->ior, NULL},
		    {"Pr", &note->roughness, &note->has_roughness},
		    {"Pm", &note->metallic, &note->has_metallic},
		    {"Pc", &note->coat, NULL},
		    {"Pcr", &note->coat_roughness, NULL},
		    {"Pdr", &note->diffuse_roughness, NULL},
		    {"Pp", &note->priority, NULL}};
	for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
		if (obj_word_is(&r->keyword, keys[i].keyword)) {
			if (read_number(r, keys[i].value) && keys[i].has)
				*keys[i].has = true;
			return true;
		}
	return false;
}

// d and Tr. Many exporters write Tr 1 for opaque surfaces, so Tr 1 alone means nothing. A halo is denser towards the rim,
// which is left out.
static bool note_dissolve(struct reader *r, struct mtl_note *note)
{
	struct obj_text ahead = r->text;
	struct obj_word word;
	double number = 1;
	if (!obj_word_is(&r->keyword, "d") && !obj_word_is(&r->keyword, "Tr"))
		return false;
	if (obj_text_word(&ahead, &word) && obj_word_is(&word, "-halo")) {
		import_ignore(r->import, "d -halo");
		r->text = ahead;
	}
	if (!read_number(r, &number))
		return true;
	if (obj_word_is(&r->keyword, "d")) {
		note->dissolve = number;
		note->has_dissolve = true;
	} else if (!note->has_dissolve && number < 1) {
		note->dissolve = 1 - number;
	}
	return true;
}

static bool note_illum(struct reader *r, struct mtl_note *note)
{
	double number;
	if (!obj_word_is(&r->keyword, "illum"))
		return false;
	if (read_number(r, &number)) {
		note->illum = number >= 0 && number < 11 ? (int)number : -1;
		if (note->illum < 0)
			tell_malformed(r, "is no model from 0 to 10");
	}
	return true;
}

// A map; the last of a kind counts. *known becomes false if the statement is none.
static enum status note_map(struct reader *r, struct mtl_note *note, bool *known, struct error *err)
{
	struct mtl_map map;
	for (size_t i = 0; i < sizeof map_keywords / sizeof *map_keywords; i++) {
		if (!obj_word_is(&r->keyword, map_keywords[i].keyword))
			continue;
		if (mtl_map_read(r->import, &r->text, &map, err) != STATUS_OK)
			return err->code;
		struct mtl_map *old = &note->maps[map_keywords[i].kind];
		if (!map.file) {
			tell_malformed(r, "names no file");
			return STATUS_OK;
		}
		free(old->file);
		*old = map;
		return import_expect_images(r->import, err);
	}
	*known = false;
	return STATUS_OK;
}

static void tell_left_out(struct reader *r)
{
	if (obj_word_is(&r->keyword, "Ka"))
		return;
	for (size_t i = 0; i < sizeof left_out / sizeof left_out[0]; i++)
		if (obj_word_is(&r->keyword, left_out[i])) {
			import_ignore(r->import, left_out[i]);
			return;
		}
	for (size_t i = 0; i < sizeof passed_over / sizeof passed_over[0]; i++)
		if (obj_word_is(&r->keyword, passed_over[i])) {
			import_pass_over(r->import, passed_over[i]);
			return;
		}
	tell_malformed(r, "is no statement of MTL that is known");
}

static enum status start_material(struct reader *r, struct error *err)
{
	char *name = obj_text_rest(&r->text);
	if (!name)
		return error_set(err, STATUS_MEMORY, "no memory for a material's name");
	enum status status = mtl_notes_number(r->notes, name, &r->current, err);
	r->has_begun = true;
	if (status == STATUS_OK && r->notes->notes[r->current].folder) {
		import_warn(r->import, "%.60s, line %zu: material '%.60s' is defined again, and its first definition counts",
			    r->file, r->text.line, name);
		r->current = NONE;
	} else if (status == STATUS_OK) {
		r->notes->notes[r->current].folder = r->folder;
	}
	free(name);
	return status;
}

static enum status read_statement(struct reader *r, struct error *err)
{
	if (obj_word_is(&r->keyword, "newmtl"))
		return start_material(r, err);
	bool known = true;
	struct mtl_note *note = r->current == NONE ? NULL : &r->notes->notes[r->current];
	if (!note && !r->has_begun)
		tell_malformed(r, "stands before any newmtl");
	if (!note)
		return STATUS_OK;
	if (note_colours(r, note) || note_numbers(r, note) || note_dissolve(r, note) || note_illum(r, note))
		return STATUS_OK;
	if (note_map(r, note, &known, err) != STATUS_OK)
		return err->code;
	if (!known)
		tell_left_out(r);
	return STATUS_OK;
}

// Keep the folder of a file.
static enum status add_folder(struct mtl_notes *notes, const char *file, struct error *err)
{
	const char *slash = strrchr(file, '/');
	void *items = import_grown(notes->folders, notes->folder_count, 1, &notes->folder_room, sizeof *notes->folders,
				   LIMIT_MATERIALS, "material libraries", err);
	if (!items)
		return err->code;
	notes->folders = items;
	char *folder = strndup(file, slash ? (size_t)(slash - file) + 1 : 0);
	if (!folder)
		return error_set(err, STATUS_MEMORY, "no memory for a folder's name");
	notes->folders[notes->folder_count++] = folder;
	return STATUS_OK;
}

enum status mtl_notes_read(struct mtl_notes *notes, struct import *im, const char *file, const struct file_bytes *bytes,
			   struct error *err)
{
	struct error why;
	struct reader r = {.notes = notes, .import = im, .file = file, .current = NONE};
	if (obj_text_start(&r.text, bytes, &why) != STATUS_OK) {
		import_warn(im, "material library '%.100s' is left out: %s", file, why.text);
		return STATUS_OK;
	}
	if (add_folder(notes, file, err) != STATUS_OK)
		return err->code;
	r.folder = notes->folders[notes->folder_count - 1];
	while (obj_text_statement(&r.text, &r.keyword))
		if (read_statement(&r, err) != STATUS_OK)
			return err->code;
	return STATUS_OK;
}
