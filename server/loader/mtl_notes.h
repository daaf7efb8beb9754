// What an MTL file says that assimp's materials do not preserve: which materials it defines, the specular lobe, glass and
// bumps of each, and which statements the renderer ignores. One thread.
#ifndef CANDIL_LOADER_MTL_NOTES_H
#define CANDIL_LOADER_MTL_NOTES_H

#include <stdbool.h>
#include <stddef.h>

#include "server/loader/import.h"

struct mtl_note {
	char *name;
	bool has_diffuse; // Kd
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
	double bump; // -bm of its bump or normal map; 1 if none given
};

struct mtl_notes {
	struct mtl_note *notes;
	size_t count, room;
};

// Scan the text of an MTL file (a NUL follows its `size` bytes) and add what it defines. Ignored features go to
// import_ignore. STATUS_SCENE_LIMIT, STATUS_MEMORY.
enum status mtl_notes_scan(struct mtl_notes *notes, struct import *import, const struct file_bytes *bytes,
			   struct error *err);

// The note of a material, or NULL. It remains the table's.
const struct mtl_note *mtl_notes_find(const struct mtl_notes *notes, const char *name);

// Free the notes.
void mtl_notes_finish(struct mtl_notes *notes);

#endif
