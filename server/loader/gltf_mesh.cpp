#include "server/loader/gltf_parts.h"

#include <cmath>
#include <cstring>

namespace
{

// Bytes of an accessor's elements, all of them inside their buffer.
struct span {
	const unsigned char *data;
	size_t stride;
};

enum status bad(struct error *err, int accessor, const char *what)
{
	return error_set(err, STATUS_SCENE_INVALID, "the glTF file is invalid: accessor %d %s; export it again", accessor,
			 what);
}

enum status find_span(const tinygltf::Model &model, int number, int view_number, size_t offset, size_t element, size_t count,
		      bool strided, span *out, struct error *err)
{
	if (view_number < 0 || view_number >= (int)model.bufferViews.size())
		return bad(err, number, "names a buffer view that is not there");
	const tinygltf::BufferView &view = model.bufferViews[(size_t)view_number];
	if (view.buffer < 0 || view.buffer >= (int)model.buffers.size())
		return bad(err, number, "names a buffer that is not there");
	const std::vector<unsigned char> &bytes = model.buffers[(size_t)view.buffer].data;
	if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
		return bad(err, number, "uses a buffer view that ends behind its buffer");
	const size_t stride = strided && view.byteStride != 0 ? view.byteStride : element;
	if (stride < element)
		return bad(err, number, "has elements longer than their stride");
	// count ≤ LIMIT_VERTICES · 3 and stride ≤ 252: no overflow.
	if (count > 0 && (offset > view.byteLength || (count - 1) * stride + element > view.byteLength - offset))
		return bad(err, number, "ends behind its buffer view");
	*out = {bytes.data() + view.byteOffset + offset, stride};
	return STATUS_OK;
}

double component(const unsigned char *p, int type, bool normalized)
{
	switch (type) {
	case TINYGLTF_COMPONENT_TYPE_BYTE: {
		const double v = (signed char)*p;
		return normalized ? std::fmax(v / 127.0, -1.0) : v;
	}
	case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
		return normalized ? *p / 255.0 : *p;
	case TINYGLTF_COMPONENT_TYPE_SHORT: {
		int16_t v;
		std::memcpy(&v, p, sizeof v);
		return normalized ? std::fmax(v / 32767.0, -1.0) : v;
	}
	case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
		uint16_t v;
		std::memcpy(&v, p, sizeof v);
		return normalized ? v / 65535.0 : v;
	}
	case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: {
		uint32_t v;
		std::memcpy(&v, p, sizeof v);
		return v;
	}
	default: {
		float v;
		std::memcpy(&v, p, sizeof v);
		return v;
	}
	}
}

bool component_is_read(int type)
{
	return type == TINYGLTF_COMPONENT_TYPE_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
	       type == TINYGLTF_COMPONENT_TYPE_SHORT || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
	       type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT || type == TINYGLTF_COMPONENT_TYPE_FLOAT;
}

// Elements as doubles, `width` of them each. Indices are exact in a double too.
struct elements {
	std::vector<double> values;
	size_t count = 0;
};

enum status overlay_sparse(const tinygltf::Model &model, const tinygltf::Accessor &a, int number, size_t width,
			   size_t element, elements *out, struct error *err)
{
	const int type = a.sparse.indices.componentType;
	span indices, values;
	if (a.sparse.count < 1 || (size_t)a.sparse.count > out->count || a.sparse.indices.byteOffset < 0 ||
	    a.sparse.values.byteOffset < 0)
		return bad(err, number, "has a sparse part out of range");
	if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
	    type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
		return bad(err, number, "has sparse indices of a wrong type");
	const size_t count = (size_t)a.sparse.count;
	const size_t index_bytes = (size_t)tinygltf::GetComponentSizeInBytes((uint32_t)type);
	if (find_span(model, number, a.sparse.indices.bufferView, (size_t)a.sparse.indices.byteOffset, index_bytes, count,
		      false, &indices, err) != STATUS_OK ||
	    find_span(model, number, a.sparse.values.bufferView, (size_t)a.sparse.values.byteOffset, element, count, false,
		      &values, err) != STATUS_OK)
		return err->code;
	for (size_t i = 0; i < count; i++) {
		const size_t at = (size_t)component(indices.data + i * indices.stride, type, false);
		if (at >= out->count)
			return bad(err, number, "has a sparse index out of range");
		for (size_t c = 0; c < width; c++)
			out->values[at * width + c] = component(values.data + i * values.stride + c * (element / width),
								a.componentType, a.normalized);
	}
	return STATUS_OK;
}

