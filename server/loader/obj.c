#include "server/loader/obj.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "server/loader/mtl_material.h"
#include "server/loader/obj_faces.h"
#include "server/loader/obj_groups.h"

#define DEFAULT_ALBEDO 0.8f // of a surface whose material does not give one, where no vertices have colours

// Statements that are left out, by what is told of them.
static const struct {
	const char *keyword, *told;
	bool is_seen; // in pictures of surfaces
} left_out[] = {
    {"p", "points", true},
    {"l", "lines", true},
    {"vp", "curves and surfaces", true},
    {"cstype", "curves and surfaces", true},
    {"deg", "curves and surfaces", true},
    {"bmat", "curves and surfaces", true},
    {"step", "curves and surfaces", true},
    {"curv", "curves and surfaces", true},
    {"curv2", "curves and surfaces", true},
    {"surf", "curves and surfaces", true},
    {"parm", "curves and surfaces", true},
    {"trim", "curves and surfaces", true},
    {"hole", "curves and surfaces", true},
    {"scrv", "curves and surfaces", true},
    {"sp", "curves and surfaces", true},
    {"end", "curves and surfaces", true},
    {"con", "curves and surfaces", true},
    {"mg", "curves and surfaces", true},
    {"ctech", "curves and surfaces", true},
    {"stech", "curves and surfaces", true},
    {"bsp", "curves and surfaces", true},
    {"bzp", "curves and surfaces", true},
    {"cdc", "curves and surfaces", true},
    {"cdp", "curves and surfaces", true},
    {"res", "curves and surfaces", true},
    {"call", "call", true},
    {"csh", "csh", true},
    {"scmp", "scmp", true},
    {"usemap", "usemap", true},
    {"maplib", "maplib", true},
    {"shadow_obj", "shadow_obj", true},
    {"trace_obj", "trace_obj", true},
    {"bevel", "bevel", false},
    {"c_interp", "c_interp", false},
    {"d_interp", "d_interp", false},
    {"lod", "lod", false},
};

struct reader {
	struct import *import;
	const char *name; // of the OBJ file
	struct obj_points points;
	struct mtl_notes notes;
	struct obj_faces faces;
	struct obj_groups groups;
	struct obj_text text;
	struct obj_word keyword;
	struct obj_counts before; // what stands before the line that is read
	uint32_t material; // of the faces to come; NONE: none was named yet
	bool is_smooth;
	bool has_statement; // any that is known
	bool told_fallback;
	struct key_table libraries; // the names of those that were read
};

// Read the library that has the OBJ file's own name in the place of one that is not there, as exporters name it.
static enum status read_own_library(struct reader *r, const char *missing, const char *why, struct error *err)
{
	const size_t stem = strlen(r->name) - 4; // ".obj"
	char own[256];
	struct file_bytes bytes;
	struct error unread;
	snprintf(own, sizeof own, "%.*s.mtl", (int)(stem < 200 ? stem : 200), r->name);
	if (r->told_fallback || strcmp(own, missing) == 0 ||
	    files_read(r->import->files, own, &bytes, &unread) != STATUS_OK) {
		import_warn(r->import, "material library left out, its materials are taken as grey: %s", why);
		return STATUS_OK;
	}
	r->told_fallback = true;
	import_warn(r->import, "material library '%.60s' is taken from '%.60s': %.100s", missing, own, why);
	enum status status = mtl_notes_read(&r->notes, r->import, own, &bytes, err);
	file_bytes_finish(&bytes);
	return status;
}

// Read a library that is not where it is said to be: by its last name, or by another case of letters. STATUS_SCENE_FILE:
// there is none such, and `err` stays as it is.
static enum status read_renamed(struct reader *r, const char *name, const char **from, char *found, struct file_bytes *bytes,
				struct error *err)
{
	const char *last = strrchr(name, '/');
	const char *const wanted[] = {name, last ? last + 1 : name};
	*from = wanted[1];
	bool is_there = last && files_exists(r->import->files, wanted[1]);
	for (size_t i = 0; i < 2 && !is_there; i++) {
		is_there = files_find_in_any_case(r->import->files, wanted[i], found);
		*from = found;
	}
	if (!is_there)
		return STATUS_SCENE_FILE;
	import_warn(r->import, "material library '%.100s' is taken from '%.100s' in the scene's folder", name, *from);
	return files_read(r->import->files, *from, bytes, err);
}

