// What the C++ files of the glTF importer share. Functions that return a status return the one that is in err. They may
// throw std::bad_alloc, which gltf_import catches. One thread.
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
	uint32_t default_material = NONE; // NONE until the first primitive without a material
	bool uses_second_uvs = false; // whether some texture does
	size_t curve_numbers = 0; // that the channels read so far name
	std::vector<uint32_t> nodes; // each of the file's nodes: its index in the import, or NONE outside of the scene
};

// Add a mesh's vertices and triangles, transformed to world space. gltf_mesh.cpp
enum status gltf_add_mesh(gltf_reader *reader, const tinygltf::Mesh &mesh, const transform &world, struct error *err);

// Limit what all nodes beneath `roots`, with all their instances, ask for, before any of it is made: a file of a few bytes
// may name a large mesh by each of many nodes, and millions of instances by each. gltf_sums.cpp
enum status gltf_check_sums(const gltf_reader *reader, const std::vector<int> &roots, struct error *err);

// The object of a node's instances, EXT_mesh_gpu_instancing's attributes; null if it has none. gltf_instances.cpp
const tinygltf::Value *gltf_instances_of(const tinygltf::Node &node);

// Add the mesh of a node, once or for each instance of EXT_mesh_gpu_instancing. The import's node must exist. All instances
// belong to the node and move with it. gltf_instances.cpp
enum status gltf_add_instances(gltf_reader *reader, const tinygltf::Node &node, const transform &world, struct error *err);

// Add all of the file's materials, in its order, and the textures that they use. gltf_material.cpp
enum status gltf_add_materials(gltf_reader *reader, struct error *err);

// A material's reference to a texture: index, set of texture coordinates, transform.
struct gltf_slot {
	int index; // -1: none
	int set; // number of the set of texture coordinates
	const tinygltf::ExtensionMap *extensions; // may be null
};

// The texture of a slot as an index in the import, or NONE. `flags` is TEXTURE_SRGB or 0. gltf_texture.cpp
enum status gltf_find_texture(gltf_reader *reader, const gltf_slot &slot, uint32_t flags, uint32_t *texture,
			      struct error *err);

// A number of a JSON object, or one of a list; `standard` if it is absent. gltf_texture.cpp
double gltf_number(const tinygltf::Value &object, const char *key, double standard);
double gltf_number_in(const tinygltf::Value &object, const char *key, int index, double standard);

// A material's object for an extension's name; null if there is none. It lives as long as the material. gltf_extension.cpp
const tinygltf::Value *gltf_extension_of(const tinygltf::Material &m, const char *name);

// The texture that an extension's object names under `key`, for extensions that tinygltf does not read itself.
// gltf_extension.cpp
enum status gltf_texture_in(gltf_reader *reader, const tinygltf::Value &object, const char *key, uint32_t flags,
			    uint32_t *texture, struct error *err);

// KHR_materials_clearcoat and KHR_materials_diffuse_roughness. gltf_fill_layers sets the factors and must run after the
// transmission is known; it returns false if a value had to be clamped. gltf_find_layer_textures sets the textures and must
// run after the normal map is known. gltf_layers.cpp
bool gltf_fill_layers(gltf_reader *reader, const tinygltf::Material &m, struct material *out);
enum status gltf_find_layer_textures(gltf_reader *reader, const tinygltf::Material &m, struct material *out,
				     struct error *err);

// The index of the material for primitives that name none. gltf_material.cpp
enum status gltf_default_material(gltf_reader *reader, uint32_t *material, struct error *err);

// Add a node's camera, or its light. One that is unusable is left out with a warning. gltf_light.cpp
enum status gltf_add_camera(gltf_reader *reader, const tinygltf::Node &node, const transform &world, struct error *err);
enum status gltf_add_light(gltf_reader *reader, const tinygltf::Node &node, const transform &world, struct error *err);

// Add the file's animations of nodes that are in the scene. The nodes must have been added. gltf_animation.cpp
enum status gltf_add_animations(gltf_reader *reader, struct error *err);

#endif
