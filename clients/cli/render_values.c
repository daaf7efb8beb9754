#include "clients/cli/render_values.h"

#include <string.h>

#include "clients/cli/cli.h"
#include "protocol/names.h"

#define ALL_EFFECTS ((1u << CANDIL_EFFECT_COUNT) - 1u)

bool value_size(const char *text, struct candil_render_request *r)
{
	return cli_parse_pair(text, 'x', &r->width, &r->height) && r->width > 0 && r->height > 0;
}

bool value_camera(const char *text, struct candil_render_request *r)
{
	double v[10];
	r->has_camera = cli_parse_doubles(text, v, 10);
	r->camera_name = r->has_camera ? NULL : text;
	if (r->has_camera) {
		r->eye = (struct candil_vec3){v[0], v[1], v[2]};
		r->target = (struct candil_vec3){v[3], v[4], v[5]};
		r->up = (struct candil_vec3){v[6], v[7], v[8]};
		r->vfov_degrees = v[9];
	}
	return r->has_camera || (*text != '\0' && !strchr(text, ','));
}

bool value_background(const char *text, struct candil_render_request *r)
{
	double v[3];
	r->has_background = cli_parse_doubles(text, v, 3);
	r->environment = r->has_background ? NULL : text;
	if (r->has_background)
		r->background = (struct candil_vec3){v[0], v[1], v[2]};
	// A text that looks like numbers, or like a list that begins with one, was meant as a colour.
	const size_t numbers = strspn(text, "0123456789.,+-eE ");
	const bool list = strchr(text, ',') && strspn(text, "0123456789+-") > 0;
	return r->has_background || (text[numbers] != '\0' && !list);
}

// Cut the next word off a list with commas. NULL: the list has ended.
static char *next_word(char **list)
{
	char *word;
	while ((word = strsep(list, ",")) && *word == '\0')
		;
	return word;
}

static bool parse_effect(const char *word, struct candil_render_request *r)
{
	const bool off = word[0] == '-';
	const char *name = off || word[0] == '+' ? word + 1 : word;
	for (unsigned i = 0; i < CANDIL_EFFECT_COUNT; i++) {
		if (strcmp(name, candil_effect_name((enum candil_effect)i)) != 0)
			continue;
		uint32_t bit = 1u << i;
		r->effects_on = off ? r->effects_on & ~bit : r->effects_on | bit;
		r->effects_off = off ? r->effects_off | bit : r->effects_off & ~bit;
		return true;
	}
	return false;
}

bool value_effects(char *list, struct candil_render_request *r, const char **wrong)
{
	char *word;
	while ((word = next_word(&list))) {
		if (strcmp(word, "auto") == 0) {
			r->effects_on = r->effects_off = 0;
		} else if (strcmp(word, "all") == 0) {
			r->effects_on = ALL_EFFECTS;
			r->effects_off = 0;
		} else if (strcmp(word, "none") == 0) {
			r->effects_on = 0;
			r->effects_off = ALL_EFFECTS;
		} else if (!parse_effect(word, r)) {
			*wrong = word;
			return false;
		}
	}
	return true;
}

bool value_aovs(char *list, struct candil_render_request *r, const char **wrong)
{
	static const char *const names[] = {"depth", "normal", "albedo", "id"};
	char *word;
	while ((word = next_word(&list))) {
		unsigned i = 0;
		while (i < 4 && strcmp(word, names[i]) != 0)
			i++;
		if (i == 4) {
			*wrong = word;
			return false;
		}
		r->aovs |= 1u << i;
	}
	return true;
}

bool value_technique(const char *text, struct candil_render_request *r)
{
	const int number = technique_number(text, strlen(text));
	if (number >= 0)
		r->technique = (enum candil_technique)number;
	return number >= 0;
}

bool value_view(const char *text, struct candil_render_request *r)
{
	for (int i = CANDIL_VIEW_NONE; i <= CANDIL_VIEW_FILMIC; i++) {
		if (strcmp(text, candil_view_name((enum candil_view)i)) == 0) {
			r->view = (enum candil_view)i;
			return true;
		}
	}
	return false;
}

bool value_filter(const char *text, struct candil_render_request *r)
{
	static const char *const names[] = {"box", "gauss", "bh"};
	for (int i = CANDIL_FILTER_BOX; i <= CANDIL_FILTER_BLACKMAN_HARRIS; i++) {
		if (strcmp(text, names[i]) == 0) {
			r->filter = (enum candil_filter)i;
			return true;
		}
	}
	return false;
}

bool value_lens(const char *text, struct candil_lens *lens)
{
	double v[2];
	if (!cli_parse_doubles(text, v, 2))
		return false;
	lens->radius = v[0];
	lens->focus = v[1];
	return v[0] > 0 && v[1] > 0;
}

bool value_orthographic(const char *text, struct candil_lens *lens)
{
	lens->projection = CANDIL_PROJECTION_ORTHOGRAPHIC;
	return cli_parse_double(text, &lens->height) && lens->height > 0;
}
