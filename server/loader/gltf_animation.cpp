#include "server/loader/gltf_accessor.h"

#include <cmath>
#include <string>

namespace
{

// The enum channel_path of a glTF path, or -1.
int path_of(const std::string &path)
{
	return path == "translation" ? CHANNEL_TRANSLATION
	       : path == "rotation"  ? CHANNEL_ROTATION
	       : path == "scale"     ? CHANNEL_SCALE
				     : -1;
}

int curve_of(const std::string &interpolation)
{
	return interpolation == "STEP"          ? CURVE_STEP
	       : interpolation == "CUBICSPLINE" ? CURVE_CUBIC
	       : interpolation == "LINEAR"      ? CURVE_LINEAR
						: -1;
}

// Convert to floats. False unless all are finite.
bool to_floats(const gltf_elements &from, std::vector<float> *out)
{
	for (const double value : from.values) {
		if (!std::isfinite((float)value))
			return false;
		out->push_back((float)value);
	}
	return true;
}

bool ascend(const std::vector<float> &times)
{
	for (size_t i = 1; i < times.size(); i++)
		if (!(times[i - 1] < times[i]))
			return false;
	return true;
}

// Limit what all channels read, also those that are left out then: many may name the same numbers.
enum status count_numbers(gltf_reader *reader, const tinygltf::AnimationSampler &sampler, struct error *err)
{
	const std::vector<tinygltf::Accessor> &accessors = reader->model.accessors;
	for (const int a : {sampler.input, sampler.output}) {
		const size_t count = a >= 0 && a < (int)accessors.size() ? accessors[(size_t)a].count : 0;
		if (count > LIMIT_CURVE_FLOATS - reader->curve_numbers)
			return error_set(err, STATUS_SCENE_LIMIT,
					 "the scene's animations have more than %u keys; simplify them", LIMIT_CURVE_FLOATS);
		reader->curve_numbers += count;
	}
	return STATUS_OK;
}

enum status add_curve(gltf_reader *reader, const tinygltf::AnimationSampler &sampler, struct scene_channel *channel,
		      const char *name, struct error *err)
{
	gltf_elements keys, elements;
	std::vector<float> times, values;
	if (count_numbers(reader, sampler, err) != STATUS_OK)
		return err->code;
	const int type = channel->path == CHANNEL_ROTATION ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3;
	if (gltf_read_accessor(reader->model, sampler.input, TINYGLTF_TYPE_SCALAR, LIMIT_CURVE_FLOATS, &keys, err) !=
		STATUS_OK ||
	    gltf_read_accessor(reader->model, sampler.output, type, LIMIT_CURVE_FLOATS, &elements, err) != STATUS_OK)
		return err->code;
	const size_t per_key = channel->curve == CURVE_CUBIC ? 3 : 1;
	if (keys.count == 0 || elements.count != keys.count * per_key || !to_floats(keys, &times) ||
	    !to_floats(elements, &values) || !ascend(times)) {
		import_warn(reader->import,
			    "a channel of animation '%.60s' is left out: its times do not ascend, or its values are not "
			    "finite or not as many",
			    name);
		return STATUS_OK;
	}
	channel->keys = (uint32_t)keys.count;
	return import_add_channel(reader->import, channel, times.data(), values.data(), err);
}

enum status add_channel(gltf_reader *reader, const tinygltf::Animation &animation, const tinygltf::AnimationChannel &from,
			struct error *err)
{
	const int path = path_of(from.target_path);
	if (path < 0) {
		import_ignore(reader->import, from.target_path == "weights" ? "animations of morph targets"
									    : "animations of other things than nodes");
		return STATUS_OK;
	}
	if (from.sampler < 0 || (size_t)from.sampler >= animation.samplers.size() ||
	    from.target_node >= (int)reader->model.nodes.size())
		return error_set(err, STATUS_SCENE_INVALID,
				 "the glTF file is invalid: animation '%.60s' names a sampler or a node that is not there",
				 animation.name.c_str());
	const tinygltf::AnimationSampler &sampler = animation.samplers[(size_t)from.sampler];
	const int curve = curve_of(sampler.interpolation);
	if (curve < 0)
		return error_set(err, STATUS_SCENE_INVALID,
				 "the glTF file is invalid: animation '%.60s' has an unknown interpolation",
				 animation.name.c_str());
	const uint32_t node = from.target_node < 0 ? NONE : reader->nodes[(size_t)from.target_node];
	if (node == NONE) // the node is outside of the scene
		return STATUS_OK;
	struct scene_channel channel = {node, (uint32_t)path, (uint32_t)curve, 0, 0};
	return add_curve(reader, sampler, &channel, animation.name.c_str(), err);
}

} // namespace

enum status gltf_add_animations(gltf_reader *reader, struct error *err)
{
	for (const tinygltf::Animation &animation : reader->model.animations) {
		if (import_add_animation(reader->import, animation.name.c_str(), err) != STATUS_OK)
			return err->code;
		for (const tinygltf::AnimationChannel &channel : animation.channels)
			if (add_channel(reader, animation, channel, err) != STATUS_OK)
				return err->code;
	}
	return STATUS_OK;
}
