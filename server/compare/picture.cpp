#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

extern "C" {
#include "protocol/limits.h"
#include "server/compare/picture.h"
#include "server/worker/image/view.h"
}

namespace
{

// Find the channels R, G and B among those of a file.
void find_channels(const OIIO::ImageSpec &spec, int index[3])
{
	const char *names[3] = {"R", "G", "B"};
	bool found = true;
	for (int i = 0; i < 3; i++) {
		index[i] = spec.channelindex(names[i]);
		found = found && index[i] >= 0;
	}
	if (!found)
		for (int i = 0; i < 3; i++)
			index[i] = spec.nchannels >= 3 ? i : 0;
}

status check_size(const char *path, const OIIO::ImageSpec &spec, error *err)
{
	if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1)
		return error_set(err, STATUS_IO, "%s is no flat picture", path);
	if (uint32_t(spec.width) > LIMIT_SIDE || uint32_t(spec.height) > LIMIT_SIDE ||
	    uint64_t(spec.width) * uint64_t(spec.height) > LIMIT_PIXELS || spec.nchannels > 64)
		return error_set(err, STATUS_LIMIT,
				 "%s has %d x %d pixels of %d channels; the limit is %u a side, %u in all, 64 channels",
				 path, spec.width, spec.height, spec.nchannels, LIMIT_SIDE, LIMIT_PIXELS);
	return STATUS_OK;
}

// A text that candil wrote into the picture; "" if there is none or it is too long.
template <size_t N> void read_text(const OIIO::ImageSpec &spec, const char *key, char (&to)[N])
{
	const std::string text = spec.get_string_attribute(std::string("candil/") + key);
	to[0] = 0;
	if (text.size() < N)
		std::memcpy(to, text.c_str(), text.size() + 1);
}

uint64_t read_number(const OIIO::ImageSpec &spec, const char *key)
{
	const uint64_t all = std::strtoull(spec.get_string_attribute(std::string("candil/") + key).c_str(), nullptr, 10);
	return std::min<uint64_t>(all, UINT32_MAX);
}

void read_origin(const OIIO::ImageSpec &spec, origin *o)
{
	char part[64];
	std::string view;
	read_text(spec, "scene_hash", o->scene);
	read_text(spec, "technique", o->technique);
	read_text(spec, "made_of", o->made_of);
	for (const char *key : {"camera_eye", "camera_forward", "camera_up", "camera_projection"}) {
		read_text(spec, key, part);
		view += part[0] ? std::string(" ") + part : std::string();
	}
	std::memcpy(o->view, view.c_str(), view.size() + 1);
	o->seed = std::strtoull(spec.get_string_attribute("candil/seed").c_str(), nullptr, 10);
	o->first_sample = read_number(spec, "first_sample");
	o->samples = read_number(spec, "samples");
}

status read(const char *path, picture *out, error *err)
{
	auto in = OIIO::ImageInput::open(path);
	if (!in)
		return error_set(err, STATUS_IO, "cannot read %s: %s", path, OIIO::geterror().c_str());
	const OIIO::ImageSpec spec = in->spec();
	status s = check_size(path, spec, err);
	if (s != STATUS_OK)
		return s;
	int index[3];
	find_channels(spec, index);
	// One read for the span of channels that contains all three: not every reader can go back for the next channel.
	int first = std::min({index[0], index[1], index[2]}), end = std::max({index[0], index[1], index[2]}) + 1;
	size_t pixels = size_t(spec.width) * size_t(spec.height), span = size_t(end - first);
	std::unique_ptr<float[]> all(new float[pixels * span]);
	if (!in->read_image(0, 0, first, end, OIIO::TypeDesc::FLOAT, all.get()))
		return error_set(err, STATUS_IO, "cannot read %s: %s", path, in->geterror().c_str());
	float *rgb = static_cast<float *>(std::malloc(pixels * 3 * sizeof(float)));
	if (!rgb)
		throw std::bad_alloc();
	bool srgb = spec.get_string_attribute("oiio:ColorSpace") == "sRGB" && spec.format == OIIO::TypeDesc::UINT8;
	for (size_t i = 0; i < pixels; i++)
		for (int c = 0; c < 3; c++) {
			float v = all[i * span + size_t(index[c] - first)];
			rgb[i * 3 + size_t(c)] = srgb ? float(view_srgb_decode(double(v))) : v;
		}
	*out = {uint32_t(spec.width), uint32_t(spec.height), rgb, !spec.format.is_floating_point(), {}};
	read_origin(spec, &out->origin);
	return STATUS_OK;
}

status encode(const char *format, uint32_t width, uint32_t height, const uint8_t *codes, uint8_t **bytes, size_t *size,
	      error *err)
{
	const std::string name = std::string("picture.") + format;
	auto out = OIIO::ImageOutput::create(name);
	if (!out || !out->supports("ioproxy"))
		return error_set(err, STATUS_ENCODE, "OpenImageIO cannot write %s: %s", format, OIIO::geterror().c_str());
	OIIO::ImageSpec spec(int(width), int(height), 3, OIIO::TypeDesc::UINT8);
	spec.attribute("oiio:ColorSpace", "sRGB");
	spec.attribute("Compression", std::string(format) == "jpeg" ? "jpeg:90" : "zip:9");
	spec.attribute("jpeg:subsampling", "4:4:4");
	std::vector<unsigned char> memory;
	OIIO::Filesystem::IOVecOutput proxy(memory);
	out->set_ioproxy(&proxy);
	if (!out->open(name, spec) || !out->write_image(OIIO::TypeDesc::UINT8, codes) || !out->close())
		return error_set(err, STATUS_ENCODE, "cannot encode a picture: %s", out->geterror().c_str());
	*bytes = static_cast<uint8_t *>(std::malloc(memory.size() + 1));
	if (!*bytes)
		throw std::bad_alloc();
	std::memcpy(*bytes, memory.data(), memory.size());
	*size = memory.size();
	return STATUS_OK;
}

// Run `body` and turn exceptions into a status, so that none crosses into C.
template <typename Body> status guarded(const char *what, error *err, Body body)
{
	try {
		return body();
	} catch (const std::bad_alloc &) {
		return error_set(err, STATUS_MEMORY, "no memory for %s", what);
	} catch (const std::system_error &e) {
		const bool thread = e.code() == std::errc::resource_unavailable_try_again; // could not be started
		return thread ? error_set(err, STATUS_MEMORY, "no memory for %s", what)
			      : error_set(err, STATUS_IO, "%s: %s", what, e.what());
	} catch (const std::exception &e) {
		return error_set(err, STATUS_IO, "%s: %s", what, e.what());
	} catch (...) {
		return error_set(err, STATUS_INTERNAL, "%s failed", what);
	}
}

} // namespace

extern "C" enum status picture_read(const char *path, struct picture *picture, struct error *err)
{
	return guarded(path, err, [&] { return read(path, picture, err); });
}

extern "C" void picture_finish(struct picture *picture)
{
	std::free(picture->rgb);
	picture->rgb = nullptr;
}

extern "C" enum status picture_encode(const char *format, uint32_t width, uint32_t height, const uint8_t *codes,
				      uint8_t **bytes, size_t *size, struct error *err)
{
	return guarded(format, err, [&] { return encode(format, width, height, codes, bytes, size, err); });
}
