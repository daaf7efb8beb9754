#include "server/worker/image/scale.h"

#include <math.h>
#include <string.h>

#include "protocol/header.h"

// Where the centre of a pixel of the larger picture lies along one axis of the smaller one: between pixels `low` and `high`,
// `share` of the way. `nearest` is the pixel that it is in.
struct place {
	uint32_t low, high, nearest;
	float share;
};

static struct place place_of(uint32_t pixel, uint32_t large, uint32_t small)
{
	const double at = (pixel + 0.5) * small / large;
	const double between = fmin(fmax(at - 0.5, 0), small - 1.0);
	const uint32_t low = (uint32_t)between;
	return (struct place){
	    .low = low, .high = low + 1 < small ? low + 1 : low, .nearest = (uint32_t)at, .share = (float)(between - low)};
}

static float mix(float a, float b, float share)
{
	return a + share * (b - a);
}

// Take over all but the radiance of one pixel.
static void take_rest(const struct frame *from, uint64_t at, struct frame *to, uint64_t i)
{
	to->met[i] = from->met[at];
	if (from->depth)
		to->depth[i] = from->depth[at];
	if (from->normal)
		memcpy(to->normal + 3 * i, from->normal + 3 * at, 3 * sizeof *to->normal);
	if (from->albedo)
		memcpy(to->albedo + 3 * i, from->albedo + 3 * at, 3 * sizeof *to->albedo);
	if (from->id)
		to->id[i] = from->id[at];
}

static void scale_pixel(const struct frame *from, const struct place *x, const struct place *y, struct frame *to, uint64_t i)
{
	const uint64_t above = (uint64_t)y->low * from->width, below = (uint64_t)y->high * from->width;
	const uint64_t nearest = (uint64_t)y->nearest * from->width + x->nearest;
	const float *r = from->radiance;
	for (unsigned c = 0; c < 3; c++)
		to->radiance[3 * i + c] =
		    mix(mix(r[3 * (above + x->low) + c], r[3 * (above + x->high) + c], x->share),
			mix(r[3 * (below + x->low) + c], r[3 * (below + x->high) + c], x->share), y->share);
	take_rest(from, nearest, to, i);
}

enum status frame_scale(struct frame *f, uint32_t width, uint32_t height, struct error *err)
{
	struct frame *large;
	const uint32_t aovs =
	    (f->depth ? AOV_DEPTH : 0) | (f->normal ? AOV_NORMAL : 0) | (f->albedo ? AOV_ALBEDO : 0) | (f->id ? AOV_ID : 0);
	const enum status s = frame_create(width, height, aovs, &large, err);
	if (s != STATUS_OK)
		return s;
	for (uint32_t y = 0; y < height; y++) {
		const struct place row = place_of(y, height, f->height);
		for (uint32_t x = 0; x < width; x++) {
			const struct place column = place_of(x, width, f->width);
			scale_pixel(f, &column, &row, large, (uint64_t)y * width + x);
		}
	}
	frame_take_pixels(f, large);
	return STATUS_OK;
}

void frame_fill(struct frame *f, const struct frame *from, uint32_t side)
{
	const uint32_t tiles_x = (f->width + side - 1) / side;
	for (uint32_t y = 0; y < f->height; y++)
		for (uint32_t x = 0; x < f->width; x++) {
			const uint64_t i = (uint64_t)y * f->width + x;
			if (y / side * tiles_x + x / side < f->ahead)
				continue;
			memcpy(f->radiance + 3 * i, from->radiance + 3 * i, 3 * sizeof *f->radiance);
			take_rest(from, i, f, i);
		}
}
