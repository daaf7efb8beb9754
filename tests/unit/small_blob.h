// A small sound blob in memory, for tests that then break it.
#ifndef CANDIL_TESTS_SMALL_BLOB_H
#define CANDIL_TESTS_SMALL_BLOB_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "server/scene/blob.h"
#include "server/scene/facts.h"
#include "server/scene/ranges.h"

#define SMALL_BLOB_ROOM 65536u

struct small_blob {
	_Alignas(BLOB_ALIGN) unsigned char bytes[SMALL_BLOB_ROOM];
};

static inline struct blob_header *small_header(struct small_blob *b)
{
	return (struct blob_header *)(void *)b->bytes;
}

static inline void *small_section(struct small_blob *b, enum blob_section s)
{
	return b->bytes + small_header(b)->sections[s].offset;
}

static inline void small_box(float min[3], float max[3], float x0, float x1)
{
	for (int c = 0; c < 3; c++) {
		min[c] = c == 0 ? x0 : 0;
		max[c] = c == 0 ? x1 : c == 1 ? 1.0f : 0;
	}
}

static inline void small_sections(struct small_blob *b)
{
	static const uint64_t counts[BLOB_SECTIONS] = {3,  4, 4, 12, 2,  1, 6, 2, 3, 1, 2, 12, 12,
						       12, 2, 1, 2,  24, 2, 2, 1, 2, 4, 4, 5};
	struct blob_header *h = small_header(b);
	uint64_t end = (sizeof *h + BLOB_ALIGN - 1) / BLOB_ALIGN * BLOB_ALIGN;
	memset(b, 0, sizeof *b);
	h->magic = BLOB_MAGIC;
	h->format = BLOB_FORMAT;
	h->header_bytes = sizeof *h;
	for (unsigned s = 0; s < BLOB_SECTIONS; s++) {
		h->sections[s] = (struct blob_range){end, counts[s]};
		end += (counts[s] * blob_stride((enum blob_section)s) + BLOB_ALIGN - 1) / BLOB_ALIGN * BLOB_ALIGN;
	}
	h->total_bytes = end;
	h->bvh_depth = 2;
}

static inline void small_triangles(struct small_blob *b)
{
	struct vertex *v = small_section(b, BLOB_VERTICES);
	struct triangle *t = small_section(b, BLOB_TRIANGLES);
	struct leaf_triangle *l = small_section(b, BLOB_LEAF_TRIANGLES);
	for (uint32_t i = 0; i < 4; i++) {
		for (uint32_t k = 0; k < 3; k++) {
			v[i * 3 + k].position[0] = (float)i + (k == 1 ? 0.5f : 0);
			v[i * 3 + k].position[1] = k == 2 ? 1.0f : 0;
			t[i].vertex[k] = i * 3 + k;
		}
		t[i].material = i / 2;
		l[i].id = i;
		l[i].material = i / 2;
		memcpy(l[i].v0, v[i * 3].position, sizeof l[i].v0);
		memcpy(l[i].v1, v[i * 3 + 1].position, sizeof l[i].v1);
		memcpy(l[i].v2, v[i * 3 + 2].position, sizeof l[i].v2);
	}
}

static inline void small_tree(struct small_blob *b)
{
	struct bvh_node *n = small_section(b, BLOB_NODES);
	small_box(n[0].min0, n[0].max0, 0, 1.5f);
	small_box(n[0].min1, n[0].max1, 2, 3.5f);
	n[0].child0 = 1;
	n[0].child1 = 2;
	for (uint32_t i = 0; i < 2; i++) {
		const float x = (float)i * 2;
		small_box(n[1 + i].min0, n[1 + i].max0, x, x + 0.5f);
		small_box(n[1 + i].min1, n[1 + i].max1, x + 1, x + 1.5f);
		n[1 + i].child0 = i * 2;
		n[1 + i].child1 = i * 2 + 1;
		n[1 + i].count0 = n[1 + i].count1 = 1;
	}
}

