#include "server/worker/technique/radiosity/sliced_sort.h"

#include <stdlib.h>
#include <string.h>

#define RUN 1024u // items that qsort gets

void sliced_sort_begin(struct sliced_sort *s, void *items, void *spare, uint32_t count, size_t size,
		       int (*compare)(const void *a, const void *b))
{
	*s = (struct sliced_sort){items, spare, size, count, compare, .done = count == 0};
}

static uint32_t least(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

// The next pass, over runs of `width`.
static void begin_pass(struct sliced_sort *s, uint32_t width)
{
	s->width = width;
	s->at = 0;
	s->done = width >= s->count;
}

static void sort_run(struct sliced_sort *s)
{
	const uint32_t n = least(RUN, s->count - s->at);
	qsort((unsigned char *)s->items + s->at * s->size, n, s->size, s->compare);
	s->at += n;
	if (s->at == s->count)
		begin_pass(s, RUN);
}

// Merge at most `moves` items of two runs. Returns how many.
static uint32_t merge(struct sliced_sort *s, uint32_t moves)
{
	const uint32_t n = least(s->width, s->count - s->at), m = least(s->width, s->count - s->at - n);
	const unsigned char *one = (const unsigned char *)s->items + s->at * s->size, *two = one + n * s->size;
	unsigned char *out = (unsigned char *)s->spare + (s->at + s->left + s->right) * s->size;
	uint32_t moved = 0;
	for (; moved < moves && s->left + s->right < n + m; moved++, out += s->size) {
		const unsigned char *a = one + s->left * s->size, *b = two + s->right * s->size;
		const bool first = s->right == m || (s->left < n && s->compare(a, b) <= 0);
		memcpy(out, first ? a : b, s->size);
		s->left += first;
		s->right += !first;
	}
	if (s->left + s->right == n + m) {
		s->at += n + m;
		s->left = s->right = 0;
	}
	return moved;
}

void sliced_sort_step(struct sliced_sort *s, uint32_t moves)
{
	while (!s->done && moves > 0) {
		if (s->width == 0) {
			sort_run(s);
			moves -= least(moves, RUN);
			continue;
		}
		moves -= merge(s, moves);
		if (s->at == s->count) {
			void *merged = s->spare;
			s->spare = s->items;
			s->items = merged;
			begin_pass(s, s->width > s->count / 2 ? s->count : 2 * s->width);
		}
	}
}
