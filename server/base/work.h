// What a technique makes once for a scene before its pictures, counted: how much of it there is, and what so much took. A
// value; any thread.
#ifndef CANDIL_BASE_WORK_H
#define CANDIL_BASE_WORK_H

#include <stdint.h>

// Its parts, and what is counted of each.
enum work_part {
	WORK_CUT, // elements that the scene is cut into, and what is looked up for each
	WORK_LIGHT, // rays to lights
	WORK_ROWS, // rows of form factors, each times what its rays, or pixels, make it cost
	WORK_SOLVE, // form factors that the solver goes through
	WORK_PARTS
};

// How well is known what is left.
enum work_told {
	WORK_UNTOLD, // all else is zero
	WORK_COUNTED, // nothing is there yet
	WORK_TRIED, // likewise, but some was tried out
	WORK_KEPT // some or all is there, or the work was done
};

// Times are microseconds, amounts at least 0.
struct work {
	uint32_t told; // enum work_told
	// What a part's cost depends on beside the scene and the device, hashed: of a row, and of a sample of a pixel.
	uint64_t way_of_rows, way_of_pictures;
	double picture; // units that a sample of a pixel counts as, above 0
	double left[WORK_PARTS]; // still to be made
	double doubt[WORK_PARTS]; // deviation of the logarithm of that
	double made[WORK_PARTS]; // was made
	double us[WORK_PARTS]; // and took so long
};

// The time of all that was made.
static inline double work_us(const struct work *work)
{
	double us = 0;
	for (int part = 0; part < WORK_PARTS; part++)
		us += work->us[part];
	return us;
}

#endif
