#include "server/loader/patch_ply.h"

#include <stdlib.h>
#include <string.h>

#define WORDS_MOST 5u // of a line that says anything: "property list uchar uint vertex_indices"
#define PROPERTIES_MOST 32u

struct word {
	const char *at;
	size_t size;
};

// Where a property is: in a face behind the list, whose bytes then come on top, or before it.
struct place {
	bool known, behind;
	uint32_t at;
};

enum part { PART_NONE, PART_VERTICES, PART_FACES };

// What the header says.
struct ply {
	const char *file;
	enum part part; // whose properties come now
	bool binary, list;
	uint32_t vertices, faces;
	struct place axes[3];
	uint32_t vertex_bytes;
	struct place properties[PROPERTIES_MOST]; // in the order of patch_properties
	uint32_t before, behind; // bytes of a face before its list and behind it
	const uint8_t *body;
	size_t body_bytes;
};

// ---- the header
// -----------------------------------------------------------------------------------------------------------

static enum status invalid(const struct ply *p, const char *what, struct error *err)
{
	return error_set(err, STATUS_SCENE_INVALID, "'%.100s': %s; write it again", p->file, what);
}

static enum status foreign(const struct ply *p, const char *what, const char *name, struct error *err)
{
	return error_set(
	    err, STATUS_SCENE_UNSUPPORTED,
	    "'%.60s' has %s%.40s: of PLY files candil reads those of patches that it has written, and no meshes; "
	    "convert a mesh to glTF or OBJ",
	    p->file, what, name);
}

static bool is(struct word word, const char *text)
{
	return strlen(text) == word.size && memcmp(word.at, text, word.size) == 0;
}

// A type of numbers, by either of its names: its place in a list, and its bytes. NULL: it is none.
struct type {
	const char *name, *other;
	uint32_t bytes;
};

static const struct type *type_of(struct word word)
{
	static const struct type types[] = {{"char", "int8", 1},     {"uchar", "uint8", 1},   {"short", "int16", 2},
					    {"ushort", "uint16", 2}, {"int", "int32", 4},     {"uint", "uint32", 4},
					    {"float", "float32", 4}, {"double", "float64", 8}};
	for (size_t i = 0; i < sizeof types / sizeof *types; i++)
		if (is(word, types[i].name) || is(word, types[i].other))
			return &types[i];
	return NULL;
}

static bool is_type(struct word word, const char *name)
{
	const struct type *type = type_of(word);
	return type && strcmp(type->name, name) == 0;
}

static bool whole_number(struct word word, uint32_t *number)
{
	uint64_t n = 0;
	for (size_t i = 0; i < word.size; i++) {
		if (word.at[i] < '0' || word.at[i] > '9')
			return false;
		n = n * 10 + (uint64_t)(word.at[i] - '0');
		if (n > UINT32_MAX)
			return false;
	}
	*number = (uint32_t)n;
	return word.size > 0;
}

static enum status take_element(struct ply *p, const struct word *words, uint32_t count, struct error *err)
{
	uint32_t *number = p->part == PART_NONE ? &p->vertices : &p->faces;
	if (count != 3 || p->part == PART_FACES || !is(words[1], p->part == PART_NONE ? "vertex" : "face"))
		return foreign(p, "not vertices and then faces alone", "", err);
	p->part = p->part == PART_NONE ? PART_VERTICES : PART_FACES;
	return whole_number(words[2], number) ? STATUS_OK : invalid(p, "the number of its vertices or faces is none", err);
}

// The place of the property of that name and its type, or NULL.
static struct place *place_of(struct ply *p, struct word name, const char **type)
{
#define AXIS(type, name, member) {#type, name},
	static const struct {
		const char *type, *name;
	} axes[3] = {PATCH_AXES(AXIS)};
	uint32_t count;
	const struct patch_property *properties = patch_properties(&count);
	for (uint32_t i = 0; i < 3 && p->part == PART_VERTICES; i++)
		if (is(name, axes[i].name)) {
			*type = axes[i].type;
			return &p->axes[i];
		}
	for (uint32_t i = 0; i < count && p->part == PART_FACES; i++)
		if (is(name, properties[i].name)) {
			*type = properties[i].type;
			return &p->properties[i];
		}
	return NULL;
}

