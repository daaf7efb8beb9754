#include "tests/fuzz/import_file.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "server/base/memfd.h"
#include "server/loader/build_blob.h"

// More triangles, texels or rows of form factors are not built: what builds them is the same, and an input would take long.
#define BUILT_TRIANGLES 512u
#define BUILT_TEXELS 65536u
#define BUILT_ROWS 65536u

// Stands in for the library of images: any bytes are an image, of a few pixels, now and then of 16 bits a channel. Theirs is
// fuzz_image.c.
struct image_reader {
	uint32_t side;
	bool deep;
};

static struct image_reader plain_reader;

static enum status plain_open(const uint8_t *bytes, size_t size, const char *name, bool any_format,
			      struct image_reader **reader, uint32_t *width, uint32_t *height, struct error *err)
{
	(void)name, (void)any_format;
	*reader = NULL;
	if (size < 4)
		return error_set(err, STATUS_SCENE_INVALID, "the image has no pixels");
	plain_reader = (struct image_reader){.side = 1 + bytes[size - 1] % 4u, .deep = bytes[size - 2] % 4u == 0};
	*reader = &plain_reader;
	*width = *height = plain_reader.side;
	return STATUS_OK;
}

static uint32_t plain_words(const struct image_reader *reader)
{
	return reader->deep ? 2 : 1;
}

static enum status plain_pixels(struct image_reader *reader, uint32_t words, uint32_t *texels, bool *deep, struct error *err)
{
	(void)err;
	for (uint32_t i = 0; i < reader->side * reader->side * words; i++)
		texels[i] = 0x80FF4020u * (i + 1);
	*deep = reader->deep;
	return STATUS_OK;
}

static void plain_close(struct image_reader *reader)
{
	(void)reader;
}

static const struct image_decoder plain_decoder = {
    .open = plain_open, .words = plain_words, .pixels = plain_pixels, .close = plain_close};

static char folder[64];
static int folder_fd = -1;

static void remove_folder(void)
{
	static const char *const names[] = {"scene.mtl", "map.png"};
	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		unlinkat(folder_fd, names[i], 0);
	rmdir(folder);
}

static void open_folder(void)
{
	const char *tmp = getenv("TMPDIR");
	if (folder_fd >= 0)
		return;
	snprintf(folder, sizeof folder, "%.30s/candil-fuzz-XXXXXX", tmp ? tmp : "/tmp");
	if (!mkdtemp(folder) || (folder_fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC)) < 0)
		abort();
	atexit(remove_folder);
	import_file_write("map.png", (const uint8_t *)"image", 5);
}

void import_file_write(const char *name, const uint8_t *data, size_t size)
{
	open_folder();
	const int fd = openat(folder_fd, name, O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0600);
	if (fd < 0 || write(fd, data, size) != (ssize_t)size)
		abort();
	close(fd);
}

static void build(struct import *import)
{
	const void *map;
	size_t bytes;
	struct error err;
	int fd = -1;
	if (build_blob(import, &fd, &err) != STATUS_OK)
		return;
	// The worker refuses no blob of an honest loader.
	if (memfd_map_sealed(fd, &map, &bytes, &err) != STATUS_OK || blob_check(map, bytes, &err) != STATUS_OK) {
		fprintf(stderr, "the blob is refused: %s\n", err.text);
		abort();
	}
	munmap((void *)(uintptr_t)map, bytes);
	close(fd);
}

void import_file(importer *read, const uint8_t *data, size_t size)
{
	static candil_SceneInfo info;
	struct import import;
	struct files files = {0};
	struct error err;
	struct file_bytes bytes = {.size = size};
	open_folder();
	files.dir = folder_fd;
	memset(&info, 0, sizeof info);
	if (size == 0)
		return;
	bytes.data = malloc(size + 1);
	if (!bytes.data)
		return;
	memcpy(bytes.data, data, size);
	bytes.data[size] = 0; // as files_read has it
	import_init(&import, &files, &info);
	import.unit = 1;
	import.decoder = &plain_decoder;
	if (read(&import, &bytes, &err) == STATUS_OK && import.triangle_count <= BUILT_TRIANGLES &&
	    import.texel_count <= BUILT_TEXELS && import.row_count <= BUILT_ROWS)
		build(&import);
	import_finish(&import);
	file_bytes_finish(&bytes);
}
