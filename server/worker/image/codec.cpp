#include <Imath/half.h>
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <system_error>
#include <unistd.h>
#include <vector>

extern "C" {
#include "server/base/memfd.h"
#include "server/worker/image/codec.h"
#include "server/worker/image/view.h"
}

namespace
{

// Rows packed at a time. It bounds the extra memory, and is a multiple of the 16 rows of a zip block. The library compresses
// a strip's blocks side by side.
constexpr uint32_t STRIP_ROWS = 64;

// Noise in floats hardly gets smaller, and zip takes long to find that out. So a sample of the rows is compressed both ways,
// and the whole by run lengths if that makes it at most so many times as large. Measured: tests/bench/RESULTS.md.
constexpr double RLE_GROWTH_MAX = 1.25;
constexpr uint32_t SAMPLE_BANDS = 4, SAMPLE_BAND_ROWS = 2;
constexpr uint32_t SAMPLED_ROWS_MIN = 16 * SAMPLE_BANDS * SAMPLE_BAND_ROWS; // of a frame, so that the sample costs little

// Higher levels take longer and gain next to nothing on floats.
constexpr const char *ZIP_OF_FLOATS = "zip:2";

// zlib's way with the rows of a PNG, which libpng has filtered, each by the filter of five that suits it: run lengths and
// Huffman's code. What is left of a rendered picture repeats itself in no other way, and to search for it takes three to
// four times as long. Measured: tests/bench/RESULTS.md.
constexpr const char *PNG_STRATEGY = "rle";

struct channel {
	const char *name;
	OIIO::TypeDesc type;
	const void *plane; // of 4-byte values
	uint32_t stride; // values a pixel
	uint32_t component;
};

std::vector<channel> channels_of(const frame &f, OIIO::TypeDesc colour)
{
	std::vector<channel> c;
	auto three = [&](const float *plane, const char *x, const char *y, const char *z) {
		c.push_back({x, colour, plane, 3, 0});
		c.push_back({y, colour, plane, 3, 1});
		c.push_back({z, colour, plane, 3, 2});
	};
	three(f.radiance, "R", "G", "B");
	if (f.depth)
		c.push_back({"Z", OIIO::TypeDesc::FLOAT, f.depth, 1, 0});
	if (f.normal)
		three(f.normal, "N.X", "N.Y", "N.Z");
	if (f.albedo)
		three(f.albedo, "albedo.R", "albedo.G", "albedo.B");
	if (f.id)
		c.push_back({"id", OIIO::TypeDesc::UINT, f.id, 1, 0});
	return c;
}

// A finite value stays finite: beyond half's range it becomes half's largest value, not infinity.
uint16_t to_half(float value)
{
	const float largest = 65504.0f;
	if (std::isfinite(value))
		value = std::clamp(value, -largest, largest);
	half h(value);
	return h.bits();
}

// Append rows y0…y1-1 in the file's own layout: pixel by pixel, each channel in its own type.
void pack(const frame &f, const std::vector<channel> &channels, uint32_t y0, uint32_t y1, std::vector<unsigned char> &out)
{
	size_t pixel_bytes = 0;
	for (const channel &c : channels)
		pixel_bytes += c.type.size();
	const size_t first = size_t(y0) * f.width, count = size_t(y1 - y0) * f.width;
	const size_t before = out.size();
	out.resize(before + count * pixel_bytes);
	size_t offset = before;
	for (const channel &c : channels) {
		const unsigned char *from =
		    static_cast<const unsigned char *>(c.plane) + (first * c.stride + c.component) * 4;
		unsigned char *to = out.data() + offset;
		if (c.type != OIIO::TypeDesc::HALF) {
			for (size_t i = 0; i < count; i++, from += size_t(c.stride) * 4, to += pixel_bytes)
				std::memcpy(to, from, 4);
		} else {
			for (size_t i = 0; i < count; i++, from += size_t(c.stride) * 4, to += pixel_bytes) {
				float value;
				std::memcpy(&value, from, sizeof value);
				uint16_t bits = to_half(value);
				std::memcpy(to, &bits, sizeof bits);
			}
		}
		offset += c.type.size();
	}
}

void add_metadata(const frame &f, OIIO::ImageSpec &spec)
{
	for (uint32_t i = 0; i < f.metadata_count && i < FRAME_METADATA_MAX; i++)
		spec.attribute(std::string("candil/") + f.metadata[i].key, f.metadata[i].value);
}

OIIO::ImageSpec channel_spec(uint32_t width, uint32_t height, const std::vector<channel> &channels, const char *compression)
{
	OIIO::ImageSpec spec(int(width), int(height), int(channels.size()), channels.front().type);
	spec.channelnames.clear();
	for (const channel &c : channels) {
		spec.channelnames.push_back(c.name);
		spec.channelformats.push_back(c.type);
	}
	spec.attribute("compression", compression);
	return spec;
}

// How many bytes a file of these packed rows has; 0: the library refused.
size_t compressed_bytes(uint32_t width, uint32_t rows, const std::vector<channel> &channels, const char *compression,
			const std::vector<unsigned char> &packed)
{
	OIIO::Filesystem::IOVecOutput memory;
	{
		auto out = OIIO::ImageOutput::create("sample.exr", &memory);
		if (!out || !out->open("sample.exr", channel_spec(width, rows, channels, compression)) ||
		    !out->write_scanlines(0, int(rows), 0, OIIO::TypeDesc::UNKNOWN, packed.data()) || !out->close())
			return 0;
	}
	return memory.buffer().size();
}

// Both choices keep every bit. Halves have too little noise for run lengths to be worth a try.
const char *choose_compression(const frame &f, const std::vector<channel> &channels)
{
	constexpr uint32_t rows = SAMPLE_BANDS * SAMPLE_BAND_ROWS;
	if (channels.front().type == OIIO::TypeDesc::HALF)
		return "zip";
	if (f.height < SAMPLED_ROWS_MIN)
		return ZIP_OF_FLOATS;
	std::vector<unsigned char> packed;
	for (uint32_t i = 0; i < SAMPLE_BANDS; i++) {
		const uint32_t y = uint32_t(uint64_t(f.height) * (2 * i + 1) / (2 * SAMPLE_BANDS));
		pack(f, channels, y, y + SAMPLE_BAND_ROWS, packed);
	}
	const size_t rle = compressed_bytes(f.width, rows, channels, "rle", packed);
	const size_t zip = compressed_bytes(f.width, rows, channels, ZIP_OF_FLOATS, packed);
	return rle > 0 && double(rle) <= RLE_GROWTH_MAX * double(zip) ? "rle" : ZIP_OF_FLOATS;
}

OIIO::ImageSpec exr_spec(const frame &f, const std::vector<channel> &channels)
{
	OIIO::ImageSpec spec = channel_spec(f.width, f.height, channels, choose_compression(f, channels));
	// The primaries and white point of Rec.709, which are EXR's default, are written all the same.
	const float rec709[8] = {0.64f, 0.33f, 0.30f, 0.60f, 0.15f, 0.06f, 0.3127f, 0.3290f};
	spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), rec709);
	// Without it the library would write the time of day, and the same frame would not give the same bytes.
	spec.attribute("DateTime", "");
	add_metadata(f, spec);
	return spec;
}

