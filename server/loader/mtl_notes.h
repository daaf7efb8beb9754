// What an MTL file says that assimp's materials no longer tell: which materials it defines, what each says about its
// specular lobe, its glass and its bumps, and which statements the renderer leaves out.
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
	bool has_dissolve; // d: it goes before Tr
	bool has_filter;
	double filter[3]; // Tf
	bool has_roughness, has_metallic;
	double roughness, metallic; // Pr, Pm
	double coat, coat_roughness; // Pc, Pcr
	double diffuse_roughness; // Pdr, our own: other programs pass over it
	double priority; // Pp, our own too
	double bump; // -bm of its bump or normal map; 1 if none given
};

struct mtl_notes {
	struct mtl_note *notes;
	size_t count, room;
};

// Scan one MTL file's text (NUL behind `size` bytes) and add what it defines; features left out go to import_ignore.
enum status mtl_notes_scan(struct mtl_notes *notes, struct import *import, const struct file_bytes *bytes,
			   struct error *err);

const struct mtl_note *mtl_notes_find(const struct mtl_notes *notes, const char *name);

void mtl_notes_finish(struct mtl_notes *notes);

#endif
