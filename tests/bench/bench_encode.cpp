// Real frames encoded by the codec and, beside it, by each lossless compression of EXR that OpenImageIO has, in one run.
//
//     bench_encode [--turns N] [--png] FRAME.exr...
//
// With --png the ways are zlib's levels and strategies with each of the filters of PNG's rows, of a frame without AOVs.
// Prints for each frame, as floats and as halves, with its AOVs and without: milliseconds of the processors and of the clock
// (the least of N turns, default 5, all ways taking turns), and the bytes and processors' time against zip's. Every file is
// read back and its bits compared with those of the frame.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>
#include <vector>

extern "C" {
#include "protocol/header.h"
#include "server/base/memfd.h"
#include "server/worker/image/codec.h"
}

namespace
{

struct way {
	const char *name; // of OpenImageIO's compression; "codec": ours
	double cpu_ms, wall_ms;
	std::vector<unsigned char> file;
};

double ms_of(clockid_t clock)
{
	struct timespec t;
	clock_gettime(clock, &t);
	return double(t.tv_sec) * 1e3 + double(t.tv_nsec) * 1e-6;
}

[[noreturn]] void die(const std::string &what)
{
	std::fprintf(stderr, "bench_encode: %s\n", what.c_str());
	std::exit(1);
}

// The pixels of a file in the file's own types.
std::vector<unsigned char> native_pixels(OIIO::ImageInput &in)
{
	std::vector<unsigned char> pixels(in.spec().image_bytes(true));
	if (!in.read_image(0, 0, 0, in.spec().nchannels, OIIO::TypeDesc::UNKNOWN, pixels.data()))
		die(in.geterror());
	return pixels;
}

void fill_plane(OIIO::ImageInput &in, const std::vector<std::string> &names, void *plane)
{
	const OIIO::ImageSpec spec = in.spec();
	const size_t pixels = size_t(spec.width) * size_t(spec.height);
	for (size_t c = 0; c < names.size(); c++) {
		const int from = spec.channelindex(names[c]);
		const OIIO::TypeDesc type = names[c] == "id" ? OIIO::TypeDesc::UINT : OIIO::TypeDesc::FLOAT;
		std::vector<unsigned char> values(4 * pixels);
		if (from < 0 || !in.read_image(0, 0, from, from + 1, type, values.data()))
			die("a channel " + names[c] + " is missing");
		for (size_t i = 0; i < pixels; i++)
			std::memcpy(static_cast<unsigned char *>(plane) + 4 * (i * names.size() + c), &values[4 * i], 4);
	}
}

frame *read_frame(const char *path, bool aovs)
{
	auto in = OIIO::ImageInput::open(path);
	if (!in)
		die(OIIO::geterror());
	frame *f = nullptr;
	error err;
	if (frame_create(uint32_t(in->spec().width), uint32_t(in->spec().height), aovs ? AOV_ALL : 0, &f, &err) != STATUS_OK)
		die(err.text);
	fill_plane(*in, {"R", "G", "B"}, f->radiance);
	if (!aovs)
		return f;
	fill_plane(*in, {"Z"}, f->depth);
	fill_plane(*in, {"N.X", "N.Y", "N.Z"}, f->normal);
	fill_plane(*in, {"albedo.R", "albedo.G", "albedo.B"}, f->albedo);
	fill_plane(*in, {"id"}, f->id);
	return f;
}

void encode_by_codec(const frame &f, codec_format format, std::vector<unsigned char> &file)
{
	int fd = -1;
	size_t bytes = 0;
	error err;
	if (codec_encode(&f, format, CODEC_VIEW_NONE, 0, &fd, &bytes, &err) != STATUS_OK)
		die(err.text);
	file.resize(bytes);
	if (pread(fd, file.data(), bytes, 0) != ssize_t(bytes))
		die("cannot read the codec's file");
	close(fd);
}

// The codec's way of old: packed pixels through OpenImageIO by strips, then a copy into sealed memory.
void encode_by_library(const OIIO::ImageSpec &as, const std::vector<unsigned char> &pixels, const char *compression,
		       std::vector<unsigned char> &file)
{
	OIIO::Filesystem::IOVecOutput memory;
	{
		OIIO::ImageSpec spec = as;
		spec.attribute("compression", compression);
		auto out = OIIO::ImageOutput::create("frame.exr", &memory);
		if (!out || !out->open("frame.exr", spec))
			die(OIIO::geterror());
		for (int y = 0; y < spec.height; y += 64)
			if (!out->write_scanlines(y, std::min(spec.height, y + 64), 0, OIIO::TypeDesc::UNKNOWN,
						  pixels.data() + size_t(y) * spec.scanline_bytes(true)))
				die(out->geterror());
		out->close();
	}
	file = memory.buffer();
}

void check_bits(const way &w, const std::vector<unsigned char> &pixels)
{
	OIIO::Filesystem::IOMemReader memory(const_cast<unsigned char *>(w.file.data()), w.file.size());
	auto in = OIIO::ImageInput::open("memory.exr", nullptr, &memory);
	if (!in)
		die(OIIO::geterror());
	if (native_pixels(*in) != pixels)
		die(std::string(w.name) + " changed the pixels");
}

void bench(const char *path, bool aovs, codec_format format, int turns)
{
	frame *f = read_frame(path, aovs);
	std::vector<way> ways;
	for (const char *name : {"zip", "zip:2", "zips", "piz", "rle", "none", "codec"})
		ways.push_back({name, 1e30, 1e30, {}});
	way first = {"codec", 0, 0, {}};
	encode_by_codec(*f, format, first.file);
	OIIO::Filesystem::IOMemReader memory(first.file.data(), first.file.size());
	auto in = OIIO::ImageInput::open("memory.exr", nullptr, &memory);
	if (!in)
		die(OIIO::geterror());
	const OIIO::ImageSpec spec = in->spec();
	const std::vector<unsigned char> pixels = native_pixels(*in);
	for (int turn = 0; turn < turns; turn++)
		for (way &w : ways) {
			const double cpu = ms_of(CLOCK_PROCESS_CPUTIME_ID), wall = ms_of(CLOCK_MONOTONIC);
			if (!std::strcmp(w.name, "codec"))
				encode_by_codec(*f, format, w.file);
			else
				encode_by_library(spec, pixels, w.name, w.file);
			w.cpu_ms = std::min(w.cpu_ms, ms_of(CLOCK_PROCESS_CPUTIME_ID) - cpu);
			w.wall_ms = std::min(w.wall_ms, ms_of(CLOCK_MONOTONIC) - wall);
		}
	for (const way &w : ways) {
		check_bits(w, pixels);
		std::printf("| %s, %s%s | %s | %.1f | %.1f | %zu | %.2f | %.2f |\n", path,
			    format == CODEC_EXR_HALF ? "half" : "float", aovs ? ", AOVs" : "", w.name, w.cpu_ms, w.wall_ms,
			    w.file.size(), double(w.file.size()) / double(ways[0].file.size()), w.cpu_ms / ways[0].cpu_ms);
	}
	std::fflush(stdout);
	frame_destroy(f);
}

// ---- PNG
// ------------------------------------------------------------------------------------------------------------------

struct png_way {
	std::string name;
	const char *strategy;
	int level, filter;
	double cpu_ms, wall_ms;
	std::vector<unsigned char> file;
};

// What the codec writes, but by other settings.
void encode_png(const OIIO::ImageSpec &as, const std::vector<unsigned char> &pixels, png_way &w)
{
	OIIO::Filesystem::IOVecOutput memory;
	{
		OIIO::ImageSpec spec = as;
		spec.attribute("compression", w.strategy);
		spec.attribute("png:compressionLevel", w.level);
		spec.attribute("png:filter", w.filter);
		auto out = OIIO::ImageOutput::create("frame.png", &memory);
		if (!out || !out->open("frame.png", spec))
			die(OIIO::geterror());
		for (int y = 0; y < spec.height; y += 64)
			if (!out->write_scanlines(y, std::min(spec.height, y + 64), 0, OIIO::TypeDesc::UINT8,
						  pixels.data() + size_t(y) * spec.scanline_bytes(true)))
				die(out->geterror());
		out->close();
	}
	w.file = memory.buffer();
}

std::vector<unsigned char> png_pixels(std::vector<unsigned char> &file, OIIO::ImageSpec &spec)
{
	OIIO::Filesystem::IOMemReader memory(file.data(), file.size());
	auto in = OIIO::ImageInput::open("memory.png", nullptr, &memory);
	if (!in)
		die(OIIO::geterror());
	spec = in->spec();
	return native_pixels(*in);
}

std::vector<png_way> png_ways()
{
	static const struct {
		const char *name;
		int mask; // as libpng's PNG_FILTER_...
	} filters[] = {{"none", 8}, {"sub", 16}, {"up", 32}, {"average", 64}, {"Paeth", 128}, {"any", 248}};
	std::vector<png_way> ways;
	for (const auto &filter : filters) {
		for (const int level : {0, 1, 2, 3, 4, 6, 9})
			ways.push_back(
			    {std::to_string(level) + ", " + filter.name, "default", level, filter.mask, 1e30, 1e30, {}});
		ways.push_back({std::string("runs, ") + filter.name, "rle", 6, filter.mask, 1e30, 1e30, {}});
		ways.push_back({std::string("Huffman, ") + filter.name, "huffman", 6, filter.mask, 1e30, 1e30, {}});
	}
	return ways;
}

void bench_png(const char *path, int turns)
{
	frame *f = read_frame(path, false);
	std::vector<png_way> ways = png_ways();
	way codec = {"codec", 1e30, 1e30, {}};
	OIIO::ImageSpec spec;
	encode_by_codec(*f, CODEC_PNG, codec.file);
	const std::vector<unsigned char> pixels = png_pixels(codec.file, spec);
	for (int turn = 0; turn < turns; turn++) {
		const double cpu = ms_of(CLOCK_PROCESS_CPUTIME_ID), wall = ms_of(CLOCK_MONOTONIC);
		encode_by_codec(*f, CODEC_PNG, codec.file);
		codec.cpu_ms = std::min(codec.cpu_ms, ms_of(CLOCK_PROCESS_CPUTIME_ID) - cpu);
		codec.wall_ms = std::min(codec.wall_ms, ms_of(CLOCK_MONOTONIC) - wall);
		for (png_way &w : ways) {
			const double before = ms_of(CLOCK_PROCESS_CPUTIME_ID), at = ms_of(CLOCK_MONOTONIC);
			encode_png(spec, pixels, w);
			w.cpu_ms = std::min(w.cpu_ms, ms_of(CLOCK_PROCESS_CPUTIME_ID) - before);
			w.wall_ms = std::min(w.wall_ms, ms_of(CLOCK_MONOTONIC) - at);
		}
	}
	std::printf("| %s | codec | %.1f | %.1f | %zu | 1.00 |\n", path, codec.cpu_ms, codec.wall_ms, codec.file.size());
	for (png_way &w : ways) {
		OIIO::ImageSpec read;
		if (png_pixels(w.file, read) != pixels)
			die(w.name + " changed the pixels");
		std::printf("| %s | %s | %.1f | %.1f | %zu | %.2f |\n", path, w.name.c_str(), w.cpu_ms, w.wall_ms,
			    w.file.size(), double(w.file.size()) / double(codec.file.size()));
	}
	std::fflush(stdout);
	frame_destroy(f);
}

} // namespace

