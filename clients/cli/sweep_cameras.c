#include "clients/cli/sweep_cameras.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FILE_BYTES_MAX (256u * 1024u * 1024u)
#define DEFAULT_ELEVATION 20.0

struct list {
	struct candil_camera *cameras;
	uint32_t count, capacity;
	const char *option; // that the user gave them by
	struct candil_error *error;
};

static bool cameras_refuse(struct list *list, const char *what)
{
	list->error->code = CANDIL_STATUS_BAD_ARGUMENT;
	snprintf(list->error->text, sizeof(list->error->text), "camera %u of %s: %s", list->count, list->option, what);
	return false;
}

static bool cameras_append(struct list *list, const double v[10])
{
	if (list->count == SWEEP_CAMERAS_MAX)
		return cameras_refuse(list, "there are too many");
	if (list->count == list->capacity) {
		uint32_t capacity = list->capacity ? 2 * list->capacity : 64;
		struct candil_camera *bigger = realloc(list->cameras, capacity * sizeof(*bigger));
		if (!bigger)
			return cameras_refuse(list, "out of memory");
		list->cameras = bigger;
		list->capacity = capacity;
	}
	list->cameras[list->count++] = (struct candil_camera){
	    .eye = {v[0], v[1], v[2]}, .target = {v[3], v[4], v[5]}, .up = {v[6], v[7], v[8]}, .vfov_degrees = v[9]};
	return true;
}

// Read an array of exactly `count` numbers.
static bool cameras_take_numbers(const json_t *array, double *out, size_t count)
{
	if (!json_is_array(array) || json_array_size(array) != count)
		return false;
	for (size_t i = 0; i < count; i++) {
		const json_t *number = json_array_get(array, i);
		if (!json_is_number(number))
			return false;
		out[i] = json_number_value(number);
	}
	return true;
}

static bool cameras_take_object(struct list *list, json_t *object)
{
	double v[10] = {0, 0, 0, 0, 0, 0, 0, 1, 0, 0};
	const char *key;
	json_t *value;
	json_object_foreach(object, key, value)
	{
		bool good = strcmp(key, "eye") == 0      ? cameras_take_numbers(value, v, 3)
			    : strcmp(key, "target") == 0 ? cameras_take_numbers(value, v + 3, 3)
			    : strcmp(key, "up") == 0     ? cameras_take_numbers(value, v + 6, 3)
							 : strcmp(key, "vfov") == 0 && json_is_number(value);
		if (!good)
			return cameras_refuse(
			    list, "it has \"eye\", \"target\", \"up\" of three numbers each and \"vfov\" of one");
	}
	if (!json_object_get(object, "eye") || !json_object_get(object, "target") || !json_object_get(object, "vfov"))
		return cameras_refuse(list, "\"eye\", \"target\" and \"vfov\" are needed");
	v[9] = json_number_value(json_object_get(object, "vfov"));
	return cameras_append(list, v);
}

static bool cameras_take_camera(struct list *list, json_t *value)
{
	double v[10];
	if (json_is_object(value))
		return cameras_take_object(list, value);
	if (cameras_take_numbers(value, v, 10))
		return cameras_append(list, v);
	return cameras_refuse(list, "it is neither an array of ten numbers nor an object");
}

// A camera, or an array of cameras.
static bool cameras_take_value(struct list *list, json_t *value)
{
	if (!json_is_array(value) || json_is_number(json_array_get(value, 0)))
		return cameras_take_camera(list, value);
	for (size_t i = 0; i < json_array_size(value); i++) {
		if (!cameras_take_camera(list, json_array_get(value, i)))
			return false;
	}
	return true;
}

static bool cameras_take_text(struct list *list, const char *text, size_t bytes)
{
	static const char blank[] = " \t\r\n";
	size_t at = 0;
	for (;;) {
		while (at < bytes && strchr(blank, text[at]) && text[at] != '\0')
			at++;
		if (at == bytes)
			return list->count > 0 || cameras_refuse(list, "there is none");
		json_error_t where;
		json_t *value = json_loadb(text + at, bytes - at, JSON_DISABLE_EOF_CHECK, &where);
		if (!value)
			return cameras_refuse(list, where.text);
		at += (size_t)where.position; // after a success: how many bytes were read
		bool good = cameras_take_value(list, value);
		json_decref(value);
		if (!good)
			return false;
	}
}

