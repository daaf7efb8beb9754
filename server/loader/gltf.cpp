#include "server/loader/gltf_parts.h"

#include <cmath>
#include <exception>
#include <memory>
#include <new>
#include <string>

extern "C" {
#include "protocol/text.h"
#include "server/loader/data_uri.h"
#include "server/loader/gltf_json.h"
#include "server/scene/transform.h"
}

namespace
{

// What tinygltf's callbacks need: access to files, and the buffers that are still to be read. Images are not read here;
// those that a material uses are read later.
struct side_files {
	struct files *files;
	struct gltf_externals externals = {};
	size_t next = 0;
	struct error failure = {};

	~side_files()
	{
		gltf_externals_finish(&externals);
	}
};

bool file_exists(const std::string &, void *user)
{
	const side_files *side = static_cast<side_files *>(user);
	return side->next < side->externals.count;
}

std::string expand_path(const std::string &path, void *)
{
	return path;
}

bool read_buffer(std::vector<unsigned char> *out, std::string *, const std::string &name, void *user)
{
	side_files *side = static_cast<side_files *>(user);
	if (side->next >= side->externals.count)
		return false;
	struct file_bytes bytes = side->externals.contents[side->next];
	side->externals.contents[side->next] = {nullptr, 0};
	if (!bytes.data && files_read(side->files, name.c_str(), &bytes, &side->failure) != STATUS_OK)
		return false;
	const uint64_t length = side->externals.lengths[side->next++];
	const bool long_enough = bytes.size >= length;
	if (long_enough)
		out->assign(bytes.data, bytes.data + length); // a file may be longer than its buffer
	else
		error_set(&side->failure, STATUS_SCENE_INVALID,
			  "buffer '%.80s' has %zu bytes, the glTF file says %llu; export again", name.c_str(), bytes.size,
			  (unsigned long long)length);
	file_bytes_finish(&bytes);
	return long_enough;
}

bool write_nothing(std::string *, const std::string &, const std::vector<unsigned char> &, void *)
{
	return false;
}

// Keep an embedded image as it is. An image in a buffer view is fetched later, after the view has been checked: here the
// pointer may be out of range.
bool keep_image(tinygltf::Image *image, const int, std::string *, std::string *, int, int, const unsigned char *bytes,
		int size, void *)
{
	image->as_is = true;
	if (image->bufferView < 0 && size > 0)
		image->image.assign(bytes, bytes + size);
	return true;
}

enum status parse(gltf_reader *reader, const struct file_bytes *bytes, struct error *err)
{
	struct gltf_text text;
	side_files side;
	side.files = reader->import->files;
	if (gltf_find_json(bytes, &text, err) != STATUS_OK)
		return err->code;
	data_uri_hide(bytes->data + (text.json - reinterpret_cast<const char *>(bytes->data)), text.json_bytes);
	if (gltf_check_json(&text, &side.externals, err) != STATUS_OK)
		return err->code;
	if (side.externals.has_images && import_expect_images(reader->import, err) != STATUS_OK)
		return err->code;

