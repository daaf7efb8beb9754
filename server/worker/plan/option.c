#include "server/worker/plan/option.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct option_rule *option_find(const struct option_table *tables, const char *name, size_t *offset)
{
	for (; tables->rules; tables++)
		for (size_t i = 0; i < tables->count; i++)
			if (!strcmp(tables->rules[i].name, name)) {
				*offset = tables->offset + tables->rules[i].offset;
				return &tables->rules[i];
			}
	return NULL;
}

bool option_known(const struct option_table *tables, const char *name)
{
	size_t offset;
	return option_find(tables, name, &offset) != NULL;
}

static enum status option_word(const struct option_rule *rule, const char *text, uint32_t *value, struct error *err)
{
	char known[96] = "";
	for (uint32_t i = 0; rule->words[i]; i++) {
		if (!strcmp(rule->words[i], text)) {
			*value = rule->numbers ? rule->numbers[i] : i;
			return STATUS_OK;
		}
		snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? ", " : "", rule->words[i]);
	}
	return error_set(err, STATUS_BAD_ARGUMENT, "option %s is one of %s, not '%s'", rule->name, known, text);
}

static enum status option_whole(const struct option_rule *rule, const char *text, uint32_t *value, struct error *err)
{
	char *end;
	const unsigned long v = strtoul(text, &end, 10); // ULONG_MAX where it is larger
	const bool whole = text[0] >= '0' && text[0] <= '9' && !*end;
	if (!whole || (double)v < rule->least || (double)v > rule->most)
		return error_set(err, whole && (double)v > rule->most ? STATUS_LIMIT : STATUS_BAD_ARGUMENT,
				 "option %s takes a whole number from %.0f to %.0f, not '%s'", rule->name, rule->least,
				 rule->most, text);
	*value = (uint32_t)v;
	return STATUS_OK;
}

static enum status option_real(const struct option_rule *rule, const char *text, float *value, struct error *err)
{
	char *end;
	const double v = strtod(text, &end);
	if (text[0] == '\0' || *end || !(v >= rule->least && v <= rule->most))
		return error_set(err, STATUS_BAD_ARGUMENT, "option %s takes a number from %g to %g, not '%s'", rule->name,
				 rule->least, rule->most, text);
	*value = (float)v;
	return STATUS_OK;
}

enum status option_set(const struct option_table *tables, const candil_Option *option, void *settings, struct error *err)
{
	size_t offset;
	const struct option_rule *rule = option_find(tables, option->name, &offset);
	uint32_t whole = 0;
	float real = 0;
	if (!rule)
		return error_set(err, STATUS_INTERNAL, "there is no option '%s'", option->name);
	const enum status s = rule->real    ? option_real(rule, option->value, &real, err)
			      : rule->words ? option_word(rule, option->value, &whole, err)
					    : option_whole(rule, option->value, &whole, err);
	if (s == STATUS_OK)
		memcpy((char *)settings + offset, rule->real ? (const void *)&real : &whole, sizeof whole);
	return s;
}

void option_list(const struct option_table *tables, const char *prefix, size_t skip, char *out, size_t capacity)
{
	for (; tables->rules; tables++)
		for (size_t i = 0; i < tables->count; i++) {
			const size_t used = strlen(out);
			if (!strncmp(tables->rules[i].name, prefix, skip))
				snprintf(out + used, capacity - used, "%s%s", used ? ", " : "",
					 tables->rules[i].name + skip);
		}
}
