#include "server/loader/gltf_accessor.h"

#include <cmath>
#include <string>

extern "C" {
#include "server/scene/transform.h"
}

namespace
{

struct instances {
	gltf_elements translations, rotations, scales;
	size_t count = 0;
	bool known = false; // whether the count is known
};

enum status read_part(const gltf_reader *reader, const tinygltf::Node &node, const char *name, int type, gltf_elements *out,
		      instances *all, struct error *err)
{
	const tinygltf::Value &attributes = *gltf_instances_of(node);
	if (!attributes.Has(name))
		return STATUS_OK;
	if (gltf_read_accessor(reader->model, (int)gltf_number(attributes, name, -1), type, LIMIT_INSTANCES, out, err) !=
	    STATUS_OK)
		return err->code;
	if (all->known && all->count != out->count)
		return error_set(err, STATUS_SCENE_INVALID,
				 "the glTF file is invalid: the instances of node '%.60s' have attributes that differ in "
				 "number; export it again",
				 node.name.c_str());
	all->count = out->count;
	all->known = true;
	return STATUS_OK;
}

transform place_of(const instances &all, size_t i)
{
	transform_parts parts = transform_no_parts;
	double length = 0;
	for (size_t c = 0; c < 4 && all.rotations.count; c++)
		length += all.rotations.values[i * 4 + c] * all.rotations.values[i * 4 + c];
	length = std::sqrt(length);
	for (size_t c = 0; c < 4 && length > 0 && std::isfinite(length); c++)
		parts.rotation[c] = all.rotations.values[i * 4 + c] / length;
	for (size_t c = 0; c < 3 && all.scales.count; c++)
		parts.scale[c] = all.scales.values[i * 3 + c];
	for (size_t c = 0; c < 3 && all.translations.count; c++)
		parts.translation[c] = all.translations.values[i * 3 + c];
	return transform_of_parts(&parts);
}

} // namespace

const tinygltf::Value *gltf_instances_of(const tinygltf::Node &node)
{
	const auto found = node.extensions.find("EXT_mesh_gpu_instancing");
	if (found == node.extensions.end() || !found->second.Has("attributes"))
		return nullptr;
	const tinygltf::Value &attributes = found->second.Get("attributes");
	return attributes.Has("TRANSLATION") || attributes.Has("ROTATION") || attributes.Has("SCALE") ? &attributes
												      : nullptr;
}

enum status gltf_add_instances(gltf_reader *reader, const tinygltf::Node &node, const transform &world, struct error *err)
{
	const tinygltf::Mesh &mesh = reader->model.meshes[(size_t)node.mesh];
	instances all;
	if (!gltf_instances_of(node))
		return gltf_add_mesh(reader, mesh, world, err);
	if (read_part(reader, node, "TRANSLATION", TINYGLTF_TYPE_VEC3, &all.translations, &all, err) != STATUS_OK ||
	    read_part(reader, node, "ROTATION", TINYGLTF_TYPE_VEC4, &all.rotations, &all, err) != STATUS_OK ||
	    read_part(reader, node, "SCALE", TINYGLTF_TYPE_VEC3, &all.scales, &all, err) != STATUS_OK)
		return err->code;
	for (size_t i = 0; i < all.count; i++) {
		const transform local = place_of(all, i);
		const transform place = transform_compose(&world, &local);
		if (!transform_is_finite(&place) || !transform_is_finite(&local))
			import_warn(reader->import, "an instance of node '%.60s' is left out: its transform is not finite",
				    node.name.c_str());
		else if (gltf_add_mesh(reader, mesh, place, err) != STATUS_OK)
			return err->code;
	}
	return STATUS_OK;
}
