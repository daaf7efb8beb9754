#include "server/scene/ranges.h"

#include <math.h>
#include <string.h>

#include "server/scene/texel.h"

// Texels between two looks at whether anything is left to be learned.
#define STRIDE 4096u

// Bytes that are compared side by side: loops over so many become vector instructions. A texel's bytes are its channels, red
// first, on this order of bytes.
#define LANES 64u
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "a texel's first byte is its red");

struct lanes {
	uint8_t low[LANES], high[LANES];
};

static void widen(struct lanes *l, const uint8_t *bytes)
{
	for (unsigned k = 0; k < LANES; k++) {
		l->low[k] = bytes[k] < l->low[k] ? bytes[k] : l->low[k];
		l->high[k] = bytes[k] > l->high[k] ? bytes[k] : l->high[k];
	}
}

static struct texture_range range_of_lanes(const struct lanes *l)
{
	struct texture_range range = {.low = {255, 255, 255, 255}};
	for (unsigned k = 0; k < LANES; k++) {
		range.low[k % 4] = l->low[k] < range.low[k % 4] ? l->low[k] : range.low[k % 4];
		range.high[k % 4] = l->high[k] > range.high[k % 4] ? l->high[k] : range.high[k % 4];
	}
	return range;
}

static bool is_whole(const struct texture_range *range)
{
	for (int c = 0; c < 4; c++)
		if (range->low[c] > 0 || range->high[c] < 255)
			return false;
	return true;
}

static struct texture_range range_of_texels(const uint32_t *texels, size_t count)
{
	const uint8_t *bytes = (const uint8_t *)texels;
	const size_t end = count * 4;
	struct texture_range range;
	struct lanes l;
	size_t at = 0;
	memset(l.low, 255, sizeof l.low);
	memset(l.high, 0, sizeof l.high);
	bool whole = false;
	while (at + LANES <= end && !whole) {
		const size_t stop = end - at < STRIDE * 4 ? end : at + STRIDE * 4;
		for (; at + LANES <= stop; at += LANES)
			widen(&l, bytes + at);
		range = range_of_lanes(&l);
		whole = is_whole(&range);
	}
	// The last texels, fewer than there are lanes, in all lanes.
	for (; at < end && !whole; at += 4) {
		uint8_t rest[LANES];
		for (unsigned k = 0; k < LANES; k++)
			rest[k] = bytes[at + k % 4];
		widen(&l, rest);
	}
	return range_of_lanes(&l);
}

// Of texels of 16 bits a channel: rounded away from the middle, so that no number lies outside.
static struct texture_range range_of_deep(const struct texture_info *texture, const uint32_t *texels)
{
	struct texture_range range = {.low = {255, 255, 255, 255}};
	const size_t count = (size_t)texture->width * texture->height;
	for (size_t i = 0; i < count && (i % STRIDE || !is_whole(&range)); i++)
		for (unsigned c = 0; c < 4; c++) {
			const uint32_t number = texel_channel(texture, texels, i, c);
			const uint8_t low = (uint8_t)(number / 257), high = (uint8_t)((number + 256) / 257);
			range.low[c] = low < range.low[c] ? low : range.low[c];
			range.high[c] = high > range.high[c] ? high : range.high[c];
		}
	return range;
}

static struct texture_range range_of(const struct texture_info *texture, const uint32_t *texels)
{
	if (texture->flags & TEXTURE_DEEP)
		return range_of_deep(texture, texels);
	return range_of_texels(texels + texture->offset, (size_t)texture->width * texture->height);
}

void ranges_of_textures(const struct texture_info *textures, uint32_t count, const uint32_t *texels,
			struct texture_range *out)
{
	for (uint32_t i = 0; i < count; i++) {
		uint32_t same = 0;
		while (textures[same].offset != textures[i].offset || textures[same].width != textures[i].width ||
		       textures[same].height != textures[i].height)
			same++;
		out[i] = same < i ? out[same] : range_of(&textures[i], texels);
	}
}

static void widen_colors(struct material_use *use, const float color[4], bool first)
{
	for (int c = 0; c < 4; c++) {
		use->color_low[c] = first ? color[c] : fminf(use->color_low[c], color[c]);
		use->color_high[c] = first ? color[c] : fmaxf(use->color_high[c], color[c]);
	}
}

static bool is_there(const struct vertex_tangent *t)
{
	return t->xyzw[0] > 0 || t->xyzw[0] < 0 || t->xyzw[1] > 0 || t->xyzw[1] < 0 || t->xyzw[2] > 0 || t->xyzw[2] < 0;
}

void ranges_of_materials(const struct triangle *triangles, uint32_t count, const struct vertex_color *colors,
			 const struct vertex_tangent *tangents, uint32_t material_count, struct material_use *out)
{
	for (uint32_t m = 0; m < material_count; m++)
		out[m] = (struct material_use){0, 0, {1, 1, 1, 1}, {1, 1, 1, 1}};
	for (uint32_t i = 0; i < count; i++) {
		struct material_use *use = &out[triangles[i].material];
		const uint32_t *v = triangles[i].vertex;
		for (int k = 0; k < 3 && colors; k++)
			widen_colors(use, colors[v[k]].rgba, use->triangles == 0 && k == 0);
		use->tangents +=
		    tangents && (is_there(&tangents[v[0]]) || is_there(&tangents[v[1]]) || is_there(&tangents[v[2]]));
		use->triangles++;
	}
}

struct range range_of_texture(const struct blob_view *view, uint32_t texture, int channel)
{
	const struct texture_range *ranges = view->sections[BLOB_TEXTURE_RANGES];
	if (texture >= view->counts[BLOB_TEXTURE_RANGES])
		return (struct range){1, 1};
	return (struct range){(float)ranges[texture].low[channel] / 255, (float)ranges[texture].high[channel] / 255};
}

struct range range_times(struct range a, struct range b)
{
	return (struct range){a.low * b.low, a.high * b.high};
}
