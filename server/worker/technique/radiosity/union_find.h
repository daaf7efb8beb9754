// Sets of numbers that are joined two at a time, as an array: same[i] is i or leads to the least of i's set (Tarjan 1975).
// Any thread; nothing fails.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_UNION_FIND_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_UNION_FIND_H

#include <stdint.h>

// The least number of i's set. It halves the way there for the next time.
static inline uint32_t union_find(uint32_t *same, uint32_t i)
{
	while (same[i] != i) {
		same[i] = same[same[i]];
		i = same[i];
	}
	return i;
}

// Join the sets of two numbers.
static inline void union_join(uint32_t *same, uint32_t a, uint32_t b)
{
	a = union_find(same, a);
	b = union_find(same, b);
	same[a > b ? a : b] = a < b ? a : b;
}

#endif
