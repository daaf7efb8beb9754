#include "server/loader/mtl_map.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/loader/import_parts.h"

#define ON_OFF (-1)

// An option of a map: what follows it, and what it is by default.
struct option {
	const char *name;
	int numbers; // the most that follow; 0: one word; ON_OFF: on or off, which some exporters leave out
	const char *plain; // the word, or the number that each is, for which there is nothing to tell; NULL: never tell
};

static const struct option options[] = {{"-blendu", ON_OFF, "on"}, {"-blendv", ON_OFF, "on"}, {"-boost", 1, "0"},
					{"-cc", ON_OFF, "off"},    {"-clamp", ON_OFF, NULL},  {"-bm", 1, NULL},
					{"-o", 3, NULL},           {"-s", 3, NULL},           {"-t", 3, "0"},
					{"-texres", 1, NULL},      {"-type", 0, ""},          {"-imfchan", 0, NULL},
					{"-mm", 2, "0"},           {"-colorspace", 0, ""}};

static const struct option *find_option(const struct obj_word *word)
{
	for (size_t i = 0; i < sizeof options / sizeof *options; i++)
		if (obj_word_is(word, options[i].name))
			return &options[i];
	return NULL;
}

// Tell an option that asks for something. A range (-mm 0 1) is what a picture has anyway.
static void tell_option(struct import *im, const struct option *o, const struct obj_word *value, const double *numbers,
			int count)
{
	bool plain = o->plain == NULL || (o->numbers <= 0 && obj_word_is(value, o->plain));
	if (o->plain && o->numbers > 0) {
		plain = true;
		for (int i = 0; i < count; i++)
			plain = plain && (numbers[i] == 0 || (strcmp(o->name, "-mm") == 0 && i == 1 && numbers[i] == 1));
	}
	char text[32];
	snprintf(text, sizeof text, "map option %s", o->name);
	if (!plain)
		import_ignore(im, text);
}

// Read the numbers of an option, fewer than `most` too. A number that is the statement's last word, while there is no file's
// name yet, is that name.
static int option_numbers(struct obj_text *t, int most, bool has_file, double *numbers)
{
	int count = 0;
	for (struct obj_text ahead = *t; count < most; count++) {
		struct obj_word word, after;
		if (!obj_text_name_word(&ahead, &word) || !obj_word_number(&word, &numbers[count]))
			break;
		struct obj_text behind = ahead;
		if (!has_file && !obj_text_name_word(&behind, &after))
			break;
		*t = ahead;
	}
	return count;
}

// Read "on" or "off". An option with neither is on.
static struct obj_word read_on_off(struct obj_text *t)
{
	struct obj_text ahead = *t;
	struct obj_word word;
	if (!obj_text_name_word(&ahead, &word) || !(obj_word_is(&word, "on") || obj_word_is(&word, "off")))
		return (struct obj_word){"on", 2};
	*t = ahead;
	return word;
}

static void read_option(struct import *im, struct obj_text *t, const struct option *o, struct mtl_map *map)
{
	struct obj_word value = {"", 0};
	double numbers[3] = {0, 0, 0};
	const int count = o->numbers > 0 ? option_numbers(t, o->numbers, map->file != NULL, numbers) : 0;
	if (o->numbers == 0)
		obj_text_name_word(t, &value);
	if (o->numbers == ON_OFF)
		value = read_on_off(t);
	if (strcmp(o->name, "-clamp") == 0)
		map->clamp = obj_word_is(&value, "on");
	if (strcmp(o->name, "-imfchan") == 0)
		map->channel = value.size == 1 ? (char)tolower((unsigned char)value.at[0]) : 0;
	if (strcmp(o->name, "-bm") == 0 && count > 0)
		map->bump = numbers[0];
	for (int i = 0; i < 2 && i < count; i++) {
		if (strcmp(o->name, "-o") == 0)
			map->offset[i] = numbers[i];
		if (strcmp(o->name, "-s") == 0)
			map->scale[i] = numbers[i];
	}
	tell_option(im, o, &value, numbers, count);
}

// Read the file's name: words up to an option or the end. `first` is its first word.
static char *read_name(struct obj_text *t, const struct obj_word *first)
{
	struct obj_word word;
	const char *to = first->at + first->size;
	for (struct obj_text ahead = *t; obj_text_name_word(&ahead, &word) && !find_option(&word); *t = ahead)
		to = word.at + word.size;
	char *name = obj_text_name(first->at, to);
	for (char *c = name; c && *c; c++)
		if (*c == '\\')
			*c = '/';
	return name;
}

enum status mtl_map_read(struct import *im, struct obj_text *t, struct mtl_map *map, struct error *err)
{
	struct obj_word word;
	*map = (struct mtl_map){.scale = {1, 1}, .bump = 1};
	while (obj_text_name_word(t, &word)) {
		const struct option *o = find_option(&word);
		if (o) {
			read_option(im, t, o, map);
			continue;
		}
		if (map->file)
			continue;
		map->file = read_name(t, &word);
		if (!map->file)
			return error_set(err, STATUS_MEMORY, "no memory for a map's name");
	}
	return STATUS_OK;
}

