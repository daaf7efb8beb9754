// Plan files: JSON in and out. Every byte of a file is somebody else's.
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "clients/cli/render_values.h"
#include "clients/cli/study.h"
#include "clients/libcandil/error.h"

// A file that is being read.
struct reader {
	struct study_plan *plan;
	unsigned techniques;
	struct candil_error *error;
	char place[128]; // in it, for sentences: "points[3].settings"
};

static bool refuse(struct reader *r, const char *what)
{
	error_set(r->error, CANDIL_STATUS_BAD_ARGUMENT, "the plan's %s: %s", r->place, what);
	return false;
}

// ---- values ----------------------------------------------------------------------------------------------------------

// Check that an object has no other keys than those of a list with a zero at its end.
static bool check_keys(struct reader *r, json_t *object, const char *const *keys)
{
	const char *key;
	json_t *value;
	char what[200];
	if (!json_is_object(object))
		return refuse(r, "an object is needed");
	json_object_foreach(object, key, value)
	{
		size_t i = 0;
		while (keys[i] && strcmp(keys[i], key) != 0)
			i++;
		if (keys[i])
			continue;
		snprintf(what, sizeof(what), "there is no key \"%.60s\"; tests/bench/studies/README.md lists them", key);
		return refuse(r, what);
	}
	return true;
}

// Take a whole number if the key is there.
static bool take_whole(struct reader *r, json_t *object, const char *key, uint32_t least, uint32_t most, uint32_t *out)
{
	char what[96];
	const json_t *value = json_object_get(object, key);
	const json_int_t number = json_integer_value(value);
	if (!value)
		return true;
	snprintf(what, sizeof(what), "\"%s\" is a whole number from %u to %u", key, least, most);
	if (!json_is_integer(value) || number < least || number > most)
		return refuse(r, what);
	*out = (uint32_t)number;
	return true;
}

static bool take_real(struct reader *r, json_t *object, const char *key, double most, double *out)
{
	char what[96];
	const json_t *value = json_object_get(object, key);
	const double number = json_number_value(value);
	if (!value)
		return true;
	snprintf(what, sizeof(what), "\"%s\" is a number above 0, at most %g", key, most);
	if (!json_is_number(value) || !(number > 0) || number > most)
		return refuse(r, what);
	*out = study_round(number, STUDY_DIGITS);
	return true;
}

static bool is_printable(const char *text)
{
	for (; *text; text++)
		if ((unsigned char)*text < 0x20 || *text == 0x7f)
			return false;
	return true;
}

static bool take_text(struct reader *r, json_t *object, const char *key, char *out, size_t capacity)
{
	char what[96];
	const json_t *value = json_object_get(object, key);
	if (!value)
		return true;
	snprintf(what, sizeof(what), "\"%s\" is a text of at most %zu bytes without control characters", key, capacity - 1);
	const char *text = json_string_value(value);
	if (!text || json_string_length(value) >= capacity || strlen(text) != json_string_length(value) ||
	    !is_printable(text))
		return refuse(r, what);
	memcpy(out, text, strlen(text) + 1);
	return true;
}

static bool take_bool(struct reader *r, json_t *object, const char *key, bool *out)
{
	char what[64];
	const json_t *value = json_object_get(object, key);
	if (!value)
		return true;
	snprintf(what, sizeof(what), "\"%s\" is true or false", key);
	if (!json_is_boolean(value))
		return refuse(r, what);
	*out = json_is_true(value);
	return true;
}

// ---- points ----------------------------------------------------------------------------------------------------------

// Write a number as an option has it, whichever way a file wrote it: so the plan that a study keeps reads as the same.
static int put_number(char out[LIMIT_OPTION_VALUE + 1], double number)
{
	const bool whole = number == floor(number) && fabs(number) < 0x1p53;
	return snprintf(out, LIMIT_OPTION_VALUE + 1, whole ? "%.0f" : "%.10g", number + 0.0); // no -0
}

