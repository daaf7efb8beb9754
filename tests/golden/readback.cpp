#include "tests/golden/readback.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <unistd.h>
#include <vector>

namespace
{

readback_type type_of(OIIO::TypeDesc t)
{
	if (t == OIIO::TypeDesc::HALF)
		return READBACK_HALF;
	if (t == OIIO::TypeDesc::FLOAT)
		return READBACK_FLOAT;
	if (t == OIIO::TypeDesc::UINT)
		return READBACK_UINT;
	return t == OIIO::TypeDesc::UINT8 ? READBACK_UINT8 : READBACK_OTHER;
}

// Channels first…end-1, which are of one type, in that type, so that no conversion of the library's rounds anything.
template <typename T> bool read_as(OIIO::ImageInput &in, OIIO::TypeDesc type, int first, int end, readback *image)
{
	size_t n = size_t(image->width) * image->height, width = size_t(end - first);
	std::vector<T> pixels(n * width);
	if (!in.read_image(0, 0, first, end, type, pixels.data()))
		return false;
	for (size_t i = 0; i < n; i++)
		for (size_t c = 0; c < width; c++)
			image->values[i * image->channels + first + c] = double(pixels[i * width + c]);
	return true;
}

bool read_channels(OIIO::ImageInput &in, int first, int end, readback *image)
{
	if (image->type[first] == READBACK_UINT)
		return read_as<uint32_t>(in, OIIO::TypeDesc::UINT, first, end, image);
	if (image->type[first] == READBACK_UINT8)
		return read_as<uint8_t>(in, OIIO::TypeDesc::UINT8, first, end, image);
	return read_as<float>(in, OIIO::TypeDesc::FLOAT, first, end, image);
}

} // namespace

extern "C" int readback_open(int fd, uint64_t bytes, const char *extension, readback *image)
{
	std::vector<unsigned char> file(bytes);
	if (pread(fd, file.data(), bytes, 0) != ssize_t(bytes)) {
		std::fprintf(stderr, "cannot read %llu bytes back\n", (unsigned long long)bytes);
		return -1;
	}
	OIIO::Filesystem::IOMemReader memory(file.data(), file.size());
	auto in = OIIO::ImageInput::open(std::string("memory.") + extension, nullptr, &memory);
	if (!in || in->spec().nchannels > READBACK_CHANNELS) {
		std::fprintf(stderr, "cannot open: %s\n", OIIO::geterror().c_str());
		return -1;
	}
	const OIIO::ImageSpec spec = in->spec();
	image->width = spec.width;
	image->height = spec.height;
	image->channels = spec.nchannels;
	image->values = new double[size_t(spec.width) * spec.height * spec.nchannels];
	image->attributes = new OIIO::ImageSpec(spec);
	for (int c = 0; c < spec.nchannels; c++) {
		std::snprintf(image->name[c], sizeof image->name[c], "%s", spec.channel_name(c).c_str());
		image->type[c] = type_of(spec.channelformat(c));
	}
	// Runs of one type together: the PNG reader cannot go back to an earlier row of a file in memory.
	for (int first = 0, end; first < spec.nchannels; first = end) {
		for (end = first + 1; end < spec.nchannels && image->type[end] == image->type[first];)
			end++;
		if (!read_channels(*in, first, end, image)) {
			std::fprintf(stderr, "cannot read: %s\n", in->geterror().c_str());
			readback_close(image);
			return -1;
		}
	}
	return 0;
}

extern "C" double readback_value(const readback *image, int x, int y, const char *channel)
{
	for (int c = 0; c < image->channels; c++)
		if (!std::strcmp(image->name[c], channel))
			return image->values[(size_t(y) * image->width + x) * image->channels + c];
	return std::nan("");
}

extern "C" const char *readback_attribute(const readback *image, const char *name)
{
	const auto *spec = static_cast<const OIIO::ImageSpec *>(image->attributes);
	const OIIO::ParamValue *p = spec->find_attribute(name, OIIO::TypeDesc::STRING);
	return p ? *static_cast<const char *const *>(p->data()) : nullptr;
}

extern "C" void readback_close(readback *image)
{
	delete[] image->values;
	delete static_cast<OIIO::ImageSpec *>(image->attributes);
	image->values = nullptr;
	image->attributes = nullptr;
}
