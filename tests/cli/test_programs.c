// A program that the command line runs has time as long as it works; one that hangs is ended.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <stdio.h>

#include "clients/cli/programs.h"

#define STILL_MS 320u

static char out[256], err[256];

static int run(const char *script, unsigned work_ms)
{
	char shell[] = "sh", option[] = "-c", text[256];
	char *argv[] = {shell, option, text, NULL};
	snprintf(text, sizeof text, "%s", script);
	return program_run(argv, (struct program_time){.still_ms = STILL_MS, .work_ms = work_ms}, out, err, sizeof out);
}

static void what_it_says_and_how_it_ends_are_told(void **state)
{
	(void)state;
	assert_int_equal(run("echo out; echo err >&2; exit 3", 100000), 3);
	assert_string_equal(out, "out\n");
	assert_string_equal(err, "err\n");
	assert_int_equal(run("kill -9 $$", 100000), 128 + 9);
}

// It works for longer than it may be still.
static void slow_is_not_hung(void **state)
{
	(void)state;
	assert_int_equal(run("i=0; while [ $i -lt 1000000 ]; do i=$((i+1)); done; echo $i", 100000), 0);
	assert_string_equal(out, "1000000\n");
}

static void one_that_sleeps_is_ended(void **state)
{
	(void)state;
	assert_int_equal(run("exec sleep 1000", 100000), -1);
	assert_int_equal(errno, ETIMEDOUT);
}

static void one_that_is_stopped_is_ended(void **state)
{
	(void)state;
	assert_int_equal(run("kill -STOP $$", 100000), -1);
	assert_int_equal(errno, ETIMEDOUT);
}

static void one_that_works_without_an_end_is_ended(void **state)
{
	(void)state;
	assert_int_equal(run("while :; do :; done", 500), -1);
	assert_int_equal(errno, ETIMEDOUT);
	assert_int_equal(run("while :; do echo; done", 500), -1); // nor does it help to speak
	assert_int_equal(errno, ETIMEDOUT);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(what_it_says_and_how_it_ends_are_told),
	    cmocka_unit_test(slow_is_not_hung),
	    cmocka_unit_test(one_that_sleeps_is_ended),
	    cmocka_unit_test(one_that_is_stopped_is_ended),
	    cmocka_unit_test(one_that_works_without_an_end_is_ended),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
