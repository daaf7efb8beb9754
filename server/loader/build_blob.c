#include "server/loader/build_blob.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <xxhash.h>

#include "server/base/checked.h"
#include "server/base/memfd.h"
#include "server/loader/bvh.h"
#include "server/loader/geometry.h"
#include "server/scene/facts.h"
#include "server/scene/lights.h"
#include "server/scene/ranges.h"

// All sections of a blob, before they are laid out.
struct parts {
	struct geometry geometry;
	struct bvh bvh;
	struct leaf_triangle *leaves;
	struct emitter *emitters;
	struct punctual_light *lights;
	struct scene_node *nodes;
	struct texture_range *texture_ranges;
	struct material_use *material_uses;
	uint32_t emitter_count, light_count;
	float emitter_power, light_power;
};

static void parts_finish(struct parts *p)
{
	geometry_finish(&p->geometry);
	bvh_finish(&p->bvh);
	free(p->leaves);
	free(p->emitters);
	free(p->lights);
	free(p->nodes);
	free(p->texture_ranges);
	free(p->material_uses);
}

static enum status make_leaves(struct parts *p, struct error *err)
{
	const struct geometry *g = &p->geometry;
	p->leaves = calloc((size_t)g->triangle_count + 1, sizeof *p->leaves);
	if (!p->leaves)
		return error_set(err, STATUS_MEMORY, "no memory for %u leaf triangles", g->triangle_count);
	for (uint32_t i = 0; i < g->triangle_count; i++) {
		struct leaf_triangle *l = &p->leaves[i];
		l->id = p->bvh.order[i];
		const struct triangle *t = &g->triangles[l->id];
		l->material = t->material;
		memcpy(l->v0, g->vertices[t->vertex[0]].position, sizeof l->v0);
		memcpy(l->v1, g->vertices[t->vertex[1]].position, sizeof l->v1);
		memcpy(l->v2, g->vertices[t->vertex[2]].position, sizeof l->v2);
	}
	return STATUS_OK;
}

// Make the blob's lights. place[i] becomes the new index of the import's light i.
static enum status make_punctual(const struct import *im, struct parts *p, uint32_t *place, struct error *err)
{
	const struct geometry *g = &p->geometry;
	p->lights = calloc(im->light_count + 1, sizeof *p->lights);
	if (!p->lights)
		return error_set(err, STATUS_MEMORY, "no memory for %zu lights", im->light_count);
	for (size_t i = 0; i < im->light_count; i++) {
		p->lights[i] = im->lights[i].light;
		for (int c = 0; c < 3; c++)
			p->lights[i].position[c] = (float)(im->lights[i].position[c] - g->origin[c]);
	}
	p->light_count = (uint32_t)im->light_count;
	return lights_make_table(p->lights, &p->light_count, lights_bounding_radius(g->min, g->max), place, &p->light_power,
				 err);
}

static void make_nodes(const struct import *im, const uint32_t *light_place, struct scene_node *out)
{
	uint32_t first = 0;
	for (size_t i = 0; i < im->node_count; i++) {
		out[i] = im->nodes[i].node;
		out[i].world =
		    out[i].parent == NONE ? out[i].local : transform_compose(&out[out[i].parent].world, &out[i].local);
		out[i].first_triangle = first;
		out[i].triangle_count = (uint32_t)im->nodes[i].triangle_end - first;
		out[i].light = out[i].light == NONE ? NONE : light_place[out[i].light];
		first += out[i].triangle_count;
	}
}

static enum status make_lights_and_nodes(struct import *im, struct parts *p, struct error *err)
{
	const struct geometry *g = &p->geometry;
	if (lights_power_densities(im->materials, (uint32_t)im->material_count, im->textures, (uint32_t)im->texture_count,
				   im->texels, err) != STATUS_OK)
		return err->code;
	if (lights_collect_emitters(im->materials, g->vertices, g->triangles, g->triangle_count, &p->emitters,
				    &p->emitter_count, &p->emitter_power, err) != STATUS_OK)
		return err->code;
	uint32_t *place = malloc((im->light_count + 1) * sizeof *place);
	p->nodes = malloc((im->node_count + 1) * sizeof *p->nodes);
	enum status status = place && p->nodes ? make_punctual(im, p, place, err)
					       : error_set(err, STATUS_MEMORY, "no memory for %zu nodes", im->node_count);
	if (status == STATUS_OK)
		make_nodes(im, place, p->nodes);
	free(place);
	return status;
}

