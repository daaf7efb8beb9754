// Whose slice is next: small before large, turns among equals, nobody starved.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "server/front/jobs/schedule.h"

#define SLICE_US 50000u

// Of each candidate a peer of its own, which lives as long as the test.
static struct peer_turn peers[20];

static int set_up(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof peers / sizeof *peers; i++)
		peers[i] = (struct peer_turn){0};
	return 0;
}

static size_t pick(struct turn *const *turns, size_t count, uint64_t *clock)
{
	struct candidate candidates[20];
	for (size_t i = 0; i < count; i++)
		candidates[i] = (struct candidate){turns[i], &peers[i]};
	return schedule_pick(candidates, count, clock);
}

static void a_small_job_does_not_wait_for_a_large_one(void **state)
{
	struct turn large = {.attained_us = 60u * 60u * 1000000u}, small = {0};
	struct turn *turns[] = {&large, &small};
	uint64_t clock = 0;
	(void)state;
	for (int i = 0; i < 8; i++) {
		assert_int_equal(pick(turns, 2, &clock), 1);
		schedule_charge(&small, SLICE_US);
	}
}

static void equals_take_turns(void **state)
{
	struct turn a = {0}, b = {0}, c = {0};
	struct turn *turns[] = {&a, &b, &c};
	uint64_t clock = 0;
	unsigned had[3] = {0};
	(void)state;
	for (int i = 0; i < 300; i++) {
		size_t picked = pick(turns, 3, &clock);
		schedule_charge(turns[picked], SLICE_US);
		had[picked]++;
	}
	for (int i = 0; i < 3; i++)
		assert_int_equal(had[i], 100);
}

static void an_hour_does_not_wait_for_a_minute_to_catch_up(void **state)
{
	struct turn hour = {.attained_us = 3600000000u}, minute = {.attained_us = 60000000u};
	struct turn *turns[] = {&hour, &minute};
	uint64_t clock = 0;
	unsigned had[2] = {0};
	(void)state;
	for (int i = 0; i < 100; i++) {
		size_t picked = pick(turns, 2, &clock);
		schedule_charge(turns[picked], SLICE_US);
		had[picked]++;
	}
	assert_int_equal(had[0], 50);
	assert_int_equal(had[1], 50);
}

// What is foreseen of two jobs is what their turns give.
static void what_another_job_adds_is_foreseen(void **state)
{
	const uint64_t attained[] = {0, 400000, 3600000000u};
	const double left[] = {100000, 1e9};
	(void)state;
	for (int i = 0; i < 12; i++) {
		set_up(state);
		struct turn other = {.attained_us = attained[i % 3]}, new = {0};
		struct turn *turns[] = {&other, &new};
		const double work = i < 6 ? 600000 : 6000000, foreseen = schedule_delay_us(&other, left[i / 3 % 2], work);
		uint64_t clock = 0;
		double waited = 0, done = 0;
		while (done < work) {
			const size_t picked = pick(turns, waited < left[i / 3 % 2] ? 2 : 1, &clock);
			if (waited >= left[i / 3 % 2] || picked == 1)
				done += SLICE_US;
			else
				waited += SLICE_US;
			if (waited < left[i / 3 % 2])
				schedule_charge(turns[picked], SLICE_US);
		}
		assert_true(waited >= foreseen - 2 * SLICE_US && waited <= foreseen + 2 * SLICE_US);
	}
}

// A new small job comes with every slice, for ever: the large one still gets its share.
static void a_stream_of_small_jobs_starves_nobody(void **state)
{
	struct turn large = {.attained_us = 10000000};
	uint64_t clock = 0;
	unsigned served = 0, longest = 0, waited = 0;
	(void)state;
	for (int i = 0; i < 1000; i++) {
		struct turn fresh = {0};
		struct turn *turns[] = {&fresh, &large};
		if (pick(turns, 2, &clock) == 1) {
			schedule_charge(&large, SLICE_US);
			served++;
			waited = 0;
		} else if (++waited > longest) {
			longest = waited;
		}
	}
	assert_true(longest <= SCHEDULE_PATIENCE);
	assert_int_equal(served, 1000 / (SCHEDULE_PATIENCE + 1));
}