static inline void small_materials(struct small_blob *b)
{
	struct material *m = small_section(b, BLOB_MATERIALS);
	m[0] = (struct material){.albedo = {.5f, .5f, .5f},
				 .emission_texture = NONE,
				 .specular = {.04f, .04f, .04f},
				 .specular_weight = 1,
				 .roughness = .5f,
				 .normal_scale = 1,
				 .alpha_cutoff = .5f,
				 .alpha = 1,
				 .transmission = .5f,
				 .ior = 1.5f,
				 .flags = MATERIAL_ALPHA_MASK};
	m[1] = (struct material){.emission = {1, 1, 1},
				 .albedo_texture = NONE,
				 .emission_texture = NONE,
				 .specular_texture = NONE,
				 .surface_texture = NONE,
				 .normal_texture = NONE,
				 .transmission_texture = NONE,
				 .specular_weight_texture = NONE,
				 .coat_texture = NONE,
				 .coat_roughness_texture = NONE,
				 .coat_normal_texture = NONE,
				 .power_density = 3.14f};
}

static inline void small_attributes(struct small_blob *b)
{
	struct vertex_color *colors = small_section(b, BLOB_COLORS);
	struct vertex_tangent *tangents = small_section(b, BLOB_TANGENTS);
	for (uint32_t i = 0; i < 12; i++) {
		colors[i] = (struct vertex_color){{1, 1, 1, .5f}};
		tangents[i] = (struct vertex_tangent){{1, 0, 0, i % 2 ? 1 : -1}};
	}
	struct texture_info *texture = small_section(b, BLOB_TEXTURES);
	texture[0] = (struct texture_info){0, 3, 2, TEXTURE_SRGB | TEXTURE_UV1, {1, 0, 0}, {0, 1, 0}};
	uint32_t *texels = small_section(b, BLOB_TEXELS);
	for (uint32_t i = 0; i < 6; i++)
		texels[i] = i % 2 ? 0xFFFFFFFFu : 0;
}

static inline void small_lamps(struct small_blob *b)
{
	struct emitter *e = small_section(b, BLOB_EMITTERS);
	e[0] = (struct emitter){2, 1, 0, .5f};
	e[1] = (struct emitter){3, 1, 1, .5f};
	struct punctual_light *p = small_section(b, BLOB_LIGHTS);
	for (uint32_t i = 0; i < 3; i++)
		p[i] = (struct punctual_light){
		    .kind = i, .direction = {0, 0, 1}, .intensity = {1, 1, 1}, .keep = 1, .alias = i, .pmf = .33f};
}

static inline void small_nodes(struct small_blob *b)
{
	struct blob_camera *c = small_section(b, BLOB_CAMERAS);
	c[0] = (struct blob_camera){.name = "camera", .forward = {0, 0, -1}, .up = {0, 1, 0}, .vfov_degrees = 40};
	struct scene_node *nodes = small_section(b, BLOB_SCENE_NODES);
	for (uint32_t i = 0; i < 2; i++) {
		nodes[i] = (struct scene_node){.name = "node",
					       .local = transform_identity,
					       .parts = transform_no_parts,
					       .parent = i ? 0 : NONE,
					       .first_triangle = 2 * i,
					       .triangle_count = 2,
					       .light = i ? 0 : NONE,
					       .camera = i ? NONE : 0};
		nodes[i].local.c[3][0] = nodes[i].parts.translation[0] = 1;
		nodes[i].world = nodes[i].local;
	}
	nodes[1].world.c[3][0] = 2;
}

