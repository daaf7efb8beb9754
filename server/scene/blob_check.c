// The one place that reads a blob before it is trusted. Code that runs after it does not check indices again.
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/names.h"
#include "server/base/checked.h"
#include "server/scene/blob.h"
#include "server/scene/blob_check_nodes.h"
#include "server/scene/blob_check_patches.h"
#include "server/scene/facts.h"
#include "server/scene/texel.h"

static enum status bad(struct error *err, const char *what)
{
	return error_set(err, STATUS_SCENE_INVALID, "the scene blob is damaged: %s; load the scene again", what);
}

static bool finite_all(const float *values, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (!isfinite(values[i]))
			return false;
	return true;
}

static bool finite_doubles(const double *values, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (!isfinite(values[i]))
			return false;
	return true;
}

static bool is_share(float value)
{
	return value >= 0.0f && value <= 1.0f;
}

static const uint64_t section_limit[BLOB_SECTIONS] = {
    [BLOB_NODES] = LIMIT_TRIANGLES,
    [BLOB_LEAF_TRIANGLES] = LIMIT_TRIANGLES,
    [BLOB_TRIANGLES] = LIMIT_TRIANGLES,
    [BLOB_VERTICES] = LIMIT_VERTICES,
    [BLOB_MATERIALS] = LIMIT_MATERIALS,
    [BLOB_TEXTURES] = LIMIT_TEXTURES,
    [BLOB_TEXELS] = LIMIT_TEXELS,
    [BLOB_EMITTERS] = LIMIT_TRIANGLES,
    [BLOB_LIGHTS] = LIMIT_PUNCTUAL_LIGHTS,
    [BLOB_CAMERAS] = LIMIT_CAMERAS,
    [BLOB_MATERIAL_NAMES] = LIMIT_MATERIALS,
    [BLOB_UV1] = LIMIT_VERTICES,
    [BLOB_COLORS] = LIMIT_VERTICES,
    [BLOB_TANGENTS] = LIMIT_VERTICES,
    [BLOB_SCENE_NODES] = LIMIT_NODES,
    [BLOB_ANIMATIONS] = LIMIT_ANIMATIONS,
    [BLOB_CHANNELS] = LIMIT_CHANNELS,
    [BLOB_CURVES] = LIMIT_CURVE_FLOATS,
    [BLOB_ENVIRONMENT] = LIMIT_ENVIRONMENT_TEXELS,
    [BLOB_ENVIRONMENT_ROWS] = LIMIT_ENVIRONMENT_TEXELS,
    [BLOB_TEXTURE_RANGES] = LIMIT_TEXTURES,
    [BLOB_MATERIAL_USES] = LIMIT_MATERIALS,
    [BLOB_PATCH_ELEMENTS] = LIMIT_PATCH_ELEMENTS,
    [BLOB_FACTOR_ROWS] = LIMIT_PATCH_ELEMENTS,
    [BLOB_FACTOR_ENTRIES] = LIMIT_PATCH_ENTRIES,
};

static enum status check_sections(const struct blob_header *h, size_t bytes, struct error *err)
{
	for (unsigned s = 0; s < BLOB_SECTIONS; s++) {
		const struct blob_range *range = &h->sections[s];
		size_t length, end;
		if (range->count > section_limit[s])
			return bad(err, "a section has more elements than its limit");
		if (range->offset % BLOB_ALIGN != 0 || range->offset < sizeof *h)
			return bad(err, "a section starts at a wrong place");
		if (!checked_mul((size_t)range->count, blob_stride((enum blob_section)s), &length) ||
		    !checked_add((size_t)range->offset, length, &end) || end > bytes)
			return bad(err, "a section ends behind the blob");
	}
	if (h->sections[BLOB_NODES].count == 0 || h->sections[BLOB_MATERIALS].count == 0)
		return bad(err, "it has no node or no material");
	if (h->sections[BLOB_LEAF_TRIANGLES].count != h->sections[BLOB_TRIANGLES].count)
		return bad(err, "leaf triangles and triangles differ in number");
	if (h->sections[BLOB_MATERIAL_NAMES].count != h->sections[BLOB_MATERIALS].count)
		return bad(err, "materials and their names differ in number");
	if (h->sections[BLOB_MATERIAL_USES].count != h->sections[BLOB_MATERIALS].count ||
	    h->sections[BLOB_TEXTURE_RANGES].count != h->sections[BLOB_TEXTURES].count)
		return bad(err, "materials or textures and their ranges differ in number");
	for (unsigned s = BLOB_UV1; s <= BLOB_TANGENTS; s++)
		if (h->sections[s].count != 0 && h->sections[s].count != h->sections[BLOB_VERTICES].count)
			return bad(err, "vertices and what goes with them differ in number");
	return STATUS_OK;
}

