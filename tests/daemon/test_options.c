// The daemon's command line.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "server/front/options.h"

static struct options options;

static enum status parse(const char *const *words)
{
	char copies[8][64];
	char *argv[10] = {(char[]){"candild"}};
	int argc = 1;
	struct error err = {.code = STATUS_OK};
	for (; words[argc - 1]; argc++) {
		strcpy(copies[argc - 1], words[argc - 1]);
		argv[argc] = copies[argc - 1];
	}
	argv[argc] = NULL;
	enum status status = options_parse(&options, argc, argv, &err);
	assert_int_equal(err.code, status);
	return status;
}

#define PARSE(...) parse((const char *const[]){__VA_ARGS__, NULL})

static void everything_is_read(void **state)
{
	(void)state;
	assert_int_equal(PARSE("--socket", "/run/x", "--slice", "7", "--device", "cpu", "--require-gpu"), STATUS_OK);
	assert_string_equal(options.socket, "/run/x");
	assert_int_equal(options.slice_ms, 7);
	assert_true(options.require_gpu);
	assert_int_equal(PARSE("--socket=x", "--scene", "a=b.gltf", "--scene", "c=d=e", "--memory-budget=512"), STATUS_OK);
	assert_int_equal(options.scene_count, 2);
	assert_string_equal(options.scenes[1].name, "c");
	assert_int_equal(options.memory_budget_mib, 512);
	assert_int_equal(options.slice_ms, 50);
	assert_int_equal(options.hang_s, 0);
	assert_int_equal(options.answer_s, LIMIT_ANSWER_SECONDS);
	assert_int_equal(PARSE("--socket=x", "--hang", "7", "--answer", "9"), STATUS_OK);
	assert_int_equal(options.hang_s, 7);
	assert_int_equal(options.answer_s, 9);
	assert_int_equal(options.private_fd, -1);
	assert_int_equal(PARSE("--private-fd", "5"), STATUS_OK);
	assert_int_equal(options.private_fd, 5);
	assert_int_equal(PARSE("--help"), STATUS_OK);
	assert_true(options.help);
	assert_int_equal(PARSE("-h"), STATUS_OK);
	assert_true(options.help);
}

static void nonsense_is_refused(void **state)
{
	(void)state;
	assert_int_equal(PARSE("--socket", "x", "--slice", "0"), STATUS_BAD_ARGUMENT);
	assert_int_equal(PARSE("--socket", "x", "--slice", "1001"), STATUS_BAD_ARGUMENT);
	assert_int_equal(PARSE("--socket", "x", "--slice", "5s"), STATUS_BAD_ARGUMENT);
	assert_int_equal(PARSE("--socket", "x", "--slice", "-5"), STATUS_BAD_ARGUMENT);
	assert_int_equal(PARSE("--socket", "x", "--hang", "0"), STATUS_BAD_ARGUMENT);
	assert_int_equal(PARSE("--socket", "x", "--answer", "86401"), STATUS_BAD_ARGUMENT);
	assert_int_equal(PARSE("--socket", "x", "--scene", "box"), STATUS_BAD_ARGUMENT);
	assert_int_equal(PARSE("--socket", "x", "--scene", "=box"), STATUS_BAD_ARGUMENT);
	assert_int_equal(PARSE("--socket", "x", "--scene", "box="), STATUS_BAD_ARGUMENT);
	assert_int_equal(PARSE("--socket", ""), STATUS_BAD_ARGUMENT);
	assert_int_equal(PARSE("--socket", "x", "--private-fd", "x"), STATUS_BAD_ARGUMENT);
	assert_int_equal(PARSE("--socket"), STATUS_BAD_ARGUMENT);
	assert_int_equal(PARSE("--frobnicate"), STATUS_BAD_ARGUMENT);
	assert_int_equal(PARSE("--socket", "x", "scene.gltf"), STATUS_BAD_ARGUMENT);
}

static void the_socket_is_in_the_runtime_folder(void **state)
{
	(void)state;
	setenv("XDG_RUNTIME_DIR", "/run/user/1", 1);
	assert_int_equal(PARSE("--slice", "5"), STATUS_OK);
	assert_string_equal(options.socket, "/run/user/1/candil.sock");
	unsetenv("XDG_RUNTIME_DIR");
	assert_int_equal(PARSE("--slice", "5"), STATUS_BAD_ARGUMENT);
	assert_int_equal(PARSE("--version"), STATUS_OK);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(everything_is_read),
	    cmocka_unit_test(nonsense_is_refused),
	    cmocka_unit_test(the_socket_is_in_the_runtime_folder),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