	tinygltf::TinyGLTF parser;
	parser.SetImageLoader(keep_image, nullptr);
	parser.SetFsCallbacks({file_exists, expand_path, read_buffer, write_nothing, &side});
	std::string why, warnings;
	const unsigned size = (unsigned)bytes->size; // ≤ LIMIT_SCENE_FILE_BYTES
	const bool good = text.binary ? parser.LoadBinaryFromMemory(&reader->model, &why, &warnings, bytes->data, size, "")
				      : parser.LoadASCIIFromString(&reader->model, &why, &warnings,
								   reinterpret_cast<const char *>(bytes->data), size, "");
	if (good)
		return STATUS_OK;
	if (side.failure.code != STATUS_OK) {
		*err = side.failure;
		return err->code;
	}
	char reason[160];
	text_copy(reason, sizeof reason, why.substr(0, why.find('\n')).c_str());
	return error_set(err, STATUS_SCENE_INVALID, "the glTF file is invalid: %s; export it again", reason);
}

// The transform of a node, as a whole and in parts.
transform local_transform(const tinygltf::Node &node, transform_parts *parts)
{
	*parts = transform_no_parts;
	if (node.matrix.size() == 16) {
		transform t;
		for (size_t column = 0; column < 4; column++)
			for (size_t row = 0; row < 3; row++)
				t.c[column][row] = node.matrix[column * 4 + row];
		*parts = transform_to_parts(&t);
		return t;
	}
	double length = 0;
	for (size_t i = 0; i < 4 && node.rotation.size() == 4; i++)
		length += node.rotation[i] * node.rotation[i];
	length = std::sqrt(length);
	for (size_t i = 0; i < 4 && length > 0 && std::isfinite(length); i++)
		parts->rotation[i] = node.rotation[i] / length;
	for (size_t i = 0; i < 3 && node.scale.size() == 3; i++)
		parts->scale[i] = node.scale[i];
	for (size_t i = 0; i < 3 && node.translation.size() == 3; i++)
		parts->translation[i] = node.translation[i];
	return transform_of_parts(parts);
}

struct visit {
	int node;
	unsigned depth;
	uint32_t parent; // index in the import, or NONE
	transform world; // the parent's transform
};

enum status add_node(gltf_reader *reader, const tinygltf::Node &node, const transform &world, struct error *err)
{
	const tinygltf::Model &model = reader->model;
	if (node.mesh >= (int)model.meshes.size() || node.camera >= (int)model.cameras.size())
		return error_set(err, STATUS_SCENE_INVALID, "node '%.60s' names a mesh or camera that is not there",
				 node.name.c_str());
	if (node.skin >= 0)
		import_ignore(reader->import, "skins");
	enum status status = STATUS_OK;
	if (node.mesh >= 0)
		status = gltf_add_instances(reader, node, world, err);
	if (status == STATUS_OK && node.camera >= 0)
		status = gltf_add_camera(reader, node, world, err);
	if (status == STATUS_OK)
		status = gltf_add_light(reader, node, world, err);
	return status;
}

// Push nodes so that the first is visited first. In glTF a node has one parent. A node that is reached twice is part of a
// cycle or would be expanded over and over, so it is refused.
enum status push_nodes(const gltf_reader *reader, const std::vector<int> &nodes, uint32_t parent, const transform &world,
		       unsigned depth, std::vector<bool> *seen, std::vector<visit> *stack, struct error *err)
{
	if (depth > LIMIT_NODE_DEPTH)
		return error_set(err, STATUS_SCENE_LIMIT, "the node hierarchy is deeper than %u; flatten it",
				 LIMIT_NODE_DEPTH);
	for (size_t i = nodes.size(); i-- > 0;) {
		const int n = nodes[i];
		if (n < 0 || n >= (int)reader->model.nodes.size())
			return error_set(err, STATUS_SCENE_INVALID, "the hierarchy names node %d, which is not there", n);
		if ((*seen)[(size_t)n])
			return error_set(err, STATUS_SCENE_INVALID,
					 "node %d is reached twice: the hierarchy has a cycle or a shared node", n);
		(*seen)[(size_t)n] = true;
		stack->push_back({n, depth, parent, world});
	}
	return STATUS_OK;
}

// Add a node and everything on it. A node whose transform is not finite is left out together with its descendants; *world
// is then not finite.
enum status enter_node(gltf_reader *reader, const visit &v, transform *world, struct error *err)
{
	const tinygltf::Node &node = reader->model.nodes[(size_t)v.node];
	transform_parts parts;
	const transform local = local_transform(node, &parts);
	*world = transform_compose(&v.world, &local);
	if (v.parent == NONE)
		*world = local;
	if (!transform_is_finite(world) || !transform_is_finite(&local)) {
		world->c[3][0] = INFINITY;
		import_warn(reader->import, "node '%.60s' is left out with all beneath it: its transform is not finite",
			    node.name.c_str());
		return STATUS_OK;
	}
	reader->nodes[(size_t)v.node] = (uint32_t)reader->import->node_count;
	if (import_add_node(reader->import, node.name.c_str(), &local, &parts, v.parent, err) != STATUS_OK)
		return err->code;
	return add_node(reader, node, *world, err);
}

enum status walk_nodes(gltf_reader *reader, const std::vector<int> &roots, struct error *err)
{
	const std::vector<tinygltf::Node> &nodes = reader->model.nodes;
	std::vector<bool> seen(nodes.size());
	std::vector<visit> stack;