enum status read_accessor(const tinygltf::Model &model, int number, int type, size_t limit, elements *out, struct error *err)
{
	if (number < 0 || number >= (int)model.accessors.size())
		return bad(err, number, "is not there");
	const tinygltf::Accessor &a = model.accessors[(size_t)number];
	if (a.type != type || !component_is_read(a.componentType))
		return bad(err, number, "has a wrong type for its use");
	if (a.count > limit)
		return error_set(err, STATUS_SCENE_LIMIT, "accessor %d has %zu elements; it may have %zu", number, a.count,
				 limit);
	const size_t width = (size_t)tinygltf::GetNumComponentsInType((uint32_t)type);
	const size_t bytes = (size_t)tinygltf::GetComponentSizeInBytes((uint32_t)a.componentType);
	span from = {nullptr, 0};
	if (a.bufferView >= 0 &&
	    find_span(model, number, a.bufferView, a.byteOffset, width * bytes, a.count, true, &from, err) != STATUS_OK)
		return err->code;
	out->count = a.count;
	out->values.assign(a.count * width, 0.0); // what a sparse accessor without a buffer view starts from
	for (size_t i = 0; i < a.count && from.data; i++)
		for (size_t c = 0; c < width; c++)
			out->values[i * width + c] =
			    component(from.data + i * from.stride + c * bytes, a.componentType, a.normalized);
	return a.sparse.isSparse ? overlay_sparse(model, a, number, width, width * bytes, out, err) : STATUS_OK;
}

enum status read_attribute(const gltf_reader *reader, const tinygltf::Primitive &primitive, const char *name, int type,
			   elements *out, struct error *err)
{
	const auto found = primitive.attributes.find(name);
	out->count = 0;
	return found == primitive.attributes.end()
		   ? STATUS_OK
		   : read_accessor(reader->model, found->second, type, LIMIT_VERTICES, out, err);
}

void note_bounds(gltf_reader *reader, const elements &positions)
{
	double min[3] = {INFINITY, INFINITY, INFINITY}, max[3] = {-INFINITY, -INFINITY, -INFINITY};
	for (size_t i = 0; i < positions.count * 3; i++)
		if (std::isfinite(positions.values[i])) {
			min[i % 3] = std::fmin(min[i % 3], positions.values[i]);
			max[i % 3] = std::fmax(max[i % 3], positions.values[i]);
		}
	import_note_source(reader->import, min, max);
}

// Normals go by the inverse transpose. Its cofactors do without a division, up to a factor that has the determinant's sign.
struct normal_map {
	double c[3][3];
	double determinant;
};

normal_map normals_of(const transform &t)
{
	normal_map m;
	for (int i = 0; i < 3; i++) {
		const double *a = t.c[(i + 1) % 3], *b = t.c[(i + 2) % 3];
		m.c[i][0] = a[1] * b[2] - a[2] * b[1];
		m.c[i][1] = a[2] * b[0] - a[0] * b[2];
		m.c[i][2] = a[0] * b[1] - a[1] * b[0];
	}
	m.determinant = t.c[0][0] * m.c[0][0] + t.c[0][1] * m.c[0][1] + t.c[0][2] * m.c[0][2];
	return m;
}

void place_normal(float out[3], const double *n, const normal_map &map)
{
	double v[3], length = 0;
	for (int row = 0; row < 3; row++) {
		v[row] = map.c[0][row] * n[0] + map.c[1][row] * n[1] + map.c[2][row] * n[2];
		length = std::fmax(length, std::fabs(v[row]));
	}
	// Divided by the largest component first: a float holds it whatever the scale.
	for (int row = 0; row < 3; row++)
		out[row] = length > 0 && std::isfinite(length)
			       ? (float)(map.determinant < 0 ? -v[row] / length : v[row] / length)
			       : 0.0f;
}

enum status add_vertices(gltf_reader *reader, const tinygltf::Primitive &primitive, const transform &world,
			 const elements &positions, struct error *err)
{
	elements normals, uvs;
	if (read_attribute(reader, primitive, "NORMAL", TINYGLTF_TYPE_VEC3, &normals, err) != STATUS_OK ||
	    read_attribute(reader, primitive, "TEXCOORD_0", TINYGLTF_TYPE_VEC2, &uvs, err) != STATUS_OK)
		return err->code;
	if ((normals.count && normals.count != positions.count) || (uvs.count && uvs.count != positions.count))
		return error_set(err, STATUS_SCENE_INVALID,
				 "the glTF file is invalid: a primitive's attributes differ in number; export it again");
	const normal_map map = normals_of(world);
	for (size_t i = 0; i < positions.count; i++) {
		struct import_vertex v = {};
		const double *p = &positions.values[i * 3];
		for (int row = 0; row < 3; row++)
			v.position[row] =
			    world.c[0][row] * p[0] + world.c[1][row] * p[1] + world.c[2][row] * p[2] + world.c[3][row];
		if (normals.count)
			place_normal(v.normal, &normals.values[i * 3], map);
		if (uvs.count) {
			v.uv[0] = (float)uvs.values[i * 2];
			v.uv[1] = (float)uvs.values[i * 2 + 1];
		}
		if (import_add_vertex(reader->import, &v, err) != STATUS_OK)
			return err->code;
	}
	return STATUS_OK;
}

// The three corners of triangle `i` of a list, strip or fan, as places in the index list.
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
	elements indices;
	if (primitive.indices >= 0 && read_accessor(reader->model, primitive.indices, TINYGLTF_TYPE_SCALAR,
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
	for (const auto &attribute : primitive.attributes) {
		if (attribute.first == "COLOR_0" || attribute.first == "TEXCOORD_1")
			import_ignore(import, attribute.first.c_str());
	}
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
	elements positions;
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
	const bool flip = normals_of(world).determinant < 0;
	if (add_vertices(reader, primitive, world, positions, err) != STATUS_OK)
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