// Take one value of a setting as the text that an option has.
static bool take_value(struct reader *r, const json_t *value, char out[LIMIT_OPTION_VALUE + 1])
{
	int length = -1;
	double number;
	if (json_is_number(value))
		length = put_number(out, json_number_value(value));
	else if (json_is_string(value) && strlen(json_string_value(value)) == json_string_length(value) &&
		 cli_parse_double(json_string_value(value), &number))
		length = put_number(out, number);
	else if (json_is_string(value) && strlen(json_string_value(value)) == json_string_length(value) &&
		 is_printable(json_string_value(value)))
		length = snprintf(out, LIMIT_OPTION_VALUE + 1, "%s", json_string_value(value));
	return (length > 0 && length <= (int)LIMIT_OPTION_VALUE) ||
	       refuse(r, "a value is a number or a word of at most 31 bytes, or a list of them");
}

static bool take_samples(struct reader *r, const json_t *value, unsigned technique, uint32_t *out)
{
	if (json_is_string(value) && strcmp(json_string_value(value), "fit") == 0) {
		*out = STUDY_SAMPLES_FIT;
		return study_has_noise(technique) ||
		       refuse(r, "\"samples\": \"fit\" is for techniques whose noise more samples lower");
	}
	const json_int_t number = json_integer_value(value);
	if (!json_is_integer(value) || number < 1 || number > LIMIT_SAMPLES)
		return refuse(r, "\"samples\" is a whole number from 1 to 16777216, \"fit\", or a list of numbers");
	*out = (uint32_t)number;
	return true;
}

static size_t value_count(const json_t *value)
{
	return json_is_array(value) ? json_array_size(value) : 1;
}

static const json_t *value_at(const json_t *value, size_t index)
{
	return json_is_array(value) ? json_array_get(value, index) : value;
}

// Take a setting that is no number of samples.
static bool take_setting(struct reader *r, const char *key, const json_t *value, struct study_setting *settings,
			 uint32_t *count)
{
	if (strlen(key) > LIMIT_OPTION_NAME || !strchr(key, '.') || !is_printable(key))
		return refuse(r, "a setting is \"samples\" or the name of an option, as in --set " TECHNIQUE_OPTION_EXAMPLE);
	if (strcmp(key, TECHNIQUE_OPTION_IMPORT) == 0)
		return refuse(
		    r,
		    "a study imports no file: it measures what techniques make. candil render --set " TECHNIQUE_OPTION_IMPORT
		    "=FILE does");
	if (*count == STUDY_SETTINGS_MAX)
		return refuse(r, "a run has no room for more than 16 options");
	snprintf(settings[*count].name, sizeof(settings[*count].name), "%s", key);
	return take_value(r, value, settings[(*count)++].value);
}

// Set one cell of a grid: `number` counts through all combinations of the settings' values.
static bool take_cell(struct reader *r, json_t *settings, size_t number, struct study_point *point)
{
	const char *key;
	json_t *value;
	char place[sizeof(r->place)];
	memcpy(place, r->place, sizeof(place));
	point->setting_count = 0;
	point->samples = study_has_noise(point->technique) ? STUDY_SAMPLES_FIT : 1;
	json_object_foreach(settings, key, value)
	{
		const json_t *one = value_at(value, number % value_count(value));
		number /= value_count(value);
		snprintf(r->place, sizeof(r->place), "%.60s.%.31s", place, key);
		if (strcmp(key, "samples") == 0) {
			if (!take_samples(r, one, point->technique, &point->samples))
				return false;
			continue;
		}
		if (!take_setting(r, key, one, point->settings, &point->setting_count))
			return false;
	}
	memcpy(r->place, place, sizeof(place));
	return study_add_point(r->plan, point) || refuse(r, "more than 1024 points, or no memory: take fewer values");
}

