#include "server/loader/gltf_parts.h"

#include <cfloat>
#include <cmath>
#include <string>

extern "C" {
#include "server/loader/gltf_json.h"
}

namespace
{

// Index of refraction of a dielectric whose file gives neither KHR_materials_ior nor KHR_materials_specular.
const double standard_ior = 1.5;

template <typename info> gltf_slot slot_of(const info &texture)
{
	return {texture.index, texture.texCoord, &texture.extensions};
}

void list_ignored(struct import *import, const tinygltf::Material &m)
{
	if (m.occlusionTexture.index >= 0)
		import_pass_over(import, "occlusionTexture"); // light is traced, not baked
	if (m.alphaMode != "OPAQUE" && m.alphaMode != "MASK" && m.alphaMode != "BLEND")
		import_ignore(import, ("alphaMode " + m.alphaMode).c_str());
	for (const auto &extension : m.extensions)
		if (!gltf_extension_is_read(extension.first.c_str()))
			import_ignore(import, extension.first.c_str());
}

// Set base colour, emission, metalness and roughness. False if a value had to be clamped.
bool fill_factors(const tinygltf::Material &m, struct material *out)
{
	const tinygltf::PbrMetallicRoughness &pbr = m.pbrMetallicRoughness;
	const std::vector<double> &base = pbr.baseColorFactor;
	const tinygltf::Value *strong = gltf_extension_of(m, "KHR_materials_emissive_strength");
	const double strength = strong ? gltf_number(*strong, "emissiveStrength", 1) : 1;
	bool fit = true;
	for (size_t c = 0; c < 3; c++) {
		fit &= import_fit(&out->albedo[c], base.size() > c ? base[c] : 1.0, 1.0);
		fit &= import_fit(&out->emission[c], m.emissiveFactor.size() > c ? m.emissiveFactor[c] * strength : 0.0,
				  LIMIT_RADIANCE);
	}
	fit &= import_fit(&out->metallic, pbr.metallicFactor, 1.0);
	fit &= import_fit(&out->roughness, pbr.roughnessFactor, 1.0);
	return fit;
}

// KHR_materials_specular on top of KHR_materials_ior: the dielectric part reflects min(F0 · colour, 1) · factor at normal
// incidence and `factor` at grazing incidence. An index of 0 stands for F0 = 1, which is also what the formula gives.
bool fill_specular(const tinygltf::Material &m, struct material *out)
{
	const tinygltf::Value *index = gltf_extension_of(m, "KHR_materials_ior");
	const tinygltf::Value *specular = gltf_extension_of(m, "KHR_materials_specular");
	const double ior = index ? gltf_number(*index, "ior", standard_ior) : standard_ior;
	const double f0 = (ior - 1) / (ior + 1) * ((ior - 1) / (ior + 1));
	bool fit = import_fit(&out->specular_weight, specular ? gltf_number(*specular, "specularFactor", 1) : 1, 1.0);
	for (int c = 0; c < 3; c++) {
		const double colour = specular ? gltf_number_in(*specular, "specularColorFactor", c, 1) : 1;
		float reflectance;
		fit &= import_fit(&reflectance, f0, 1.0) && colour >= 0;
		import_fit(&reflectance, f0 * colour, 1.0); // the extension itself clamps above 1
		out->specular[c] = reflectance * out->specular_weight;
	}
	return fit;
}

// KHR_materials_volume: at the attenuation distance, the attenuation colour is left of white light. The thickness only says
// whether there is an interior; the triangles determine its size.
bool fill_volume(const tinygltf::Value &volume, struct material *out)
{
	const double distance = gltf_number(volume, "attenuationDistance", INFINITY);
	bool fit = !(distance < 0);
	out->flags &= ~MATERIAL_THIN;
	for (int c = 0; c < 3; c++) {
		const double colour = gltf_number_in(volume, "attenuationColor", c, 1);
		fit &= colour >= 0 && colour <= 1;
		const double taken = -std::log(std::fmin(std::fmax(colour, DBL_MIN), 1));
		import_fit(&out->absorption[c], taken > 0 ? taken / std::fmax(distance, DBL_MIN) : 0.0, LIMIT_ABSORPTION);
	}
	return fit;
}

// KHR_materials_transmission, with the index of KHR_materials_ior. An index of 0 means total reflection.
bool fill_transmission(struct import *import, const tinygltf::Material &m, struct material *out)
{
	const tinygltf::Value *transmission = gltf_extension_of(m, "KHR_materials_transmission");
	const tinygltf::Value *index = gltf_extension_of(m, "KHR_materials_ior");
	const tinygltf::Value *volume = gltf_extension_of(m, "KHR_materials_volume");
	const double ior = index ? gltf_number(*index, "ior", standard_ior) : standard_ior;
	if (!transmission || ior == 0)
		return true;
	bool fit = import_fit(&out->transmission, gltf_number(*transmission, "transmissionFactor", 0), 1.0);
	if (out->transmission == 0)
		return fit;
	out->flags |= MATERIAL_THIN;
	fit &= import_fit(&out->ior, ior, LIMIT_IOR_MOST) && ior >= LIMIT_IOR_LEAST;
	out->ior = std::fmax(out->ior, (float)LIMIT_IOR_LEAST);
	if (volume && volume->Has("thicknessTexture"))
		import_ignore(import, "thicknessTexture");
	if (volume && gltf_number(*volume, "thicknessFactor", 0) > 0)
		fit &= fill_volume(*volume, out);
	return fit;
}

// Our own property: the body of the highest priority exists where several overlap.
bool fill_priority(struct import *import, const tinygltf::Material &m, struct material *out)
{
	const double given = gltf_number(m.extras, "candil_priority", 0);
	float priority;
	const bool fit = import_fit(&priority, given, LIMIT_PRIORITY) && std::floor(given) == given;
	if (out->transmission > 0 && !(out->flags & MATERIAL_THIN))
		out->flags |= (uint32_t)priority << MATERIAL_PRIORITY_SHIFT;
	else if (priority > 0)
		import_ignore(import, "candil_priority of what is no clear body");
	return fit;
}

enum status find_transmission_texture(gltf_reader *reader, const tinygltf::Material &m, struct material *out,
				      struct error *err)
{
	const tinygltf::Value *transmission = gltf_extension_of(m, "KHR_materials_transmission");
	if (out->transmission == 0 || !transmission->Has("transmissionTexture"))
		return STATUS_OK;
	return gltf_texture_in(reader, *transmission, "transmissionTexture", 0, &out->transmission_texture, err);
}

enum status find_specular_texture(gltf_reader *reader, const tinygltf::Material &m, struct material *out, struct error *err)
{
	const tinygltf::Value *specular = gltf_extension_of(m, "KHR_materials_specular");
	if (!specular || out->specular_weight == 0)
		return STATUS_OK;
	if (specular->Has("specularTexture") &&
	    gltf_texture_in(reader, *specular, "specularTexture", 0, &out->specular_weight_texture, err) != STATUS_OK)
		return err->code;
	if (!specular->Has("specularColorTexture"))
		return STATUS_OK;
	return gltf_texture_in(reader, *specular, "specularColorTexture", TEXTURE_SRGB, &out->specular_texture, err);
}

enum status find_normal_texture(gltf_reader *reader, const tinygltf::Material &m, struct material *out, struct error *err)
{
	const double scale = m.normalTexture.scale;
	const bool fit = std::isfinite((float)scale);
	out->normal_scale = fit ? (float)scale : 1.0f;
	if (!fit)
		import_warn(reader->import, "material '%.60s' has a normal scale out of range, taken as 1", m.name.c_str());
	return gltf_find_texture(reader, slot_of(m.normalTexture), 0, &out->normal_texture, err);
}

// For a mask, the shader compares only the alpha of texture and vertex, so the cutoff is divided by the factor's alpha.
bool fill_alpha(const tinygltf::Material &m, struct material *out)
{
	const std::vector<double> &base = m.pbrMetallicRoughness.baseColorFactor;
	const double alpha = base.size() > 3 ? base[3] : 1.0;
	if (m.alphaMode == "BLEND") {
		out->flags |= MATERIAL_ALPHA_BLEND;
		return import_fit(&out->alpha, alpha, 1.0);
	}
	if (m.alphaMode != "MASK")
		return true;
	out->flags |= MATERIAL_ALPHA_MASK;
	const double cutoff = m.alphaCutoff > 0 ? (alpha > 0 ? m.alphaCutoff / alpha : FLT_MAX) : 0.0;
	out->alpha_cutoff = (float)std::fmin(cutoff, FLT_MAX);
	return true;
}

// Find the other textures of a lit surface. Textures that a black factor hides are not decoded.
enum status find_textures(gltf_reader *reader, const tinygltf::Material &m, struct material *out, struct error *err)
{
	const bool emits = out->emission[0] > 0 || out->emission[1] > 0 || out->emission[2] > 0;
	if (emits &&
	    gltf_find_texture(reader, slot_of(m.emissiveTexture), TEXTURE_SRGB, &out->emission_texture, err) != STATUS_OK)
		return err->code;
	if (gltf_find_texture(reader, slot_of(m.pbrMetallicRoughness.metallicRoughnessTexture), 0, &out->surface_texture,
			      err) != STATUS_OK ||
	    find_specular_texture(reader, m, out, err) != STATUS_OK ||
	    find_transmission_texture(reader, m, out, err) != STATUS_OK)
		return err->code;
	if (find_normal_texture(reader, m, out, err) != STATUS_OK)
		return err->code;
	return gltf_find_layer_textures(reader, m, out, err);
}

enum status add_material(gltf_reader *reader, const tinygltf::Material &m, struct error *err)
{
	struct material out = import_plain_material(1.0f);
	bool fit = fill_factors(m, &out);
	fit &= fill_specular(m, &out);
	fit &= fill_transmission(reader->import, m, &out);
	fit &= fill_priority(reader->import, m, &out);
	fit &= fill_alpha(m, &out);
	fit &= gltf_fill_layers(reader, m, &out);
	if (!fit)
		import_warn(reader->import, "material '%.60s' has a colour or factor out of range, which was clamped",
			    m.name.c_str());
	list_ignored(reader->import, m);
	if (gltf_extension_of(m, "KHR_materials_unlit")) {
		// An unlit material keeps only its base colour and alpha. It is not an emitter.
		struct material unlit = import_plain_material(1.0f);
		for (int c = 0; c < 3; c++)
			unlit.albedo[c] = out.albedo[c];
		unlit.alpha_cutoff = out.alpha_cutoff;
		unlit.alpha = out.alpha;
		unlit.flags = (out.flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND)) | MATERIAL_UNLIT;
		out = unlit;
	} else if (m.doubleSided && (out.emission[0] > 0 || out.emission[1] > 0 || out.emission[2] > 0)) {
		out.flags |= MATERIAL_EMITS_BOTH_SIDES;
	}
	if (gltf_find_texture(reader, slot_of(m.pbrMetallicRoughness.baseColorTexture), TEXTURE_SRGB, &out.albedo_texture,
			      err) != STATUS_OK)
		return err->code;
	if (!(out.flags & MATERIAL_UNLIT) && find_textures(reader, m, &out, err) != STATUS_OK)
		return err->code;
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
		// glTF 2.0, 3.9: all properties have their defaults, which is a white and rough metal.
		struct material standard = import_plain_material(1.0f);
		const tinygltf::Material nothing;
		const uint32_t index = (uint32_t)reader->import->material_count;
		standard.metallic = 1;
		fill_specular(nothing, &standard);
		if (import_add_material(reader->import, &standard, "default", err) != STATUS_OK)
			return err->code;
		reader->default_material = index;
	}
	*material = reader->default_material;
	return STATUS_OK;
}
