// What the next units of a pass will take, by what units took before. A pass goes over its units in one order, again with
// every sample, and a unit is about the same work each time: a tile of a picture, which sees the same place. Units differ
// much from one another, because a tile of empty sky takes next to nothing and one in the corner of a room many times the
// mean; so the last units of one sample tell little of the first of the next, and what is kept is a profile along the pass.
//
// Pieces are sized by it with care, since what is between the ends of a piece that was measured is not known: no unit is
// taken for cheaper than the mean of the pass; and where the pass has not been yet, for as dear as the dearest part that was
// seen, by this attempt at a picture or, at the smaller picture, by the one before it. So with us <= left / N the units of
// forecast_fit end within `left`, or there is but one of them, as long as none takes more than N times the mean or N times
// what is known of its part.
//
// A value that its owner keeps; zeroed is one that knows nothing. Any thread, one at a time. Host only.
//
// Example: a pass of 256 units, of which the first half take 10 µs each and the others next to nothing, and once more
//	struct forecast f = {0};
//	forecast_begin(&f, 256);
//	assert(forecast_us(&f, 0, 4) <= 0); // not known
//	forecast_add(&f, 0, 128, 1280);
//	assert(forecast_fit(&f, 128, 128, 100) == 10); // as dear as the dearest yet
//	forecast_add(&f, 128, 128, 1);
//	assert(forecast_fit(&f, 0, 256, 100) == 10); // at 10
//	assert(forecast_fit(&f, 128, 128, 100) == 19); // at the mean, which is 5
#ifndef CANDIL_WORKER_PLAN_FORECAST_H
#define CANDIL_WORKER_PLAN_FORECAST_H

#include <stdbool.h>
#include <stdint.h>

#define FORECAST_BINS 256u

// What is known of one pass.
struct forecast {
	uint32_t units; // of the pass
	float us[FORECAST_BINS]; // of a unit in a part of the pass, when it was last done
	bool known[FORECAST_BINS]; // it was
	double dearest_us; // of a unit, where most: by this attempt and the one before it; 0: not known
	double least_us; // what the shortest piece took; 0: there was none
	double mean_us; // of a unit, when the pass was last gone over; 0: not once yet
	double done, taken_us; // units since then, and what they took
};

// A pass of `units` begins, at least one. What is known of it by now was measured at another picture.
void forecast_begin(struct forecast *forecast, uint32_t units);

// Microseconds that `count` units from `first` on take, about; 0 if nothing is known.
double forecast_us(const struct forecast *forecast, uint32_t first, uint32_t count);

// Microseconds within which a piece that begins at unit `first` does not end, however short it is; 0 if nothing is known.
double forecast_least_us(const struct forecast *forecast, uint32_t first);

// How many of the `most` units from `first` on take no more than `us` together, with care: at least one, if there is one. If
// nothing is known, all of them.
uint32_t forecast_fit(const struct forecast *forecast, uint32_t first, uint32_t most, double us);

// A piece of `count` units from `first` on, at least one, took `us`.
void forecast_add(struct forecast *forecast, uint32_t first, uint32_t count, double us);

#endif