// Spread a grid of settings over points.
static bool take_grid(struct reader *r, json_t *settings, struct study_point *point)
{
	const char *key;
	json_t *value;
	size_t cells = 1;
	if (settings && !json_is_object(settings))
		return refuse(r, "\"settings\" is an object");
	json_object_foreach(settings, key, value)
	{
		const size_t count = value_count(value);
		if (count < 1 || count > STUDY_VALUES_MAX)
			return refuse(r, "a list of \"settings\" has 1 to 64 values");
		cells *= count; // at most 64 times what was checked below
		if (cells > STUDY_POINTS_MAX)
			return refuse(r, "the lists of \"settings\" make more than 1024 points");
	}
	for (size_t i = 0; i < cells; i++)
		if (!take_cell(r, settings, i, point))
			return false;
	return true;
}

static bool take_effects(struct reader *r, struct study_point *point)
{
	struct candil_render_request request = {0};
	char list[sizeof(point->effects)];
	const char *wrong = "";
	memcpy(list, point->effects, sizeof(list));
	point->kind = point->effects[0] ? STUDY_ABLATION : STUDY_POINT;
	return value_effects(list, &request, &wrong) ||
	       refuse(r, "\"effects\" is auto, all or none, then +NAME or -NAME, between commas; candil render --help lists "
			 "the names");
}

static bool take_point(struct reader *r, json_t *object)
{
	static const char *const keys[] = {"technique", "settings", "effects", "seeds", NULL};
	struct study_point point = {0};
	char name[32] = "";
	if (!check_keys(r, object, keys) || !take_text(r, object, "technique", name, sizeof(name)))
		return false;
	const int technique = technique_number(name, strlen(name));
	if (technique <= 0 || !(technique_traits((unsigned)technique) & TECHNIQUE_RENDERS))
		return refuse(r, "\"technique\" names one that renders; candil render --help lists them");
	point.technique = (unsigned)technique;
	if (!take_whole(r, object, "seeds", 1, STUDY_SEEDS_MAX, &point.seeds) ||
	    !take_text(r, object, "effects", point.effects, sizeof(point.effects)) || !take_effects(r, &point))
		return false;
	if (!(r->techniques & 1u << technique))
		return true; // --techniques leaves it out
	return take_grid(r, json_object_get(object, "settings"), &point);
}

// ---- the rest --------------------------------------------------------------------------------------------------------

static bool take_view(struct reader *r, json_t *object, struct study_view *view)
{
	static const char *const keys[] = {"name", "camera", "relmse", "samples", NULL};
	struct candil_render_request request = {0};
	if (!check_keys(r, object, keys) || !take_text(r, object, "name", view->name, sizeof(view->name)) ||
	    !take_text(r, object, "camera", view->camera, sizeof(view->camera)) ||
	    !take_real(r, object, "relmse", 1e6, &view->relmse) ||
	    !take_whole(r, object, "samples", 1, LIMIT_SAMPLES, &view->samples))
		return false;
	return !view->camera[0] || value_camera(view->camera, &request) ||
	       refuse(r, "\"camera\" is the name of a camera, or ten numbers: ex,ey,ez,tx,ty,tz,ux,uy,uz,VFOV");
}

static bool take_views(struct reader *r, json_t *views)
{
	size_t index;
	json_t *view;
	if (!views)
		return true;
	snprintf(r->place, sizeof(r->place), "views");
	if (!json_is_array(views) || json_array_size(views) < 1 || json_array_size(views) > STUDY_VIEWS_MAX)
		return refuse(r, "a list of 1 to 32 views is needed");
	r->plan->view_count = (uint32_t)json_array_size(views);
	json_array_foreach(views, index, view)
	{
		snprintf(r->place, sizeof(r->place), "views[%zu]", index);
		r->plan->views[index] = (struct study_view){0};
		if (!take_view(r, view, &r->plan->views[index]))
			return false;
	}
	return true;
}

static bool take_size(struct reader *r, const json_t *size)
{
	const json_int_t width = json_integer_value(json_array_get(size, 0)),
			 height = json_integer_value(json_array_get(size, 1));
	if (!size)
		return true;
	snprintf(r->place, sizeof(r->place), "size");
	if (json_array_size(size) != 2 || width < 1 || height < 1 || width > LIMIT_SIDE || height > LIMIT_SIDE)
		return refuse(r, "two whole numbers of pixels from 1 to 16384 are needed: [width, height]");
	r->plan->width = (uint32_t)width;
	r->plan->height = (uint32_t)height;
	return true;
}