// Whether a library has not been read yet: exporters name one before each object.
static enum status note_library(struct reader *r, const char *name, bool *is_new, struct error *err)
{
	uint32_t key[KEY_TEXT_WORDS], number;
	const uint32_t known = r->libraries.count;
	key_of_text(name, key);
	const enum status status = key_table_number(&r->libraries, key, &number, err);
	*is_new = r->libraries.count > known;
	return status;
}

static enum status read_library(struct reader *r, const char *name, struct error *err)
{
	bool is_new = true;
	struct file_bytes bytes;
	struct error why;
	const char *from = name;
	char *found = malloc(strlen(name) + 1);
	if (!found)
		return error_set(err, STATUS_MEMORY, "no memory for a library's name");
	enum status status = files_read(r->import->files, name, &bytes, &why);
	if (status == STATUS_SCENE_FILE || status == STATUS_SCENE_PATH)
		status = read_renamed(r, name, &from, found, &bytes, &why);
	if (status == STATUS_SCENE_LIMIT || status == STATUS_MEMORY) {
		error_set(err, status, "%s", why.text);
	} else if (status != STATUS_OK) {
		status = read_own_library(r, name, why.text, err);
	} else {
		status = from == name ? STATUS_OK : note_library(r, from, &is_new, err);
		if (status == STATUS_OK && is_new)
			status = mtl_notes_read(&r->notes, r->import, from, &bytes, err);
		file_bytes_finish(&bytes);
	}
	free(found);
	return status;
}

static enum status read_library_once(struct reader *r, char *name, struct error *err)
{
	bool is_new;
	for (char *c = name; *c; c++)
		if (*c == '\\')
			*c = '/';
	while (name[0] == '.' && name[1] == '/')
		name += 2;
	if (note_library(r, name, &is_new, err) != STATUS_OK)
		return err->code;
	return is_new ? read_library(r, name, err) : STATUS_OK;
}

// Whether the word ends the name of a library. Names may hold blanks.
static bool ends_library(const struct obj_word *word)
{
	const size_t quote = word->size > 0 && (word->at[word->size - 1] == '"' || word->at[word->size - 1] == '\'');
	return word->size >= 4 + quote && strncasecmp(word->at + word->size - quote - 4, ".mtl", 4) == 0;
}

// mtllib: one name or several.
static enum status read_libraries(struct reader *r, struct error *err)
{
	struct obj_word word;
	const char *from = NULL, *to = NULL;
	enum status status = STATUS_OK;
	for (bool more = true; more && status == STATUS_OK;) {
		more = obj_text_name_word(&r->text, &word);
		if (more) {
			from = from ? from : word.at;
			to = word.at + word.size;
		}
		if (!from || (more && !ends_library(&word)))
			continue;
		char *name = obj_text_name(from, to);
		status =
		    name ? read_library_once(r, name, err) : error_set(err, STATUS_MEMORY, "no memory for a library's name");
		free(name);
		from = NULL;
	}
	return status;
}

// First pass: the lists that faces point into, and the materials.
static enum status read_lists(struct reader *r, struct error *err)
{
	while (obj_text_statement(&r->text, &r->keyword)) {
		bool known;
		if (obj_points_read(&r->points, r->import, &r->text, &r->keyword, &known, err) != STATUS_OK)
			return err->code;
		r->has_statement |= known;
		if (!known && obj_word_is(&r->keyword, "mtllib") && read_libraries(r, err) != STATUS_OK)
			return err->code;
	}
	return obj_points_end(&r->points, r->import, err);
}

static enum status use_material(struct reader *r, const char *name, struct error *err)
{
	if (!name)
		return error_set(err, STATUS_MEMORY, "no memory for a material's name");
	return mtl_notes_number(&r->notes, name, &r->material, err);
}

static enum status read_face(struct reader *r, struct error *err)
{
	uint32_t group;
	if ((r->material == NONE && use_material(r, "", err) != STATUS_OK) ||
	    obj_groups_current(&r->groups, r->import, &group, err) != STATUS_OK)
		return err->code;
	const size_t before = r->import->triangle_count;
	if (obj_faces_read(&r->faces, &r->text, &r->before, r->material, group, r->is_smooth, err) != STATUS_OK)
		return err->code;
	r->notes.notes[r->material].is_used |= r->import->triangle_count > before;
	return STATUS_OK;
}

