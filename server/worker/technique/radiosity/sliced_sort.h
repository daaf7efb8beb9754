// A sort that is done in slices: runs are sorted, then merged two by two. Its time is n log n whatever the items, and the
// order is that of qsort where `compare` takes no two for equal. Host only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_SLICED_SORT_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_SLICED_SORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

// A sort under way.
struct sliced_sort {
	void *items, *spare; // the caller's, of equal length
	size_t size; // of an item, bytes
	uint32_t count;
	int (*compare)(const void *a, const void *b);
	uint32_t width; // of the runs that are merged; 0: runs are being sorted
	uint32_t at; // where the two begin that are being merged, or the next run to be sorted
	uint32_t left, right; // taken from the two
	bool done;
};

// Begin. `items` and `spare` have room for `count` items each, and are the sort's until it is done.
void sliced_sort_begin(struct sliced_sort *sort, void *items, void *spare, uint32_t count, size_t size,
		       int (*compare)(const void *a, const void *b));

// Move about `moves` items. Once `done` is true, `items` are sorted, which is either of the two arrays that it began with.
void sliced_sort_step(struct sliced_sort *sort, uint32_t moves);

#endif
