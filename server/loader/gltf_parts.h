// The parts of the glTF importer, C++ among themselves. All functions return the status that err carries.
#ifndef CANDIL_LOADER_GLTF_PARTS_H
#define CANDIL_LOADER_GLTF_PARTS_H

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <vector>

extern "C" {
#include "server/loader/gltf.h"
}

struct gltf_reader {
	struct import *import;
	tinygltf::Model model;
	uint32_t default_material = NONE; // made when the first primitive without a material comes
	std::vector<uint32_t> nodes; // by the file's number: the import's, or NONE for those outside the scene
};

// Positions, UVs, indices of a mesh, into world space. gltf_mesh.cpp
enum status gltf_add_mesh(gltf_reader *reader, const tinygltf::Mesh &mesh, const transform &world, struct error *err);

// A node's mesh, once or as often as its EXT_mesh_gpu_instancing says; the node's mesh is there. All instances are the
// node's own: what moves it moves them. gltf_instances.cpp
enum status gltf_add_instances(gltf_reader *reader, const tinygltf::Node &node, const transform &world, struct error *err);

// All of the file's materials, in its order, with the images that they use. gltf_material.cpp
enum status gltf_add_materials(gltf_reader *reader, struct error *err);

// What one place of a material says about its texture: index, set of coordinates, transform.
struct gltf_slot {
	int index; // -1: none
	int set; // of texture coordinates
	const tinygltf::ExtensionMap *extensions; // may be null
};

// The texture of a slot, or NONE. `flags` is TEXTURE_SRGB or 0. gltf_texture.cpp
enum status gltf_find_texture(gltf_reader *reader, const gltf_slot &slot, uint32_t flags, uint32_t *texture,
			      struct error *err);

// A number, or a list of them, of a JSON object; `standard` where it is not there. gltf_texture.cpp
double gltf_number(const tinygltf::Value &object, const char *key, double standard);
double gltf_number_in(const tinygltf::Value &object, const char *key, int index, double standard);

// What a material says under an extension's name; null: nothing. gltf_extension.cpp
const tinygltf::Value *gltf_extension_of(const tinygltf::Material &m, const char *name);

// A texture that an extension's object names, which tinygltf does not read itself. gltf_extension.cpp
enum status gltf_texture_in(gltf_reader *reader, const tinygltf::Value &object, const char *key, uint32_t flags,
			    uint32_t *texture, struct error *err);

// KHR_materials_clearcoat and KHR_materials_diffuse_roughness: factors, after the transmission is known, then the textures,
// after the normal map. False if something had to be clamped. gltf_layers.cpp
bool gltf_fill_layers(gltf_reader *reader, const tinygltf::Material &m, struct material *out);
enum status gltf_find_layer_textures(gltf_reader *reader, const tinygltf::Material &m, struct material *out,
				     struct error *err);

// The material of primitives that name none. gltf_material.cpp
enum status gltf_default_material(gltf_reader *reader, uint32_t *material, struct error *err);

// A node's camera and light. gltf_light.cpp
enum status gltf_add_camera(gltf_reader *reader, const tinygltf::Node &node, const transform &world, struct error *err);
enum status gltf_add_light(gltf_reader *reader, const tinygltf::Node &node, const transform &world, struct error *err);

// The file's animations of nodes that are in the scene; after the nodes. gltf_animation.cpp
enum status gltf_add_animations(gltf_reader *reader, struct error *err);

#endif