static enum status take_list(struct ply *p, const struct word *words, uint32_t count, struct error *err)
{
	const bool corners = p->part == PART_FACES && count == 5 && is_type(words[2], PATCH_LIST_LENGTH) &&
			     is_type(words[3], PATCH_LIST_ITEM) && is(words[4], PATCH_LIST_NAME);
	if (!corners || p->list)
		return foreign(p, "another list than " PATCH_LIST, "", err);
	p->list = true;
	return STATUS_OK;
}

static enum status take_property(struct ply *p, const struct word *words, uint32_t count, struct error *err)
{
	if (count > 1 && is(words[1], "list"))
		return take_list(p, words, count, err);
	const struct type *type = count == 3 ? type_of(words[1]) : NULL;
	if (!type || p->part == PART_NONE)
		return invalid(p, "a property in its header is none", err);
	const char *wanted = NULL;
	struct place *place = place_of(p, words[2], &wanted);
	uint32_t *at = p->part == PART_VERTICES ? &p->vertex_bytes : p->list ? &p->behind : &p->before;
	if (place && strcmp(type->name, wanted) != 0)
		return foreign(p, "a property of another type than ", wanted, err);
	if (place && place->known)
		return invalid(p, "its header has a property twice", err);
	if (place)
		*place = (struct place){.known = true, .behind = p->list, .at = *at};
	*at += type->bytes; // a header has less than 2^16 properties
	return STATUS_OK;
}

static enum status take_line(struct ply *p, const struct word *words, uint32_t count, struct error *err)
{
	if (is(words[0], "comment") || is(words[0], "obj_info"))
		return STATUS_OK;
	if (is(words[0], "format")) {
		p->binary = count == 3 && is(words[1], "binary_little_endian") && is(words[2], "1.0");
		return p->binary ? STATUS_OK : foreign(p, "another format than binary_little_endian 1.0", "", err);
	}
	if (is(words[0], "element"))
		return take_element(p, words, count, err);
	return is(words[0], "property") ? take_property(p, words, count, err)
					: invalid(p, "its header has a line that is none", err);
}

// The words of the line, at most WORDS_MOST of them, and how many there would be, up to one more. *at becomes the next line.
// False: it does not end.
static bool next_line(const char **at, const char *end, struct word words[WORDS_MOST], uint32_t *count)
{
	const char *stop = memchr(*at, '\n', (size_t)(end - *at)), *c = *at;
	if (!stop)
		return false;
	*at = stop + 1;
	stop -= stop > c && stop[-1] == '\r';
	for (*count = 0; *count <= WORDS_MOST; ++*count) {
		while (c < stop && *c == ' ')
			c++;
		if (c == stop)
			break;
		const char *word = c;
		while (c < stop && *c != ' ')
			c++;
		if (*count < WORDS_MOST)
			words[*count] = (struct word){word, (size_t)(c - word)};
	}
	return true;
}

static enum status check_header(const struct ply *p, struct error *err)
{
	uint32_t count;
	const struct patch_property *properties = patch_properties(&count);
	if (!p->binary)
		return invalid(p, "its header has no format", err);
	if (!p->axes[0].known || !p->axes[1].known || !p->axes[2].known)
		return foreign(p, "vertices without x, y and z", "", err);
	if (!p->list)
		return foreign(p, "faces without ", PATCH_LIST, err);
	for (uint32_t i = 0; i < count; i++)
		if (!p->properties[i].known)
			return foreign(p, "faces without ", properties[i].name, err);
	if (p->faces == 0)
		return invalid(p, "it has no faces", err);
	return p->faces <= LIMIT_PATCH_ELEMENTS
		   ? STATUS_OK
		   : error_set(err, STATUS_SCENE_LIMIT, "'%.100s' has %u faces, %u are the most: write it of fewer patches",
			       p->file, p->faces, LIMIT_PATCH_ELEMENTS);
}