OIIO::ImageSpec png_spec(const frame &f, codec_view view, double exposure_ev)
{
	OIIO::ImageSpec spec(int(f.width), int(f.height), 3, OIIO::TypeDesc::UINT8);
	spec.attribute("oiio:ColorSpace", "sRGB");
	spec.attribute("compression", PNG_STRATEGY);
	add_metadata(f, spec);
	char text[32];
	std::snprintf(text, sizeof text, "%g", exposure_ev);
	spec.attribute("candil/view", view_name(view));
	spec.attribute("candil/exposure", text);
	return spec;
}

void pack_srgb(const frame &f, const view_table &table, uint32_t y0, uint32_t y1, std::vector<unsigned char> &out)
{
	const size_t first = size_t(y0) * f.width, count = size_t(y1 - y0) * f.width;
	out.resize(count * 3);
	for (size_t i = 0; i < count; i++)
		view_table_srgb8(&table, f.radiance + (first + i) * 3, out.data() + i * 3);
}

// Write all rows through `packer`; false leaves the reason in the library's error.
template <typename Packer> bool write_rows(OIIO::ImageOutput &out, const frame &f, OIIO::TypeDesc type, Packer packer)
{
	std::vector<unsigned char> strip;
	for (uint32_t y = 0; y < f.height; y += STRIP_ROWS) {
		uint32_t end = std::min(f.height, y + STRIP_ROWS);
		strip.clear();
		packer(y, end, strip);
		if (!out.write_scanlines(int(y), int(end), 0, type, strip.data()))
			return false;
	}
	return true;
}

