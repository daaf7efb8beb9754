// What a scene asks for, counted before it is made. A mesh costs a few bytes to name, and so do a million instances of it.
#include "server/loader/gltf_parts.h"

#include <algorithm>

extern "C" {
#include "server/base/checked.h"
}

namespace
{

// What is made of a mesh, once or in a whole scene.
struct sum {
	size_t vertices = 0, triangles = 0;
	size_t parts = 0; // primitives, of which each is looked at again whenever the mesh is named
};

size_t elements_of(const tinygltf::Model &model, int accessor)
{
	return accessor >= 0 && accessor < (int)model.accessors.size() ? model.accessors[(size_t)accessor].count : 0;
}

// SIZE_MAX if it is beyond.
size_t plus(size_t a, size_t b)
{
	return checked_add(a, b, &a) ? a : SIZE_MAX;
}

sum sum_of(const tinygltf::Model &model, const tinygltf::Mesh &mesh)
{
	sum all;
	all.parts = std::max(mesh.primitives.size(), (size_t)1);
	for (const tinygltf::Primitive &p : mesh.primitives) {
		const auto positions = p.attributes.find("POSITION");
		if (p.mode < TINYGLTF_MODE_TRIANGLES || positions == p.attributes.end())
			continue;
		const size_t vertices = elements_of(model, positions->second);
		const size_t corners = p.indices >= 0 ? elements_of(model, p.indices) : vertices;
		all.vertices = plus(all.vertices, vertices);
		all.triangles = plus(all.triangles, p.mode == TINYGLTF_MODE_TRIANGLES ? corners / 3
						    : corners < 3                     ? 0
										      : corners - 2);
	}
	return all;
}

// The largest number that a node's attributes speak of; gltf_add_instances finds out whether they agree.
size_t count_of(const tinygltf::Model &model, const tinygltf::Node &node)
{
	const tinygltf::Value *attributes = gltf_instances_of(node);
	if (!attributes)
		return 1;
	size_t count = 0;
	for (const char *name : {"TRANSLATION", "ROTATION", "SCALE"})
		count = std::max(count, elements_of(model, (int)gltf_number(*attributes, name, -1)));
	return count;
}

void add(sum *to, const sum &mesh, size_t times)
{
	size_t product;
	to->vertices = plus(to->vertices, checked_mul(mesh.vertices, times, &product) ? product : SIZE_MAX);
	to->triangles = plus(to->triangles, checked_mul(mesh.triangles, times, &product) ? product : SIZE_MAX);
	to->parts = plus(to->parts, checked_mul(mesh.parts, times, &product) ? product : SIZE_MAX);
}

enum status check(const sum &all, const tinygltf::Node &node, struct error *err)
{
	const struct {
		size_t count, most;
		const char *what;
	} sums[] = {{all.vertices, LIMIT_VERTICES, "vertices"},
		    {all.triangles, LIMIT_TRIANGLES, "triangles"},
		    {all.parts, LIMIT_TRIANGLES, "instances and primitives"}};
	for (const auto &s : sums)
		if (s.count > s.most)
			return error_set(err, STATUS_SCENE_LIMIT,
					 "up to node '%.60s' the scene's nodes ask for more than %zu %s; split the scene or "
					 "simplify it",
					 node.name.c_str(), s.most, s.what);
	return STATUS_OK;
}

} // namespace

enum status gltf_check_sums(const gltf_reader *reader, const std::vector<int> &roots, struct error *err)
{
	const tinygltf::Model &model = reader->model;
	std::vector<bool> seen(model.nodes.size());
	std::vector<int> stack = roots;
	std::vector<sum> meshes;
	sum all;
	for (const tinygltf::Mesh &mesh : model.meshes)
		meshes.push_back(sum_of(model, mesh));
	while (!stack.empty()) {
		const int n = stack.back();
		stack.pop_back();
		if (n < 0 || n >= (int)model.nodes.size() || seen[(size_t)n])
			continue; // refused when it is added
		seen[(size_t)n] = true;
		const tinygltf::Node &node = model.nodes[(size_t)n];
		stack.insert(stack.end(), node.children.begin(), node.children.end());
		if (node.mesh < 0 || node.mesh >= (int)meshes.size())
			continue;
		add(&all, meshes[(size_t)node.mesh], count_of(model, node));
		if (check(all, node, err) != STATUS_OK)
			return err->code;
	}
	return STATUS_OK;
}
