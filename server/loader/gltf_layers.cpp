#include "server/loader/gltf_parts.h"

#include <cmath>

extern "C" {
#include "server/loader/gltf_json.h"
}

const char *const gltf_layer_extensions[] = {"EXT_materials_diffuse_roughness", "KHR_materials_clearcoat",
					     "KHR_materials_diffuse_roughness", NULL};

namespace
{

// The names of the draft extension: Khronos's, and its first one.
const char *const diffuse_names[] = {"KHR_materials_diffuse_roughness", "EXT_materials_diffuse_roughness"};

bool fill_diffuse(gltf_reader *reader, const tinygltf::Material &m, struct material *out)
{
	bool fit = true;
	for (const char *name : diffuse_names) {
		const tinygltf::Value *rough = gltf_extension_of(m, name);
		if (!rough)
			continue;
		fit &= import_fit(&out->diffuse_roughness, gltf_number(*rough, "diffuseRoughnessFactor", 0), 1.0);
		if (rough->Has("diffuseRoughnessTexture"))
			import_ignore(reader->import, "diffuseRoughnessTexture");
	}
	return fit;
}

bool fill_coat(gltf_reader *reader, const tinygltf::Material &m, struct material *out)
{
	const tinygltf::Value *coat = gltf_extension_of(m, "KHR_materials_clearcoat");
	if (!coat)
		return true;
	bool fit = import_fit(&out->coat, gltf_number(*coat, "clearcoatFactor", 0), 1.0);
	fit &= import_fit(&out->coat_roughness, gltf_number(*coat, "clearcoatRoughnessFactor", 0), 1.0);
	if (out->coat > 0 && out->transmission > 0)
		import_ignore(reader->import, "clearcoat over transmission");
	return fit;
}

// Two maps share the tangents of a vertex, so both must use the same texture coordinates and transform.
bool same_place(const struct texture_info *a, const struct texture_info *b)
{
	bool same = (a->flags & TEXTURE_UV1) == (b->flags & TEXTURE_UV1);
	for (int i = 0; i < 3; i++)
		same = same && std::fabs(a->row_u[i] - b->row_u[i]) == 0 && std::fabs(a->row_v[i] - b->row_v[i]) == 0;
	return same;
}

enum status find_coat_normals(gltf_reader *reader, const tinygltf::Value &coat, struct material *out, struct error *err)
{
	struct import *import = reader->import;
	if (!coat.Has("clearcoatNormalTexture"))
		return STATUS_OK;
	const double scale = gltf_number(coat.Get("clearcoatNormalTexture"), "scale", 1);
	out->coat_normal_scale = std::isfinite((float)scale) ? (float)scale : 1.0f;
	if (gltf_texture_in(reader, coat, "clearcoatNormalTexture", 0, &out->coat_normal_texture, err) != STATUS_OK)
		return err->code;
	if (out->normal_texture == NONE || out->coat_normal_texture == NONE ||
	    same_place(&import->textures[out->normal_texture], &import->textures[out->coat_normal_texture]))
		return STATUS_OK;
	out->coat_normal_texture = NONE;
	import_ignore(import, "clearcoatNormalTexture with its own coordinates");
	return STATUS_OK;
}

} // namespace

bool gltf_fill_layers(gltf_reader *reader, const tinygltf::Material &m, struct material *out)
{
	const bool fit = fill_diffuse(reader, m, out);
	return fill_coat(reader, m, out) && fit;
}

enum status gltf_find_layer_textures(gltf_reader *reader, const tinygltf::Material &m, struct material *out,
				     struct error *err)
{
	const tinygltf::Value *coat = gltf_extension_of(m, "KHR_materials_clearcoat");
	if (!(out->coat > 0))
		return STATUS_OK;
	if (coat->Has("clearcoatTexture") &&
	    gltf_texture_in(reader, *coat, "clearcoatTexture", 0, &out->coat_texture, err) != STATUS_OK)
		return err->code;
	if (coat->Has("clearcoatRoughnessTexture") && out->coat_roughness > 0 &&
	    gltf_texture_in(reader, *coat, "clearcoatRoughnessTexture", 0, &out->coat_roughness_texture, err) != STATUS_OK)
		return err->code;
	return find_coat_normals(reader, *coat, out, err);
}