// Many that starve at once are served in the order in which they were left.
static void the_starving_are_served_in_order(void **state)
{
	struct turn jobs[20] = {{0}};
	struct turn *turns[20];
	uint64_t clock = 0;
	unsigned had[20] = {0};
	(void)state;
	for (int i = 0; i < 20; i++) {
		turns[i] = &jobs[i];
		jobs[i].attained_us = (uint64_t)i * 1000000000u;
	}
	for (int i = 0; i < 2000; i++) {
		size_t picked = pick(turns, 20, &clock);
		schedule_charge(turns[picked], SLICE_US);
		had[picked]++;
	}
	for (int i = 0; i < 20; i++)
		assert_true(had[i] >= 80);
}

static void the_same_calls_give_the_same_answers(void **state)
{
	size_t first[200];
	(void)state;
	for (int run = 0; run < 2; run++) {
		set_up(state);
		struct turn a = {0}, b = {.attained_us = 300000}, c = {.attained_us = 5000000};
		struct turn *turns[] = {&a, &b, &c};
		uint64_t clock = 0;
		for (int i = 0; i < 200; i++) {
			size_t picked = pick(turns, 3, &clock);
			schedule_charge(turns[picked], SLICE_US);
			if (run == 0)
				first[i] = picked;
			else
				assert_int_equal(picked, first[i]);
		}
	}
}

// A peer's ten jobs, young or old, wait for each other and not another's for all of them.
static void ten_jobs_of_a_peer_take_no_more_than_one(void **state)
{
	for (int old = 0; old < 2; old++) {
		struct turn jobs[11] = {{0}};
		struct candidate candidates[11];
		uint64_t clock = 0;
		unsigned had[11] = {0}, waited = 0;
		set_up(state);
		for (int i = 0; i < 11; i++) {
			jobs[i].attained_us = old ? 60000000u * (unsigned)(i + 1) : 0;
			candidates[i] = (struct candidate){&jobs[i], &peers[i == 10]};
		}
		for (int i = 0; i < 400; i++) {
			const size_t picked = schedule_pick(candidates, 11, &clock);
			schedule_charge(&jobs[picked], SLICE_US);
			had[picked]++;
			waited = picked == 10 ? 0 : waited + 1;
			assert_true(waited <= 1);
		}
		assert_true(had[10] >= 199 && had[10] <= 201);
		for (int i = 0; i < 10; i++)
			assert_true(had[i] >= 19 && had[i] <= 21);
	}
}

// It may be served while its own others are not, but not for ever.
static void a_peers_small_jobs_do_not_starve_its_large_one(void **state)
{
	struct turn large = {.attained_us = 10000000}, others = {.attained_us = 10000000};
	uint64_t clock = 0;
	unsigned served = 0;
	(void)state;
	for (int i = 0; i < 1800; i++) {
		struct turn fresh = {0};
		const struct candidate candidates[] = {{&fresh, &peers[0]}, {&large, &peers[0]}, {&others, &peers[1]}};
		const size_t picked = schedule_pick(candidates, 3, &clock);
		schedule_charge(candidates[picked].job, SLICE_US);
		served += picked == 1;
	}
	assert_int_equal(served, 100);
}

static void time_does_not_wrap(void **state)
{
	struct turn turn = {.attained_us = UINT64_MAX - 1};
	(void)state;
	schedule_charge(&turn, SLICE_US);
	assert_true(turn.attained_us == UINT64_MAX);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test_setup(a_small_job_does_not_wait_for_a_large_one, set_up),
	    cmocka_unit_test_setup(equals_take_turns, set_up),
	    cmocka_unit_test_setup(an_hour_does_not_wait_for_a_minute_to_catch_up, set_up),
	    cmocka_unit_test_setup(what_another_job_adds_is_foreseen, set_up),
	    cmocka_unit_test_setup(a_stream_of_small_jobs_starves_nobody, set_up),
	    cmocka_unit_test_setup(the_starving_are_served_in_order, set_up),
	    cmocka_unit_test_setup(the_same_calls_give_the_same_answers, set_up),
	    cmocka_unit_test_setup(ten_jobs_of_a_peer_take_no_more_than_one, set_up),
	    cmocka_unit_test_setup(a_peers_small_jobs_do_not_starve_its_large_one, set_up),
	    cmocka_unit_test_setup(time_does_not_wrap, set_up),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