static enum status make_ranges(const struct import *im, struct parts *p, struct error *err)
{
	const struct geometry *g = &p->geometry;
	p->texture_ranges = calloc(im->texture_count + 1, sizeof *p->texture_ranges);
	p->material_uses = calloc(im->material_count + 1, sizeof *p->material_uses);
	if (!p->texture_ranges || !p->material_uses)
		return error_set(err, STATUS_MEMORY, "no memory for %zu materials", im->material_count);
	ranges_of_textures(im->textures, (uint32_t)im->texture_count, im->texels, p->texture_ranges);
	ranges_of_materials(g->triangles, g->triangle_count, g->colors, g->tangents, (uint32_t)im->material_count,
			    p->material_uses);
	return STATUS_OK;
}

struct source {
	const void *data;
	size_t count;
};

static void list_sources(const struct import *im, const struct parts *p, struct source out[BLOB_SECTIONS])
{
	const struct geometry *g = &p->geometry;
	out[BLOB_NODES] = (struct source){p->bvh.nodes, p->bvh.node_count};
	out[BLOB_LEAF_TRIANGLES] = (struct source){p->leaves, g->triangle_count};
	out[BLOB_TRIANGLES] = (struct source){g->triangles, g->triangle_count};
	out[BLOB_VERTICES] = (struct source){g->vertices, g->vertex_count};
	out[BLOB_MATERIALS] = (struct source){im->materials, im->material_count};
	out[BLOB_TEXTURES] = (struct source){im->textures, im->texture_count};
	out[BLOB_TEXELS] = (struct source){im->texels, im->texel_count};
	out[BLOB_EMITTERS] = (struct source){p->emitters, p->emitter_count};
	out[BLOB_LIGHTS] = (struct source){p->lights, p->light_count};
	out[BLOB_CAMERAS] = (struct source){im->cameras, im->camera_count};
	out[BLOB_MATERIAL_NAMES] = (struct source){im->names, im->material_count};
	out[BLOB_UV1] = (struct source){g->uv1, g->uv1 ? g->vertex_count : 0};
	out[BLOB_COLORS] = (struct source){g->colors, g->colors ? g->vertex_count : 0};
	out[BLOB_TANGENTS] = (struct source){g->tangents, g->tangents ? g->vertex_count : 0};
	out[BLOB_SCENE_NODES] = (struct source){p->nodes, im->node_count};
	out[BLOB_ANIMATIONS] = (struct source){im->animations, im->animation_count};
	out[BLOB_CHANNELS] = (struct source){im->channels, im->channel_count};
	out[BLOB_CURVES] = (struct source){im->curves, im->curve_count};
	const size_t texels = (size_t)im->environment_width * im->environment_height;
	out[BLOB_ENVIRONMENT] = (struct source){im->environment, texels};
	out[BLOB_ENVIRONMENT_ROWS] = (struct source){im->environment_rows, texels};
	out[BLOB_TEXTURE_RANGES] = (struct source){p->texture_ranges, im->texture_count};
	out[BLOB_MATERIAL_USES] = (struct source){p->material_uses, im->material_count};
	out[BLOB_PATCH_ELEMENTS] = (struct source){im->elements, im->element_count};
	out[BLOB_FACTOR_ROWS] = (struct source){im->rows, im->row_count};
	out[BLOB_FACTOR_ENTRIES] = (struct source){im->factors, im->factor_count};
}

static size_t aligned(size_t bytes)
{
	return (bytes + BLOB_ALIGN - 1) / BLOB_ALIGN * BLOB_ALIGN;
}

static enum status lay_out(struct blob_header *h, const struct source sources[BLOB_SECTIONS], struct error *err)
{
	size_t end = aligned(sizeof *h);
	for (unsigned s = 0; s < BLOB_SECTIONS; s++) {
		size_t bytes;
		h->sections[s].offset = end;
		h->sections[s].count = sources[s].count;
		if (!checked_mul(sources[s].count, blob_stride((enum blob_section)s), &bytes) ||
		    !checked_add(end, bytes + BLOB_ALIGN, &bytes) || bytes > LIMIT_BLOB_BYTES)
			return error_set(err, STATUS_SCENE_LIMIT, "the scene takes more than %llu bytes; simplify it",
					 (unsigned long long)LIMIT_BLOB_BYTES);
		end = aligned(bytes - BLOB_ALIGN);
	}
	h->total_bytes = end;
	return STATUS_OK;
}

