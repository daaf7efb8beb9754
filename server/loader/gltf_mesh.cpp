#include "server/loader/gltf_accessor.h"

#include <cmath>
#include <string>

namespace
{

enum status read_attribute(const gltf_reader *reader, const tinygltf::Primitive &primitive, const char *name, int type,
			   gltf_elements *out, struct error *err)
{
	const auto found = primitive.attributes.find(name);
	out->count = 0;
	return found == primitive.attributes.end()
		   ? STATUS_OK
		   : gltf_read_accessor(reader->model, found->second, type, LIMIT_VERTICES, out, err);
}

void note_bounds(gltf_reader *reader, const gltf_elements &positions)
{
	double min[3] = {INFINITY, INFINITY, INFINITY}, max[3] = {-INFINITY, -INFINITY, -INFINITY};
	for (size_t i = 0; i < positions.count * 3; i++)
		if (std::isfinite(positions.values[i])) {
			min[i % 3] = std::fmin(min[i % 3], positions.values[i]);
			max[i % 3] = std::fmax(max[i % 3], positions.values[i]);
		}
	import_note_source(reader->import, min, max);
}

// The attributes of a primitive's vertices except the positions. Those that nothing uses stay empty.
struct attributes {
	gltf_elements normals, uvs, uvs1, colors, tangents;
	size_t color_width = 0;
};

enum status read_colors(const gltf_reader *reader, const tinygltf::Primitive &primitive, attributes *out, struct error *err)
{
	const auto found = primitive.attributes.find("COLOR_0");
	if (found == primitive.attributes.end())
		return STATUS_OK;
	const std::vector<tinygltf::Accessor> &all = reader->model.accessors;
	const bool three = (size_t)found->second < all.size() && all[(size_t)found->second].type == TINYGLTF_TYPE_VEC3;
	out->color_width = three ? 3 : 4;
	return read_attribute(reader, primitive, "COLOR_0", three ? TINYGLTF_TYPE_VEC3 : TINYGLTF_TYPE_VEC4, &out->colors,
			      err);
}

enum status read_attributes(const gltf_reader *reader, const tinygltf::Primitive &primitive, uint32_t material, size_t count,
			    attributes *out, struct error *err)
{
	const struct import *import = reader->import;
	if (read_attribute(reader, primitive, "NORMAL", TINYGLTF_TYPE_VEC3, &out->normals, err) != STATUS_OK ||
	    read_attribute(reader, primitive, "TEXCOORD_0", TINYGLTF_TYPE_VEC2, &out->uvs, err) != STATUS_OK ||
	    read_colors(reader, primitive, out, err) != STATUS_OK)
		return err->code;
	if (reader->uses_second_uvs &&
	    read_attribute(reader, primitive, "TEXCOORD_1", TINYGLTF_TYPE_VEC2, &out->uvs1, err) != STATUS_OK)
		return err->code;
	if (import_tangent_map(&import->materials[material]) != NONE &&
	    read_attribute(reader, primitive, "TANGENT", TINYGLTF_TYPE_VEC4, &out->tangents, err) != STATUS_OK)
		return err->code;
	for (const gltf_elements *e : {&out->normals, &out->uvs, &out->uvs1, &out->colors, &out->tangents})
		if (e->count && e->count != count)
			return error_set(err, STATUS_SCENE_INVALID,
					 "the glTF file is invalid: a primitive's attributes differ in number; export it "
					 "again");
	return STATUS_OK;
}

// Fill in a vertex's extra. False if a colour had to be clamped.
bool fill_extra(const attributes &from, size_t i, const transform &world, const transform_normals &map,
		struct import_extra *out)
{
	bool fit = true;
	*out = {{0, 0}, {1, 1, 1, 1}, {0, 0, 0, 0}};
	for (size_t c = 0; c < 2 && from.uvs1.count; c++)
		out->uv1[c] = (float)from.uvs1.values[i * 2 + c];
	for (size_t c = 0; c < from.color_width && from.colors.count; c++)
		fit &= import_fit(&out->color[c], from.colors.values[i * from.color_width + c], (double)BLOB_COLOR_MAX);
	if (from.tangents.count)
		transform_tangent(&world, &map, &from.tangents.values[i * 4], out->tangent);
	return fit;
}

enum status add_vertex(struct import *import, const attributes &from, size_t i, const double *p, const transform &world,
		       const transform_normals &map, struct error *err)
{
	struct import_vertex v = {};
	struct import_extra extra;
	transform_point(&world, p, v.position);
	if (from.normals.count)
		transform_normal(&map, &from.normals.values[i * 3], v.normal);
	for (size_t c = 0; c < 2 && from.uvs.count; c++)
		v.uv[c] = (float)from.uvs.values[i * 2 + c];
	if (import_add_vertex(import, &v, err) != STATUS_OK)
		return err->code;
	if (!from.uvs1.count && !from.colors.count && !from.tangents.count)
		return STATUS_OK;
	if (!fill_extra(from, i, world, map, &extra))
		import_warn(import, "a vertex colour was out of range and has been clamped");
	return import_set_extra(import, &extra, err);
}

enum status add_vertices(gltf_reader *reader, const tinygltf::Primitive &primitive, uint32_t material,
			 const transform &world, const gltf_elements &positions, struct error *err)
{
	attributes from;
	if (read_attributes(reader, primitive, material, positions.count, &from, err) != STATUS_OK)
		return err->code;
	const transform_normals map = transform_normals_of(&world);
	for (size_t i = 0; i < positions.count; i++)
		if (add_vertex(reader->import, from, i, &positions.values[i * 3], world, map, err) != STATUS_OK)
			return err->code;
	return STATUS_OK;
}

// The three corners of triangle `i` of a list, strip or fan, as positions in the index list.
void corners(int mode, size_t i, size_t out[3])
{
	if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
		out[0] = i;
		out[1] = i + 1 + i % 2;
		out[2] = i + 2 - i % 2;
	} else if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
		out[0] = i + 1;
		out[1] = i + 2;
		out[2] = 0;
	} else {
		out[0] = i * 3;
		out[1] = i * 3 + 1;
		out[2] = i * 3 + 2;
	}
}

