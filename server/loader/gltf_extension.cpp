// Access to the extension objects of a material.
#include "server/loader/gltf_parts.h"

#include <string>

const tinygltf::Value *gltf_extension_of(const tinygltf::Material &m, const char *name)
{
	const auto found = m.extensions.find(name);
	return found == m.extensions.end() ? nullptr : &found->second;
}

enum status gltf_texture_in(gltf_reader *reader, const tinygltf::Value &object, const char *key, uint32_t flags,
			    uint32_t *texture, struct error *err)
{
	const tinygltf::Value &info = object.Get(key);
	tinygltf::ExtensionMap extensions;
	if (info.Has("extensions"))
		for (const std::string &name : info.Get("extensions").Keys())
			extensions.emplace(name, info.Get("extensions").Get(name));
	const gltf_slot slot = {(int)gltf_number(info, "index", -1), (int)gltf_number(info, "texCoord", 0), &extensions};
	return gltf_find_texture(reader, slot, flags, texture, err);
}