static void fill_header(struct blob_header *h, const struct import *im, const struct parts *p)
{
	h->magic = BLOB_MAGIC;
	h->format = BLOB_FORMAT;
	h->header_bytes = sizeof *h;
	h->bvh_depth = p->bvh.depth;
	h->emitter_power = p->emitter_power;
	h->light_power = p->light_power;
	h->environment_width = im->environment_width;
	h->environment_height = im->environment_height;
	h->environment_power = im->environment_power;
	h->environment_contrast = im->environment_contrast;
	memcpy(h->origin, p->geometry.origin, sizeof h->origin);
	memcpy(h->bounds_min, p->geometry.min, sizeof h->bounds_min);
	memcpy(h->bounds_max, p->geometry.max, sizeof h->bounds_max);
}

static candil_Vec3 vec3(const double v[3])
{
	return (candil_Vec3){.x = v[0], .y = v[1], .z = v[2]};
}

static void describe_cameras(candil_SceneInfo *info, const struct blob_header *h)
{
	const struct blob_camera *cameras = blob_section(h, BLOB_CAMERAS);
	const uint32_t room = sizeof info->cameras / sizeof info->cameras[0];
	info->camera_count = blob_count(h, BLOB_CAMERAS);
	for (uint32_t i = 0; i < info->camera_count && i < room; i++) {
		candil_CameraInfo *out = &info->cameras[info->cameras_count++];
		double target[3];
		for (int c = 0; c < 3; c++)
			target[c] = cameras[i].eye[c] + cameras[i].forward[c];
		memcpy(out->name, cameras[i].name, sizeof out->name);
		out->has_eye = out->has_target = out->has_up = true;
		out->eye = vec3(cameras[i].eye);
		out->target = vec3(target);
		out->up = vec3(cameras[i].up);
		out->vfov_degrees = cameras[i].vfov_degrees;
	}
}

static void describe_names(candil_SceneInfo *info, const struct blob_header *h)
{
	const struct scene_node *nodes = blob_section(h, BLOB_SCENE_NODES);
	const struct blob_name *materials = blob_section(h, BLOB_MATERIAL_NAMES);
	const struct scene_animation *animations = blob_section(h, BLOB_ANIMATIONS);
	info->node_count = blob_count(h, BLOB_SCENE_NODES);
	info->animation_count = blob_count(h, BLOB_ANIMATIONS);
	for (uint32_t i = 0; i < info->node_count && i < LIMIT_NODE_LIST; i++)
		memcpy(info->nodes[info->nodes_count++], nodes[i].name, sizeof nodes[i].name);
	for (uint32_t i = 0; i < blob_count(h, BLOB_MATERIAL_NAMES) && i < LIMIT_MATERIAL_LIST; i++)
		memcpy(info->material_names[info->material_names_count++], materials[i].text, sizeof materials[i].text);
	for (uint32_t i = 0; i < info->animation_count && i < LIMIT_ANIMATION_LIST; i++) {
		candil_AnimationInfo *out = &info->animations[info->animations_count++];
		memcpy(out->name, animations[i].name, sizeof out->name);
		out->duration_s = animations[i].duration_s;
	}
}

static void describe(candil_SceneInfo *info, const struct blob_header *h)
{
	double min[3], max[3];
	for (int i = 0; i < 3; i++) {
		min[i] = h->origin[i] + h->bounds_min[i];
		max[i] = h->origin[i] + h->bounds_max[i];
	}
	snprintf(info->hash, sizeof info->hash, "%016llx%016llx", (unsigned long long)h->hash[1],
		 (unsigned long long)h->hash[0]);
	info->blob_bytes = h->total_bytes;
	info->triangles = blob_count(h, BLOB_TRIANGLES);
	info->materials = blob_count(h, BLOB_MATERIALS);
	info->textures = blob_count(h, BLOB_TEXTURES);
	info->emissive_triangles = blob_count(h, BLOB_EMITTERS);
	info->punctual_lights = blob_count(h, BLOB_LIGHTS);
	info->has_bounds_min = info->has_bounds_max = info->has_origin = true;
	info->bounds_min = vec3(min);
	info->bounds_max = vec3(max);
	info->origin = vec3(h->origin);
	info->bvh_nodes = blob_count(h, BLOB_NODES);
	info->bvh_depth = h->bvh_depth;
	info->environment_width = h->environment_width;
	info->environment_height = h->environment_height;
	info->patch_elements = blob_count(h, BLOB_PATCH_ELEMENTS);
	info->factor_rows = blob_count(h, BLOB_FACTOR_ROWS);
	info->factor_entries = blob_count(h, BLOB_FACTOR_ENTRIES);
	_Static_assert(sizeof info->facts / sizeof info->facts[0] == 32, "room for every bit of `facts`");
	for (uint32_t bit = 0; bit < 32; bit++)
		if (h->facts & 1u << bit)
			snprintf(info->facts[info->facts_count++], sizeof info->facts[0], "%s",
				 fact_name((enum fact)(1u << bit)));
	describe_cameras(info, h);
	describe_names(info, h);
}

