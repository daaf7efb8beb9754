// Ranges: between which values a texture's channels and a material's vertex colours lie. By them the facts (facts.h) tell an
// effect that changes nothing from one that does, without reading a texel again. The loader finds them once, and the blob
// carries them. One thread; cannot fail.
#ifndef CANDIL_SCENE_RANGES_H
#define CANDIL_SCENE_RANGES_H

#include <stdbool.h>
#include <stdint.h>

#include "server/scene/blob.h"

// A closed range of values.
struct range {
	float low, high;
};

// The range of each texture, out[i] that of textures[i], whose texels must be within `texels`. Reads each image once,
// however many textures share it, and stops at the texel from which on nothing more can be learned.
void ranges_of_textures(const struct texture_info *textures, uint32_t count, const uint32_t *texels,
			struct texture_range *out);

// How triangles use each material, out[m] for m below `material_count`. By vertex, each may be NULL: `colors` (all are
// white) and `tangents` (there are none).
void ranges_of_materials(const struct triangle *triangles, uint32_t count, const struct vertex_color *colors,
			 const struct vertex_tangent *tangents, uint32_t material_count, struct material_use *out);

// The range of a texture's channel (0 to 3: red to alpha) as a share of its largest code, [1, 1] for NONE. Of an sRGB
// texture this is the code, not the linear value: both are 0, and 1, at the same places.
struct range range_of_texture(const struct blob_view *view, uint32_t texture, int channel);

// The range of the products of two ranges of values that are not negative.
struct range range_times(struct range a, struct range b);

#endif