static bool take_reference(struct reader *r, json_t *reference)
{
	static const char *const keys[] = {"relmse", "samples", "seed", "settings", NULL};
	json_t *settings = json_object_get(reference, "settings"), *value;
	const char *key;
	double relmse = 0;
	uint32_t samples = 0, seed = 0;
	snprintf(r->place, sizeof(r->place), "reference");
	r->plan->reference = !json_is_false(reference);
	if (!reference || json_is_boolean(reference))
		return true;
	if (!check_keys(r, reference, keys) || !take_real(r, reference, "relmse", 1e6, &relmse) ||
	    !take_whole(r, reference, "samples", 1, LIMIT_SAMPLES, &samples) ||
	    !take_whole(r, reference, "seed", STUDY_SEEDS_MAX + 1, UINT32_MAX, &seed))
		return false;
	if (settings && !json_is_object(settings))
		return refuse(r, "\"settings\" is an object");
	r->plan->reference_setting_count = 0;
	json_object_foreach(settings, key, value)
	{
		if (!take_setting(r, key, value, r->plan->reference_settings, &r->plan->reference_setting_count))
			return false;
	}
	for (uint32_t i = 0; i < r->plan->view_count; i++) {
		if (relmse > 0)
			r->plan->views[i].relmse = relmse;
		if (samples > 0)
			r->plan->views[i].samples = samples;
	}
	if (seed > 0)
		r->plan->reference_seed = seed;
	return true;
}

static bool take_points(struct reader *r, json_t *points)
{
	size_t index;
	json_t *point;
	snprintf(r->place, sizeof(r->place), "points");
	if (!json_is_array(points) || json_array_size(points) < 1 || json_array_size(points) > STUDY_POINTS_MAX)
		return refuse(r, "a list of 1 to 1024 points is needed");
	json_array_foreach(points, index, point)
	{
		snprintf(r->place, sizeof(r->place), "points[%zu]", index);
		if (!take_point(r, point))
			return false;
	}
	snprintf(r->place, sizeof(r->place), "points");
	return r->plan->point_count > 0 || refuse(r, "none is of a technique that --techniques names");
}

static bool take_all(struct reader *r, json_t *file)
{
	// "experiment" is for the programs that run a plan: which scenes, and the figures of others to put beside.
	static const char *const keys[] = {"title",    "size",   "views",      "seeds",     "repeats",
					   "budget",   "points", "ablations",  "reference", "planned",
					   "left_out", "key",    "experiment", NULL};
	struct study_plan *p = r->plan;
	snprintf(r->place, sizeof(r->place), "top");
	if (!check_keys(r, file, keys) || !take_text(r, file, "title", p->title, sizeof(p->title)) ||
	    !take_text(r, file, "key", p->key, sizeof(p->key)) ||
	    !take_whole(r, file, "seeds", 1, STUDY_SEEDS_MAX, &p->seeds) ||
	    !take_whole(r, file, "repeats", 1, STUDY_SEEDS_MAX, &p->repeats) ||
	    !take_real(r, file, "budget", STUDY_BUDGET_MAX, &p->budget_s) ||
	    !take_whole(r, file, "left_out", 0, STUDY_POINTS_MAX, &p->left_out) ||
	    !take_real(r, file, "planned", 1e12, &p->planned_s) || !take_bool(r, file, "ablations", &p->ablations))
		return false;
	return take_size(r, json_object_get(file, "size")) && take_views(r, json_object_get(file, "views")) &&
	       take_reference(r, json_object_get(file, "reference")) && take_points(r, json_object_get(file, "points"));
}