static enum status read_header(struct ply *p, const struct file_bytes *bytes, struct error *err)
{
	const char *at = (const char *)bytes->data;
	const char *end = at + (bytes->size < LIMIT_PLY_HEADER_BYTES ? bytes->size : LIMIT_PLY_HEADER_BYTES);
	struct word words[WORDS_MOST];
	uint32_t count;
	enum status status = STATUS_OK;
	bool ended = false;
	if (!next_line(&at, end, words, &count) || count != 1 || !is(words[0], "ply"))
		return error_set(err, STATUS_SCENE_INVALID, "'%.100s' is not a PLY file; give it its proper ending",
				 p->file);
	while (status == STATUS_OK && !ended) {
		if (!next_line(&at, end, words, &count))
			return invalid(p, "its header does not end", err);
		ended = count == 1 && is(words[0], "end_header");
		if (!ended)
			status =
			    count > 0 ? take_line(p, words, count, err) : invalid(p, "its header has an empty line", err);
	}
	p->body = (const uint8_t *)at;
	p->body_bytes = bytes->size - (size_t)(at - (const char *)bytes->data);
	return status == STATUS_OK ? check_header(p, err) : status;
}

// ---- the body
// -------------------------------------------------------------------------------------------------------------

static void take_corner(const struct ply *p, uint32_t vertex, double corner[3])
{
	const uint8_t *at = p->body + (size_t)vertex * p->vertex_bytes;
	for (int c = 0; c < 3; c++)
		memcpy(&corner[c], at + p->axes[c].at, sizeof corner[c]);
}

// Read the face at *at, which moves behind it.
static enum status read_face(const struct ply *p, const uint8_t **at, struct imported_element *e, struct error *err)
{
	const uint8_t *face = *at, *list = face + p->before;
	const size_t left = p->body_bytes - (size_t)(face - p->body);
	uint32_t count, vertex;
	const struct patch_property *properties = patch_properties(&count);
	if (left <= p->before)
		return invalid(p, "it ends before its last face", err);
	e->corners = *list;
	if (e->corners != 3 && e->corners != 4)
		return invalid(p, "a face has neither three corners nor four", err);
	const size_t list_bytes = 1 + e->corners * sizeof vertex;
	if (left < p->before + list_bytes + p->behind)
		return invalid(p, "it ends before its last face", err);
	for (uint32_t k = 0; k < e->corners; k++) {
		memcpy(&vertex, list + 1 + k * sizeof vertex, sizeof vertex);
		if (vertex >= p->vertices)
			return invalid(p, "a face names a vertex that is not there", err);
		take_corner(p, vertex, e->corner[k]);
	}
	for (uint32_t i = 0; i < count; i++) {
		const struct place *place = &p->properties[i];
		memcpy((char *)e + properties[i].offset, face + place->at + (place->behind ? p->before + list_bytes : 0),
		       properties[i].bytes);
	}
	*at += p->before + list_bytes + p->behind;
	return STATUS_OK;
}

static enum status read_faces(const struct ply *p, struct imported_element *elements, struct error *err)
{
	const uint8_t *at = p->body + (size_t)p->vertices * p->vertex_bytes;
	enum status status = STATUS_OK;
	uint32_t which;
	for (uint32_t i = 0; i < p->faces && status == STATUS_OK; i++)
		status = read_face(p, &at, &elements[i], err);
	if (status == STATUS_OK && at != p->body + p->body_bytes)
		status = invalid(p, "it goes on behind its last face", err);
	const char *fault = status == STATUS_OK ? imported_elements_fault(elements, p->faces, &which) : NULL;
	return fault ? error_set(err, STATUS_SCENE_INVALID, "'%.60s', face %u: %s; write it again", p->file, which, fault)
		     : status;
}

enum status patch_ply_import(struct import *im, const char *file, const struct file_bytes *bytes, struct error *err)
{
	struct ply p = {.file = file};
	uint32_t count;
	(void)patch_properties(&count);
	if (count > PROPERTIES_MOST)
		return error_set(err, STATUS_INTERNAL, "there are more properties than places for them");
	if (read_header(&p, bytes, err) != STATUS_OK)
		return err->code;
	// Each is a product of less than 2^32 and less than 2^20.
	const uint64_t vertices = (uint64_t)p.vertices * p.vertex_bytes;
	const uint64_t faces = p.faces * (1 + 3 * sizeof(uint32_t) + p.before + p.behind);
	if (vertices + faces > p.body_bytes)
		return invalid(&p, "it ends before its last face", err);
	im->elements = calloc(p.faces, sizeof *im->elements); // a fourth corner that is not there is 0
	if (!im->elements)
		return error_set(err, STATUS_MEMORY, "no memory for %u faces", p.faces);
	im->element_count = p.faces;
	return read_faces(&p, im->elements, err);
}
