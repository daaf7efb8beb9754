#include "server/loader/gltf_parts.h"

#include <cmath>
#include <cstring>

extern "C" {
#include "protocol/text.h"
#include "server/base/angle.h"
#include "server/scene/lights.h"
#include "server/scene/nodes.h"
}

namespace
{

bool set_lens(struct blob_camera *out, const tinygltf::Camera &camera)
{
	if (camera.type == "perspective") {
		out->vfov_degrees = camera.perspective.yfov * 180.0 / PI;
		out->aspect = camera.perspective.aspectRatio > 0 ? camera.perspective.aspectRatio : 0.0;
		return out->vfov_degrees > 0 && out->vfov_degrees < 180 && std::isfinite(out->aspect);
	}
	if (camera.type != "orthographic")
		return false;
	out->half_height = std::fabs(camera.orthographic.ymag);
	out->aspect = out->half_height > 0 ? std::fabs(camera.orthographic.xmag) / out->half_height : 0.0;
	return out->half_height > 0 && std::isfinite(out->half_height) && std::isfinite(out->aspect);
}

// The index of a node's light; -1 if it has none, -2 if the reference is invalid.
int light_index(const tinygltf::Node &node, size_t lights)
{
	const auto found = node.extensions.find("KHR_lights_punctual");
	if (found == node.extensions.end())
		return -1;
	if (!found->second.IsObject() || !found->second.Has("light"))
		return -2;
	const tinygltf::Value &v = found->second.Get("light");
	return v.IsInt() && v.GetNumberAsInt() >= 0 && (size_t)v.GetNumberAsInt() < lights ? v.GetNumberAsInt() : -2;
}

bool set_intensity(struct punctual_light *out, const tinygltf::Light &light)
{
	bool some = false;
	if (!(light.intensity >= 0) || !std::isfinite(light.intensity))
		return false;
	for (size_t c = 0; c < 3; c++) {
		const double colour = light.color.size() == 3 ? light.color[c] : 1.0;
		if (!import_fit(&out->intensity[c], colour * light.intensity, LIMIT_INTENSITY))
			return false;
		some = some || out->intensity[c] > 0;
	}
	return some || light.intensity == 0;
}

bool set_cone(struct punctual_light *out, const tinygltf::SpotLight &spot)
{
	const double inner = spot.innerConeAngle, outer = spot.outerConeAngle;
	if (!(inner >= 0) || !(outer > inner) || !(outer <= PI / 2 + 1e-6))
		return false;
	out->inner = (float)angle_spread(inner);
	out->outer = (float)std::fmin(angle_spread(outer), 1.0);
	return true;
}

bool fill_light(struct import_light *out, const tinygltf::Light &light, const transform &world)
{
	struct punctual_light *l = &out->light;
	const bool point = light.type == "point", spot = light.type == "spot";
	l->kind = point ? LIGHT_POINT : spot ? LIGHT_SPOT : LIGHT_DIRECTIONAL;
	if (!set_intensity(l, light) || !node_place_light(&world, l, out->position))
		return false;
	l->range = point || spot ? lights_range(light.range) : 0.0f;
	return point || (spot ? set_cone(l, light.spot) : light.type == "directional");
}

} // namespace

enum status gltf_add_camera(gltf_reader *reader, const tinygltf::Node &node, const transform &world, struct error *err)
{
	const tinygltf::Camera &camera = reader->model.cameras[(size_t)node.camera];
	struct blob_camera out = {};
	const char *name = !camera.name.empty() ? camera.name.c_str() : node.name.c_str();

	if (*name)
		text_copy(out.name, sizeof out.name, name);
	else
		snprintf(out.name, sizeof out.name, "camera %zu", reader->import->camera_count);
	if (!set_lens(&out, camera) || !node_place_camera(&world, &out)) {
		import_warn(reader->import, "camera '%s' has no usable lens or direction and is left out", out.name);
		return STATUS_OK;
	}
	return import_add_camera(reader->import, &out, err);
}

enum status gltf_add_light(gltf_reader *reader, const tinygltf::Node &node, const transform &world, struct error *err)
{
	struct import *import = reader->import;
	const int index = light_index(node, reader->model.lights.size());
	if (index == -1)
		return STATUS_OK;
	if (index < 0)
		return error_set(err, STATUS_SCENE_INVALID,
				 "the glTF file is invalid: node '%.60s' names a light that is not there",
				 node.name.c_str());
	const tinygltf::Light &light = reader->model.lights[(size_t)index];
	struct import_light out = {};
	if (!fill_light(&out, light, world)) {
		import_warn(import, "light '%.60s' is left out: its type, intensity, cone or direction is out of range",
			    light.name.c_str());
		return STATUS_OK;
	}
	if (out.light.kind != LIGHT_DIRECTIONAL && light.range < 0)
		import_warn(import, "light '%.60s' has a range below zero, taken as none", light.name.c_str());
	return import_add_light(import, &out, err);
}