	reader->nodes.assign(nodes.size(), NONE);
	enum status status = push_nodes(reader, roots, NONE, transform_identity, 1, &seen, &stack, err);
	while (status == STATUS_OK && !stack.empty()) {
		const visit v = stack.back();
		transform world;
		stack.pop_back();
		status = enter_node(reader, v, &world, err);
		if (status == STATUS_OK && transform_is_finite(&world))
			status = push_nodes(reader, nodes[(size_t)v.node].children, reader->nodes[(size_t)v.node], world,
					    v.depth + 1, &seen, &stack, err);
	}
	return status;
}

enum status pick_scene(const tinygltf::Model &model, const tinygltf::Scene **scene, struct error *err)
{
	const int index = model.defaultScene >= 0 ? model.defaultScene : 0;
	if (model.scenes.empty())
		return error_set(err, STATUS_SCENE_INVALID, "the glTF file has no scene; export it with one");
	if (index >= (int)model.scenes.size())
		return error_set(err, STATUS_SCENE_INVALID, "the glTF file's scene %d is not there; export it again", index);
	*scene = &model.scenes[(size_t)index];
	return STATUS_OK;
}

void list_ignored(gltf_reader *reader)
{
	for (const std::string &name : reader->model.extensionsUsed)
		if (!gltf_extension_is_read(name.c_str()))
			import_ignore(reader->import, name.c_str());
	if (reader->model.scenes.size() > 1)
		import_pass_over(reader->import, "scenes other than the default one");
}

// An accessor without a buffer view is all zeros except for its sparse part. So a few bytes of text can stand for
// gigabytes.
enum status check_zero_elements(const tinygltf::Model &model, struct error *err)
{
	size_t total = 0;
	for (const tinygltf::Accessor &a : model.accessors) {
		if (a.bufferView >= 0)
			continue;
		if (a.count > LIMIT_ZERO_ELEMENTS - total)
			return error_set(err, STATUS_SCENE_LIMIT,
					 "accessors without a buffer view have more than %u elements; export their data",
					 LIMIT_ZERO_ELEMENTS);
		total += a.count;
	}
	return STATUS_OK;
}

enum status import_all(struct import *import, const struct file_bytes *bytes, struct error *err)
{
	auto reader = std::make_unique<gltf_reader>();
	const tinygltf::Scene *scene = nullptr;
	reader->import = import;
	if (parse(reader.get(), bytes, err) != STATUS_OK)
		return err->code;
	if (reader->model.nodes.size() > LIMIT_NODES)
		return error_set(err, STATUS_SCENE_LIMIT, "the scene has %zu nodes; it may have %u",
				 reader->model.nodes.size(), LIMIT_NODES);
	enum status status = check_zero_elements(reader->model, err);
	if (status == STATUS_OK)
		status = pick_scene(reader->model, &scene, err);
	if (status == STATUS_OK)
		status = gltf_check_sums(reader.get(), scene->nodes, err);
	if (status == STATUS_OK)
		status = gltf_add_materials(reader.get(), err);
	if (status == STATUS_OK)
		status = walk_nodes(reader.get(), scene->nodes, err);
	if (status == STATUS_OK)
		status = gltf_add_animations(reader.get(), err);
	if (status == STATUS_OK)
		list_ignored(reader.get());
	return status;
}

} // namespace

extern "C" enum status gltf_import(struct import *import, const struct file_bytes *bytes, struct error *err)
{
	try {
		return import_all(import, bytes, err);
	} catch (const std::bad_alloc &) {
		return error_set(err, STATUS_MEMORY, "no memory to read the glTF file");
	} catch (const std::exception &e) {
		return error_set(err, STATUS_SCENE_INVALID, "the glTF file cannot be read: %.120s", e.what());
	}
}
