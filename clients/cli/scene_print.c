#include "clients/cli/scene_print.h"

#include <inttypes.h>

static void print_cameras(const struct candil_scene_info *s)
{
	for (uint32_t i = 0; i < s->camera_list_count; i++) {
		const struct candil_camera_info *c = &s->cameras[i];
		printf("camera      %s: eye %g %g %g, target %g %g %g, up %g %g %g, ", c->name, c->eye.x, c->eye.y, c->eye.z,
		       c->target.x, c->target.y, c->target.z, c->up.x, c->up.y, c->up.z);
		if (c->vfov_degrees > 0)
			printf("%g° high\n", c->vfov_degrees);
		else
			puts("orthographic");
	}
	if (s->camera_count > s->camera_list_count)
		printf("            and %" PRIu32 " camera%s more\n", s->camera_count - s->camera_list_count,
		       cli_s(s->camera_count - s->camera_list_count));
}

// Print names in lines of about 100 columns, then how many more there are.
static void print_names(const char *label, const char (*names)[64], uint32_t listed, uint32_t count)
{
	int column = 0;
	for (uint32_t i = 0; i < listed; i++) {
		if (column > 88) {
			fputs(",\n", stdout);
			column = 0;
		}
		if (column == 0)
			column = printf("%-12s%s", i == 0 ? label : "", names[i]);
		else
			column += printf(", %s", names[i]);
	}
	if (listed > 0 && count > listed)
		printf(" and %" PRIu32 " more", count - listed);
	if (listed > 0)
		putchar('\n');
}

static void print_animations(const struct candil_scene_info *s)
{
	for (uint32_t i = 0; i < s->animation_list_count; i++)
		printf("animation   %s: %g s\n", s->animations[i].name, s->animations[i].duration_s);
	if (s->animation_count > s->animation_list_count)
		printf("            and %" PRIu32 " animation%s more\n", s->animation_count - s->animation_list_count,
		       cli_s(s->animation_count - s->animation_list_count));
}

static void print_mended(const struct candil_scene_info *s)
{
	const struct {
		const char *one, *many;
		uint32_t count;
	} mended[] = {
	    {"degenerate triangle was dropped", "degenerate triangles were dropped", s->dropped_degenerate},
	    {"triangle that is not finite was dropped", "triangles that are not finite were dropped", s->dropped_non_finite},
	    {"triangle with an index out of range was dropped", "triangles with an index out of range were dropped",
	     s->dropped_out_of_range},
	    {"texture is missing", "textures are missing", s->missing_textures},
	};
	for (size_t i = 0; i < sizeof(mended) / sizeof(mended[0]); i++) {
		if (mended[i].count > 0)
			printf("mended      %" PRIu32 " %s\n", mended[i].count,
			       mended[i].count == 1 ? mended[i].one : mended[i].many);
	}
	for (uint32_t i = 0; i < s->warning_count; i++)
		printf("warning     %s\n", s->warnings[i]);
	if (s->warnings_more > 0)
		printf("            and %" PRIu32 " warning%s more\n", s->warnings_more, cli_s(s->warnings_more));
	for (uint32_t i = 0; i < s->ignored_count; i++)
		printf("ignored     %s\n", s->ignored[i]);
}

