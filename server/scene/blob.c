#include "server/scene/blob.h"

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
