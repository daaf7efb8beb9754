#include "server/worker/plan/forecast.h"

#include <math.h>

#define LEAST_SHARE 0.01 // of the mean of a piece, that each of its units is taken to have had a part in

static double dearest(const struct forecast *f)
{
	double us = 0;
	for (uint32_t bin = 0; bin < FORECAST_BINS; bin++)
		us = f->known[bin] ? fmax(us, (double)f->us[bin]) : us;
	return us;
}

void forecast_begin(struct forecast *f, uint32_t units)
{
	const double own = dearest(f);
	*f = (struct forecast){.units = units, .dearest_us = own > 0 ? own : f->dearest_us};
}

static uint32_t bin_of(const struct forecast *f, uint32_t unit)
{
	return (uint32_t)((uint64_t)unit * FORECAST_BINS / f->units);
}

// The first unit behind a part.
static uint32_t end_of(const struct forecast *f, uint32_t bin)
{
	return (uint32_t)(((uint64_t)(bin + 1) * f->units + FORECAST_BINS - 1) / FORECAST_BINS);
}

// How many of `count` units from `first` on are in the part in which that one is.
static uint32_t run(const struct forecast *f, uint32_t first, uint32_t count)
{
	const uint32_t end = end_of(f, bin_of(f, first));
	return count < end - first ? count : end - first;
}

static double unit_us(const struct forecast *f, uint32_t bin)
{
	return f->known[bin] ? (double)f->us[bin] : f->dearest_us;
}

// The same with care. Until the pass has been gone over once its mean is not known, nor all of a part of which some is.
static double careful_us(const struct forecast *f, uint32_t bin)
{
	return fmax(unit_us(f, bin), f->mean_us > 0 ? f->mean_us : f->dearest_us);
}

double forecast_us(const struct forecast *f, uint32_t first, uint32_t count)
{
	double us = 0;
	for (uint32_t n = 0; n < count;) {
		const uint32_t more = run(f, first + n, count - n);
		us += more * unit_us(f, bin_of(f, first + n));
		n += more;
	}
	return us;
}

double forecast_least_us(const struct forecast *f, uint32_t first)
{
	return fmax(f->least_us, forecast_us(f, first, 1));
}

uint32_t forecast_fit(const struct forecast *f, uint32_t first, uint32_t most, double us)
{
	uint32_t n = 0;
	while (n < most) {
		const uint32_t more = run(f, first + n, most - n);
		const double each = careful_us(f, bin_of(f, first + n));
		if (more * each > us) {
			n += (uint32_t)fmax(us / each, 0);
			break;
		}
		us -= more * each;
		n += more;
	}
	return n > 0 || most == 0 ? n : 1;
}

// What a piece took is shared among its parts nearly as it was forecast; a part that was forecast to take nothing gets
// something, too, or it could never get more. A part of which the piece had some units alone changes by so much.
void forecast_add(struct forecast *f, uint32_t first, uint32_t count, double us)
{
	const double each = us / count, least = LEAST_SHARE * each;
	const double foreseen = forecast_us(f, first, count) + least * count;
	for (uint32_t n = 0; n < count;) {
		const uint32_t more = run(f, first + n, count - n), bin = bin_of(f, first + n);
		const uint32_t begin = bin > 0 ? end_of(f, bin - 1) : 0;
		const double part = f->known[bin] ? (double)more / (end_of(f, bin) - begin) : 1;
		const double took = foreseen > 0 ? (unit_us(f, bin) + least) * us / foreseen : 0;
		f->us[bin] = (float)((1 - part) * (double)f->us[bin] + part * took);
		n += more;
	}
	for (uint32_t bin = bin_of(f, first); bin <= bin_of(f, first + count - 1); bin++)
		f->known[bin] = true;
	f->dearest_us = fmax(f->dearest_us, dearest(f));
	f->least_us = f->least_us > 0 ? fmin(f->least_us, us) : us;
	f->done += count;
	f->taken_us += us;
	if (f->done < f->units)
		return;
	f->mean_us = f->taken_us / f->done;
	f->done = f->taken_us = 0;
}