void scene_print(const struct candil_scene_info *s)
{
	if (s->name[0])
		printf("scene       %s (%s)\n", s->name, s->file);
	else // it was loaded for this command alone
		printf("scene       %s\n", s->file);
	printf("holds       %" PRIu32 " triangle%s, %" PRIu32 " material%s, %" PRIu32
	       " texture%s; %.1f MiB, loaded in %.0f ms\n",
	       s->triangles, cli_s(s->triangles), s->materials, cli_s(s->materials), s->textures, cli_s(s->textures),
	       (double)s->blob_bytes / 1048576.0, (double)s->load_us * 1e-3);
	if (s->environment_width > 0)
		printf("picture     of the surroundings, %" PRIu32 " x %" PRIu32 " texels\n", s->environment_width,
		       s->environment_height);
	if (s->patch_elements > 0)
		printf("patches     of a radiosity solution, %" PRIu32 " sides\n", s->patch_elements);
	if (s->factor_rows > 0)
		printf("factors     between the sides of patches, %" PRIu32 " rows, %" PRIu32 " entries\n", s->factor_rows,
		       s->factor_entries);
	printf("lights      %" PRIu32 " emissive triangle%s, %" PRIu32 " punctual light%s\n", s->emissive_triangles,
	       cli_s(s->emissive_triangles), s->punctual_lights, cli_s(s->punctual_lights));
	if (s->light_units[0])
		printf("units       %s\n", s->light_units);
	printf("bounds      %g %g %g to %g %g %g m\n", s->bounds_min.x, s->bounds_min.y, s->bounds_min.z, s->bounds_max.x,
	       s->bounds_max.y, s->bounds_max.z);
	printf("bvh         %" PRIu32 " node%s, %" PRIu32 " level%s\n", s->bvh_nodes, cli_s(s->bvh_nodes), s->bvh_depth,
	       cli_s(s->bvh_depth));
	if (s->fact_count > 0)
		printf("facts       ");
	for (uint32_t i = 0; i < s->fact_count; i++)
		printf("%s%s", s->facts[i], i + 1 < s->fact_count ? ", " : "\n");
	print_cameras(s);
	print_names("nodes", s->nodes, s->node_list_count, s->node_count);
	print_names("materials", s->material_names, s->material_list_count, s->materials);
	print_animations(s);
	print_mended(s);
	printf("hash        %s\n", s->hash);
}

static json_t *cameras_json(const struct candil_scene_info *s)
{
	json_t *list = json_array();
	for (uint32_t i = 0; i < s->camera_list_count; i++) {
		const struct candil_camera_info *c = &s->cameras[i];
		json_array_append_new(list, json_pack("{s:o,s:o,s:o,s:o,s:f}", "name", cli_json_text(c->name), "eye",
						      cli_json_vec3(&c->eye), "target", cli_json_vec3(&c->target), "up",
						      cli_json_vec3(&c->up), "vfov_degrees", c->vfov_degrees));
	}
	return list;
}

static json_t *animations_json(const struct candil_scene_info *s)
{
	json_t *list = json_array();
	for (uint32_t i = 0; i < s->animation_list_count; i++)
		json_array_append_new(list, json_pack("{s:o,s:f}", "name", cli_json_text(s->animations[i].name),
						      "duration_s", s->animations[i].duration_s));
	return list;
}

json_t *scene_json(const struct candil_scene_info *s)
{
	json_t *object = json_object();
#define TEXT(field) json_object_set_new(object, #field, cli_json_text(s->field))
#define NUMBER(field) json_object_set_new(object, #field, cli_json_u64(s->field))
#define VEC3(field) json_object_set_new(object, #field, cli_json_vec3(&s->field))
#define LIST(key, array, count) \
	do { \
		json_t *list = json_array(); \
		for (uint32_t i = 0; i < s->count; i++) \
			json_array_append_new(list, cli_json_text(s->array[i])); \
		json_object_set_new(object, key, list); \
	} while (0)
	TEXT(name);
	TEXT(file);
	TEXT(hash);
	NUMBER(blob_bytes);
	NUMBER(triangles);
	NUMBER(materials);
	NUMBER(textures);
	NUMBER(emissive_triangles);
	NUMBER(punctual_lights);
	NUMBER(camera_count);
	json_object_set_new(object, "cameras", cameras_json(s));
	VEC3(bounds_min);
	VEC3(bounds_max);
	VEC3(origin);
	NUMBER(bvh_nodes);
	NUMBER(bvh_depth);
	NUMBER(dropped_degenerate);
	NUMBER(dropped_non_finite);
	NUMBER(dropped_out_of_range);
	NUMBER(missing_textures);
	LIST("warnings", warnings, warning_count);
	NUMBER(warnings_more);
	LIST("ignored", ignored, ignored_count);
	LIST("facts", facts, fact_count);
	NUMBER(node_count);
	LIST("nodes", nodes, node_list_count);
	LIST("material_names", material_names, material_list_count);
	NUMBER(animation_count);
	json_object_set_new(object, "animations", animations_json(s));
	NUMBER(environment_width);
	NUMBER(environment_height);
	NUMBER(patch_elements);
	NUMBER(factor_rows);
	NUMBER(factor_entries);
	NUMBER(load_us);
	TEXT(light_units);
#undef TEXT
#undef NUMBER
#undef VEC3
#undef LIST
	return object;
}
