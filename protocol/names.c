#include "protocol/names.h"

#include <stdio.h>
#include <string.h>

#include "candil.pb.h"
#include "protocol/limits.h"
#include "shaders/shared/layout.h"

#define SAME_TECHNIQUE(NAME, number, ...) \
	_Static_assert((int)candil_Technique_TECHNIQUE_##NAME == (number), "candil.proto has another number");
CANDIL_TECHNIQUE_LIST(SAME_TECHNIQUE)
_Static_assert((int)TECHNIQUE_COUNT == (int)_candil_Technique_ARRAYSIZE, "candil.proto has other techniques");

#define SAME_EFFECT(NAME, number, ...) \
	_Static_assert((int)candil_Effect_EFFECT_##NAME == (number), "candil.proto has another number");
CANDIL_EFFECT_LIST(SAME_EFFECT)
_Static_assert((int)EFFECT_COUNT == (int)_candil_Effect_ARRAYSIZE, "candil.proto has other effects");
// What is said of an effect fits a report.
#define WHOLE_WORDS(NAME, number, name, simulated, absent, inert, substitute) \
	_Static_assert(sizeof(simulated) <= sizeof((candil_EffectReport){0}.why) && \
			   sizeof(absent) <= sizeof((candil_EffectReport){0}.why) && \
			   sizeof(inert) <= sizeof((candil_EffectReport){0}.why) && \
			   sizeof(substitute) <= sizeof((candil_EffectReport){0}.why), \
		       "a sentence is too long for EffectReport.why");
CANDIL_EFFECT_LIST(WHOLE_WORDS)
_Static_assert(EFFECT_COUNT <= LIMIT_EFFECTS && EFFECT_COUNT < 32, "an effect is a bit, and a report in Accepted");

#define SAME_ERROR_KIND(NAME, number, ...) \
	_Static_assert((int)candil_ErrorKind_ERROR_KIND_##NAME == (number), "candil.proto has another number");
CANDIL_ERROR_KIND_LIST(SAME_ERROR_KIND)
_Static_assert((int)ERROR_KIND_COUNT == (int)_candil_ErrorKind_ARRAYSIZE, "candil.proto has other kinds of errors");

// Shaders and the scene blob have the same numbers.
#define SAME_LIGHT_KIND(NAME, number, ...) \
	_Static_assert((int)candil_LightKind_LIGHT_KIND_##NAME == (number), "candil.proto has another number"); \
	_Static_assert(LIGHT_##NAME == (number), "layout.h has another number");
CANDIL_LIGHT_KIND_LIST(SAME_LIGHT_KIND)
_Static_assert((int)LIGHT_KIND_COUNT == (int)_candil_LightKind_ARRAYSIZE, "candil.proto has other kinds of lights");

struct technique_row {
	const char *name;
	unsigned traits;
	unsigned options;
};

#define TECHNIQUE_ROW(NAME, number, name, traits, options) [number] = {name, traits, options},
static const struct technique_row techniques[TECHNIQUE_COUNT] = {CANDIL_TECHNIQUE_LIST(TECHNIQUE_ROW)};

#define EFFECT_ROW(NAME, number, name, simulated, absent, inert, substitute) \
	[number] = {name, simulated, absent, inert, substitute},
static const struct effect_words effects[EFFECT_COUNT] = {CANDIL_EFFECT_LIST(EFFECT_ROW)};

const char *technique_name(unsigned technique)
{
	return technique < TECHNIQUE_COUNT ? techniques[technique].name : "unknown";
}

const char *effect_name(unsigned effect)
{
	return effect < EFFECT_COUNT ? effects[effect].name : "unknown";
}

const char *error_kind_name(unsigned kind)
{
#define ERROR_KIND_ROW(NAME, number, name) [number] = (name),
	static const char *const names[ERROR_KIND_COUNT] = {CANDIL_ERROR_KIND_LIST(ERROR_KIND_ROW)};
	return kind < ERROR_KIND_COUNT ? names[kind] : "unknown";
}

unsigned error_kind_of_both(unsigned a, unsigned b)
{
	if (a == candil_ErrorKind_ERROR_KIND_UNKNOWN || b == candil_ErrorKind_ERROR_KIND_UNKNOWN)
		return candil_ErrorKind_ERROR_KIND_UNKNOWN;
	return a == b ? a : candil_ErrorKind_ERROR_KIND_PREDICTED;
}

bool format_is_picture(unsigned format)
{
	return format <= candil_Format_FORMAT_PNG;
}

const char *format_name(unsigned format)
{
	static const char *const names[_candil_Format_ARRAYSIZE] = {"exr-half", "exr-float", "png", "ply", "mtx"};
	return format < _candil_Format_ARRAYSIZE ? names[format] : "unknown";
}

int technique_number(const char *name, size_t length)
{
	for (unsigned i = 0; i < TECHNIQUE_COUNT; i++)
		if (strlen(techniques[i].name) == length && !memcmp(techniques[i].name, name, length))
			return (int)i;
	return -1;
}

unsigned technique_traits(unsigned technique)
{
	if (technique == (unsigned)candil_Technique_TECHNIQUE_AUTO)
		technique = TECHNIQUE_OF_AUTO;
	return technique < TECHNIQUE_COUNT ? techniques[technique].traits : 0;
}

bool technique_takes(unsigned technique, const char *option)
{
	const int of = technique_number(option, strcspn(option, "."));
	return of >= 0 && technique < TECHNIQUE_COUNT && techniques[technique].options >> of & 1u;
}

void names_list(const char *const *names, size_t count, const char *last, char *out, size_t capacity)
{
	size_t used = 0;
	out[0] = '\0';
	for (size_t i = 0; i < count && used < capacity; i++) {
		const int n = i == 0          ? snprintf(out, capacity, "%s", names[i])
			      : i < count - 1 ? snprintf(out + used, capacity - used, ", %s", names[i])
					      : snprintf(out + used, capacity - used, " %s %s", last, names[i]);
		used += n > 0 ? (size_t)n : 0;
	}
}

void technique_list(unsigned traits, const char *last, char *out, size_t capacity)
{
	const char *names[TECHNIQUE_COUNT];
	size_t count = 0;
	for (unsigned i = 0; i < TECHNIQUE_COUNT; i++)
		if ((techniques[i].traits & traits) == traits)
			names[count++] = techniques[i].name;
	names_list(names, count, last, out, capacity);
}

int technique_with(unsigned traits)
{
	for (unsigned i = 0; i < TECHNIQUE_COUNT; i++)
		if ((techniques[i].traits & traits) == traits)
			return (int)i;
	return -1;
}

const struct effect_words *effect_words(unsigned effect)
{
	static const struct effect_words none = {"", "", "", "", ""};
	return effect < EFFECT_COUNT ? &effects[effect] : &none;
}

#define LIGHT_TRAITS(NAME, number, name, traits, ...) [number] = traits,
static const unsigned light_traits[LIGHT_KIND_COUNT] = {CANDIL_LIGHT_KIND_LIST(LIGHT_TRAITS)};

unsigned light_kind_traits(unsigned kind)
{
	return kind < LIGHT_KIND_COUNT ? light_traits[kind] : 0;
}

void light_kind_list(unsigned traits, const char *last, char *out, size_t capacity)
{
#define LIGHT_CALLED(NAME, number, name, traits, called, ...) [number] = called,
	static const char *const called[LIGHT_KIND_COUNT] = {CANDIL_LIGHT_KIND_LIST(LIGHT_CALLED)};
	const char *names[LIGHT_KIND_COUNT];
	size_t count = 0;
	for (unsigned i = 0; i < LIGHT_KIND_COUNT; i++)
		if ((light_traits[i] & traits) == traits)
			names[count++] = called[i];
	names_list(names, count, last, out, capacity);
}
