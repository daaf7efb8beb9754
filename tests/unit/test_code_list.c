// The list of code that the driver has compiled before: what one process adds another finds, and a bad file does no harm.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "server/worker/code_list.h"

static char folder[] = "/tmp/candil-code-XXXXXX";
static struct error err;

static int make_folder(void **state)
{
	(void)state;
	return mkdtemp(folder) ? 0 : 1;
}

static int remove_folder(void **state)
{
	char path[64];
	(void)state;
	snprintf(path, sizeof path, "%s/candil_code", folder);
	unlink(path);
	return rmdir(folder);
}

static struct code_list opened(const char *device)
{
	struct code_list list;
	code_list_open(&list, folder, device);
	assert_true(list.file >= 0);
	return list;
}

static bool refuses(struct code_list *list, uint64_t piece)
{
	list->refused = 0;
	const bool refused = code_list_ask(list, piece, &err) != STATUS_OK;
	assert_true(refused == (list->refused != 0));
	return refused;
}

static void what_one_adds_others_find(void **state)
{
	(void)state;
	struct code_list a = opened("x"), b = opened("x"), other = opened("y");
	assert_true(refuses(&a, 1) && refuses(&b, 1));
	code_list_add(&a, 1);
	code_list_add(&b, 2);
	assert_false(refuses(&a, 1) || refuses(&b, 1) || refuses(&a, 2) || refuses(&b, 2));
	// Another device has its own code.
	assert_true(refuses(&other, 1));
	code_list_close(&a);
	a = opened("x");
	assert_false(refuses(&a, 1) || refuses(&a, 2));
	assert_true(refuses(&a, 3));
	a.at_will = true;
	assert_false(refuses(&a, 3));
	code_list_close(&a);
	code_list_close(&a);
	code_list_close(&b);
	code_list_close(&other);
}

static void it_does_not_grow_for_ever(void **state)
{
	(void)state;
	struct code_list a = opened("many"), b = opened("many");
	struct stat info;
	for (uint64_t i = 0; i < CODE_LIST_MOST + 10; i++)
		code_list_add(&a, i);
	assert_int_equal(fstat(a.file, &info), 0);
	assert_true((uint64_t)info.st_size <= CODE_LIST_MOST * sizeof(uint64_t));
	assert_false(refuses(&a, CODE_LIST_MOST + 9) || refuses(&b, CODE_LIST_MOST + 9));
	assert_true(refuses(&a, 0) && refuses(&b, 0));
	code_list_close(&a);
	code_list_close(&b);
}

static void a_piece_is_all_of_its_parts(void **state)
{
	(void)state;
	assert_int_not_equal(code_piece(code_piece(0, "a", 1), "b", 1), code_piece(code_piece(0, "b", 1), "a", 1));
	assert_int_not_equal(code_piece(0, "a", 1), code_piece(0, "a", 2));
}

static void without_a_place_nothing_is_refused(void **state)
{
	(void)state;
	struct code_list list;
	code_list_open(&list, "", "x");
	assert_false(refuses(&list, 1));
	code_list_add(&list, 1);
	code_list_close(&list);
	code_list_open(&list, "/proc/nowhere", "x");
	assert_false(refuses(&list, 1));
	code_list_close(&list);
	setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
	code_list_open(&list, folder, "x");
	assert_false(refuses(&list, 77));
	code_list_close(&list);
	unsetenv("MESA_SHADER_CACHE_DISABLE");
}

static void a_spoilt_file_is_misread_at_worst(void **state)
{
	(void)state;
	struct code_list a = opened("x");
	assert_int_equal(ftruncate(a.file, 0), 0);
	assert_int_equal(write(a.file, "abc", 3), 3);
	code_list_add(&a, 5);
	code_list_add(&a, 6);
	struct code_list b = opened("x");
	refuses(&b, 5);
	code_list_add(&b, 7);
	code_list_close(&a);
	code_list_close(&b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(what_one_adds_others_find), cmocka_unit_test(it_does_not_grow_for_ever),
	    cmocka_unit_test(a_piece_is_all_of_its_parts), cmocka_unit_test(without_a_place_nothing_is_refused),
	    cmocka_unit_test(a_spoilt_file_is_misread_at_worst)};
	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
