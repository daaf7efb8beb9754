#include "server/loader/load.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "protocol/text.h"
#include "server/loader/build_blob.h"
#include "server/loader/environment.h"
#include "server/loader/gltf.h"
#include "server/loader/import.h"
#include "server/loader/obj.h"
#include "server/loader/patch_matrix.h"
#include "server/loader/patch_ply.h"

typedef enum status reader(struct import *import, const char *file, const struct file_bytes *bytes, struct error *err);

static enum status read_gltf(struct import *import, const char *file, const struct file_bytes *bytes, struct error *err)
{
	(void)file;
	return gltf_import(import, bytes, err);
}

// What reads a file, by its name's ending. NULL: nothing does.
static reader *reader_of(const char *file)
{
	static const struct {
		const char *ending;
		reader *read;
	} readers[] = {{".gltf", read_gltf},          {".glb", read_gltf},          {".obj", obj_import},
		       {".exr", environment_import},  {".hdr", environment_import}, {".tif", environment_import},
		       {".tiff", environment_import}, {".png", environment_import}, {".jpg", environment_import},
		       {".jpeg", environment_import}, {".ply", patch_ply_import},   {".mtx", patch_matrix_import}};
	const char *dot = strrchr(file, '.');
	for (size_t i = 0; dot && i < sizeof readers / sizeof *readers; i++)
		if (strcasecmp(dot, readers[i].ending) == 0)
			return readers[i].read;
	return NULL;
}

// The name determines the format. The first bytes must not contradict it.
static enum status check_content(const char *file, reader *read, const struct file_bytes *bytes, struct error *err)
{
	const char *dot = strrchr(file, '.');
	const bool glb = bytes->size >= 4 && memcmp(bytes->data, "glTF", 4) == 0;
	if (bytes->size == 0)
		return error_set(err, STATUS_SCENE_INVALID, "'%.100s' is empty", file);
	if (read == read_gltf && strcasecmp(dot, ".glb") == 0 && !glb)
		return error_set(err, STATUS_SCENE_INVALID, "'%.100s' is not a GLB file; export it again", file);
	if (read == obj_import && (glb || bytes->data[0] == '{'))
		return error_set(err, STATUS_SCENE_INVALID, "'%.100s' is not an OBJ file; give it its proper ending", file);
	return STATUS_OK;
}

static enum status import_file(struct import *import, const char *file, struct error *err)
{
	struct file_bytes bytes;
	reader *read = reader_of(file);
	if (!read)
		return error_set(err, STATUS_SCENE_UNSUPPORTED,
				 "'%.60s' is not .gltf, .glb or .obj, nor an .exr, .hdr, .tiff, .png or .jpeg of the "
				 "surroundings, nor a .ply or .mtx of radiosity; convert it to one of them",
				 file);
	if (files_read(import->files, file, &bytes, err) != STATUS_OK)
		return err->code;
	enum status status = check_content(file, read, &bytes, err);
	if (status == STATUS_OK)
		status = read(import, file, &bytes, err);
	file_bytes_finish(&bytes);
	return status;
}

enum status load_scene(struct load_options *options, candil_SceneInfo *info, struct scene_remarks *remarks, int *fd,
		       struct error *err)
{
	struct files files = {0};
	struct import import;
	const char *file;

	*fd = -1;
	*remarks = (struct scene_remarks){0};
	*info = (candil_SceneInfo)candil_SceneInfo_init_zero;
	text_copy(info->file, sizeof info->file, options->file);
	if (files_open_folder(options->dir, options->file, &files.dir, &file, err) != STATUS_OK)
		return err->code;
	import_init(&import, &files, info);
	import.z_up = options->z_up;
	import.unit = options->metres_per_unit;
	import.decoder = options->decoder;
	enum status status = import_file(&import, file, err);
	if (status == STATUS_OK && import.light_count > 0)
		snprintf(info->light_units, sizeof info->light_units,
			 "photometric values are taken as radiometric: 1 cd as 1 W/sr, 1 lx as 1 W/m^2");
	if (status == STATUS_OK)
		status = build_blob(&import, fd, err);
	*remarks = import.remarks;
	options->wants_decoder = import.wants_decoder;
	import_finish(&import);
	close(files.dir);
	return status;
}