static enum status check_header(const struct blob_header *h, size_t bytes, struct error *err)
{
	if (bytes < sizeof *h || h->magic != BLOB_MAGIC || h->format != BLOB_FORMAT || h->header_bytes != sizeof *h)
		return bad(err, "its header is not of this build");
	if (h->total_bytes != bytes || bytes > LIMIT_BLOB_BYTES)
		return bad(err, "its length is wrong");
	if (h->bvh_depth == 0 || h->bvh_depth > LIMIT_BVH_DEPTH)
		return bad(err, "its BVH is too deep");
	if (!finite_doubles(h->origin, 3) || !finite_all(h->bounds_min, 3) || !finite_all(h->bounds_max, 3))
		return bad(err, "its origin or its bounds are not finite");
	if (!isfinite(h->emitter_power) || h->emitter_power < 0 || !isfinite(h->light_power) || h->light_power < 0)
		return bad(err, "its power is not finite");
	return check_sections(h, bytes, err);
}

static enum status check_geometry(const struct blob_header *h, struct error *err)
{
	const struct vertex *vertices = blob_section(h, BLOB_VERTICES);
	const struct triangle *triangles = blob_section(h, BLOB_TRIANGLES);
	const uint32_t vertex_count = blob_count(h, BLOB_VERTICES), material_count = blob_count(h, BLOB_MATERIALS);

	if (!finite_all((const float *)(const void *)vertices, (size_t)vertex_count * 8))
		return bad(err, "a vertex is not finite");
	for (uint32_t i = 0; i < blob_count(h, BLOB_TRIANGLES); i++) {
		const struct triangle *t = &triangles[i];
		if (t->vertex[0] >= vertex_count || t->vertex[1] >= vertex_count || t->vertex[2] >= vertex_count)
			return bad(err, "a triangle names a vertex that is not there");
		if (t->material >= material_count)
			return bad(err, "a triangle names a material that is not there");
	}
	return STATUS_OK;
}

static enum status check_vertex_parts(const struct blob_header *h, struct error *err)
{
	const struct vertex_uv1 *uvs = blob_section(h, BLOB_UV1);
	const struct vertex_color *colors = blob_section(h, BLOB_COLORS);
	const struct vertex_tangent *tangents = blob_section(h, BLOB_TANGENTS);

	for (uint32_t i = 0; i < blob_count(h, BLOB_UV1); i++)
		if (!finite_all(uvs[i].uv, 2))
			return bad(err, "a second texture coordinate is not finite");
	for (uint32_t i = 0; i < blob_count(h, BLOB_COLORS); i++)
		for (int c = 0; c < 4; c++)
			if (!(colors[i].rgba[c] >= 0 && colors[i].rgba[c] <= BLOB_COLOR_MAX))
				return bad(err, "a vertex colour is out of range");
	for (uint32_t i = 0; i < blob_count(h, BLOB_TANGENTS); i++) {
		const float sign = tangents[i].xyzw[3];
		if (!finite_all(tangents[i].xyzw, 3) || (sign != -1.0f && sign != 0.0f && sign != 1.0f))
			return bad(err, "a tangent is not finite or its sign is none");
	}
	return STATUS_OK;
}