int main(int argc, char **argv)
{
	int first = 1, turns = 5;
	if (argc > 2 && !std::strcmp(argv[1], "--turns")) {
		turns = std::max(1, std::atoi(argv[2]));
		first = 3;
	}
	const bool png = first < argc && !std::strcmp(argv[first], "--png");
	first += png;
	if (first >= argc)
		die("usage: bench_encode [--turns N] [--png] FRAME.exr...");
	if (png) {
		std::puts("| frame | level, filter | processors, ms | clock, ms | bytes | bytes / codec |");
		std::puts("| --- | --- | ---: | ---: | ---: | ---: |");
		for (int i = first; i < argc; i++)
			bench_png(argv[i], turns);
		return 0;
	}
	std::puts("| frame | way | processors, ms | clock, ms | bytes | bytes / zip | processors / zip |");
	std::puts("| --- | --- | ---: | ---: | ---: | ---: | ---: |");
	for (int i = first; i < argc; i++)
		for (const codec_format format : {CODEC_EXR_FLOAT, CODEC_EXR_HALF})
			for (const bool aovs : {false, true}) {
				auto in = OIIO::ImageInput::open(argv[i]);
				if (in && aovs && in->spec().channelindex("Z") < 0)
					continue;
				bench(argv[i], aovs, format, turns);
			}
	return 0;
}
