#include "server/scene/blob.h"

#include <string.h>

size_t blob_stride(enum blob_section section)
{
	static const size_t strides[BLOB_SECTIONS] = {
	    [BLOB_NODES] = sizeof(struct bvh_node),
	    [BLOB_LEAF_TRIANGLES] = sizeof(struct leaf_triangle),
	    [BLOB_TRIANGLES] = sizeof(struct triangle),
	    [BLOB_VERTICES] = sizeof(struct vertex),
	    [BLOB_MATERIALS] = sizeof(struct material),
	    [BLOB_TEXTURES] = sizeof(struct texture_info),
	    [BLOB_TEXELS] = sizeof(uint32_t),
	    [BLOB_EMITTERS] = sizeof(struct emitter),
	    [BLOB_LIGHTS] = sizeof(struct punctual_light),
	    [BLOB_CAMERAS] = sizeof(struct blob_camera),
	    [BLOB_MATERIAL_NAMES] = sizeof(struct blob_name),
	    [BLOB_UV1] = sizeof(struct vertex_uv1),
	    [BLOB_COLORS] = sizeof(struct vertex_color),
	    [BLOB_TANGENTS] = sizeof(struct vertex_tangent),
	    [BLOB_SCENE_NODES] = sizeof(struct scene_node),
	    [BLOB_ANIMATIONS] = sizeof(struct scene_animation),
	    [BLOB_CHANNELS] = sizeof(struct scene_channel),
	    [BLOB_CURVES] = sizeof(float),
	    [BLOB_ENVIRONMENT] = sizeof(struct environment_texel),
	    [BLOB_ENVIRONMENT_ROWS] = sizeof(struct environment_row),
	    [BLOB_TEXTURE_RANGES] = sizeof(struct texture_range),
	    [BLOB_MATERIAL_USES] = sizeof(struct material_use),
	    [BLOB_PATCH_ELEMENTS] = sizeof(struct imported_element),
	    [BLOB_FACTOR_ROWS] = sizeof(struct imported_row),
	    [BLOB_FACTOR_ENTRIES] = sizeof(struct imported_factor),
	};
	return strides[section];
}

const void *blob_section(const struct blob_header *blob, enum blob_section section)
{
	return (const char *)blob + blob->sections[section].offset;
}

uint32_t blob_count(const struct blob_header *blob, enum blob_section section)
{
	return (uint32_t)blob->sections[section].count;
}

void blob_view_init(struct blob_view *view, const struct blob_header *blob)
{
	*view = (struct blob_view){
	    .blob = blob, .facts = blob->facts, .emitter_power = blob->emitter_power, .light_power = blob->light_power};
	memcpy(view->bounds_min, blob->bounds_min, sizeof view->bounds_min);
	memcpy(view->bounds_max, blob->bounds_max, sizeof view->bounds_max);
	for (unsigned s = 0; s < BLOB_SECTIONS; s++) {
		view->sections[s] = blob_section(blob, (enum blob_section)s);
		view->counts[s] = blob_count(blob, (enum blob_section)s);
	}
}
