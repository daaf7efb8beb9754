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

static struct room all, peers[300], connections[300];
static unsigned peer_of[300];
static struct room_place places[4096];
static unsigned most_images;

static int set_up(void **state)
{
	(void)state;
	all = (struct room){0};
	most_images = 1000;
	for (size_t i = 0; i < sizeof connections / sizeof *connections; i++) {
		connections[i] = peers[i] = (struct room){0};
		peer_of[i] = (unsigned)i;
	}
	for (size_t i = 0; i < sizeof places / sizeof *places; i++)
		places[i] = (struct room_place){0};
	return 0;
}

static struct room_owner owner_of(unsigned connection)
{
	return (struct room_owner){.all = &all,
				   .peer = &peers[peer_of[connection]],
				   .connection = &connections[connection],
				   .most_images = most_images};
}

static enum room_answer take(unsigned connection, unsigned place, uint64_t bytes)
{
	const struct room_owner owner = owner_of(connection);
	return room_take(&owner, &places[place], bytes, false);
}

static void give_back(unsigned connection, unsigned place)
{
	const struct room_owner owner = owner_of(connection);
	room_give_back(&owner, &places[place]);
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
	const struct room_owner owner = owner_of(0);
	(void)state;
	assert_int_equal(room_take(&owner, &places[0], 5 * MIB, true), ROOM_SHARE_FULL);
	assert_int_equal(room_take(&owner, &places[0], MIB, true), ROOM_TAKEN);
}

static void test_the_first_image_of_each_needs_no_shared_descriptor(void **state)
{
	(void)state;
	most_images = 3;
	assert_int_equal(take(0, 0, 1), ROOM_TAKEN);
	assert_int_equal(take(0, 1, 1), ROOM_TAKEN);
	assert_int_equal(take(0, 2, 1), ROOM_TAKEN);
	assert_int_equal(take(2, 3, 1), ROOM_TAKEN);
	assert_int_equal(take(2, 6, 1), ROOM_TAKEN);
	assert_int_equal(take(0, 7, 1), ROOM_COMMON_FULL);
	assert_int_equal(take(1, 4, 1), ROOM_TAKEN);
	assert_int_equal(take(1, 5, 1), ROOM_COMMON_FULL);
	// Whichever of a connection's is gone, one of the others is its first now.
	give_back(0, 0);
	assert_int_equal(take(1, 5, 1), ROOM_TAKEN);
	assert_int_equal(take(0, 0, 1), ROOM_COMMON_FULL);
	give_back(2, 3);
	give_back(2, 6);
	give_back(1, 4);
	give_back(1, 5);
	give_back(0, 1);
	give_back(0, 2);
	assert_int_equal(all.images, 0);
	assert_int_equal(connections[0].images, 0);
}

static void test_a_peer_leaves_a_quarter_of_the_common_room(void **state)
{
	(void)state;
	for (unsigned i = 0; i < 4; i++)
		peer_of[i] = 0;
	for (unsigned i = 0; i < 3; i++)
		assert_int_equal(take(i, i, LIMIT_IMAGE_BYTES), ROOM_TAKEN);
	assert_int_equal(take(3, 3, LIMIT_OWN_IMAGE_BYTES + 1), ROOM_SHARE_FULL);
	assert_int_equal(take(3, 3, LIMIT_OWN_IMAGE_BYTES), ROOM_TAKEN);
	assert_int_equal(take(4, 4, LIMIT_IMAGE_BYTES), ROOM_TAKEN);
	assert_int_equal(take(5, 5, LIMIT_OWN_IMAGE_BYTES + 1), ROOM_COMMON_FULL);
	for (unsigned i = 0; i < 4; i++)
		give_back(i, i);
	assert_int_equal(room_bytes(&peers[0]), 0);
}

static void test_a_peer_leaves_some_of_the_descriptors(void **state)
{
	(void)state;
	most_images = 4;
	peer_of[1] = 0;
	for (unsigned i = 0; i < 2; i++)
		assert_int_equal(take(i, i, 1), ROOM_TAKEN);
	for (unsigned i = 2; i < 5; i++)
		assert_int_equal(take(i % 2, i, 1), ROOM_TAKEN);
	assert_int_equal(take(0, 5, 1), ROOM_SHARE_FULL);
	assert_int_equal(take(2, 6, 1), ROOM_TAKEN);
	assert_int_equal(take(2, 7, 1), ROOM_TAKEN);
	assert_int_equal(take(2, 8, 1), ROOM_COMMON_FULL);
}

static void test_sizes_become_true_and_all_is_given_back(void **state)
{
	const struct room_owner owner = owner_of(0);
	(void)state;
	assert_int_equal(take(0, 0, 3 * MIB), ROOM_TAKEN);
	assert_int_equal(take(0, 1, 50 * MIB), ROOM_TAKEN);
	room_resize(&owner, &places[0], MIB);
	room_resize(&owner, &places[1], 2 * MIB);
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
	    cmocka_unit_test_setup(test_the_first_image_of_each_needs_no_shared_descriptor, set_up),
	    cmocka_unit_test_setup(test_a_peer_leaves_a_quarter_of_the_common_room, set_up),
	    cmocka_unit_test_setup(test_a_peer_leaves_some_of_the_descriptors, set_up),
	    cmocka_unit_test_setup(test_sizes_become_true_and_all_is_given_back, set_up),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
