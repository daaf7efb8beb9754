// Textures of a material: the image, the sampler and the transform of coordinates.
#include "server/loader/gltf_parts.h"

#include <cmath>
#include <string>

extern "C" {
#include "server/loader/data_uri.h"
}

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
	return wrap_of(s.wrapS) << TEXTURE_WRAP_S_SHIFT | wrap_of(s.wrapT) << TEXTURE_WRAP_T_SHIFT |
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

// The encoded bytes of an image that is embedded in the file; null if it is not.
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

enum status image_texture(gltf_reader *reader, int number, const struct import_sampling &sampling, uint32_t *texture,
			  struct error *err)
{
	struct import *import = reader->import;
	const tinygltf::Image &image = reader->model.images[(size_t)number];
	const bool in_file = image.uri.empty() || data_uri_is(image.uri.c_str());
	// A name longer than any path is none, and not read again for each texture.
	const bool too_long = !in_file && image.uri.size() > 3 * LIMIT_PATH;
	const std::string key = in_file || too_long ? "image " + std::to_string(number) : percent_decoded(image.uri);
	struct file_bytes file = {nullptr, 0};
	struct error why;
	size_t size = 0;
	const unsigned char *bytes = nullptr;

	if (!import_knows_image(import, key.c_str())) {
		if (too_long) {
			error_set(&why, STATUS_SCENE_FILE, "its name is longer than %u bytes", LIMIT_PATH);
		} else if (in_file && !image.uri.empty()) { // of a form that tinygltf does not know
			if (data_uri_read(image.uri.c_str(), &file, &why) == STATUS_OK) {
				bytes = file.data;
				size = file.size;
			}
		} else if (in_file) {
			bytes = embedded_bytes(reader->model, image, &size);
			error_set(&why, STATUS_SCENE_INVALID, "its bytes are not in the file");
		} else if (files_read(import->files, key.c_str(), &file, &why) == STATUS_OK) {
			bytes = file.data;
			size = file.size;
		}
		if (!bytes && import_missing_image(import, key.c_str(), why.text, err) != STATUS_OK)
			return err->code;
	}
	enum status status = import_texture(import, key.c_str(), bytes, size, false, &sampling, texture, err);
	file_bytes_finish(&file);
	return status;
}

// KHR_texture_transform: offset · rotation · scale. The rotation turns coordinates counter-clockwise as seen in the
// picture, where v points down: with 90 degrees, u runs up. (The extension's text, its worked example and the viewers agree
// in that; the GLSL in it, read by columns, would turn the other way.)
bool read_transform(const tinygltf::Value &t, struct import_sampling *out)
{
	const double offset[2] = {gltf_number_in(t, "offset", 0, 0), gltf_number_in(t, "offset", 1, 0)};
	const double scale[2] = {gltf_number_in(t, "scale", 0, 1), gltf_number_in(t, "scale", 1, 1)};
	const double angle = gltf_number(t, "rotation", 0);
	const double c = std::cos(angle), s = std::sin(angle);
	const double u[3] = {c * scale[0], s * scale[1], offset[0]}, v[3] = {-s * scale[0], c * scale[1], offset[1]};
	bool finite = true;
	for (int i = 0; i < 3; i++) {
		out->row_u[i] = (float)u[i];
		out->row_v[i] = (float)v[i];
		finite = finite && std::isfinite(out->row_u[i]) && std::isfinite(out->row_v[i]);
	}
	return finite;
}

struct import_sampling sampling_of(gltf_reader *reader, const gltf_slot &slot, uint32_t flags)
{
	struct import_sampling sampling = import_plain_sampling(flags);
	int set = slot.set;
	for (const auto &extension : slot.extensions ? *slot.extensions : tinygltf::ExtensionMap()) {
		if (extension.first != "KHR_texture_transform") {
			import_ignore(reader->import, extension.first.c_str());
			continue;
		}
		if (!read_transform(extension.second, &sampling)) {
			import_warn(reader->import, "a texture transform that is not finite is left out");
			sampling = import_plain_sampling(flags);
		}
		set = (int)gltf_number(extension.second, "texCoord", set);
	}
	if (set == 1)
		sampling.flags |= TEXTURE_UV1;
	else if (set != 0)
		import_ignore(reader->import, ("TEXCOORD_" + std::to_string(set)).c_str());
	return sampling;
}

} // namespace

double gltf_number(const tinygltf::Value &object, const char *key, double standard)
{
	if (!object.Has(key))
		return standard;
	const tinygltf::Value &v = object.Get(key);
	return v.IsNumber() ? v.GetNumberAsDouble() : standard;
}

double gltf_number_in(const tinygltf::Value &object, const char *key, int index, double standard)
{
	if (!object.Has(key))
		return standard;
	const tinygltf::Value &list = object.Get(key);
	if (!list.IsArray() || (size_t)index >= list.ArrayLen() || !list.Get(index).IsNumber())
		return standard;
	return list.Get(index).GetNumberAsDouble();
}

enum status gltf_find_texture(gltf_reader *reader, const gltf_slot &slot, uint32_t flags, uint32_t *out, struct error *err)
{
	const tinygltf::Model &model = reader->model;
	*out = NONE;
	if (slot.index < 0)
		return STATUS_OK;
	if (slot.index >= (int)model.textures.size())
		return error_set(err, STATUS_SCENE_INVALID, "the glTF file is invalid: a material names texture %d of %zu",
				 slot.index, model.textures.size());
	const tinygltf::Texture &texture = model.textures[(size_t)slot.index];
	if (texture.source >= (int)model.images.size() || texture.sampler >= (int)model.samplers.size())
		return error_set(err, STATUS_SCENE_INVALID,
				 "the glTF file is invalid: texture %d names an image or sampler that is not there",
				 slot.index);
	if (texture.source < 0) {
		reader->import->info->missing_textures++;
		import_warn(reader->import, "texture %d has no png or jpeg image and is taken as white", slot.index);
		return STATUS_OK;
	}
	const struct import_sampling sampling = sampling_of(reader, slot, flags | flags_of(model, texture));
	reader->uses_second_uvs = reader->uses_second_uvs || (sampling.flags & TEXTURE_UV1);
	return image_texture(reader, texture.source, sampling, out, err);
}
