// Descriptors divided between connections, scenes and images: never more than there are, and somebody is served or nobody.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>

#include "protocol/limits.h"
#include "server/front/capacity.h"

#define MANY 4096u

static void no_more_are_given_than_there_are(void **state)
{
	struct capacity before = {0};
	(void)state;
	for (unsigned n = 0; n <= MANY; n++) {
		struct capacity c = {0};
		if (!capacity_divide(&c, n)) {
			assert_int_equal(before.connections, 0);
			continue;
		}
		assert_true(capacity_descriptors(&c) <= n);
		assert_true(c.connections >= 4 && c.scenes >= 2 && c.images >= 2);
		// One scene more may cost a connection.
		assert_true(c.connections + 1 >= before.connections && c.scenes >= before.scenes);
		before = c;
	}
	assert_int_equal(before.connections, LIMIT_CONNECTIONS);
	assert_int_equal(before.scenes, LIMIT_SCENES);
	assert_int_equal(before.images, 2 * LIMIT_JOBS);
}

// Of the usual 1024 some forty are the daemon's own.
static void the_usual_limit_lacks_no_connection_and_no_scene(void **state)
{
	struct capacity c;
	(void)state;
	assert_true(capacity_divide(&c, 1024 - 64));
	assert_int_equal(c.connections, LIMIT_CONNECTIONS);
	assert_int_equal(c.scenes, LIMIT_SCENES);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(no_more_are_given_than_there_are),
	    cmocka_unit_test(the_usual_limit_lacks_no_connection_and_no_scene),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