bool write_file(OIIO::ImageOutput &out, const frame &f, codec_format format, codec_view view, double exposure_ev)
{
	view_table table;
	if (format == CODEC_PNG) {
		view_table_init(&table, view, exposure_ev);
		return out.open("frame.png", png_spec(f, view, exposure_ev)) &&
		       write_rows(out, f, OIIO::TypeDesc::UINT8,
				  [&](uint32_t y0, uint32_t y1, std::vector<unsigned char> &strip) {
					  pack_srgb(f, table, y0, y1, strip);
				  }) &&
		       out.close();
	}
	const auto channels = channels_of(f, format == CODEC_EXR_HALF ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
	// UNKNOWN: the strip is already in the file's own types.
	return out.open("frame.exr", exr_spec(f, channels)) &&
	       write_rows(
		   out, f, OIIO::TypeDesc::UNKNOWN,
		   [&](uint32_t y0, uint32_t y1, std::vector<unsigned char> &strip) { pack(f, channels, y0, y1, strip); }) &&
	       out.close();
}

status to_memfd(const std::vector<unsigned char> &file, int *fd, size_t *bytes, error *err)
{
	int f = -1;
	void *map = nullptr;
	status s = memfd_create_mapped("candil-image", file.size(), &f, &map, err);
	if (s != STATUS_OK)
		return s;
	std::memcpy(map, file.data(), file.size());
	s = memfd_seal(f, map, file.size(), err);
	if (s != STATUS_OK) {
		close(f);
		return s;
	}
	*fd = f;
	*bytes = file.size();
	return STATUS_OK;
}

status encode(const frame &f, codec_format format, codec_view view, double exposure_ev, int *fd, size_t *bytes, error *err)
{
	// Declared before the output, which writes to it until the output is destroyed. It would grow by copies.
	std::vector<unsigned char> file;
	file.reserve(size_t(f.width) * f.height * 3 * (format == CODEC_EXR_FLOAT ? 4 : 1));
	OIIO::Filesystem::IOVecOutput memory(file);
	{
		auto out = OIIO::ImageOutput::create(format == CODEC_PNG ? "frame.png" : "frame.exr", &memory);
		if (!out)
			return error_set(err, STATUS_ENCODE, "OpenImageIO cannot write this format: %s",
					 OIIO::geterror().c_str());
		if (!write_file(*out, f, format, view, exposure_ev))
			return error_set(err, STATUS_ENCODE, "OpenImageIO refused the frame: %s", out->geterror().c_str());
	}
	if (memory.buffer().empty())
		return error_set(err, STATUS_ENCODE, "OpenImageIO wrote an empty file");
	return to_memfd(memory.buffer(), fd, bytes, err);
}

} // namespace

extern "C" enum status codec_encode(const struct frame *frame, enum codec_format format, enum codec_view view,
				    double exposure_ev, int *fd, size_t *bytes, struct error *err)
{
	try {
		return encode(*frame, format, view, exposure_ev, fd, bytes, err);
	} catch (const std::bad_alloc &) {
		return error_set(err, STATUS_MEMORY, "no memory to encode the frame; ask for a smaller one");
	} catch (const std::system_error &e) {
		const bool thread = e.code() == std::errc::resource_unavailable_try_again; // could not be started
		return thread ? error_set(err, STATUS_MEMORY, "no memory to encode the frame; ask for a smaller one")
			      : error_set(err, STATUS_ENCODE, "cannot encode the frame: %s", e.what());
	} catch (const std::exception &e) {
		return error_set(err, STATUS_ENCODE, "cannot encode the frame: %s", e.what());
	} catch (...) {
		return error_set(err, STATUS_ENCODE, "cannot encode the frame");
	}
}
