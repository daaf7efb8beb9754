#include "server/loader/gltf_parts.h"

#include <cmath>
#include <cstring>

namespace
{

const double pi = 3.14159265358979323846;

double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// False for a vector without a direction.
bool normalize(double v[3])
{
	double largest = std::fmax(std::fabs(v[0]), std::fmax(std::fabs(v[1]), std::fabs(v[2])));
	if (!(largest > 0) || !std::isfinite(largest))
		return false;
	for (int i = 0; i < 3; i++)
		v[i] /= largest;
	const double length = std::sqrt(dot(v, v));
	for (int i = 0; i < 3; i++)
		v[i] /= length;
	return true;
}

bool finite(const double v[3])
{
	return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]) && std::fabs(v[0]) <= LIMIT_COORDINATE &&
	       std::fabs(v[1]) <= LIMIT_COORDINATE && std::fabs(v[2]) <= LIMIT_COORDINATE;
}

// Eye, forward and up in world space. False where the node's transform leaves no direction.
bool place_camera(struct blob_camera *out, const transform &world)
{
	for (int i = 0; i < 3; i++) {
		out->eye[i] = world.c[3][i];
		out->forward[i] = -world.c[2][i];
		out->up[i] = world.c[1][i];
	}
	if (!finite(out->eye) || !normalize(out->forward) || !normalize(out->up))
		return false;
	const double along = dot(out->forward, out->up);
	for (int i = 0; i < 3; i++)
		out->up[i] -= along * out->forward[i];
	return dot(out->up, out->up) > 1e-12 && normalize(out->up);
}

bool set_lens(struct blob_camera *out, const tinygltf::Camera &camera)
{
	if (camera.type == "perspective") {
		out->vfov_degrees = camera.perspective.yfov * 180.0 / pi;
		out->aspect = camera.perspective.aspectRatio > 0 ? camera.perspective.aspectRatio : 0.0;
		return out->vfov_degrees > 0 && out->vfov_degrees < 180 && std::isfinite(out->aspect);
	}
	if (camera.type != "orthographic")
		return false;
	out->half_height = std::fabs(camera.orthographic.ymag);
	out->aspect = out->half_height > 0 ? std::fabs(camera.orthographic.xmag) / out->half_height : 0.0;
	return out->half_height > 0 && std::isfinite(out->half_height) && std::isfinite(out->aspect);
}

// The index of a node's light; -1 without one, -2 for nonsense.
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
		if (!import_fit(&out->intensity[c], colour * light.intensity, LIMIT_RADIANCE))
			return false;
		some = some || out->intensity[c] > 0;
	}
	return some || light.intensity == 0;
}

bool set_cone(struct punctual_light *out, const tinygltf::SpotLight &spot)
{
	const double inner = spot.innerConeAngle, outer = spot.outerConeAngle;
	if (!(inner >= 0) || !(outer > inner) || !(outer <= pi / 2 + 1e-6))
		return false;
	out->cos_inner = (float)std::cos(inner);
	out->cos_outer = (float)std::fmax(std::cos(outer), 0.0);
	return true;
}

bool fill_light(struct import_light *out, const tinygltf::Light &light, const transform &world)
{
	struct punctual_light *l = &out->light;
	double forward[3];
	for (int i = 0; i < 3; i++) {
		out->position[i] = world.c[3][i];
		forward[i] = -world.c[2][i];
	}
	if (!set_intensity(l, light) || !finite(out->position))
		return false;
	if (light.type == "point") {
		l->kind = LIGHT_POINT;
		return true;
	}
	if (!normalize(forward))
		return false;
	for (int i = 0; i < 3; i++)
		l->direction[i] = (float)forward[i];
	l->kind = light.type == "spot" ? LIGHT_SPOT : LIGHT_DIRECTIONAL;
	return light.type == "spot" ? set_cone(l, light.spot) : light.type == "directional";
}

} // namespace

enum status gltf_add_camera(gltf_reader *reader, const tinygltf::Node &node, const transform &world, struct error *err)
{
	const tinygltf::Camera &camera = reader->model.cameras[(size_t)node.camera];
	struct blob_camera out = {};
	const char *name = !camera.name.empty() ? camera.name.c_str() : node.name.c_str();

	if (*name)
		import_clean_text(out.name, sizeof out.name, name);
	else
		snprintf(out.name, sizeof out.name, "camera %zu", reader->import->camera_count);
	if (!set_lens(&out, camera) || !place_camera(&out, world)) {
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
	if (light.range > 0)
		import_ignore(import, "light range");
	return import_add_light(import, &out, err);
}
