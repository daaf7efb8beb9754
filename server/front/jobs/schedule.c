#include "server/front/jobs/schedule.h"

#include <math.h>
#include <stdbool.h>

static uint64_t turn_weight(const struct turn *turn)
{
	return turn->attained_us < SCHEDULE_FAIR_US ? turn->attained_us : SCHEDULE_FAIR_US;
}

// Is it the turn of `a` before that of `b`?
static bool turn_before(const struct turn *a, const struct turn *b)
{
	bool a_starves = a->passed_over >= SCHEDULE_PATIENCE, b_starves = b->passed_over >= SCHEDULE_PATIENCE;
	if (a_starves != b_starves)
		return a_starves;
	if (a_starves && a->passed_over != b->passed_over)
		return a->passed_over > b->passed_over;
	if (turn_weight(a) != turn_weight(b))
		return turn_weight(a) < turn_weight(b);
	return a->served < b->served;
}

static void pass_over(struct turn *turn)
{
	if (turn->passed_over < UINT32_MAX)
		turn->passed_over++;
}

static void serve(struct turn *turn, uint64_t clock)
{
	turn->passed_over = 0;
	turn->served = clock;
}

// What the jobs of each peer have had together.
static void add_up(const struct candidate *candidates, size_t count)
{
	for (size_t i = 0; i < count; i++)
		candidates[i].peer->turn.attained_us = 0;
	for (size_t i = 0; i < count; i++)
		candidates[i].peer->turn.attained_us += turn_weight(candidates[i].job);
}

static struct peer_turn *pick_peer(const struct candidate *candidates, size_t count)
{
	struct peer_turn *peer = candidates[0].peer;
	for (size_t i = 1; i < count; i++)
		if (turn_before(&candidates[i].peer->turn, &peer->turn))
			peer = candidates[i].peer;
	return peer;
}

size_t schedule_pick(const struct candidate *candidates, size_t count, uint64_t *clock)
{
	size_t picked = count;
	add_up(candidates, count);
	struct peer_turn *peer = pick_peer(candidates, count);
	++*clock;
	for (size_t i = 0; i < count; i++) {
		struct peer_turn *other = candidates[i].peer;
		if (other != peer && other->passed != *clock) {
			other->passed = *clock;
			pass_over(&other->turn);
		}
		if (other == peer && (picked == count || turn_before(candidates[i].job, candidates[picked].job)))
			picked = i;
	}
	for (size_t i = 0; i < count; i++)
		if (candidates[i].peer == peer)
			pass_over(candidates[i].job);
	serve(&peer->turn, *clock);
	serve(candidates[picked].job, *clock);
	return picked;
}

double schedule_delay_us(const struct turn *other, double left_us, double us)
{
	// Until the new one has had as much it goes first, and the other is served for its patience alone. Then they take
	// turns.
	const double first_us = fmin((double)turn_weight(other), us);
	return fmin(left_us, first_us / SCHEDULE_PATIENCE + us - first_us);
}

void schedule_charge(struct turn *turn, uint64_t device_us)
{
	if (__builtin_add_overflow(turn->attained_us, device_us, &turn->attained_us))
		turn->attained_us = UINT64_MAX;
}