static char *cameras_read_file(const char *path, size_t *bytes, struct candil_error *error)
{
	char *text = NULL;
	size_t capacity = 0;
	*bytes = 0;
	errno = 0;
	FILE *file = fopen(path, "rbe");
	while (file && !feof(file) && !ferror(file) && *bytes < FILE_BYTES_MAX) {
		if (*bytes == capacity) {
			capacity = capacity ? 2 * capacity : 64u * 1024u;
			char *bigger = realloc(text, capacity);
			if (!bigger)
				break;
			text = bigger;
		}
		*bytes += fread(text + *bytes, 1, capacity - *bytes, file);
	}
	bool whole = file && feof(file);
	if (!whole) {
		error->code = CANDIL_STATUS_BAD_ARGUMENT;
		snprintf(error->text, sizeof(error->text), "cannot read %.150s: %s", path,
			 errno ? strerror(errno) : "it is too large");
		free(text);
		text = NULL;
	}
	if (file)
		fclose(file);
	return text;
}

bool sweep_cameras_read(const char *path, const char *option, struct candil_camera **cameras, uint32_t *count,
			struct candil_error *error)
{
	struct list list = {.option = option, .error = error};
	size_t bytes;
	char *text = cameras_read_file(path, &bytes, error);
	if (!text)
		return false;
	bool good = cameras_take_text(&list, text, bytes);
	free(text);
	if (!good) {
		free(list.cameras);
		return false;
	}
	*cameras = list.cameras;
	*count = list.count;
	return true;
}

bool sweep_orbit_parse(const char *text, uint32_t *count, double *elevation, double *radius)
{
	double v[3] = {0, DEFAULT_ELEVATION, 0};
	bool three = cli_parse_doubles(text, v, 3);
	if (!three && !cli_parse_doubles(text, v, 2) && !cli_parse_doubles(text, v, 1))
		return false;
	if (!(v[0] >= 1 && v[0] <= SWEEP_CAMERAS_MAX) || v[0] != floor(v[0]) || !(fabs(v[1]) <= 89))
		return false;
	*count = (uint32_t)v[0];
	*elevation = v[1];
	*radius = v[2];
	return !three || v[2] > 0;
}

bool sweep_shard_parse(const char *text, uint32_t *shard, uint32_t *shards)
{
	return cli_parse_pair(text, '/', shard, shards) && *shard >= 1 && *shard <= *shards;
}

#define MARK "{index}"

bool sweep_name_unknown(const char *pattern, char *out, size_t capacity)
{
	for (const char *at = pattern; (at = strchr(at, '{')); at++) {
		const size_t inside = strcspn(at + 1, "{}");
		if (at[1 + inside] != '}' || strncmp(at, MARK, strlen(MARK)) == 0)
			continue;
		snprintf(out, capacity, "the output's name has {%.*s} in it: a sweep knows {index} alone",
			 (int)(inside < 64 ? inside : 64), at + 1);
		return true;
	}
	return false;
}

char *sweep_name(const char *pattern, uint32_t index, uint32_t count)
{
	static const char mark[] = MARK;
	char number[16], *name = NULL;
	size_t bytes;
	int width = snprintf(NULL, 0, "%u", count);
	snprintf(number, sizeof(number), "%0*u", width, index);
	FILE *out = open_memstream(&name, &bytes);
	if (!out)
		return NULL;
	for (const char *at; (at = strstr(pattern, mark)); pattern = at + strlen(mark)) {
		fwrite(pattern, 1, (size_t)(at - pattern), out);
		fputs(number, out);
	}
	fputs(pattern, out);
	if (fclose(out) != 0) {
		free(name);
		return NULL;
	}
	return name;
}
