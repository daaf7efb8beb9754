#include "server/compare/comparison.h"

#include <stdlib.h>
#include <string.h>

static enum status copy(const struct picture *from, struct picture *to, struct error *err)
{
	const size_t bytes = (size_t)from->width * from->height * 3 * sizeof *from->rgb;
	*to = *from;
	to->rgb = malloc(bytes);
	if (!to->rgb)
		return error_set(err, STATUS_MEMORY, "no memory to compare");
	memcpy(to->rgb, from->rgb, bytes);
	return STATUS_OK;
}

enum status comparison_make(const struct picture *a, const struct picture *b, double mask_above,
			    struct comparison *comparison, float *error, float *flip_map, struct error *err)
{
	struct picture x = {0}, r = {0};
	comparison->high_range = !a->is_display || !b->is_display;
	enum status s = metrics_compare(a, b, mask_above, &comparison->metrics, error, err);
	// Copies, in which the pixels that do not count are blanked: the originals are still needed for drawing.
	if (s == STATUS_OK)
		s = copy(a, &x, err);
	if (s == STATUS_OK)
		s = copy(b, &r, err);
	if (s == STATUS_OK) {
		metrics_blank(&x, &r, error);
		s = flip_compare(&x, &r, error, comparison->high_range, &comparison->flip, flip_map, err);
	}
	picture_finish(&x);
	picture_finish(&r);
	return s;
}
