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

enum format { FORMAT_NONE, FORMAT_GLTF, FORMAT_OBJ, FORMAT_PICTURE };

static enum format format_of(const char *file)
{
	static const char *const pictures[] = {".exr", ".hdr", ".tif", ".tiff", ".png", ".jpg", ".jpeg"};
	const char *dot = strrchr(file, '.');
	if (!dot)
		return FORMAT_NONE;
	for (size_t i = 0; i < sizeof pictures / sizeof *pictures; i++)
		if (strcasecmp(dot, pictures[i]) == 0)
			return FORMAT_PICTURE;
	if (strcasecmp(dot, ".gltf") == 0 || strcasecmp(dot, ".glb") == 0)
		return FORMAT_GLTF;
	return strcasecmp(dot, ".obj") == 0 ? FORMAT_OBJ : FORMAT_NONE;
}

// The name determines the format. The first bytes must not contradict it.
static enum status check_content(const char *file, enum format format, const struct file_bytes *bytes, struct error *err)
{
	const char *dot = strrchr(file, '.');
	const bool glb = bytes->size >= 4 && memcmp(bytes->data, "glTF", 4) == 0;
	if (bytes->size == 0)
		return error_set(err, STATUS_SCENE_INVALID, "'%.100s' is empty", file);
	if (format == FORMAT_GLTF && strcasecmp(dot, ".glb") == 0 && !glb)
		return error_set(err, STATUS_SCENE_INVALID, "'%.100s' is not a GLB file; export it again", file);
	if (format == FORMAT_OBJ && (glb || bytes->data[0] == '{'))
		return error_set(err, STATUS_SCENE_INVALID, "'%.100s' is not an OBJ file; give it its proper ending", file);
	return STATUS_OK;
}

static enum status import_file(struct import *import, const char *file, struct error *err)
{
	struct file_bytes bytes;
	const enum format format = format_of(file);
	if (format == FORMAT_NONE)
		return error_set(err, STATUS_SCENE_UNSUPPORTED,
				 "'%.100s' is not .gltf, .glb or .obj, nor an .exr, .hdr, .tiff, .png or .jpeg of the "
				 "surroundings; convert it to one of them",
				 file);
	if (files_read(import->files, file, &bytes, err) != STATUS_OK)
		return err->code;
	enum status status = check_content(file, format, &bytes, err);
	if (status == STATUS_OK)
		status = format == FORMAT_GLTF  ? gltf_import(import, &bytes, err)
			 : format == FORMAT_OBJ ? obj_import(import, file, &bytes, err)
						: environment_import(import, file, &bytes, err);
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
