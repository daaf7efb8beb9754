#include "server/compare/origin.h"

#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "protocol/names.h"

static bool differ(const char *a, const char *b)
{
	return a[0] && b[0] && strcmp(a, b) != 0;
}

static bool has_noise(const struct origin *o)
{
	const int number = technique_number(o->technique, strlen(o->technique));
	return number >= 0 && technique_traits((unsigned)number) & TECHNIQUE_NOISE;
}

// How many samples of a pixel are the same random numbers in both; *first is the first of them.
static uint64_t shared_samples(const struct origin *a, const struct origin *b, uint64_t *first)
{
	const uint64_t end_a = a->first_sample + a->samples, end_b = b->first_sample + b->samples,
		       end = end_a < end_b ? end_a : end_b;
	*first = a->first_sample > b->first_sample ? a->first_sample : b->first_sample;
	return has_noise(a) && strcmp(a->technique, b->technique) == 0 && a->seed == b->seed && end > *first ? end - *first
													     : 0;
}

unsigned origin_compare(const struct origin *a, const struct origin *b,
			char warnings[ORIGIN_WARNINGS_MAX][ORIGIN_WARNING_BYTES])
{
	unsigned count = 0;
	uint64_t first;
	if (differ(a->scene, b->scene))
		snprintf(warnings[count++], ORIGIN_WARNING_BYTES,
			 "the pictures are of two scenes, or of two states of one: the difference is no error");
	else if (differ(a->view, b->view))
		snprintf(warnings[count++], ORIGIN_WARNING_BYTES,
			 "the pictures are seen by two cameras: the difference is no error");
	const char *scaled = a->made_of[0] ? a->made_of : b->made_of;
	if (scaled[0])
		snprintf(
		    warnings[count++], ORIGIN_WARNING_BYTES,
		    "a deadline left time for %s pixels in one of the pictures, which is scaled: much of the difference is "
		    "that",
		    scaled);
	const uint64_t shared = shared_samples(a, b, &first);
	if (shared > 0)
		snprintf(warnings[count++], ORIGIN_WARNING_BYTES,
			 "both pictures have seed %" PRIu64 " and share samples %" PRIu64 " to %" PRIu64
			 ": the difference is smaller than the error; give one of them another --seed",
			 a->seed, first, first + shared - 1);
	return count;
}