candil_status study_plan_read(const char *path, unsigned techniques, struct study_plan *plan, struct candil_error *error)
{
	struct reader r = {.plan = plan, .techniques = techniques, .error = error};
	struct stat about;
	json_error_t wrong;
	if (stat(path, &about) != 0)
		return error_set(error, CANDIL_STATUS_BAD_ARGUMENT, "cannot read the plan %.150s: %s", path,
				 strerror(errno));
	if (!S_ISREG(about.st_mode) || about.st_size > (off_t)STUDY_PLAN_BYTES)
		return error_set(error, CANDIL_STATUS_BAD_ARGUMENT, "the plan %.150s is no file of at most 1 MiB", path);
	json_t *file = json_load_file(path, JSON_REJECT_DUPLICATES, &wrong);
	if (!file)
		return error_set(error, CANDIL_STATUS_BAD_ARGUMENT, "the plan %.100s is no JSON, line %d: %.100s", path,
				 wrong.line, wrong.text);
	const bool good = take_all(&r, file);
	json_decref(file);
	return good ? CANDIL_STATUS_OK : CANDIL_STATUS_BAD_ARGUMENT;
}

// ---- out -------------------------------------------------------------------------------------------------------------

static void put_settings(json_t *o, const struct study_setting *settings, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		const struct study_setting *s = &settings[i];
		double number;
		const bool is_number = cli_parse_double(s->value, &number);
		const bool whole = is_number && number == floor(number) && fabs(number) < 0x1p53;
		json_object_set_new(o, s->name,
				    whole       ? json_integer((json_int_t)number)
				    : is_number ? json_real(number)
						: cli_json_text(s->value));
	}
}

json_t *study_settings_json(uint32_t samples, const struct study_setting *settings, uint32_t count)
{
	json_t *o = json_object();
	json_object_set_new(o, "samples", samples == STUDY_SAMPLES_FIT ? json_string("fit") : cli_json_u64(samples));
	put_settings(o, settings, count);
	return o;
}

static json_t *reference_json(const struct study_plan *plan)
{
	json_t *settings = json_object();
	put_settings(settings, plan->reference_settings, plan->reference_setting_count);
	return json_pack("{s:o,s:o}", "seed", cli_json_u64(plan->reference_seed), "settings", settings);
}

json_t *study_plan_json(const struct study_plan *plan)
{
	json_t *views = json_array(), *points = json_array();
	for (uint32_t i = 0; i < plan->view_count; i++) {
		const struct study_view *v = &plan->views[i];
		json_t *view = json_pack("{s:o}", "name", cli_json_text(v->name));
		if (v->camera[0])
			json_object_set_new(view, "camera", cli_json_text(v->camera));
		if (v->relmse > 0)
			json_object_set_new(view, "relmse", json_real(v->relmse));
		if (v->samples > 0)
			json_object_set_new(view, "samples", cli_json_u64(v->samples));
		json_array_append_new(views, view);
	}
	for (uint32_t i = 0; i < plan->point_count; i++) {
		const struct study_point *p = &plan->points[i];
		json_t *point = json_pack("{s:s,s:o}", "technique", technique_name(p->technique), "settings",
					  study_settings_json(p->samples, p->settings, p->setting_count));
		if (p->effects[0])
			json_object_set_new(point, "effects", cli_json_text(p->effects));
		if (p->seeds > 0)
			json_object_set_new(point, "seeds", cli_json_u64(p->seeds));
		json_array_append_new(points, point);
	}
	json_t *o =
	    json_pack("{s:o,s:s,s:[o,o],s:o,s:o,s:o,s:f,s:o,s:o}", "title", cli_json_text(plan->title), "key", plan->key,
		      "size", cli_json_u64(plan->width), cli_json_u64(plan->height), "views", views, "seeds",
		      cli_json_u64(plan->seeds), "repeats", cli_json_u64(plan->repeats), "budget", plan->budget_s,
		      "reference", plan->reference ? reference_json(plan) : json_false(), "points", points);
	if (o && plan->left_out > 0)
		json_object_set_new(o, "left_out", cli_json_u64(plan->left_out));
	if (o && plan->planned_s > 0)
		json_object_set_new(o, "planned", json_real(plan->planned_s));
	return o;
}
