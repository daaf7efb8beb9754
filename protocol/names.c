#include "protocol/names.h"

#include <stdio.h>
#include <string.h>

#include "candil.pb.h"
#include "protocol/limits.h"

#define SAME_TECHNIQUE(NAME, number, ...) \
	_Static_assert((int)candil_Technique_TECHNIQUE_##NAME == (number), "candil.proto has another number");
CANDIL_TECHNIQUE_LIST(SAME_TECHNIQUE)
_Static_assert((int)TECHNIQUE_COUNT == (int)_candil_Technique_ARRAYSIZE, "candil.proto has other techniques");

#define SAME_EFFECT(NAME, number, ...) \
	_Static_assert((int)candil_Effect_EFFECT_##NAME == (number), "candil.proto has another number");
CANDIL_EFFECT_LIST(SAME_EFFECT)
_Static_assert((int)EFFECT_COUNT == (int)_candil_Effect_ARRAYSIZE, "candil.proto has other effects");
_Static_assert(EFFECT_COUNT <= LIMIT_EFFECTS, "an effect is a bit, and a report in Accepted");

struct technique_row {
	const char *name;
	unsigned traits;
};

#define TECHNIQUE_ROW(NAME, number, name, traits) [number] = {name, traits},
static const struct technique_row techniques[TECHNIQUE_COUNT] = {CANDIL_TECHNIQUE_LIST(TECHNIQUE_ROW)};

#define EFFECT_ROW(NAME, number, name, simulated, absent, substitute) [number] = {name, simulated, absent, substitute},
static const struct effect_words effects[EFFECT_COUNT] = {CANDIL_EFFECT_LIST(EFFECT_ROW)};

const char *technique_name(unsigned technique)
{
	return technique < TECHNIQUE_COUNT ? techniques[technique].name : "unknown";
}

const char *effect_name(unsigned effect)
{
	return effect < EFFECT_COUNT ? effects[effect].name : "unknown";
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

void technique_list(unsigned traits, const char *last, char *out, size_t capacity)
{
	unsigned left = 0;
	for (unsigned i = 0; i < TECHNIQUE_COUNT; i++)
		left += (techniques[i].traits & traits) == traits;
	size_t used = 0;
	out[0] = '\0';
	for (unsigned i = 0; i < TECHNIQUE_COUNT && used < capacity; i++) {
		if ((techniques[i].traits & traits) != traits)
			continue;
		const int n = snprintf(out + used, capacity - used, "%s", techniques[i].name);
		used += n > 0 ? (size_t)n : 0;
		if (--left == 0 || used >= capacity)
			break;
		const int m = left > 1 ? snprintf(out + used, capacity - used, ", ")
				       : snprintf(out + used, capacity - used, " %s ", last);
		used += m > 0 ? (size_t)m : 0;
	}
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
	static const struct effect_words none = {"", "", "", ""};
	return effect < EFFECT_COUNT ? &effects[effect] : &none;
}
