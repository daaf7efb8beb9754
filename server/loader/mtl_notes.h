// What MTL files say: their materials by name, as written. mtl_surface.h makes surfaces of them. One thread.
#ifndef CANDIL_LOADER_MTL_NOTES_H
#define CANDIL_LOADER_MTL_NOTES_H

#include <stdbool.h>
#include <stddef.h>

#include "server/loader/key_table.h"
#include "server/loader/mtl_map.h"

enum mtl_map_kind {
	MTL_DIFFUSE,
	MTL_EMISSION,
	MTL_SPECULAR,
	MTL_NORMALS,
	MTL_BUMPS,
	MTL_DISSOLVE, // from here on of a number each
	MTL_ROUGHNESS,
	MTL_METALLIC,
	MTL_MAPS
};

struct mtl_note {
	char *name;
	const char *folder; // of the MTL file that defines it, "" or ended by a slash; NULL: none does
	bool is_used; // by a face
	bool has_diffuse, has_emission, has_specular;
	double diffuse[3]; // Kd
	double emission[3]; // Ke
	int illum; // the illumination model; -1: none given
	double specular[3]; // Ks
	double exponent; // Ns
	bool has_exponent;
	double ior; // Ni; 0: none given
	double dissolve; // d, else 1 - Tr; 1 if neither is given
	bool has_dissolve; // d is given; it takes precedence over Tr
	bool has_filter;
	double filter[3]; // Tf
	bool has_roughness, has_metallic;
	double roughness, metallic; // Pr, Pm
	double coat, coat_roughness; // Pc, Pcr
	double diffuse_roughness; // Pdr, our own statement; other programs skip it
	double priority; // Pp, our own statement
	struct mtl_map maps[MTL_MAPS];
};

struct mtl_notes {
	struct mtl_note *notes;
	size_t count, room;
	struct key_table names;
	char **folders; // of the files
	size_t folder_count, folder_room;
};

// Start without notes. mtl_notes_finish frees them.
void mtl_notes_init(struct mtl_notes *notes);
void mtl_notes_finish(struct mtl_notes *notes);

// Read an MTL file, `file` for messages and for the folder in which its maps lie, and add the materials that it defines. The
// first definition of a name counts. What is left out goes to import_ignore or import_warn, and so does a file that is no
// text. STATUS_SCENE_LIMIT, STATUS_MEMORY.
enum status mtl_notes_read(struct mtl_notes *notes, struct import *import, const char *file, const struct file_bytes *bytes,
			   struct error *err);

// The number of the material of this name in notes->notes. One that no file has defined is added.
// STATUS_SCENE_LIMIT, STATUS_MEMORY.
enum status mtl_notes_number(struct mtl_notes *notes, const char *name, uint32_t *number, struct error *err);

#endif