static enum status check_leaf_triangles(const struct blob_header *h, struct error *err)
{
	const struct vertex *vertices = blob_section(h, BLOB_VERTICES);
	const struct triangle *triangles = blob_section(h, BLOB_TRIANGLES);
	const struct leaf_triangle *leaves = blob_section(h, BLOB_LEAF_TRIANGLES);
	const uint32_t count = blob_count(h, BLOB_LEAF_TRIANGLES);
	enum status status = STATUS_OK;
	uint8_t *seen = calloc((size_t)count / 8 + 1, 1);

	if (!seen)
		return error_set(err, STATUS_MEMORY, "no memory to check a scene of %u triangles", count);
	for (uint32_t i = 0; i < count && status == STATUS_OK; i++) {
		const struct leaf_triangle *l = &leaves[i];
		const uint8_t bit = (uint8_t)(1u << (l->id & 7u));
		if (l->id >= count || (seen[l->id / 8] & bit)) {
			status = bad(err, "its leaves do not name each triangle once");
			break;
		}
		seen[l->id / 8] |= bit;
		const struct triangle *t = &triangles[l->id];
		if (l->material != t->material || memcmp(l->v0, vertices[t->vertex[0]].position, sizeof l->v0) != 0 ||
		    memcmp(l->v1, vertices[t->vertex[1]].position, sizeof l->v1) != 0 ||
		    memcmp(l->v2, vertices[t->vertex[2]].position, sizeof l->v2) != 0)
			status = bad(err, "a leaf triangle differs from its triangle");
	}
	free(seen);
	return status;
}

// The state of a depth-first walk over the tree. An entry of its stack is a child still to be visited.
struct walk {
	const struct blob_header *blob;
	uint32_t next_node;
	uint32_t next_leaf;
	uint32_t depth;
	uint32_t stacked;
	struct {
		uint32_t child;
		uint32_t count;
		uint32_t level;
	} stack[LIMIT_BVH_DEPTH + 2];
};

static bool box_is_empty(const float min[3], const float max[3])
{
	for (int i = 0; i < 3; i++)
		if (!(isinf(min[i]) && min[i] > 0 && isinf(max[i]) && max[i] > 0))
			return false;
	return true;
}

static bool box_is_sane(const float min[3], const float max[3])
{
	return finite_all(min, 3) && finite_all(max, 3) && min[0] <= max[0] && min[1] <= max[1] && min[2] <= max[2];
}

// Only the single node of a scene with at most one leaf may lack a child.
static bool walk_push(struct walk *w, const float min[3], const float max[3], uint32_t child, uint32_t count, uint32_t level)
{
	if (box_is_empty(min, max))
		return blob_count(w->blob, BLOB_NODES) == 1 && child == 0 && count == 0;
	if (!box_is_sane(min, max) || level > LIMIT_BVH_DEPTH + 1)
		return false;
	w->stack[w->stacked].child = child;
	w->stack[w->stacked].count = count;
	w->stack[w->stacked++].level = level;
	return true;
}

// A leaf starts where the previous one ended, so every leaf triangle lies in exactly one leaf.
static bool walk_leaf(struct walk *w, uint32_t first, uint32_t count)
{
	if (first != w->next_leaf || count > BLOB_LEAF_MAX ||
	    count > blob_count(w->blob, BLOB_LEAF_TRIANGLES) - w->next_leaf)
		return false;
	w->next_leaf += count;
	return true;
}

// Nodes are numbered in the order of this walk: a node, then the tree of its first child, then that of its second. A
// child's number must be the one that the walk has reached. This alone makes the nodes a tree and bounds the walk. Each
// level leaves at most one entry on the stack, so the stack's size bounds the depth and vice versa.
static bool walk_node(struct walk *w, uint32_t node, uint32_t level)
{
	const struct bvh_node *n = (const struct bvh_node *)blob_section(w->blob, BLOB_NODES) + node;

	if (node != w->next_node || node >= blob_count(w->blob, BLOB_NODES) || level > w->blob->bvh_depth)
		return false;
	w->next_node++;
	if (level > w->depth)
		w->depth = level;
	return walk_push(w, n->min1, n->max1, n->child1, n->count1, level + 1) &&
	       walk_push(w, n->min0, n->max0, n->child0, n->count0, level + 1);
}