// Statements that change how later faces are read. False for any other.
static bool read_state(struct reader *r, enum status *status, struct error *err)
{
	struct obj_word word;
	if (obj_word_is(&r->keyword, "usemtl")) {
		char *name = obj_text_rest(&r->text);
		*status = use_material(r, name, err);
		free(name);
	} else if (obj_word_is(&r->keyword, "g") || obj_word_is(&r->keyword, "o")) {
		char *name = obj_text_rest(&r->text);
		obj_groups_name(&r->groups, name);
		*status = name ? STATUS_OK : error_set(err, STATUS_MEMORY, "no memory for a group's name");
	} else if (obj_word_is(&r->keyword, "s")) {
		r->is_smooth = obj_text_word(&r->text, &word) && !obj_word_is(&word, "off") && !obj_word_is(&word, "0");
	} else {
		return false;
	}
	return true;
}

// What was read in the first pass is counted, so that indices can count back from a face.
static bool count_lists(struct reader *r)
{
	const bool v = obj_word_is(&r->keyword, "v"), vt = obj_word_is(&r->keyword, "vt"),
		   vn = obj_word_is(&r->keyword, "vn");
	r->before.positions += v;
	r->before.uvs += vt;
	r->before.normals += vn;
	return v || vt || vn || obj_word_is(&r->keyword, "mtllib");
}

static void tell_left_out(struct reader *r)
{
	for (size_t i = 0; i < sizeof left_out / sizeof *left_out; i++)
		if (obj_word_is(&r->keyword, left_out[i].keyword)) {
			(left_out[i].is_seen ? import_ignore : import_pass_over)(r->import, left_out[i].told);
			r->has_statement = true;
			return;
		}
	import_warn(r->import, "line %zu: '%.*s' is no statement of OBJ that is known and is left out", r->text.line,
		    r->keyword.size < 40 ? (int)r->keyword.size : 40, r->keyword.at);
}

// Second pass: faces, and what they are made of.
static enum status read_faces(struct reader *r, struct error *err)
{
	enum status status = STATUS_OK;
	while (status == STATUS_OK && obj_text_statement(&r->text, &r->keyword)) {
		if (count_lists(r))
			continue;
		if (obj_word_is(&r->keyword, "f") || obj_word_is(&r->keyword, "fo")) {
			status = read_face(r, err);
			r->has_statement = true;
		} else if (read_state(r, &status, err)) {
			r->has_statement = true;
		} else {
			tell_left_out(r);
		}
	}
	return status;
}

// Read the text in both passes. Whatever fails, its line is named.
static enum status read_passes(struct reader *r, struct error *err)
{
	const struct obj_text start = r->text;
	struct error why;
	enum status status = read_lists(r, &why);
	if (status == STATUS_OK) {
		r->text = start;
		status = read_faces(r, &why);
	}
	if (status != STATUS_OK)
		return error_set(err, status, "line %zu of the OBJ file: %s", r->text.line, why.text);
	return STATUS_OK;
}

static enum status read_all(struct reader *r, const struct file_bytes *bytes, struct error *err)
{
	struct error why;
	if (obj_text_start(&r->text, bytes, &why) != STATUS_OK)
		return error_set(err, why.code, "the OBJ file is not read: %s", why.text);
	// ZBrush writes its vertex colours so.
	if (memmem(r->text.at, (size_t)(r->text.end - r->text.at), "\n#MRGB ", 7))
		import_ignore(r->import, "vertex colours in comments (#MRGB)");
	if (read_passes(r, err) != STATUS_OK)
		return err->code;
	if (!r->has_statement)
		return error_set(err, STATUS_SCENE_INVALID, "the OBJ file holds no statement of OBJ");
	const float albedo = r->points.colours ? 1.0f : DEFAULT_ALBEDO;
	if (mtl_materials_add(r->import, &r->notes, albedo, err) != STATUS_OK)
		return err->code;
	return obj_groups_end(&r->groups, r->import, err);
}

enum status obj_import(struct import *im, const char *name, const struct file_bytes *bytes, struct error *err)
{
	struct reader r = {.import = im, .name = name, .material = NONE};
	mtl_notes_init(&r.notes);
	key_table_init(&r.libraries, KEY_TEXT_WORDS);
	obj_groups_init(&r.groups);
	obj_faces_init(&r.faces, im, &r.points);
	enum status status = read_all(&r, bytes, err);
	obj_faces_finish(&r.faces);
	obj_groups_finish(&r.groups);
	mtl_notes_finish(&r.notes);
	key_table_finish(&r.libraries);
	obj_points_finish(&r.points);
	return status;
}
