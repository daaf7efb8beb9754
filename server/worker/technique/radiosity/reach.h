// Which elements light reaches. They go by groups (element_groups.h): where light is on an element, or an element shines,
// all of its group is reached; the entries of a reached element's row of form factors tell which groups it sees, and these
// are reached in turn. So the inside of a closed body and the outside of a room are left out, and cost nothing.
//
// It is found along with the rows: reach_follow goes through those that are there, and stops at the first that is not, for
// somebody to make it. What is reached depends on where light is, and not on what other rows there are. Device's thread
// only.
//
//   reach_init, reach_add …, (reach_follow, make what reach_missing lists)* until reach_ended, reach_list, reach_finish
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_REACH_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_REACH_H

#include "server/worker/technique/radiosity/element_groups.h"
#include "server/worker/technique/radiosity/factors_window.h"

// A walk.
struct reach {
	const struct element_groups *groups;
	uint8_t *reached; // by group
	uint32_t *queue; // groups, in the order in which they were found
	uint32_t queued;
	struct reach_place {
		uint32_t group; // of the queue
		uint32_t row; // within that group
	} next; // row to be followed
	uint64_t found, followed; // elements of all groups of the queue, and of those whose rows were followed
	struct factors_window window;
};

// Begin. `groups` must outlive it. STATUS_MEMORY: `reach` is empty then. Zeroed may be finished.
enum status reach_init(struct reach *reach, const struct element_groups *groups, struct error *err);
void reach_finish(struct reach *reach);

// A group is reached.
void reach_add(struct reach *reach, uint32_t group);

// Go through rows that are there for about budget_us, until one is missing or all were. STATUS_MEMORY, STATUS_DEVICE: it may
// be called again.
enum status reach_follow(struct reach *reach, const struct factors *factors, uint32_t budget_us, struct error *err);

// Whether the next row is missing.
bool reach_waits(const struct reach *reach, const struct factors *factors);

// The next elements, `most` at most, that are known to be reached and have no row. Returns how many.
uint32_t reach_missing(const struct reach *reach, const struct factors *factors, uint32_t *elements, uint32_t most);

// Whether all rows were followed, and the share of those known so far that were, 0…1.
bool reach_ended(const struct reach *reach);
double reach_fraction(const struct reach *reach);

// Fill in a byte for each element: 1 if it is reached.
void reach_list(const struct reach *reach, uint8_t *elements);

#endif