enum status add_triangles(gltf_reader *reader, const tinygltf::Primitive &primitive, size_t first, size_t vertex_count,
			  uint32_t material, bool flip, struct error *err)
{
	gltf_elements indices;
	if (primitive.indices >= 0 && gltf_read_accessor(reader->model, primitive.indices, TINYGLTF_TYPE_SCALAR,
							 (size_t)LIMIT_TRIANGLES * 3, &indices, err) != STATUS_OK)
		return err->code;
	const bool indexed = primitive.indices >= 0;
	const size_t count = indexed ? indices.count : vertex_count;
	const size_t triangles = primitive.mode == TINYGLTF_MODE_TRIANGLES ? count / 3 : count < 3 ? 0 : count - 2;
	for (size_t i = 0; i < triangles; i++) {
		struct triangle t = {{0, 0, 0}, material};
		size_t corner[3];
		bool inside = true;
		corners(primitive.mode, i, corner);
		for (int k = 0; k < 3; k++) {
			const double v = indexed ? indices.values[corner[k]] : (double)corner[k];
			inside = inside && v >= 0 && v < (double)vertex_count;
			t.vertex[flip && k > 0 ? 3 - k : k] = inside ? (uint32_t)(first + (size_t)v) : 0;
		}
		if (!inside)
			reader->import->info->dropped_out_of_range++;
		else if (import_add_triangle(reader->import, &t, err) != STATUS_OK)
			return err->code;
	}
	return STATUS_OK;
}

void list_ignored(struct import *import, const tinygltf::Primitive &primitive)
{
	if (!primitive.targets.empty())
		import_ignore(import, "morph targets");
}

enum status pick_material(gltf_reader *reader, const tinygltf::Primitive &primitive, uint32_t *material, struct error *err)
{
	if (primitive.material < 0)
		return gltf_default_material(reader, material, err);
	if (primitive.material >= (int)reader->model.materials.size())
		return error_set(err, STATUS_SCENE_INVALID,
				 "the glTF file is invalid: a primitive names material %d of %zu; export it again",
				 primitive.material, reader->model.materials.size());
	*material = (uint32_t)primitive.material;
	return STATUS_OK;
}

enum status add_primitive(gltf_reader *reader, const tinygltf::Primitive &primitive, const transform &world,
			  struct error *err)
{
	struct import *import = reader->import;
	gltf_elements positions;
	uint32_t material;
	if (primitive.mode < TINYGLTF_MODE_POINTS || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
		return error_set(err, STATUS_SCENE_INVALID, "the glTF file is invalid: a primitive has mode %d",
				 primitive.mode);
	if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
		import_ignore(import, primitive.mode == TINYGLTF_MODE_POINTS ? "points" : "lines");
		return STATUS_OK;
	}
	if (primitive.attributes.find("POSITION") == primitive.attributes.end()) {
		import_warn(import, "a primitive without positions is left out");
		return STATUS_OK;
	}
	if (read_attribute(reader, primitive, "POSITION", TINYGLTF_TYPE_VEC3, &positions, err) != STATUS_OK ||
	    pick_material(reader, primitive, &material, err) != STATUS_OK)
		return err->code;
	list_ignored(import, primitive);
	note_bounds(reader, positions);
	const size_t first = import->vertex_count;
	const bool flip = transform_normals_of(&world).determinant < 0;
	if (add_vertices(reader, primitive, material, world, positions, err) != STATUS_OK)
		return err->code;
	return add_triangles(reader, primitive, first, positions.count, material, flip, err);
}

} // namespace

enum status gltf_add_mesh(gltf_reader *reader, const tinygltf::Mesh &mesh, const transform &world, struct error *err)
{
	for (const tinygltf::Primitive &primitive : mesh.primitives)
		if (add_primitive(reader, primitive, world, err) != STATUS_OK)
			return err->code;
	return STATUS_OK;
}
