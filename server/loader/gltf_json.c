#include "server/loader/gltf_json.h"

#include <jansson.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "server/loader/data_uri.h"

static uint32_t le32(const uint8_t *p)
{
	return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static enum status bad_glb(struct error *err, const char *what)
{
	return error_set(err, STATUS_SCENE_INVALID, "the GLB file is damaged: %s; export it again", what);
}

enum status gltf_find_json(const struct file_bytes *bytes, struct gltf_text *text, struct error *err)
{
	const uint8_t *b = bytes->data;
	*text = (struct gltf_text){.json = (const char *)b, .json_bytes = bytes->size};
	if (bytes->size < 4 || memcmp(b, "glTF", 4) != 0)
		return STATUS_OK;
	text->binary = true;
	if (bytes->size < 20)
		return bad_glb(err, "it ends within its header");
	if (le32(b + 4) != 2)
		return error_set(err, STATUS_SCENE_UNSUPPORTED, "the GLB file has version %u; only 2 can be read",
				 le32(b + 4));
	const uint64_t length = le32(b + 8), json = le32(b + 12);
	if (length > bytes->size)
		return bad_glb(err, "it is shorter than its header says");
	if (length < 20 || le32(b + 16) != 0x4E4F534Au || json > length - 20)
		return bad_glb(err, "its JSON chunk does not fit into it");
	text->json = (const char *)b + 20;
	text->json_bytes = (size_t)json;
	if (20 + json == length)
		return STATUS_OK;
	if (length - 20 - json < 8 || le32(b + 20 + json) > length - 28 - json)
		return bad_glb(err, "its second chunk does not fit into it");
	if (le32(b + 24 + json) == 0x004E4942u)
		text->bin_bytes = le32(b + 20 + json);
	return STATUS_OK;
}

enum kind { KIND_INDEX, KIND_INDICES, KIND_NUMBER, KIND_NUMBERS, KIND_STRING, KIND_BOOL, KIND_OBJECT };

struct property {
	const char *name;
	enum kind kind;
	size_t length; // required length of KIND_NUMBERS; 0: any
};

struct section {
	const char *name;
	struct property properties[9];
};

static const struct section sections[] = {
    {"scenes", {{"nodes", KIND_INDICES, 0}}},
    {"nodes",
     {{"mesh", KIND_INDEX, 0},
      {"camera", KIND_INDEX, 0},
      {"skin", KIND_INDEX, 0},
      {"children", KIND_INDICES, 0},
      {"matrix", KIND_NUMBERS, 16},
      {"translation", KIND_NUMBERS, 3},
      {"rotation", KIND_NUMBERS, 4},
      {"scale", KIND_NUMBERS, 3}}},
    {"accessors",
     {{"bufferView", KIND_INDEX, 0},
      {"byteOffset", KIND_INDEX, 0},
      {"count", KIND_INDEX, 0},
      {"componentType", KIND_INDEX, 0},
      {"type", KIND_STRING, 0},
      {"normalized", KIND_BOOL, 0},
      {"sparse", KIND_OBJECT, 0}}},
    {"bufferViews",
     {{"buffer", KIND_INDEX, 0},
      {"byteOffset", KIND_INDEX, 0},
      {"byteLength", KIND_INDEX, 0},
      {"byteStride", KIND_INDEX, 0}}},
    {"buffers", {{"byteLength", KIND_INDEX, 0}, {"uri", KIND_STRING, 0}}},
    {"materials",
     {{"pbrMetallicRoughness", KIND_OBJECT, 0},
      {"normalTexture", KIND_OBJECT, 0},
      {"occlusionTexture", KIND_OBJECT, 0},
      {"emissiveTexture", KIND_OBJECT, 0},
      {"emissiveFactor", KIND_NUMBERS, 3},
      {"alphaMode", KIND_STRING, 0},
      {"alphaCutoff", KIND_NUMBER, 0},
      {"doubleSided", KIND_BOOL, 0}}},
    {"textures", {{"source", KIND_INDEX, 0}, {"sampler", KIND_INDEX, 0}}},
    {"images", {{"uri", KIND_STRING, 0}, {"bufferView", KIND_INDEX, 0}, {"mimeType", KIND_STRING, 0}}},
    {"samplers",
     {{"magFilter", KIND_INDEX, 0}, {"minFilter", KIND_INDEX, 0}, {"wrapS", KIND_INDEX, 0}, {"wrapT", KIND_INDEX, 0}}},
    {"meshes", {{NULL, KIND_INDEX, 0}}},
    {"cameras", {{"type", KIND_STRING, 0}, {"perspective", KIND_OBJECT, 0}, {"orthographic", KIND_OBJECT, 0}}},
};

static const struct property texture_properties[] = {
    {"index", KIND_INDEX, 0}, {"texCoord", KIND_INDEX, 0}, {"scale", KIND_NUMBER, 0}, {"strength", KIND_NUMBER, 0}};

static const struct property pbr_properties[] = {{"baseColorFactor", KIND_NUMBERS, 4},
						 {"metallicFactor", KIND_NUMBER, 0},
						 {"roughnessFactor", KIND_NUMBER, 0},
						 {"baseColorTexture", KIND_OBJECT, 0},
						 {"metallicRoughnessTexture", KIND_OBJECT, 0}};

// The properties of known extensions that readers rely on. An absent extension is not an object and so has no properties to
// check.
struct extension {
	const char *name;
	struct property properties[4];
};

static const struct extension material_extensions[] = {
    {"KHR_materials_emissive_strength", {{"emissiveStrength", KIND_NUMBER, 0}}},
    {"KHR_materials_ior", {{"ior", KIND_NUMBER, 0}}},
    {"KHR_materials_specular",
     {{"specularFactor", KIND_NUMBER, 0},
      {"specularColorFactor", KIND_NUMBERS, 3},
      {"specularTexture", KIND_OBJECT, 0},
      {"specularColorTexture", KIND_OBJECT, 0}}},
    {"KHR_materials_unlit", {{NULL, KIND_OBJECT, 0}}},
};

static const struct extension texture_extensions[] = {
    {"KHR_texture_transform",
     {{"offset", KIND_NUMBERS, 2}, {"rotation", KIND_NUMBER, 0}, {"scale", KIND_NUMBERS, 2}, {"texCoord", KIND_INDEX, 0}}},
};

static const struct property primitive_properties[] = {
    {"attributes", KIND_OBJECT, 0}, {"indices", KIND_INDEX, 0}, {"material", KIND_INDEX, 0}, {"mode", KIND_INDEX, 0}};

static bool is_index(const json_t *v)
{
	return json_is_integer(v) && json_integer_value(v) >= 0 && json_integer_value(v) <= INT_MAX;
}

static bool all_of(const json_t *array, bool (*is)(const json_t *))
{
	size_t i;
	json_t *item;
	if (!json_is_array(array))
		return false;
	json_array_foreach(array, i, item) if (!is(item)) return false;
	return true;
}

static bool is_number(const json_t *v)
{
	return json_is_number(v);
}

static bool has_kind(const json_t *v, const struct property *property)
{
	switch (property->kind) {
	case KIND_INDEX:
		return is_index(v);
	case KIND_INDICES:
		return all_of(v, is_index);
	case KIND_NUMBER:
		return json_is_number(v);
	case KIND_NUMBERS:
		return all_of(v, is_number) && json_array_size(v) == property->length;
	case KIND_STRING:
		return json_is_string(v);
	case KIND_BOOL:
		return json_is_boolean(v);
	case KIND_OBJECT:
		return json_is_object(v);
	}
	return false;
}

static enum status check_object(const json_t *object, const struct property *properties, size_t count, const char *where,
				struct error *err)
{
	for (size_t i = 0; i < count && properties[i].name; i++) {
		const json_t *v = json_object_get(object, properties[i].name);
		if (v && !has_kind(v, &properties[i]))
			return error_set(
			    err, STATUS_SCENE_INVALID,
			    "the glTF file is invalid: %s has a '%s' of the wrong type, size or range; export it again",
			    where, properties[i].name);
	}
	return STATUS_OK;
}

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static enum status check_extensions_of(const json_t *object, const struct extension *known, size_t count, struct error *err)
{
	const json_t *extensions = json_object_get(object, "extensions");
	if (extensions && !json_is_object(extensions))
		return error_set(err, STATUS_SCENE_INVALID,
				 "the glTF file is invalid: a material's extensions are no object");
	for (size_t i = 0; i < count; i++) {
		const json_t *extension = json_object_get(extensions, known[i].name);
		if (extension && !json_is_object(extension))
			return error_set(err, STATUS_SCENE_INVALID, "the glTF file is invalid: %s is no object",
					 known[i].name);
		if (check_object(extension, known[i].properties, COUNT(known[i].properties), known[i].name, err) !=
		    STATUS_OK)
			return err->code;
	}
	return STATUS_OK;
}

static enum status check_texture(const json_t *object, const char *name, struct error *err)
{
	const json_t *texture = json_object_get(object, name);
	enum status status = check_object(texture, texture_properties, COUNT(texture_properties), name, err);
	if (status == STATUS_OK)
		status = check_extensions_of(texture, texture_extensions, COUNT(texture_extensions), err);
	return status;
}

static enum status check_material(const json_t *material, struct error *err)
{
	static const char *const textures[] = {"normalTexture", "occlusionTexture", "emissiveTexture"};
	static const char *const pbr_textures[] = {"baseColorTexture", "metallicRoughnessTexture"};
	static const char *const specular_textures[] = {"specularTexture", "specularColorTexture"};
	const json_t *specular = json_object_get(json_object_get(material, "extensions"), "KHR_materials_specular");
	const json_t *pbr = json_object_get(material, "pbrMetallicRoughness");
	enum status status = check_object(pbr, pbr_properties, COUNT(pbr_properties), "a material", err);

	for (size_t i = 0; i < COUNT(textures) && status == STATUS_OK; i++)
		status = check_texture(material, textures[i], err);
	for (size_t i = 0; i < COUNT(pbr_textures) && status == STATUS_OK; i++)
		status = check_texture(pbr, pbr_textures[i], err);
	if (status == STATUS_OK)
		status = check_extensions_of(material, material_extensions, COUNT(material_extensions), err);
	for (size_t i = 0; i < COUNT(specular_textures) && status == STATUS_OK; i++)
		status = check_texture(specular, specular_textures[i], err);
	return status;
}

static enum status check_mesh(const json_t *mesh, struct error *err)
{
	const json_t *primitives = json_object_get(mesh, "primitives");
	size_t i;
	json_t *item;
	if (!json_is_array(primitives))
		return error_set(err, STATUS_SCENE_INVALID, "the glTF file is invalid: a mesh has no list of primitives");
	json_array_foreach(primitives, i, item)
	{
		if (!json_is_object(item) || !json_object_get(item, "attributes"))
			return error_set(err, STATUS_SCENE_INVALID,
					 "the glTF file is invalid: a primitive has no attributes");
		if (check_object(item, primitive_properties, COUNT(primitive_properties), "a primitive", err) != STATUS_OK)
			return err->code;
		const char *name;
		json_t *value;
		json_object_foreach(json_object_get(item, "attributes"), name, value) if (!is_index(value)) return error_set(
		    err, STATUS_SCENE_INVALID, "the glTF file is invalid: attribute '%.40s' is no accessor index", name);
	}
	return STATUS_OK;
}

static enum status check_section(const json_t *root, const struct section *section, struct error *err)
{
	const json_t *array = json_object_get(root, section->name);
	size_t i;
	json_t *item;
	if (!array)
		return STATUS_OK;
	if (!json_is_array(array))
		return error_set(err, STATUS_SCENE_INVALID, "the glTF file is invalid: '%s' is not a list", section->name);
	json_array_foreach(array, i, item)
	{
		char where[64];
		snprintf(where, sizeof where, "%s[%zu]", section->name, i);
		if (!json_is_object(item))
			return error_set(err, STATUS_SCENE_INVALID, "the glTF file is invalid: %s is not an object", where);
		enum status status = check_object(item, section->properties, COUNT(section->properties), where, err);
		if (status == STATUS_OK && strcmp(section->name, "materials") == 0)
			status = check_material(item, err);
		if (status == STATUS_OK && strcmp(section->name, "meshes") == 0)
			status = check_mesh(item, err);
		if (status != STATUS_OK)
			return status;
	}
	return STATUS_OK;
}

static enum status check_root(const json_t *root, struct error *err)
{
	static const struct property scene = {"scene", KIND_INDEX, 0};
	if (!json_is_object(root))
		return error_set(err, STATUS_SCENE_INVALID, "the glTF file is invalid: its root is not an object");
	const char *version = json_string_value(json_object_get(json_object_get(root, "asset"), "version"));
	if (!version)
		return error_set(err, STATUS_SCENE_INVALID, "the glTF file is invalid: it has no asset.version");
	if (strncmp(version, "2.", 2) != 0)
		return error_set(err, STATUS_SCENE_UNSUPPORTED, "the file is glTF %.20s; only 2.x can be read", version);
	return check_object(root, &scene, 1, "the file", err);
}

bool gltf_extension_is_read(const char *name)
{
	// Beside those of the layers.
	static const char *const others[] = {"EXT_mesh_gpu_instancing",
					     "KHR_lights_punctual",
					     "KHR_materials_emissive_strength",
					     "KHR_materials_ior",
					     "KHR_materials_specular",
					     "KHR_materials_transmission",
					     "KHR_materials_unlit",
					     "KHR_materials_volume",
					     "KHR_mesh_quantization",
					     "KHR_texture_transform",
					     NULL};
	static const char *const *const lists[] = {others, gltf_layer_extensions};
	for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
		for (const char *const *known = lists[i]; *known; known++)
			if (strcmp(*known, name) == 0)
				return true;
	return false;
}

static enum status check_extensions(const json_t *root, struct error *err)
{
	const json_t *required = json_object_get(root, "extensionsRequired");
	size_t i;
	json_t *item;
	json_array_foreach(required, i, item)
	{
		const char *name = json_string_value(item);
		if (!name || !gltf_extension_is_read(name))
			return error_set(err, STATUS_SCENE_UNSUPPORTED,
					 "the file requires the extension %.80s, which is not supported; export it without",
					 name ? name : "(not a string)");
	}
	return STATUS_OK;
}

static enum status list_externals(const json_t *root, const struct gltf_text *text, struct gltf_externals *externals,
				  struct error *err)
{
	const json_t *buffers = json_object_get(root, "buffers");
	size_t i;
	json_t *item;
	externals->lengths = calloc(json_array_size(buffers) + 1, sizeof *externals->lengths);
	externals->contents = calloc(json_array_size(buffers) + 1, sizeof *externals->contents);
	if (!externals->lengths || !externals->contents)
		return error_set(err, STATUS_MEMORY, "no memory for the list of buffers");
	json_array_foreach(buffers, i, item)
	{
		const char *uri = json_string_value(json_object_get(item, "uri"));
		if (uri && !*uri)
			uri = NULL; // tinygltf treats an empty URI as none
		const json_int_t length = json_integer_value(json_object_get(item, "byteLength"));
		if (length < 1)
			return error_set(err, STATUS_SCENE_INVALID,
					 "the glTF file is invalid: buffers[%zu] has no byteLength", i);
		// Only the first buffer may be the BIN chunk. Each other buffer without a URI would copy it.
		if (!uri && (!text->binary || i > 0 || (uint64_t)length > text->bin_bytes))
			return error_set(err, STATUS_SCENE_INVALID, "the glTF file is invalid: buffers[%zu] has no bytes",
					 i);
		if (!uri || data_uri_is_plain(uri))
			continue;
		struct error why;
		if (data_uri_is(uri) && data_uri_read(uri, &externals->contents[externals->count], &why) != STATUS_OK)
			return error_set(err, why.code, "the glTF file is invalid: buffers[%zu]: %s", i, why.text);
		externals->lengths[externals->count++] = (uint64_t)length;
	}
	return STATUS_OK;
}

void gltf_externals_finish(struct gltf_externals *externals)
{
	for (size_t i = 0; i < externals->count; i++)
		file_bytes_finish(&externals->contents[i]);
	free(externals->contents);
	free(externals->lengths);
	*externals = (struct gltf_externals){0};
}

enum status gltf_check_json(const struct gltf_text *text, struct gltf_externals *externals, struct error *err)
{
	json_error_t why;
	*externals = (struct gltf_externals){0};
	json_t *root = json_loadb(text->json, text->json_bytes, 0, &why);
	if (!root)
		return error_set(err, STATUS_SCENE_INVALID, "the glTF file's JSON is invalid in line %d: %.150s", why.line,
				 why.text);
	enum status status = check_root(root, err);
	if (status == STATUS_OK)
		status = check_extensions(root, err);
	for (size_t i = 0; i < COUNT(sections) && status == STATUS_OK; i++)
		status = check_section(root, &sections[i], err);
	if (status == STATUS_OK)
		status = list_externals(root, text, externals, err);
	externals->has_images = status == STATUS_OK && json_array_size(json_object_get(root, "images")) > 0;
	json_decref(root);
	return status;
}
