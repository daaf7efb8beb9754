#include "server/loader/obj_files.h"

#include <stdlib.h>
#include <string.h>

// A file that assimp has open: bytes in memory and a read position.
struct open_file {
	struct aiFile file;
	struct file_bytes owned; // content of an MTL file
	const uint8_t *data;
	size_t size;
	size_t at;
};

static struct open_file *self(struct aiFile *file)
{
	return (struct open_file *)(void *)file->UserData;
}

static size_t read_proc(struct aiFile *file, char *out, size_t size, size_t count)
{
	struct open_file *f = self(file);
	if (size == 0)
		return 0;
	const size_t whole = (f->size - f->at) / size;
	if (count > whole)
		count = whole;
	memcpy(out, f->data + f->at, size * count);
	f->at += size * count;
	return count;
}

static size_t write_proc(struct aiFile *file, const char *data, size_t size, size_t count)
{
	(void)file, (void)data, (void)size, (void)count;
	return 0;
}

static size_t tell_proc(struct aiFile *file)
{
	return self(file)->at;
}

static size_t size_proc(struct aiFile *file)
{
	return self(file)->size;
}

static enum aiReturn seek_proc(struct aiFile *file, size_t offset, enum aiOrigin origin)
{
	struct open_file *f = self(file);
	const size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? f->at : f->size;
	if (offset > f->size - from)
		return aiReturn_FAILURE;
	f->at = from + offset;
	return aiReturn_SUCCESS;
}

static void flush_proc(struct aiFile *file)
{
	(void)file;
}

// assimp joins folder and name in its own way. The result is always meant relative to the scene's folder.
static const char *plain_name(const char *name)
{
	while (name[0] == '.' && name[1] == '/')
		name += 2;
	return name;
}

static bool read_mtl(struct obj_files *files, const char *name, struct open_file *f)
{
	struct error why;
	const enum status status = files_read(files->import->files, name, &f->owned, &why);
	if (status == STATUS_OK) {
		f->data = f->owned.data;
		f->size = f->owned.size;
		return mtl_notes_scan(&files->notes, files->import, &f->owned, &files->failure) == STATUS_OK;
	}
	if (status == STATUS_SCENE_LIMIT || status == STATUS_MEMORY)
		files->failure = why;
	else if (!files->library_missing) // after a missing library, assimp tries names that the file does not contain
		import_warn(files->import, "material library left out, its materials are taken as grey: %s", why.text);
	files->library_missing = true;
	return false;
}

static struct aiFile *open_proc(struct aiFileIO *io, const char *name, const char *mode)
{
	struct obj_files *files = (struct obj_files *)(void *)io->UserData;
	struct open_file *f = strchr(mode, 'w') ? NULL : calloc(1, sizeof *f);
	if (!f)
		return NULL;
	name = plain_name(name);
	if (strcmp(name, files->name) == 0) {
		f->data = files->bytes->data;
		f->size = files->bytes->size;
	} else if (!read_mtl(files, name, f)) {
		file_bytes_finish(&f->owned);
		free(f);
		return NULL;
	}
	f->file = (struct aiFile){.ReadProc = read_proc,
				  .WriteProc = write_proc,
				  .TellProc = tell_proc,
				  .FileSizeProc = size_proc,
				  .SeekProc = seek_proc,
				  .FlushProc = flush_proc,
				  .UserData = (aiUserData)(void *)f};
	return &f->file;
}

static void close_proc(struct aiFileIO *io, struct aiFile *file)
{
	(void)io;
	struct open_file *f = self(file);
	file_bytes_finish(&f->owned);
	free(f);
}

void obj_files_init(struct obj_files *files, struct import *import, const char *name, const struct file_bytes *bytes)
{
	*files = (struct obj_files){.import = import, .name = name, .bytes = bytes};
	files->io = (struct aiFileIO){.OpenProc = open_proc, .CloseProc = close_proc, .UserData = (aiUserData)(void *)files};
}

void obj_files_finish(struct obj_files *files)
{
	mtl_notes_finish(&files->notes);
}
