#include "clients/cli/edit_options.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/angles.h"
#include "protocol/names.h"

#define NUMBERS_MAX 4u

// "key=1,2,3"
struct pair {
	const char *key;
	double v[NUMBERS_MAX];
	size_t count;
};

// Cut the next pair off "key=1,2,key=3". false: what is there is no pair.
static bool next_pair(char **text, struct pair *pair)
{
	char *equals = strchr(*text, '=');
	if (!equals)
		return false;
	*equals = '\0';
	pair->key = *text;
	pair->count = 0;
	char *at = equals + 1;
	do {
		char number[32];
		const size_t length = strcspn(at, ",");
		if (length == 0 || length >= sizeof(number) || pair->count == NUMBERS_MAX)
			return false;
		memcpy(number, at, length);
		number[length] = '\0';
		if (!cli_parse_double(number, &pair->v[pair->count++]))
			return false;
		at += length;
		at += *at == ',';
	} while (*at && !isalpha((unsigned char)*at));
	*text = at;
	return true;
}

// Cut "NAME:key=…" at the last colon before the first '='. Returns what is behind the colon. NULL: there is no such colon,
// or no name before it.
static char *cut_name(char *text)
{
	char *equals = strchr(text, '='), *colon = NULL;
	for (char *at = text; equals && at < equals; at++)
		if (*at == ':')
			colon = at;
	if (!colon || colon == text)
		return NULL;
	*colon = '\0';
	return colon + 1;
}

// Three numbers; with `grey` also one number, which counts for all three.
static bool take_vector(const struct pair *pair, bool grey, struct candil_vec3 *out)
{
	if (pair->count != 3 && !(grey && pair->count == 1))
		return false;
	const bool one = pair->count == 1;
	*out = (struct candil_vec3){pair->v[0], pair->v[one ? 0 : 1], pair->v[one ? 0 : 2]};
	return true;
}

static bool take_number(const struct pair *pair, double *out)
{
	*out = pair->v[0];
	return pair->count == 1;
}

// ---- lights ----------------------------------------------------------------------------------------------------------

struct light_text {
	struct candil_vec3 at, to, direction, intensity;
	bool has_at, has_to, has_direction, has_intensity, has_cone, has_angle, has_range;
	double inner, outer, angle, range;
};

static bool take_light_pair(const struct pair *pair, struct light_text *t)
{
	if (strcmp(pair->key, "at") == 0)
		return (t->has_at = take_vector(pair, false, &t->at));
	if (strcmp(pair->key, "to") == 0)
		return (t->has_to = take_vector(pair, false, &t->to));
	if (strcmp(pair->key, "direction") == 0)
		return (t->has_direction = take_vector(pair, false, &t->direction));
	if (strcmp(pair->key, "intensity") == 0)
		return (t->has_intensity = take_vector(pair, true, &t->intensity));
	if (strcmp(pair->key, "angle") == 0)
		return (t->has_angle = take_number(pair, &t->angle));
	if (strcmp(pair->key, "range") == 0)
		return (t->has_range = take_number(pair, &t->range));
	t->inner = pair->v[0];
	t->outer = pair->count > 1 ? pair->v[1] : 0;
	t->has_cone = true;
	return strcmp(pair->key, "cone") == 0 && pair->count == 2;
}

// Whether a light of this kind has every key that it needs and no other.
static bool light_fits(unsigned kind, const struct light_text *t)
{
	const unsigned traits = light_kind_traits(kind);
	const bool place = traits & LIGHT_HAS_PLACE, direction = traits & LIGHT_HAS_DIRECTION;
	const bool cone = traits & LIGHT_HAS_CONE, disc = traits & LIGHT_HAS_DISC;
	return t->has_intensity && t->has_at == place && t->has_cone == cone && (disc || !t->has_angle) &&
	       t->has_to + t->has_direction == direction && (place || (!t->has_to && !t->has_range));
}

static bool take_light(char *text, struct edit_options *o)
{
#define KIND_NAME(NAME, number, name, ...) name,
	static const char *const kinds[] = {CANDIL_LIGHT_KIND_LIST(KIND_NAME)};
	struct light_text t = {0};
	struct pair pair;
	char *rest = cut_name(text);
	unsigned kind = 0;
	while (kind < LIGHT_KIND_COUNT && rest && strcmp(text, kinds[kind]) != 0)
		kind++;
	o->full = o->edits.light_count == LIMIT_EDIT_LIGHTS;
	if (!rest || kind == LIGHT_KIND_COUNT || o->full)
		return false;
	while (*rest)
		if (!next_pair(&rest, &pair) || !take_light_pair(&pair, &t))
			return false;
	if (!light_fits(kind, &t))
		return false;
	if (t.has_to)
		t.direction = (struct candil_vec3){t.to.x - t.at.x, t.to.y - t.at.y, t.to.z - t.at.z};
	o->lights[o->edits.light_count++] = (struct candil_light){.kind = (enum candil_light_kind)kind,
								  .position = t.at,
								  .direction = t.direction,
								  .intensity = t.intensity,
								  .inner_degrees = t.inner,
								  .outer_degrees = t.outer,
								  .angle_degrees = t.angle,
								  .range = t.range};
	return true;
}