static enum status check_bvh(const struct blob_header *h, struct error *err)
{
	struct walk w = {.blob = h};
	bool good = walk_node(&w, 0, 1);
	while (good && w.stacked > 0) {
		w.stacked--;
		const uint32_t child = w.stack[w.stacked].child, count = w.stack[w.stacked].count;
		good = count > 0 ? walk_leaf(&w, child, count) : walk_node(&w, child, w.stack[w.stacked].level);
	}
	if (!good || w.next_node != blob_count(h, BLOB_NODES) || w.next_leaf != blob_count(h, BLOB_LEAF_TRIANGLES) ||
	    w.depth != h->bvh_depth)
		return bad(err, "its BVH is not a tree over all triangles");
	return STATUS_OK;
}

static bool texture_is_known(uint32_t texture, uint32_t count)
{
	return texture == NONE || texture < count;
}

static bool textures_are_known(const struct material *m, uint32_t count)
{
	return texture_is_known(m->albedo_texture, count) && texture_is_known(m->emission_texture, count) &&
	       texture_is_known(m->specular_texture, count) && texture_is_known(m->surface_texture, count) &&
	       texture_is_known(m->normal_texture, count) && texture_is_known(m->transmission_texture, count) &&
	       texture_is_known(m->specular_weight_texture, count) && texture_is_known(m->coat_texture, count) &&
	       texture_is_known(m->coat_roughness_texture, count) && texture_is_known(m->coat_normal_texture, count);
}

// Whether the parameters of a clear material are in their ranges.
static bool clears(const struct material *m)
{
	for (int c = 0; c < 3; c++)
		if (!(m->absorption[c] >= 0 && (double)m->absorption[c] <= LIMIT_ABSORPTION))
			return false;
	return is_share(m->alpha) && is_share(m->transmission) &&
	       (m->transmission == 0 || ((double)m->ior >= LIMIT_IOR_LEAST && (double)m->ior <= LIMIT_IOR_MOST));
}

static enum status check_materials(const struct blob_header *h, struct error *err)
{
	const struct material *materials = blob_section(h, BLOB_MATERIALS);
	const struct blob_name *names = blob_section(h, BLOB_MATERIAL_NAMES);
	const uint32_t textures = blob_count(h, BLOB_TEXTURES);
	const uint32_t flags = MATERIAL_EMITS_BOTH_SIDES | MATERIAL_ALPHA_MASK | MATERIAL_UNLIT | MATERIAL_ALPHA_BLEND |
			       MATERIAL_THIN | LIMIT_PRIORITY << MATERIAL_PRIORITY_SHIFT;

	for (uint32_t i = 0; i < blob_count(h, BLOB_MATERIALS); i++) {
		const struct material *m = &materials[i];
		if (!textures_are_known(m, textures))
			return bad(err, "a material names a texture that is not there");
		for (int c = 0; c < 3; c++)
			if (!is_share(m->albedo[c]) || !is_share(m->specular[c]) || !isfinite(m->emission[c]) ||
			    m->emission[c] < 0)
				return bad(err, "a material's colour is out of range");
		bool sane = isfinite(m->normal_scale) && isfinite(m->coat_normal_scale) && isfinite(m->alpha_cutoff) &&
			    m->alpha_cutoff >= 0;
#define CHECK_SHARE(field, ...) sane = sane && is_share(m->field);
		CANDIL_MATERIAL_SHARES(CHECK_SHARE)
		if (!sane)
			return bad(err, "a material's surface is out of range");
		if (!clears(m))
			return bad(err, "a material's glass is out of range");
		if (!isfinite(m->power_density) || m->power_density < 0 || (m->flags & ~flags))
			return bad(err, "a material's power or flags are out of range");
		if (!memchr(names[i].text, 0, sizeof names[i].text))
			return bad(err, "a material's name does not end");
	}
	return STATUS_OK;
}

static enum status check_textures(const struct blob_header *h, struct error *err)
{
	const struct texture_info *textures = blob_section(h, BLOB_TEXTURES);
	const uint32_t known = 3u << TEXTURE_WRAP_S_SHIFT | 3u << TEXTURE_WRAP_T_SHIFT | TEXTURE_NEAREST | TEXTURE_SRGB |
			       TEXTURE_UV1 | TEXTURE_DEEP;
	const bool has_uv1 = blob_count(h, BLOB_UV1) == blob_count(h, BLOB_VERTICES);

