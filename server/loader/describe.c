#include "server/loader/describe.h"

#include <jansson.h>
#include <stdio.h>

static json_t *vector(const candil_Vec3 *v)
{
	return json_pack("[f,f,f]", v->x, v->y, v->z);
}

static json_t *strings(const char *first, size_t stride, size_t count)
{
	json_t *out = json_array();
	for (size_t i = 0; i < count; i++)
		json_array_append_new(out, json_string(first + i * stride));
	return out;
}

static json_t *cameras(const candil_SceneInfo *info)
{
	json_t *out = json_array();
	for (pb_size_t i = 0; i < info->cameras_count; i++) {
		const candil_CameraInfo *c = &info->cameras[i];
		json_array_append_new(out,
				      json_pack("{s:s,s:o,s:o,s:o,s:f}", "name", c->name, "eye", vector(&c->eye), "target",
						vector(&c->target), "up", vector(&c->up), "vfov_degrees", c->vfov_degrees));
	}
	return out;
}

static json_t *animations(const candil_SceneInfo *info)
{
	json_t *out = json_array();
	for (pb_size_t i = 0; i < info->animations_count; i++)
		json_array_append_new(out, json_pack("{s:s,s:f}", "name", info->animations[i].name, "duration_s",
						     info->animations[i].duration_s));
	return out;
}

static void set_number(json_t *root, const char *name, uint64_t value)
{
	json_object_set_new(root, name, json_integer((json_int_t)value));
}

static void set_counts(json_t *root, const candil_SceneInfo *info)
{
	set_number(root, "blob_bytes", info->blob_bytes);
	set_number(root, "triangles", info->triangles);
	set_number(root, "materials", info->materials);
	set_number(root, "textures", info->textures);
	set_number(root, "emissive_triangles", info->emissive_triangles);
	set_number(root, "punctual_lights", info->punctual_lights);
	set_number(root, "camera_count", info->camera_count);
	set_number(root, "node_count", info->node_count);
	set_number(root, "animation_count", info->animation_count);
	set_number(root, "environment_width", info->environment_width);
	set_number(root, "environment_height", info->environment_height);
	set_number(root, "patch_elements", info->patch_elements);
	set_number(root, "factor_rows", info->factor_rows);
	set_number(root, "factor_entries", info->factor_entries);
	set_number(root, "bvh_nodes", info->bvh_nodes);
	set_number(root, "bvh_depth", info->bvh_depth);
	set_number(root, "dropped_degenerate", info->dropped_degenerate);
	set_number(root, "dropped_non_finite", info->dropped_non_finite);
	set_number(root, "dropped_out_of_range", info->dropped_out_of_range);
	set_number(root, "missing_textures", info->missing_textures);
	set_number(root, "warnings_more", info->warnings_more);
}

bool describe_print(const candil_SceneInfo *info)
{
	json_t *root = json_object();
	json_object_set_new(root, "file", json_string(info->file));
	json_object_set_new(root, "hash", json_string(info->hash));
	set_counts(root, info);
	json_object_set_new(root, "bounds_min", vector(&info->bounds_min));
	json_object_set_new(root, "bounds_max", vector(&info->bounds_max));
	json_object_set_new(root, "origin", vector(&info->origin));
	json_object_set_new(root, "cameras", cameras(info));
	json_object_set_new(root, "nodes", strings(info->nodes[0], sizeof info->nodes[0], info->nodes_count));
	json_object_set_new(root, "material_names",
			    strings(info->material_names[0], sizeof info->material_names[0], info->material_names_count));
	json_object_set_new(root, "animations", animations(info));
	json_object_set_new(root, "warnings", strings(info->warnings[0], sizeof info->warnings[0], info->warnings_count));
	json_object_set_new(root, "ignored", strings(info->ignored[0], sizeof info->ignored[0], info->ignored_count));
	json_object_set_new(root, "facts", strings(info->facts[0], sizeof info->facts[0], info->facts_count));
	json_object_set_new(root, "light_units", json_string(info->light_units));
	const bool good = json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) == 0 && putchar('\n') != EOF &&
			  fflush(stdout) == 0;
	json_decref(root);
	return good;
}
