#include "server/loader/gltf_accessor.h"

#include <cmath>
#include <cstring>

namespace
{

// The bytes of an accessor's elements, all of them inside their buffer.
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

enum status overlay_sparse(const tinygltf::Model &model, const tinygltf::Accessor &a, int number, size_t width,
			   size_t element, gltf_elements *out, struct error *err)
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

} // namespace

enum status gltf_read_accessor(const tinygltf::Model &model, int number, int type, size_t limit, gltf_elements *out,
			       struct error *err)
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
	out->values.assign(a.count * width, 0.0); // the initial values of a sparse accessor without a buffer view
	for (size_t i = 0; i < a.count && from.data; i++)
		for (size_t c = 0; c < width; c++)
			out->values[i * width + c] =
			    component(from.data + i * from.stride + c * bytes, a.componentType, a.normalized);
	return a.sparse.isSparse ? overlay_sparse(model, a, number, width, width * bytes, out, err) : STATUS_OK;
}
