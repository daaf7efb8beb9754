#include "clients/cli/verify.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define TEXT_MAX 256u // of an attribute's name or type

struct reader {
	FILE *file;
	uint64_t size;
	struct metadata *metadata;
};

static bool verify_take(const struct reader *r, void *out, size_t bytes)
{
	return fread(out, 1, bytes, r->file) == bytes;
}

static bool verify_seek(const struct reader *r, uint64_t to)
{
	return to <= r->size && fseeko(r->file, (off_t)to, SEEK_SET) == 0;
}

static bool verify_skip(const struct reader *r, uint64_t bytes)
{
	off_t at = ftello(r->file);
	return at >= 0 && bytes <= r->size && verify_seek(r, (uint64_t)at + bytes);
}

static uint32_t big_endian(const uint8_t *b)
{
	return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

static uint32_t little_endian(const uint8_t *b)
{
	return (uint32_t)b[3] << 24 | (uint32_t)b[2] << 16 | (uint32_t)b[1] << 8 | b[0];
}

// ---- PNG -------------------------------------------------------------------------------------------------------------

// Read a tEXt chunk: a name, a zero, a text without one. false: the file ends before.
static bool take_png_text(const struct reader *r, uint32_t size)
{
	char both[TEXT_MAX + ASKED_TEXT_BYTES];
	if (size == 0 || size > sizeof(both))
		return verify_skip(r, size);
	if (!verify_take(r, both, size))
		return false;
	const char *zero = memchr(both, 0, size);
	const size_t bytes = zero ? size - (size_t)(zero + 1 - both) : 0;
	if (zero && metadata_wants(r->metadata, both, bytes))
		metadata_keep(r->metadata, both, zero + 1, bytes);
	return true;
}

static bool verify_png(const struct reader *r, uint32_t width, uint32_t height)
{
	static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
	uint8_t head[8 + 8 + 13 + 4], chunk[8];
	bool data = false;
	if (!verify_take(r, head, sizeof(head)) || memcmp(head, signature, 8) != 0 || memcmp(head + 12, "IHDR", 4) != 0)
		return false;
	if (big_endian(head + 8) != 13 || big_endian(head + 16) != width || big_endian(head + 20) != height)
		return false;
	while (verify_take(r, chunk, sizeof(chunk))) {
		const uint32_t size = big_endian(chunk);
		const bool text = memcmp(chunk + 4, "tEXt", 4) == 0;
		if (!(text ? take_png_text(r, size) : verify_skip(r, size)) || !verify_skip(r, 4))
			return false;
		if (memcmp(chunk + 4, "IEND", 4) == 0)
			return data && (uint64_t)ftello(r->file) == r->size;
		data = data || memcmp(chunk + 4, "IDAT", 4) == 0;
	}
	return false;
}

// ---- EXR -------------------------------------------------------------------------------------------------------------

struct exr {
	bool has_window, has_compression;
	int32_t window[4]; // xMin, yMin, xMax, yMax
	uint8_t compression;
};

// Read a string up to its zero. false: the file ends before, or the string is too long.
static bool verify_take_text(const struct reader *r, char text[TEXT_MAX])
{
	for (unsigned i = 0; i < TEXT_MAX; i++) {
		int c = getc(r->file);
		if (c == EOF)
			return false;
		text[i] = (char)c;
		if (c == 0)
			return true;
	}
	return false;
}

static bool take_attribute(const struct reader *r, const char *name, struct exr *exr)
{
	char type[TEXT_MAX];
	uint8_t bytes[4], window[16];
	if (!verify_take_text(r, type) || !verify_take(r, bytes, 4))
		return false;
	uint32_t size = little_endian(bytes);
	if (strcmp(name, "dataWindow") == 0 && size == 16) {
		exr->has_window = verify_take(r, window, 16);
		for (unsigned i = 0; exr->has_window && i < 4; i++)
			exr->window[i] = (int32_t)little_endian(window + 4u * i);
		return exr->has_window;
	}
	if (strcmp(name, "compression") == 0 && size == 1)
		return exr->has_compression = verify_take(r, &exr->compression, 1);
	char value[ASKED_TEXT_BYTES];
	if (strcmp(type, "string") != 0 || !metadata_wants(r->metadata, name, size))
		return verify_skip(r, size);
	if (!verify_take(r, value, size))
		return false;
	metadata_keep(r->metadata, name, value, size);
	return true;
}

static bool take_header(const struct reader *r, struct exr *exr)
{
	static const uint8_t magic[4] = {0x76, 0x2f, 0x31, 0x01};
	uint8_t head[8];
	char name[TEXT_MAX];
	// Version 2. A file of scan lines in one part may have one flag: long names.
	if (!verify_take(r, head, 8) || memcmp(head, magic, 4) != 0 || (little_endian(head + 4) & ~0x400u) != 2)
		return false;
	while (verify_take_text(r, name)) {
		if (name[0] == '\0')
			return exr->has_window && exr->has_compression;
		if (!take_attribute(r, name, exr))
			return false;
	}
	return false;
}

// How many lines a block has, by compression: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
static const uint32_t block_lines[] = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};

// Check that a block begins with this line and ends within the file; *end is where. false: it does not.
static bool take_block(const struct reader *r, uint64_t offset, int64_t line, uint64_t *end)
{
	uint8_t head[8];
	if (!verify_seek(r, offset) || !verify_take(r, head, 8) || (int32_t)little_endian(head) != line)
		return false;
	*end = offset + 8 + little_endian(head + 4);
	return little_endian(head + 4) > 0 && *end <= r->size;
}

static bool verify_exr(const struct reader *r, uint32_t width, uint32_t height)
{
	struct exr exr = {0};
	if (!take_header(r, &exr) || exr.compression >= sizeof(block_lines) / sizeof(block_lines[0]))
		return false;
	const int64_t top = exr.window[1], lines = block_lines[exr.compression];
	if ((int64_t)exr.window[2] - exr.window[0] + 1 != width || (int64_t)exr.window[3] - top + 1 != height)
		return false;
	const uint64_t table = (uint64_t)ftello(r->file),
		       blocks = ((uint64_t)height + (uint64_t)lines - 1) / (uint64_t)lines;
	uint64_t last = 0;
	for (uint64_t i = 0; i < blocks; i++) {
		uint8_t b[8];
		uint64_t end;
		if (!verify_seek(r, table + 8 * i) || !verify_take(r, b, 8))
			return false;
		uint64_t offset = (uint64_t)little_endian(b + 4) << 32 | little_endian(b);
		if (offset < table + 8 * blocks || !take_block(r, offset, top + (int64_t)i * lines, &end))
			return false;
		last = end > last ? end : last;
	}
	return last == r->size;
}

bool verify_image(const char *path, bool png, uint32_t width, uint32_t height, struct metadata *metadata)
{
	// A pipe would be waited for, and has no image that stays.
	const int fd = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
	struct stat about;
	struct reader r = {.metadata = metadata};
	bool whole = false;
	if (fd >= 0 && fstat(fd, &about) == 0 && S_ISREG(about.st_mode))
		r.file = fdopen(fd, "rb");
	if (!r.file) {
		if (fd >= 0)
			close(fd);
		return false;
	}
	if (fseeko(r.file, 0, SEEK_END) == 0) {
		off_t size = ftello(r.file);
		r.size = size > 0 ? (uint64_t)size : 0;
		if (size > 0 && verify_seek(&r, 0))
			whole = png ? verify_png(&r, width, height) : verify_exr(&r, width, height);
	}
	fclose(r.file);
	return whole;
}
