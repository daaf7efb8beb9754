// Room for images that wait: what a connection has for itself, what all share, what one alone may have.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "protocol/limits.h"
#include "server/front/jobs/room.h"

#define MIB (1ull << 20)
#define FIRST_LARGE 10u // connections that fill the common room

static struct room all, connections[300];
static struct room_place places[4096];

static int set_up(void **state)
{
	(void)state;
	all = (struct room){0};
	for (size_t i = 0; i < sizeof connections / sizeof *connections; i++)
		connections[i] = (struct room){0};
	for (size_t i = 0; i < sizeof places / sizeof *places; i++)
		places[i] = (struct room_place){0};
	return 0;
}

static enum room_answer take(unsigned connection, unsigned place, uint64_t bytes)
{
	return room_take(&all, &connections[connection], &places[place], bytes, false);
}

static void give_back(unsigned connection, unsigned place)
{
	room_give_back(&all, &connections[connection], &places[place]);
}

// Fill the common room with images of 256 MiB.
static void fill_common(void)
{
	for (unsigned i = 0; i < LIMIT_COMMON_IMAGE_BYTES / LIMIT_IMAGE_BYTES; i++)
		assert_int_equal(take(FIRST_LARGE + i, FIRST_LARGE + i, LIMIT_IMAGE_BYTES), ROOM_TAKEN);
	assert_int_equal(all.common, LIMIT_COMMON_IMAGE_BYTES);
}

static void test_small_images_of_all_connections_fit_beside_a_full_common_room(void **state)
{
	(void)state;
	fill_common();
	for (unsigned i = 0; i < LIMIT_CONNECTIONS; i++)
		assert_int_equal(take(FIRST_LARGE + 10 + i, 1000 + i, LIMIT_OWN_IMAGE_BYTES), ROOM_TAKEN);
	assert_int_equal(room_bytes(&all), (uint64_t)LIMIT_CONNECTIONS * LIMIT_OWN_IMAGE_BYTES + LIMIT_COMMON_IMAGE_BYTES);
	assert_int_equal(take(FIRST_LARGE + 10, 1, 1), ROOM_COMMON_FULL);
}

static void test_own_room_is_used_first_and_is_one_connections(void **state)
{
	(void)state;
	assert_int_equal(take(0, 0, 3 * MIB), ROOM_TAKEN);
	assert_int_equal(take(0, 1, 3 * MIB), ROOM_TAKEN);
	assert_int_equal(take(1, 2, 3 * MIB), ROOM_TAKEN);
	assert_int_equal(places[0].kind, ROOM_OWN);
	assert_int_equal(places[1].kind, ROOM_COMMON);
	assert_int_equal(places[2].kind, ROOM_OWN);
	assert_int_equal(all.own, 6 * MIB);
	assert_int_equal(all.common, 3 * MIB);
	assert_int_equal(room_bytes(&connections[0]), 6 * MIB);
}

static void test_a_connection_has_its_limit_and_one_image_beyond_it(void **state)
{
	(void)state;
	assert_int_equal(take(0, 0, LIMIT_IMAGE_BYTES + 1), ROOM_TAKEN);
	assert_int_equal(take(0, 1, 1), ROOM_CONNECTION_FULL);
	assert_int_equal(take(1, 2, LIMIT_IMAGE_BYTES - MIB), ROOM_TAKEN);
	assert_int_equal(take(1, 3, MIB), ROOM_TAKEN);
	assert_int_equal(take(1, 4, 1), ROOM_CONNECTION_FULL);
	give_back(0, 0);
	assert_int_equal(take(0, 1, 1), ROOM_TAKEN);
}

static void test_one_image_may_have_all_the_common_room(void **state)
{
	(void)state;
	const uint64_t huge = 3ull * LIMIT_COMMON_IMAGE_BYTES;
	assert_int_equal(take(0, 0, 5 * MIB), ROOM_TAKEN);
	assert_int_equal(take(1, 1, huge), ROOM_COMMON_FULL);
	assert_int_equal(places[1].kind, ROOM_NONE);
	give_back(0, 0);
	assert_int_equal(take(1, 1, huge), ROOM_TAKEN);
	assert_int_equal(take(0, 0, 5 * MIB), ROOM_COMMON_FULL);
	assert_int_equal(take(0, 0, 4 * MIB), ROOM_TAKEN);
}

static void test_while_others_wait_only_ones_own_is_given(void **state)
{
	(void)state;
	assert_int_equal(room_take(&all, &connections[0], &places[0], 5 * MIB, true), ROOM_COMMON_FULL);
	assert_int_equal(room_take(&all, &connections[0], &places[0], MIB, true), ROOM_TAKEN);
}

static void test_sizes_become_true_and_all_is_given_back(void **state)
{
	(void)state;
	assert_int_equal(take(0, 0, 3 * MIB), ROOM_TAKEN);
	assert_int_equal(take(0, 1, 50 * MIB), ROOM_TAKEN);
	room_resize(&all, &connections[0], &places[0], MIB);
	room_resize(&all, &connections[0], &places[1], 2 * MIB);
	assert_int_equal(room_bytes(&all), 3 * MIB);
	assert_int_equal(connections[0].own, MIB);
	assert_int_equal(connections[0].common, 2 * MIB);
	give_back(0, 0);
	give_back(0, 0); // it is nowhere: nothing
	give_back(0, 1);
	assert_int_equal(room_bytes(&all), 0);
	assert_int_equal(room_bytes(&connections[0]), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test_setup(test_small_images_of_all_connections_fit_beside_a_full_common_room, set_up),
	    cmocka_unit_test_setup(test_own_room_is_used_first_and_is_one_connections, set_up),
	    cmocka_unit_test_setup(test_a_connection_has_its_limit_and_one_image_beyond_it, set_up),
	    cmocka_unit_test_setup(test_one_image_may_have_all_the_common_room, set_up),
	    cmocka_unit_test_setup(test_while_others_wait_only_ones_own_is_given, set_up),
	    cmocka_unit_test_setup(test_sizes_become_true_and_all_is_given_back, set_up),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