static inline void small_animation(struct small_blob *b)
{
	struct scene_animation *animation = small_section(b, BLOB_ANIMATIONS);
	animation[0] = (struct scene_animation){.name = "turn", .duration_s = 2, .channel_count = 2};
	struct scene_channel *channels = small_section(b, BLOB_CHANNELS);
	channels[0] = (struct scene_channel){0, CHANNEL_ROTATION, CURVE_LINEAR, 2, 0};
	channels[1] = (struct scene_channel){1, CHANNEL_TRANSLATION, CURVE_CUBIC, 1, 10};
	static const float curves[] = {0, 2, 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1, 2, 3, 0, 0, 0};
	memcpy(small_section(b, BLOB_CURVES), curves, sizeof curves);
}

static inline void small_surroundings(struct small_blob *b)
{
	struct environment_texel *texels = small_section(b, BLOB_ENVIRONMENT);
	struct environment_row *rows = small_section(b, BLOB_ENVIRONMENT_ROWS);
	for (uint32_t i = 0; i < 2; i++) {
		texels[i] = (struct environment_texel){{1, 2, 3}, .08f};
		rows[i] = (struct environment_row){1, i};
	}
	small_header(b)->environment_width = 2;
	small_header(b)->environment_height = 1;
}

static inline void small_patches(struct small_blob *b)
{
	struct imported_element *elements = small_section(b, BLOB_PATCH_ELEMENTS);
	struct imported_row *rows = small_section(b, BLOB_FACTOR_ROWS);
	struct imported_factor *entries = small_section(b, BLOB_FACTOR_ENTRIES);
	for (uint32_t i = 0; i < 4; i++) {
		const uint8_t corners = i % 2 ? 3 : 4;
		elements[i] = (struct imported_element){.corner = {{0}, {1}, {1, 1}, {0, corners == 4}},
							.patch = i % 2,
							.area = 1,
							.b = {3, 2, 1},
							.h = {2, 2, 2},
							.rho = {1, 0.5f, 0},
							.escaped = 0.5f,
							.corners = corners,
							.side = i >= 2,
							.reached = 1};
		rows[i] = (struct imported_row){i ? i + 1 : 0, i ? 1 : 2};
	}
	static const struct imported_factor factors[] = {{1, 0.25f}, {3, 0.75f}, {0, 1}, {3, 0}, {2, 1e-40f}};
	memcpy(entries, factors, sizeof factors);
}

// Find the ranges again, of whatever a test has made of the rest.
static inline void small_ranges(struct small_blob *b)
{
	const struct blob_header *h = small_header(b);
	ranges_of_textures(small_section(b, BLOB_TEXTURES), blob_count(h, BLOB_TEXTURES), small_section(b, BLOB_TEXELS),
			   small_section(b, BLOB_TEXTURE_RANGES));
	ranges_of_materials(small_section(b, BLOB_TRIANGLES), blob_count(h, BLOB_TRIANGLES),
			    blob_count(h, BLOB_COLORS) ? small_section(b, BLOB_COLORS) : NULL,
			    blob_count(h, BLOB_TANGENTS) ? small_section(b, BLOB_TANGENTS) : NULL,
			    blob_count(h, BLOB_MATERIALS), small_section(b, BLOB_MATERIAL_USES));
}

// Four triangles side by side along x, three nodes, two materials (glossy and masked with all maps, and a lamp), a texture
// by the second coordinates, two emitters, a light of each kind, a camera; colours and tangents for each vertex. A root node
// has the first two triangles and the camera, its child the others and the point light; an animation turns the root in two
// linear keys and moves the child in one cubic. Surroundings of two by one texels. The elements of a quad and a triangle,
// and rows of form factors of one entry but for the first, which has two.
static inline void small_make(struct small_blob *b)
{
	struct blob_header *h = small_header(b);
	small_sections(b);
	small_triangles(b);
	small_tree(b);
	small_materials(b);
	small_attributes(b);
	small_lamps(b);
	small_nodes(b);
	small_animation(b);
	small_surroundings(b);
	small_patches(b);
	h->bounds_max[0] = 3.5f;
	h->bounds_max[1] = 1;
	small_ranges(b);
	h->facts = facts_collect(h);
}

#endif
