// What is in a scene, as lines and as one object.
#ifndef CANDIL_CLI_SCENE_PRINT_H
#define CANDIL_CLI_SCENE_PRINT_H

#include "clients/cli/cli.h"

#define SCENE_JSON_HELP \
	"{\"name\", \"file\", \"hash\", \"blob_bytes\", \"triangles\", \"materials\", \"textures\", " \
	"\"emissive_triangles\",\n" \
	"\"punctual_lights\", \"camera_count\", \"cameras\": [{\"name\", \"eye\", \"target\", \"up\", " \
	"\"vfov_degrees\"}],\n" \
	"\"bounds_min\", \"bounds_max\", \"origin\", \"bvh_nodes\", \"bvh_depth\", \"dropped_degenerate\",\n" \
	"\"dropped_non_finite\", \"dropped_out_of_range\", \"missing_textures\", \"warnings\": [], \"warnings_more\",\n" \
	"\"ignored\": [], \"facts\": [], \"node_count\", \"nodes\": [], \"material_names\": [], \"animation_count\",\n" \
	"\"animations\": [{\"name\", \"duration_s\"}], \"environment_width\", \"environment_height\" (0: no picture),\n" \
	"\"patch_elements\" (0: no patches), \"factor_rows\" (0: no form factors), \"factor_entries\",\n" \
	"\"load_us\", \"light_units\"}\n"

void scene_print(const struct candil_scene_info *scene);
json_t *scene_json(const struct candil_scene_info *scene);

#endif