	for (uint32_t i = 0; i < blob_count(h, BLOB_TEXTURES); i++) {
		const struct texture_info *t = &textures[i];
		if (t->width == 0 || t->height == 0 || t->width > LIMIT_TEXTURE_SIDE || t->height > LIMIT_TEXTURE_SIDE)
			return bad(err, "a texture's size is out of range");
		if ((uint64_t)t->offset + (uint64_t)t->width * t->height * texel_words(t) > blob_count(h, BLOB_TEXELS))
			return bad(err, "a texture ends behind the texels");
		if ((t->flags & ~known) || (t->flags >> TEXTURE_WRAP_S_SHIFT & 3u) > WRAP_MIRROR ||
		    (t->flags >> TEXTURE_WRAP_T_SHIFT & 3u) > WRAP_MIRROR)
			return bad(err, "a texture's flags are unknown");
		if (!finite_all(t->row_u, 3) || !finite_all(t->row_v, 3))
			return bad(err, "a texture's transform is not finite");
		if ((t->flags & TEXTURE_UV1) && !has_uv1)
			return bad(err, "a texture asks for coordinates that are not there");
	}
	return STATUS_OK;
}

static enum status check_emitters(const struct blob_header *h, struct error *err)
{
	const struct emitter *emitters = blob_section(h, BLOB_EMITTERS);
	const uint32_t count = blob_count(h, BLOB_EMITTERS), triangles = blob_count(h, BLOB_TRIANGLES);

	for (uint32_t i = 0; i < count; i++) {
		const struct emitter *e = &emitters[i];
		if (e->triangle >= triangles || e->alias >= count)
			return bad(err, "an emitter names a triangle or a row that is not there");
		if (!is_share(e->keep) || !is_share(e->pmf))
			return bad(err, "an emitter's probability is out of range");
	}
	return STATUS_OK;
}

static bool light_is_sane(const struct punctual_light *l, uint32_t count)
{
	return l->kind < LIGHT_KIND_COUNT && l->alias < count && is_share(l->keep) && is_share(l->pmf) &&
	       finite_all(l->position, 3) && finite_all(l->direction, 3) && finite_all(l->intensity, 3) &&
	       l->intensity[0] >= 0 && l->intensity[1] >= 0 && l->intensity[2] >= 0 && is_share(l->inner) &&
	       is_share(l->outer) && is_share(l->spread) && isfinite(l->range) && l->range >= 0;
}

// Shaders index the environment map by its width and height, so the counts must agree with them.
static enum status check_environment(const struct blob_header *h, struct error *err)
{
	const struct environment_texel *texels = blob_section(h, BLOB_ENVIRONMENT);
	const struct environment_row *rows = blob_section(h, BLOB_ENVIRONMENT_ROWS);
	const uint32_t count = blob_count(h, BLOB_ENVIRONMENT);

	if (h->environment_width > LIMIT_TEXTURE_SIDE || h->environment_height > LIMIT_TEXTURE_SIDE ||
	    (uint64_t)h->environment_width * h->environment_height != count || count != blob_count(h, BLOB_ENVIRONMENT_ROWS))
		return bad(err, "its surroundings have another size than their table");
	if (!isfinite(h->environment_power) || h->environment_power < 0)
		return bad(err, "its surroundings' power is not finite");
	if (!isfinite(h->environment_contrast) || h->environment_contrast < 0)
		return bad(err, "its surroundings' contrast is not finite");
	for (uint32_t i = 0; i < count; i++) {
		for (int c = 0; c < 3; c++)
			if (!(texels[i].radiance[c] >= 0 && (double)texels[i].radiance[c] <= LIMIT_RADIANCE))
				return bad(err, "a radiance of its surroundings is out of range");
		if (!isfinite(texels[i].pdf) || texels[i].pdf < 0 || !is_share(rows[i].keep) || rows[i].alias >= count)
			return bad(err, "a row of its surroundings' table is out of range");
	}
	return STATUS_OK;
}

