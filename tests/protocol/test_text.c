// UTF-8 as the standard has it: what is refused in names is replaced in others' sentences.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>

#include "protocol/text.h"

static const char *const unclean[] = {
    "\x01",
    "a\nb",
    "\x1B[2J",
    "\x7F",
    "\x80", // a continuation without a beginning
    "\xC3", // cut short
    "\xC0\x80", // overlong zero
    "\xE0\x80\xAF", // overlong '/'
    "\xED\xA0\x80", // a surrogate
    "\xF4\x90\x80\x80", // past the last code point
    "\xF8\x88\x80\x80\x80",
    "\xC2\x9B", // a control character of the second page
};

static void unclean_text_is_found_and_mended(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof unclean / sizeof *unclean; i++) {
		char copy[16];
		assert_false(text_is_clean(unclean[i]));
		assert_false(text_is_name(unclean[i]));
		strcpy(copy, unclean[i]);
		text_clean(copy, sizeof copy);
		assert_true(text_is_clean(copy));
		assert_int_equal(strlen(copy), strlen(unclean[i]));
	}
}

static void clean_text_is_left_alone(void **state)
{
	const char *const clean[] = {"", "box", "l\xC3\xA1mpara", "\xE2\x82\xAC", "\xF0\x9F\x8E\xA8", "\xF4\x8F\xBF\xBF"};
	(void)state;
	for (size_t i = 0; i < sizeof clean / sizeof *clean; i++) {
		char copy[16];
		assert_true(text_is_clean(clean[i]));
		strcpy(copy, clean[i]);
		text_clean(copy, sizeof copy);
		assert_string_equal(copy, clean[i]);
	}
}

static void a_missing_end_is_set(void **state)
{
	char text[4] = {'a', 'b', (char)0xC3, (char)0xA1};
	(void)state;
	text_clean(text, sizeof text);
	assert_string_equal(text, "ab?");
}

static void a_copy_is_clean_and_cut_between_characters(void **state)
{
	char out[8];
	(void)state;
	text_copy(out, sizeof out, "plain");
	assert_string_equal(out, "plain");
	text_copy(out, sizeof out, "longer than it");
	assert_string_equal(out, "longer ");
	text_copy(out, sizeof out, "a\n\x1b\x7f");
	assert_string_equal(out, "a ??");
	text_copy(out, sizeof out, "\xc3\xa9\xe2\x82\xac"); // é €
	assert_string_equal(out, "\xc3\xa9\xe2\x82\xac");
	text_copy(out, sizeof out, "12345\xe2\x82\xac"); // would be cut within
	assert_string_equal(out, "12345");
	text_copy(out, sizeof out, "\xff\xc0\xaf\xed\xa0\x80"); // no UTF-8
	assert_string_equal(out, "??????");
	text_copy(out, sizeof out, "\xe2");
	assert_string_equal(out, "?");
}

static void sentences_are_alike_but_for_numbers(void **state)
{
	static const struct {
		const char *a, *b;
		bool alike;
	} pairs[] = {
	    {"", "", true},
	    {"as it is", "as it is", true},
	    {"exposure +18.8 shows it", "exposure +19.0 shows it", true},
	    {"exposure +18.8 shows it", "exposure -2 shows it", true},
	    {"3 lamps of 12", "20 lamps of 7", true},
	    {"radius 1e-05 m", "radius 0.25 m", true},
	    {"97 %", "100 %", true},
	    {"ends with 7", "ends with 70", true},
	    {"3 lamps", "3 lights", false},
	    {"3 lamps", "lamps", false},
	    {"3 lamps", " lamps", false},
	    {"lamp12 is dark", "lamp13 is dark", false},
	    {"lamp_1 is dark", "lamp_2 is dark", false},
	    {"exposure +18.8", "exposure +18.8 shows it", false},
	    {"exposure +", "exposure -", false},
	};
	(void)state;
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
		assert_int_equal(text_alike(pairs[i].a, pairs[i].b), pairs[i].alike);
		assert_int_equal(text_alike(pairs[i].b, pairs[i].a), pairs[i].alike);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(unclean_text_is_found_and_mended),
	    cmocka_unit_test(clean_text_is_left_alone),
	    cmocka_unit_test(a_missing_end_is_set),
	    cmocka_unit_test(a_copy_is_clean_and_cut_between_characters),
	    cmocka_unit_test(sentences_are_alike_but_for_numbers),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