static void warn_all(struct import *im, const struct blob_header *h)
{
	const candil_SceneInfo *info = im->info;
	if (info->dropped_degenerate)
		import_remark(im, "triangles left out because they have no area: %u", info->dropped_degenerate);
	if (info->dropped_non_finite)
		import_warn(im, "triangles left out because a position is not finite or beyond 1e12 m: %u",
			    info->dropped_non_finite);
	if (info->dropped_out_of_range)
		import_warn(im, "triangles left out because they name a vertex that is not there: %u",
			    info->dropped_out_of_range);
	if (blob_count(h, BLOB_TRIANGLES) == 0 && !(h->facts & (FACT_SURROUNDINGS | FACT_PATCHES | FACT_FACTORS)))
		import_warn(im, "the scene has no triangle");
	if (im->source_extent > 0 && im->source_reach / im->source_extent > 1e4)
		import_warn(im,
			    "vertices lie up to %.3g units from the file's zero but span only %.3g: floats place them to "
			    "%.2g units; "
			    "move them to zero and put the offset into a node",
			    im->source_reach, im->source_extent, ldexp(im->source_reach, -24));
}

static enum status write_blob(struct blob_header *h, const struct source sources[BLOB_SECTIONS], struct import *im, int *fd,
			      struct error *err)
{
	void *map;
	if (memfd_create_mapped("candil-scene", h->total_bytes, fd, &map, err) != STATUS_OK)
		return err->code;
	memcpy(map, h, sizeof *h);
	for (unsigned s = 0; s < BLOB_SECTIONS; s++)
		if (sources[s].count > 0)
			memcpy((char *)map + h->sections[s].offset, sources[s].data,
			       sources[s].count * blob_stride((enum blob_section)s));
	struct blob_header *out = map;
	out->facts = facts_collect(out);
	const XXH128_hash_t hash = XXH3_128bits(map, h->total_bytes);
	out->hash[0] = hash.low64;
	out->hash[1] = hash.high64;
	enum status status = blob_check(map, h->total_bytes, err);
	describe(im->info, out);
	warn_all(im, out);
	const enum status sealed = memfd_seal(*fd, map, h->total_bytes, status == STATUS_OK ? err : NULL);
	if (status == STATUS_OK)
		status = sealed;
	if (status != STATUS_OK) {
		close(*fd);
		*fd = -1;
	}
	return status;
}

static enum status make_parts(struct import *im, struct parts *p, struct error *err)
{
	if (im->material_count == 0) {
		const struct material white = import_plain_material(1.0f);
		if (import_add_material(im, &white, "default", err) != STATUS_OK)
			return err->code;
	}
	enum status status = geometry_build(im, &p->geometry, err);
	if (status == STATUS_OK)
		status = make_lights_and_nodes(im, p, err);
	if (status == STATUS_OK)
		status = make_ranges(im, p, err);
	if (status == STATUS_OK)
		status = bvh_build(p->geometry.vertices, p->geometry.triangles, p->geometry.triangle_count, &p->bvh, err);
	return status == STATUS_OK ? make_leaves(p, err) : status;
}

enum status build_blob(struct import *im, int *fd, struct error *err)
{
	struct parts parts = {0};
	struct source sources[BLOB_SECTIONS];
	struct blob_header header;

	*fd = -1;
	memset(&header, 0, sizeof header); // padding too, because the header is hashed
	enum status status = make_parts(im, &parts, err);
	if (status == STATUS_OK) {
		list_sources(im, &parts, sources);
		fill_header(&header, im, &parts);
		status = lay_out(&header, sources, err);
	}
	if (status == STATUS_OK)
		status = write_blob(&header, sources, im, fd, err);
	parts_finish(&parts);
	return status;
}