// ---- materials and nodes ---------------------------------------------------------------------------------------------

static bool take_material_pair(const struct pair *pair, struct candil_material_edit *m)
{
	if (strcmp(pair->key, "color") == 0)
		return (m->has_base_color = take_vector(pair, true, &m->base_color));
	if (strcmp(pair->key, "emission") == 0)
		return (m->has_emission = take_vector(pair, true, &m->emission));
	if (strcmp(pair->key, "specular") == 0)
		return (m->has_specular = take_vector(pair, true, &m->specular));
#define TAKE_SHARE(field, name) \
	if (strcmp(pair->key, name) == 0) \
		return (m->has_##field = take_number(pair, &m->field));
	CANDIL_MATERIAL_SHARES(TAKE_SHARE)
	return false;
}

static bool take_material(char *text, struct edit_options *o)
{
	struct candil_material_edit *m = &o->materials[o->edits.material_count];
	struct pair pair;
	char *rest = cut_name(text);
	o->full = o->edits.material_count == LIMIT_EDIT_MATERIALS;
	if (!rest || o->full)
		return false;
	*m = (struct candil_material_edit){.name = text};
	while (*rest)
		if (!next_pair(&rest, &pair) || !take_material_pair(&pair, m))
			return false;
	o->edits.material_count++;
	return true;
}

// Make a quaternion of an axis and an angle in degrees.
static bool take_rotation(const struct pair *pair, double out[4])
{
	const double length = sqrt(pair->v[0] * pair->v[0] + pair->v[1] * pair->v[1] + pair->v[2] * pair->v[2]);
	const double half = angles_radians(0.5 * pair->v[3]);
	if (pair->count != 4 || !(length > 0) || !isfinite(length))
		return false;
	for (int i = 0; i < 3; i++)
		out[i] = pair->v[i] / length * sin(half);
	out[3] = cos(half);
	return true;
}

static bool take_node_pair(const struct pair *pair, struct candil_node_edit *n)
{
	if (strcmp(pair->key, "translate") == 0)
		return (n->has_translation = take_vector(pair, false, &n->translation));
	if (strcmp(pair->key, "rotate") == 0)
		return (n->has_rotation = take_rotation(pair, n->rotation));
	return strcmp(pair->key, "scale") == 0 && (n->has_scale = take_vector(pair, true, &n->scale));
}

static bool take_node(char *text, struct edit_options *o)
{
	struct candil_node_edit *n = &o->nodes[o->edits.node_count];
	struct pair pair;
	char *rest = cut_name(text);
	o->full = o->edits.node_count == LIMIT_EDIT_NODES;
	if (!rest || o->full)
		return false;
	*n = (struct candil_node_edit){.name = text};
	while (*rest)
		if (!next_pair(&rest, &pair) || !take_node_pair(&pair, n))
			return false;
	o->edits.node_count++;
	return true;
}

// ---- all of them -----------------------------------------------------------------------------------------------------

void edit_options_init(struct edit_options *o)
{
	memset(o, 0, sizeof(*o));
	o->edits.lights = o->lights;
	o->edits.materials = o->materials;
	o->edits.nodes = o->nodes;
}

bool edit_is_option(int option)
{
	return option >= OPTION_LIGHT && option <= OPTION_AT;
}

bool edit_option(int option, char *value, struct edit_options *o)
{
	o->given = true;
	switch (option) {
	case OPTION_LIGHT:
		return take_light(value, o);
	case OPTION_REPLACE_LIGHTS:
		o->edits.replace_lights = true;
		return true;
	case OPTION_MATERIAL:
		return take_material(value, o);
	case OPTION_NODE:
		return take_node(value, o);
	case OPTION_ANIMATION:
		o->edits.animation = value;
		return *value != '\0';
	case OPTION_AT:
		o->at = true;
		return cli_parse_double(value, &o->edits.time_s);
	default:
		return false;
	}
}

const char *edit_option_form(int option)
{
	switch (option) {
	case OPTION_LIGHT:
		return "{lights}, up to 32 times";
	case OPTION_MATERIAL:
		return "NAME: (or #N: where a name has an equals sign) and then color, emission, specular (=r,g,b or =v), "
		       "{shares} (=v) between commas, up to 32 times";
	case OPTION_NODE:
		return "NAME: (or #N: where a name has an equals sign) and then translate=x,y,z, rotate=x,y,z,DEGREES or "
		       "scale=x,y,z between commas, up to 32 times";
	case OPTION_ANIMATION:
		return "the name of an animation";
	default:
		return "something else";
	}
}
