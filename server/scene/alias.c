#include "server/scene/alias.h"

#include <stdlib.h>

// The probabilities that the finished rows produce: a row's own share and what other rows pass on to it.
static void fill_pmf(struct alias_row *rows, size_t count, double *share)
{
	for (size_t i = 0; i < count; i++)
		share[i] = 0;
	for (size_t i = 0; i < count; i++) {
		share[i] += rows[i].keep;
		share[rows[i].alias] += 1.0 - (double)rows[i].keep;
	}
	for (size_t i = 0; i < count; i++)
		rows[i].pmf = (float)(share[i] / (double)count);
}

// `share` starts as weight · count / sum. Rows above 1 fill up rows below 1. `queue` holds the rows below 1 at its front
// and those above 1 at its back.
static void pair_rows(struct alias_row *rows, size_t count, double *share, uint32_t *queue)
{
	size_t poor = 0, rich = count;
	for (size_t i = 0; i < count; i++) {
		rows[i] = (struct alias_row){.keep = 1.0f, .alias = (uint32_t)i};
		if (share[i] < 1.0)
			queue[poor++] = (uint32_t)i;
		else
			queue[--rich] = (uint32_t)i;
	}
	while (poor > 0 && rich < count) {
		const uint32_t low = queue[--poor], high = queue[rich];
		rows[low].keep = (float)share[low];
		rows[low].alias = high;
		share[high] = (share[high] + share[low]) - 1.0;
		if (share[high] < 1.0) {
			rich++;
			queue[poor++] = high;
		}
	}
}

enum status alias_build(const double *weights, size_t count, struct alias_row *rows, double *sum, struct error *err)
{
	double *share = malloc((count + 1) * sizeof *share);
	uint32_t *queue = malloc((count + 1) * sizeof *queue);
	enum status status = STATUS_OK;

	*sum = 0;
	if (!share || !queue) {
		status = error_set(err, STATUS_MEMORY, "no memory for a table of %zu lights", count);
		goto out;
	}
	for (size_t i = 0; i < count; i++)
		*sum += weights[i];
	for (size_t i = 0; i < count; i++)
		share[i] = weights[i] / *sum * (double)count;
	pair_rows(rows, count, share, queue);
	fill_pmf(rows, count, share);
out:
	free(queue);
	free(share);
	return status;
}
