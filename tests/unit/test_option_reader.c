// The reader of options: every kind of value, at its ends and beyond them, and the sentences that say what is known.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "protocol/names.h"
#include "server/worker/plan/make.h"
#include "server/worker/plan/option.h"
#include "server/worker/technique/technique.h"

struct own {
	uint32_t count, way, side;
	float size;
};

struct settings {
	uint32_t before;
	struct own own;
};

static const char *const ways[] = {"near", "far", NULL};
static const char *const side_words[] = {"16", "32", NULL};
static const uint32_t sides[] = {16, 32};

static const struct option_rule rules[] = {
    OPTION_WHOLE("a.count", 1, 4096, struct own, count),
    OPTION_WORD("a.way", ways, struct own, way),
    OPTION_NUMBER("a.side", side_words, sides, struct own, side),
    OPTION_REAL("a.size", 0.5, 2, struct own, size),
};
static const struct option_table tables[] = {{rules, 4, offsetof(struct settings, own)}, {0}};

static struct settings settings;
static struct error err;

static enum status set(const char *name, const char *value)
{
	candil_Option option = candil_Option_init_zero;
	snprintf(option.name, sizeof option.name, "%s", name);
	snprintf(option.value, sizeof option.value, "%s", value);
	return option_set(tables, &option, &settings, &err);
}

static void values_reach_their_fields(void **state)
{
	(void)state;
	assert_int_equal(set("a.count", "4096"), STATUS_OK);
	assert_int_equal(set("a.way", "far"), STATUS_OK);
	assert_int_equal(set("a.side", "32"), STATUS_OK);
	assert_int_equal(set("a.size", "0.5"), STATUS_OK);
	assert_int_equal(settings.before, 0);
	assert_int_equal(settings.own.count, 4096);
	assert_int_equal(settings.own.way, 1);
	assert_int_equal(settings.own.side, 32);
	assert_true(settings.own.size == 0.5f);
}

static void what_is_no_value_is_refused(void **state)
{
	(void)state;
	static const char *const wrong[][2] = {{"a.count", "0"},   {"a.count", "-1"},  {"a.count", "8x"}, {"a.count", ""},
					       {"a.count", " 8"},  {"a.way", "near "}, {"a.way", ""},     {"a.side", "24"},
					       {"a.size", "0.49"}, {"a.size", "2.01"}, {"a.size", "nan"}, {"a.size", "inf"},
					       {"a.size", ""},     {"a.size", "1m"}};
	const struct settings before = settings;
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
		assert_int_equal(set(wrong[i][0], wrong[i][1]), STATUS_BAD_ARGUMENT);
	assert_int_equal(set("a.count", "4097"), STATUS_LIMIT);
	assert_int_equal(set("a.count", "99999999999999999999"), STATUS_LIMIT);
	assert_memory_equal(&before, &settings, sizeof before);
	set("a.way", "up");
	assert_non_null(strstr(err.text, "near, far"));
}

static void names_are_told(void **state)
{
	(void)state;
	char text[64] = "";
	assert_true(option_known(tables, "a.side"));
	assert_false(option_known(tables, "a.sid"));
	assert_false(option_known(tables, "side"));
	option_list(tables, "a.none", 2, text, sizeof text);
	assert_string_equal(text, "count, way, side, size");
	text[0] = '\0';
	option_list(tables, "b.none", 2, text, sizeof text);
	assert_string_equal(text, "");
	char brief[10] = "";
	option_list(tables, "a.", 2, brief, sizeof brief);
	assert_string_equal(brief, "count, wa");
}

// Every technique: defaults that it would itself take, and options of its own name or of what it stands on.
static void techniques_have_what_the_seam_asks_for(void **state)
{
	(void)state;
	assert_true(technique_count() > 0);
	for (uint32_t i = 0; i < technique_count(); i++) {
		const struct technique *t = technique_at(i);
		assert_ptr_equal(technique_find(t->number), t);
		assert_non_null(t->options);
		assert_non_null(t->defaults);
		assert_non_null(t->depth);
		assert_true(t->bytes && t->begin && t->step && t->read && t->end);
		struct plan plan = {.technique = t->number};
		t->defaults(&plan.settings);
		assert_true(t->depth(&plan) >= 1);
		if (t->check)
			assert_int_equal(t->check(&plan, &err), STATUS_OK);
	}
	assert_null(technique_find((candil_Technique)TECHNIQUE_COUNT));
	assert_non_null(technique_find(candil_Technique_TECHNIQUE_AUTO));
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(values_reach_their_fields),
					   cmocka_unit_test(what_is_no_value_is_refused), cmocka_unit_test(names_are_told),
					   cmocka_unit_test(techniques_have_what_the_seam_asks_for)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