// The texture's v runs down, the map's up: 1 - v' = scale · (1 - v) + offset.
static struct import_sampling sampling_of(const struct mtl_map *map, uint32_t flags)
{
	const uint32_t wrap = map->clamp ? WRAP_CLAMP : WRAP_REPEAT;
	struct import_sampling s =
	    import_plain_sampling(flags | wrap << TEXTURE_WRAP_S_SHIFT | wrap << TEXTURE_WRAP_T_SHIFT);
	s.row_u[0] = (float)map->scale[0];
	s.row_u[2] = (float)map->offset[0];
	s.row_v[1] = (float)map->scale[1];
	s.row_v[2] = (float)(1 - map->scale[1] - map->offset[1]);
	return s;
}

// The name by which the file is found, or that which it ought to have.
static enum status seek_file(struct import *im, const char *file, const char *folder, char **name, struct error *err)
{
	const size_t bytes = strlen(folder) + strlen(file) + 1;
	const char *last = strrchr(file, '/');
	const struct {
		const char *folder, *file;
	} places[] = {{folder, file}, {"", file}, {"", last ? last + 1 : file}};
	const size_t count = sizeof places / sizeof *places;
	*name = malloc(bytes);
	char *wanted = malloc(bytes);
	bool found = false, renamed = false;
	if (!*name || !wanted) {
		free(wanted);
		return error_set(err, STATUS_MEMORY, "no memory for a map's name");
	}
	for (size_t i = 0; i < count && !found; i++) {
		snprintf(*name, bytes, "%s%s", places[i].folder, places[i].file);
		found = import_knows_image(im, *name) || files_exists(im->files, *name);
		renamed = i == 2;
	}
	for (size_t i = 0; i < count && !found; i++) {
		snprintf(wanted, bytes, "%s%s", places[i].folder, places[i].file);
		found = renamed = files_find_in_any_case(im->files, wanted, *name);
	}
	free(wanted);
	if (!found)
		snprintf(*name, bytes, "%s", file);
	else if (renamed)
		import_warn(im, "texture '%.100s' is taken from '%.100s' in the scene's folder", file, *name);
	return STATUS_OK;
}

// Find a file, once for all maps that name it: folders may be large.
static enum status find_file(struct import *im, const char *file, const char *folder, const char **name, struct error *err)
{
	uint32_t key[KEY_TEXT_WORDS], number;
	char *wanted;
	while (file[0] == '.' && file[1] == '/')
		file += 2;
	if (asprintf(&wanted, "%s\n%s", folder, file) < 0)
		return error_set(err, STATUS_MEMORY, "no memory for a map's name");
	key_of_text(wanted, key);
	free(wanted);
	if (key_table_number(&im->sought, key, &number, err) != STATUS_OK)
		return err->code;
	if (number == im->found_count) {
		void *items = import_grown(im->found, number, 1, &im->found_room, sizeof *im->found,
					   (size_t)LIMIT_MATERIALS * 8, "maps", err);
		if (!items)
			return err->code;
		im->found = items;
		if (seek_file(im, file, folder, &im->found[number], err) != STATUS_OK)
			return err->code;
		im->found_count++;
	}
	*name = im->found[number];
	return STATUS_OK;
}

static bool is_finite(const struct import_sampling *s)
{
	for (int i = 0; i < 3; i++)
		if (!(s->row_u[i] - s->row_u[i] == 0) || !(s->row_v[i] - s->row_v[i] == 0))
			return false;
	return true;
}

enum status mtl_map_texture(struct import *im, const struct mtl_map *map, const char *folder, uint32_t flags,
			    const char **key, uint32_t *texture, struct error *err)
{
	struct file_bytes file = {0};
	struct error why;
	*texture = NONE;
	*key = NULL;
	if (!map->file || !map->file[0])
		return STATUS_OK;
	if (find_file(im, map->file, folder, key, err) != STATUS_OK)
		return err->code;
	if (!import_knows_image(im, *key) && files_read(im->files, *key, &file, &why) != STATUS_OK &&
	    import_missing_image(im, *key, why.text, err) != STATUS_OK)
		return err->code;
	struct import_sampling sampling = sampling_of(map, flags);
	if (!is_finite(&sampling)) {
		const struct mtl_map plain = {.scale = {1, 1}, .clamp = map->clamp};
		import_warn(im, "texture '%.60s' has an offset or a scale that is not finite, which is left out", map->file);
		sampling = sampling_of(&plain, flags);
	}
	enum status status = import_texture(im, *key, file.data, file.size, true, &sampling, texture, err);
	file_bytes_finish(&file);
	return status;
}
