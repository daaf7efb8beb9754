// The maps of an MTL file's materials: their options, and the textures that they become. One thread.
#ifndef CANDIL_LOADER_MTL_MAP_H
#define CANDIL_LOADER_MTL_MAP_H

#include "server/loader/import.h"
#include "server/loader/obj_text.h"

struct mtl_map {
	char *file; // as the MTL has it, but with slashes; NULL: there is no map
	double offset[2], scale[2]; // -o and -s: the picture's coordinates are scale · vt + offset
	bool clamp; // -clamp
	double bump; // -bm
	char channel; // -imfchan: 'r', 'g', 'b', 'm' (alpha), 'l' (brightness) or 'z'; 0: not given
};

// Read a map's statement behind its keyword. Options may stand before the file's name or behind it. Those without effect
// here go to import_ignore where they ask for something. Without a file's name map->file is NULL. STATUS_MEMORY.
enum status mtl_map_read(struct import *import, struct obj_text *text, struct mtl_map *map, struct error *err);

// Make the map's texture; *texture becomes NONE if there is no map, or its picture cannot be read, which is told. The file
// is looked for beside the MTL, whose folder is `folder` ("" or ended by a slash), in the scene's folder, and there by its
// last name alone; then in the same places in any case of letters. *key becomes the name that the import knows the picture
// by, and stays the import's. `flags` is TEXTURE_SRGB or 0. STATUS_SCENE_LIMIT, STATUS_MEMORY.
enum status mtl_map_texture(struct import *import, const struct mtl_map *map, const char *folder, uint32_t flags,
			    const char **key, uint32_t *texture, struct error *err);

#endif