static bool camera_is_sane(const struct blob_camera *c)
{
	return memchr(c->name, 0, sizeof c->name) && finite_doubles(c->eye, 3) && finite_doubles(c->forward, 3) &&
	       finite_doubles(c->up, 3) && isfinite(c->vfov_degrees) && c->vfov_degrees >= 0 && c->vfov_degrees < 180 &&
	       isfinite(c->aspect) && c->aspect >= 0 && isfinite(c->half_height) && c->half_height >= 0;
}

static enum status check_lights_and_cameras(const struct blob_header *h, struct error *err)
{
	const struct punctual_light *lights = blob_section(h, BLOB_LIGHTS);
	const struct blob_camera *cameras = blob_section(h, BLOB_CAMERAS);

	for (uint32_t i = 0; i < blob_count(h, BLOB_LIGHTS); i++)
		if (!light_is_sane(&lights[i], blob_count(h, BLOB_LIGHTS)))
			return bad(err, "a light is out of range");
	for (uint32_t i = 0; i < blob_count(h, BLOB_CAMERAS); i++)
		if (!camera_is_sane(&cameras[i]))
			return bad(err, "a camera is out of range");
	return STATUS_OK;
}

// Shaders that run normal maps read tangents, whatever the maps' scale.
static bool lacks_tangents(const struct blob_header *h)
{
	const struct material *materials = blob_section(h, BLOB_MATERIALS);
	const struct material_use *uses = blob_section(h, BLOB_MATERIAL_USES);
	for (uint32_t i = 0; i < blob_count(h, BLOB_MATERIALS) && blob_count(h, BLOB_TANGENTS) == 0; i++)
		if (uses[i].triangles > 0 &&
		    (materials[i].normal_texture != NONE || materials[i].coat_normal_texture != NONE))
			return true;
	return false;
}

static enum status check_uses(const struct blob_header *h, struct error *err)
{
	const struct triangle *triangles = blob_section(h, BLOB_TRIANGLES);
	const struct material_use *uses = blob_section(h, BLOB_MATERIAL_USES);
	uint64_t used = 0;
	for (uint32_t i = 0; i < blob_count(h, BLOB_MATERIALS); i++) {
		used += uses[i].triangles;
		for (int c = 0; c < 4; c++)
			if (!(uses[i].color_low[c] >= 0 && uses[i].color_low[c] <= uses[i].color_high[c] &&
			      uses[i].color_high[c] <= BLOB_COLOR_MAX))
				return bad(err, "a range of vertex colours is none");
	}
	for (uint32_t i = 0; i < blob_count(h, BLOB_TRIANGLES); i++)
		if (uses[triangles[i].material].triangles == 0)
			return bad(err, "a material that is used counts as unused");
	return used == blob_count(h, BLOB_TRIANGLES) ? STATUS_OK : bad(err, "its materials count other triangles");
}

// Runs last, because collecting the facts trusts everything else. A shader specialised for the facts reads what they
// promise.
static enum status check_facts(const struct blob_header *h, struct error *err)
{
	if (h->facts != facts_collect(h))
		return bad(err, "its facts are not those of its contents");
	if ((h->facts & FACT_VERTEX_COLORS) && blob_count(h, BLOB_COLORS) == 0)
		return bad(err, "its vertex colours are not there");
	return lacks_tangents(h) ? bad(err, "a normal map has no tangents") : STATUS_OK;
}

enum status blob_check(const void *blob, size_t bytes, struct error *err)
{
	static enum status (*const checks[])(const struct blob_header *, struct error *) = {
	    check_geometry, check_vertex_parts,       check_materials,   check_textures,   check_leaf_triangles, check_bvh,
	    check_emitters, check_lights_and_cameras, check_environment, blob_check_nodes, blob_check_patches,   check_uses,
	    check_facts,
	};
	const struct blob_header *h = blob;
	enum status status = check_header(h, bytes, err);

	for (size_t i = 0; i < sizeof checks / sizeof checks[0] && status == STATUS_OK; i++)
		status = checks[i](h, err);
	return status;
}
