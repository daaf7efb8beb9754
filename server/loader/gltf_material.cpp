#include "server/loader/gltf_parts.h"

#include <cstring>
#include <string>

namespace
{

uint32_t wrap_of(int mode)
{
	return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? WRAP_CLAMP
	       : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? WRAP_MIRROR
							       : WRAP_REPEAT;
}

uint32_t flags_of(const tinygltf::Model &model, const tinygltf::Texture &texture)
{
	const tinygltf::Sampler standard;
	const tinygltf::Sampler &s = texture.sampler >= 0 ? model.samplers[(size_t)texture.sampler] : standard;
	return TEXTURE_SRGB | wrap_of(s.wrapS) << TEXTURE_WRAP_S_SHIFT | wrap_of(s.wrapT) << TEXTURE_WRAP_T_SHIFT |
	       (s.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST ? TEXTURE_NEAREST : 0u);
}

int hex(char c)
{
	return c >= '0' && c <= '9'   ? c - '0'
	       : c >= 'a' && c <= 'f' ? c - 'a' + 10
	       : c >= 'A' && c <= 'F' ? c - 'A' + 10
				      : -1;
}

std::string percent_decoded(const std::string &uri)
{
	std::string out;
	for (size_t i = 0; i < uri.size(); i++) {
		if (uri[i] == '%' && i + 2 < uri.size() && hex(uri[i + 1]) >= 0 && hex(uri[i + 2]) >= 0) {
			out.push_back((char)(hex(uri[i + 1]) * 16 + hex(uri[i + 2])));
			i += 2;
		} else {
			out.push_back(uri[i]);
		}
	}
	return out;
}

// Encoded bytes that lie within the file itself; null if they do not.
const unsigned char *embedded_bytes(const tinygltf::Model &model, const tinygltf::Image &image, size_t *size)
{
	*size = image.image.size();
	if (image.bufferView < 0)
		return image.image.empty() ? nullptr : image.image.data();
	if (image.bufferView >= (int)model.bufferViews.size())
		return nullptr;
	const tinygltf::BufferView &view = model.bufferViews[(size_t)image.bufferView];
	if (view.buffer < 0 || view.buffer >= (int)model.buffers.size())
		return nullptr;
	const std::vector<unsigned char> &bytes = model.buffers[(size_t)view.buffer].data;
	if (view.byteLength == 0 || view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
		return nullptr;
	*size = view.byteLength;
	return bytes.data() + view.byteOffset;
}

enum status image_texture(gltf_reader *reader, int number, uint32_t flags, uint32_t *texture, struct error *err)
{
	struct import *import = reader->import;
	const tinygltf::Image &image = reader->model.images[(size_t)number];
	const bool in_file = image.uri.empty() || image.uri.compare(0, 5, "data:") == 0;
	const std::string key = in_file ? "image " + std::to_string(number) : percent_decoded(image.uri);
	struct file_bytes file = {nullptr, 0};
	struct error why;
	size_t size = 0;
	const unsigned char *bytes = nullptr;

	if (!import_knows_image(import, key.c_str())) {
		if (in_file) {
			bytes = embedded_bytes(reader->model, image, &size);
			error_set(&why, STATUS_SCENE_INVALID, "its bytes are not in the file");
		} else if (files_read(import->files, key.c_str(), &file, &why) == STATUS_OK) {
			bytes = file.data;
			size = file.size;
		}
		if (!bytes && import_missing_image(import, key.c_str(), why.text, err) != STATUS_OK)
			return err->code;
	}
	enum status status = import_texture(import, key.c_str(), bytes, size, false, flags, texture, err);
	file_bytes_finish(&file);
	return status;
}

enum status find_texture(gltf_reader *reader, const tinygltf::TextureInfo &info, uint32_t *out, struct error *err)
{
	const tinygltf::Model &model = reader->model;
	*out = NONE;
	if (info.index < 0)
		return STATUS_OK;
	if (info.index >= (int)model.textures.size())
		return error_set(err, STATUS_SCENE_INVALID, "the glTF file is invalid: a material names texture %d of %zu",
				 info.index, model.textures.size());
	if (info.texCoord != 0)
		import_ignore(reader->import, ("TEXCOORD_" + std::to_string(info.texCoord)).c_str());
	const tinygltf::Texture &texture = model.textures[(size_t)info.index];
	if (texture.source >= (int)model.images.size() || texture.sampler >= (int)model.samplers.size())
		return error_set(err, STATUS_SCENE_INVALID,
				 "the glTF file is invalid: texture %d names an image or sampler that is not there",
				 info.index);
	if (texture.source < 0) {
		reader->import->info->missing_textures++;
		import_warn(reader->import, "texture %d has no png or jpeg image and is taken as white", info.index);
		return STATUS_OK;
	}
	return image_texture(reader, texture.source, flags_of(model, texture), out, err);
}

double strength_of(const tinygltf::Material &material)
{
	const auto found = material.extensions.find("KHR_materials_emissive_strength");
	if (found == material.extensions.end() || !found->second.Has("emissiveStrength"))
		return 1.0;
	const tinygltf::Value &v = found->second.Get("emissiveStrength");
	return v.IsNumber() ? v.GetNumberAsDouble() : 1.0;
}

void list_ignored(struct import *import, const tinygltf::Material &m)
{
	const tinygltf::PbrMetallicRoughness &pbr = m.pbrMetallicRoughness;
	if (pbr.metallicFactor != 0 || pbr.roughnessFactor != 1 || pbr.metallicRoughnessTexture.index >= 0)
		import_ignore(import, "metallicRoughness");
	if (m.normalTexture.index >= 0)
		import_ignore(import, "normalTexture");
	if (m.occlusionTexture.index >= 0)
		import_ignore(import, "occlusionTexture");
	if (m.alphaMode != "OPAQUE")
		import_ignore(import, ("alphaMode " + m.alphaMode).c_str());
	for (const auto &extension : m.extensions)
		if (extension.first != "KHR_materials_emissive_strength")
			import_ignore(import, extension.first.c_str());
	for (const tinygltf::TextureInfo *info : {&pbr.baseColorTexture, &m.emissiveTexture})
		for (const auto &extension : info->extensions)
			import_ignore(import, extension.first.c_str());
}

void fill_colours(struct import *import, const tinygltf::Material &m, struct material *out)
{
	const std::vector<double> &base = m.pbrMetallicRoughness.baseColorFactor;
	const double strength = strength_of(m);
	bool fit = true;
	for (size_t c = 0; c < 3; c++) {
		fit &= import_fit(&out->albedo[c], base.size() > c ? base[c] : 1.0, 1.0);
		fit &= import_fit(&out->emission[c], m.emissiveFactor.size() > c ? m.emissiveFactor[c] * strength : 0.0,
				  LIMIT_RADIANCE);
	}
	if (!fit)
		import_warn(import, "material '%.60s' has a colour out of range, which was clamped", m.name.c_str());
}

enum status add_material(gltf_reader *reader, const tinygltf::Material &m, struct error *err)
{
	struct material out = {};
	fill_colours(reader->import, m, &out);
	out.emission_texture = NONE;
	if (m.doubleSided && (out.emission[0] > 0 || out.emission[1] > 0 || out.emission[2] > 0))
		out.flags |= MATERIAL_EMITS_BOTH_SIDES;
	if (find_texture(reader, m.pbrMetallicRoughness.baseColorTexture, &out.albedo_texture, err) != STATUS_OK)
		return err->code;
	// Behind a black factor an emissive texture is never seen: it is not even decoded.
	if ((out.emission[0] > 0 || out.emission[1] > 0 || out.emission[2] > 0) &&
	    find_texture(reader, m.emissiveTexture, &out.emission_texture, err) != STATUS_OK)
		return err->code;
	list_ignored(reader->import, m);
	return import_add_material(reader->import, &out, m.name.c_str(), err);
}

} // namespace

enum status gltf_add_materials(gltf_reader *reader, struct error *err)
{
	for (const tinygltf::Material &material : reader->model.materials)
		if (add_material(reader, material, err) != STATUS_OK)
			return err->code;
	return STATUS_OK;
}

enum status gltf_default_material(gltf_reader *reader, uint32_t *material, struct error *err)
{
	if (reader->default_material == NONE) {
		const struct material white = {{1, 1, 1}, NONE, {0, 0, 0}, NONE, 0, 0, {0, 0}};
		const uint32_t index = (uint32_t)reader->import->material_count;
		if (import_add_material(reader->import, &white, "default", err) != STATUS_OK)
			return err->code;
		reader->default_material = index;
	}
	*material = reader->default_material;
	return STATUS_OK;
}
