// blob_check takes a sound blob, and refuses it after any one thing in it was broken.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/unit/small_blob.h"

static struct small_blob blob;

#define SECTION(type, section) ((struct type *)small_section(&blob, section))

static int fresh(void **state)
{
	(void)state;
	small_make(&blob);
	return 0;
}

static enum status check(void)
{
	return blob_check(&blob, small_header(&blob)->total_bytes, NULL);
}

static void a_sound_blob_passes(void **state)
{
	struct error err = {0};
	(void)state;
	assert_int_equal(blob_check(&blob, small_header(&blob)->total_bytes, &err), STATUS_OK);
	assert_string_equal(err.text, "");
}

// Each case breaks one thing, sees the blob refused, and makes it sound again.
#define REFUSED(...) \
	do { \
		small_make(&blob); \
		__VA_ARGS__; \
		if (check() != STATUS_SCENE_INVALID) \
			fail_msg("accepted after: %s", #__VA_ARGS__); \
	} while (0)

static void headers(void **state)
{
	struct blob_header *h = small_header(&blob);
	(void)state;
	REFUSED(h->magic++);
	REFUSED(h->format++);
	REFUSED(h->header_bytes--);
	REFUSED(h->bvh_depth = 0);
	REFUSED(h->bvh_depth = 1);
	REFUSED(h->bvh_depth = 3);
	REFUSED(h->bvh_depth = LIMIT_BVH_DEPTH + 1);
	REFUSED(h->origin[1] = NAN);
	REFUSED(h->bounds_min[2] = -INFINITY);
	REFUSED(h->bounds_max[0] = NAN);
	REFUSED(h->emitter_power = INFINITY);
	REFUSED(h->light_power = -1);
	small_make(&blob);
	assert_int_equal(blob_check(&blob, h->total_bytes - 1, NULL), STATUS_SCENE_INVALID);
	assert_int_equal(blob_check(&blob, h->total_bytes + 1, NULL), STATUS_SCENE_INVALID);
	assert_int_equal(blob_check(&blob, sizeof *h - 1, NULL), STATUS_SCENE_INVALID);
	assert_int_equal(blob_check(&blob, 0, NULL), STATUS_SCENE_INVALID);
}

static void sections(void **state)
{
	struct blob_header *h = small_header(&blob);
	(void)state;
	for (unsigned s = 0; s < BLOB_SECTIONS; s++) {
		REFUSED(h->sections[s].offset += 4);
		REFUSED(h->sections[s].offset = 0);
		REFUSED(h->sections[s].offset = UINT64_MAX - BLOB_ALIGN + 1);
		REFUSED(h->sections[s].offset = h->total_bytes);
		REFUSED(h->sections[s].count = UINT64_MAX / 2);
		REFUSED(h->sections[s].count = 1ull << 32);
		REFUSED(h->sections[s].count = 60000);
	}
	REFUSED(h->sections[BLOB_NODES].count = 0);
	REFUSED(h->sections[BLOB_MATERIALS].count = 0, h->sections[BLOB_MATERIAL_NAMES].count = 0);
	REFUSED(h->sections[BLOB_MATERIAL_NAMES].count = 1);
	REFUSED(h->sections[BLOB_LEAF_TRIANGLES].count = 3);
}

static void geometry(void **state)
{
	(void)state;
	REFUSED(SECTION(vertex, BLOB_VERTICES)[11].position[0] = NAN);
	REFUSED(SECTION(vertex, BLOB_VERTICES)[3].normal[1] = INFINITY);
	REFUSED(SECTION(vertex, BLOB_VERTICES)[5].uv[1] = NAN);
	REFUSED(SECTION(triangle, BLOB_TRIANGLES)[2].vertex[1] = 12);
	REFUSED(SECTION(triangle, BLOB_TRIANGLES)[3].material = 2);
	REFUSED(SECTION(leaf_triangle, BLOB_LEAF_TRIANGLES)[1].id = 4);
	REFUSED(SECTION(leaf_triangle, BLOB_LEAF_TRIANGLES)[1].id = 0);
	REFUSED(SECTION(leaf_triangle, BLOB_LEAF_TRIANGLES)[1].material = 1);
	REFUSED(SECTION(leaf_triangle, BLOB_LEAF_TRIANGLES)[0].v0[2] = 1e-30f);
	REFUSED(SECTION(leaf_triangle, BLOB_LEAF_TRIANGLES)[0].v2[1] = nextafterf(1.0f, 2.0f));
}

static void tree(void **state)
{
	(void)state;
	REFUSED(SECTION(bvh_node, BLOB_NODES)[0].child0 = 0); // a cycle
	REFUSED(SECTION(bvh_node, BLOB_NODES)[0].child1 = 1); // a node twice
	REFUSED(SECTION(bvh_node, BLOB_NODES)[0].child1 = 3); // behind the nodes
	REFUSED(SECTION(bvh_node, BLOB_NODES)[1].child1 = 0); // a leaf twice
	REFUSED(SECTION(bvh_node, BLOB_NODES)[2].count1 = 2); // behind the leaves
	REFUSED(SECTION(bvh_node, BLOB_NODES)[2].count1 = UINT32_MAX);
	REFUSED(SECTION(bvh_node, BLOB_NODES)[2].count1 = 0); // a leaf as a node
	REFUSED(SECTION(bvh_node, BLOB_NODES)[0].count0 = 1); // a node as a leaf
	REFUSED(SECTION(bvh_node, BLOB_NODES)[1].min0[0] = NAN);
	REFUSED(SECTION(bvh_node, BLOB_NODES)[1].max1[2] = INFINITY);
	REFUSED(SECTION(bvh_node, BLOB_NODES)[1].min1[1] = 2); // above its maximum
	// A child that is not there, where more than one node is.
	REFUSED(struct bvh_node *n = SECTION(bvh_node, BLOB_NODES);
		for (int c = 0; c < 3; c++) n[2].min1[c] = n[2].max1[c] = INFINITY; n[2].child1 = n[2].count1 = 0);
}

// A scene of one leaf with so many triangles, all at one place.
static void one_leaf(uint32_t count)
{
	struct blob_header *h = small_header(&blob);
	struct bvh_node *n = small_section(&blob, BLOB_NODES);
	struct triangle *t = small_section(&blob, BLOB_TRIANGLES);
	const struct leaf_triangle first = *SECTION(leaf_triangle, BLOB_LEAF_TRIANGLES);
	// Behind everything else there is room for longer sections.
	h->sections[BLOB_TRIANGLES] = (struct blob_range){h->total_bytes, count};
	h->sections[BLOB_LEAF_TRIANGLES] = (struct blob_range){h->total_bytes + 4096, count};
	h->sections[BLOB_NODES].count = 1;
	h->total_bytes += 8192;
	h->bvh_depth = 1;
	for (uint32_t i = 0; i < count; i++) {
		SECTION(triangle, BLOB_TRIANGLES)[i] = t[0];
		SECTION(leaf_triangle, BLOB_LEAF_TRIANGLES)[i] = first;
		SECTION(leaf_triangle, BLOB_LEAF_TRIANGLES)[i].id = i;
	}
	n[0] = (struct bvh_node){.max0 = {4, 4, 4}, .count0 = count};
	for (int c = 0; c < 3; c++)
		n[0].min1[c] = n[0].max1[c] = INFINITY;
	small_ranges(&blob);
	h->facts = facts_collect(h);
}

static void a_leaf_has_fifteen_triangles_at_most(void **state)
{
	(void)state;
	small_make(&blob);
	one_leaf(BLOB_LEAF_MAX);
	assert_int_equal(check(), STATUS_OK);
	small_make(&blob);
	one_leaf(BLOB_LEAF_MAX + 1);
	assert_int_equal(check(), STATUS_SCENE_INVALID);
}

static void colours(void **state)
{
	struct blob_header *h = small_header(&blob);
	(void)state;
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].albedo_texture = 1);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].emission_texture = NONE - 1);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].albedo[2] = 1.01f);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].albedo[2] = -0.01f);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].albedo[2] = NAN);
	REFUSED(SECTION(material, BLOB_MATERIALS)[1].emission[0] = -1);
	REFUSED(SECTION(material, BLOB_MATERIALS)[1].emission[0] = INFINITY);
	REFUSED(SECTION(material, BLOB_MATERIALS)[1].power_density = NAN);
	REFUSED(SECTION(material, BLOB_MATERIALS)[1].flags = 1u << 31);
	REFUSED(memset(&SECTION(blob_name, BLOB_MATERIAL_NAMES)[1], 'x', sizeof(struct blob_name)));
	REFUSED(SECTION(texture_info, BLOB_TEXTURES)[0].offset = 1);
	REFUSED(SECTION(texture_info, BLOB_TEXTURES)[0].offset = UINT32_MAX);
	REFUSED(SECTION(texture_info, BLOB_TEXTURES)[0].flags |= TEXTURE_DEEP, h->facts = facts_collect(h));
	REFUSED(SECTION(texture_info, BLOB_TEXTURES)[0].width = 0);
	REFUSED(SECTION(texture_info, BLOB_TEXTURES)[0].height = 3);
	REFUSED(SECTION(texture_info, BLOB_TEXTURES)[0].width = LIMIT_TEXTURE_SIDE + 1);
	REFUSED(SECTION(texture_info, BLOB_TEXTURES)[0].width = 0x80000001u,
		SECTION(texture_info, BLOB_TEXTURES)[0].height = 2);
	REFUSED(SECTION(texture_info, BLOB_TEXTURES)[0].flags = 3u << TEXTURE_WRAP_T_SHIFT);
	REFUSED(SECTION(texture_info, BLOB_TEXTURES)[0].flags = 1u << 7);
	REFUSED(SECTION(texture_info, BLOB_TEXTURES)[0].row_u[2] = NAN);
	REFUSED(SECTION(texture_info, BLOB_TEXTURES)[0].row_v[0] = INFINITY);
}

static void a_deep_texture_takes_twice_the_texels(void **state)
{
	struct blob_header *h = small_header(&blob);
	struct texture_info *texture;
	(void)state;
	small_make(&blob);
	texture = SECTION(texture_info, BLOB_TEXTURES);
	texture->flags |= TEXTURE_DEEP;
	texture->height = 1;
	small_ranges(&blob);
	h->facts = facts_collect(h);
	assert_int_equal(check(), STATUS_OK); // three texels in six words
	texture->offset = 1;
	assert_int_equal(check(), STATUS_SCENE_INVALID);
}

static void surfaces(void **state)
{
	(void)state;
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].specular_texture = 1);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].surface_texture = 1);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].normal_texture = 1);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].coat_texture = 1);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].coat_roughness_texture = 1);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].coat_normal_texture = 1);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].coat_normal_scale = INFINITY);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].coat = 1.01f);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].coat_roughness = -0.01f);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].diffuse_roughness = NAN);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].specular[1] = 1.01f);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].specular[1] = NAN);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].specular_weight = -0.01f);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].specular_weight = NAN);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].metallic = 1.01f);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].metallic = NAN);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].roughness = 1.01f);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].roughness = NAN);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].normal_scale = INFINITY);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].alpha_cutoff = -0.1f);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].alpha_cutoff = INFINITY);
	REFUSED(SECTION(material, BLOB_MATERIALS)[0].flags |= 8);
}

static void parts_of_vertices(void **state)
{
	struct blob_header *h = small_header(&blob);
	(void)state;
	REFUSED(SECTION(vertex_uv1, BLOB_UV1)[11].uv[1] = NAN);
	REFUSED(SECTION(vertex_color, BLOB_COLORS)[11].rgba[3] = -0.1f);
	REFUSED(SECTION(vertex_color, BLOB_COLORS)[4].rgba[0] = 1001);
	REFUSED(SECTION(vertex_color, BLOB_COLORS)[0].rgba[2] = NAN);
	REFUSED(SECTION(vertex_tangent, BLOB_TANGENTS)[11].xyzw[1] = INFINITY);
	REFUSED(SECTION(vertex_tangent, BLOB_TANGENTS)[0].xyzw[3] = 0.5f);
	REFUSED(SECTION(vertex_tangent, BLOB_TANGENTS)[0].xyzw[3] = NAN);
	for (unsigned s = BLOB_UV1; s <= BLOB_TANGENTS; s++)
		REFUSED(h->sections[s].count = 11);
	REFUSED(h->sections[BLOB_UV1].count = 0); // a texture asks for them
	REFUSED(h->sections[BLOB_TANGENTS].count = 0); // so does a normal map
	small_make(&blob);
	h->sections[BLOB_COLORS].count = 0;
	small_ranges(&blob);
	h->facts = facts_collect(h);
	assert_int_equal(check(), STATUS_OK);
	SECTION(material, BLOB_MATERIALS)[0].normal_texture = NONE;
	SECTION(material, BLOB_MATERIALS)[0].coat_normal_texture = NONE;
	h->sections[BLOB_TANGENTS].count = 0;
	h->facts = facts_collect(h);
	assert_int_equal(check(), STATUS_OK);
	SECTION(texture_info, BLOB_TEXTURES)[0].flags = 0;
	h->sections[BLOB_UV1].count = 0;
	assert_int_equal(check(), STATUS_OK);
}

static void facts_are_those_of_the_contents(void **state)
{
	struct blob_header *h = small_header(&blob);
	(void)state;
	for (unsigned bit = 0; bit < 32; bit++)
		REFUSED(h->facts ^= 1u << bit);
	REFUSED(h->sections[BLOB_COLORS].count = 0);
}

static void ranges_are_of_the_contents(void **state)
{
	struct blob_header *h = small_header(&blob);
	struct material_use *uses = SECTION(material_use, BLOB_MATERIAL_USES);
	(void)state;
	REFUSED(h->sections[BLOB_TEXTURE_RANGES].count = 0);
	REFUSED(h->sections[BLOB_MATERIAL_USES].count = 1);
	REFUSED(uses[0].triangles = 0, h->facts = facts_collect(h));
	REFUSED(uses[1].triangles = 3);
	REFUSED(uses[0].color_low[1] = NAN);
	REFUSED(uses[0].color_low[1] = 2, h->facts = facts_collect(h));
	REFUSED(uses[1].color_high[3] = 1001, h->facts = facts_collect(h));
}

static void lights_and_cameras(void **state)
{
	struct blob_header *h = small_header(&blob);
	(void)state;
	REFUSED(SECTION(emitter, BLOB_EMITTERS)[0].triangle = 4);
	REFUSED(SECTION(emitter, BLOB_EMITTERS)[0].alias = 2);
	REFUSED(SECTION(emitter, BLOB_EMITTERS)[0].keep = 1.5f);
	REFUSED(SECTION(emitter, BLOB_EMITTERS)[0].pmf = NAN);
	REFUSED(SECTION(punctual_light, BLOB_LIGHTS)[1].kind = 3);
	REFUSED(SECTION(punctual_light, BLOB_LIGHTS)[1].alias = 3);
	REFUSED(SECTION(punctual_light, BLOB_LIGHTS)[1].keep = -0.1f);
	REFUSED(SECTION(punctual_light, BLOB_LIGHTS)[1].position[0] = NAN);
	REFUSED(SECTION(punctual_light, BLOB_LIGHTS)[1].direction[2] = INFINITY);
	REFUSED(SECTION(punctual_light, BLOB_LIGHTS)[1].intensity[0] = -1);
	REFUSED(SECTION(punctual_light, BLOB_LIGHTS)[1].outer = 2);
	REFUSED(SECTION(punctual_light, BLOB_LIGHTS)[1].inner = 2);
	REFUSED(SECTION(punctual_light, BLOB_LIGHTS)[1].inner = -0.1f);
	REFUSED(SECTION(punctual_light, BLOB_LIGHTS)[1].inner = NAN);
	REFUSED(SECTION(punctual_light, BLOB_LIGHTS)[1].range = -1, h->facts = facts_collect(h));
	REFUSED(SECTION(punctual_light, BLOB_LIGHTS)[1].range = NAN, h->facts = facts_collect(h));
	REFUSED(SECTION(punctual_light, BLOB_LIGHTS)[1].range = INFINITY, h->facts = facts_collect(h));
	REFUSED(SECTION(blob_camera, BLOB_CAMERAS)[0].eye[0] = NAN);
	REFUSED(SECTION(blob_camera, BLOB_CAMERAS)[0].up[0] = INFINITY);
	REFUSED(SECTION(blob_camera, BLOB_CAMERAS)[0].vfov_degrees = 180);
	REFUSED(SECTION(blob_camera, BLOB_CAMERAS)[0].half_height = -1);
	REFUSED(memset(SECTION(blob_camera, BLOB_CAMERAS)[0].name, 'x', LIMIT_NAME + 1));
}

static void surroundings(void **state)
{
	struct blob_header *h = small_header(&blob);
	struct environment_texel *texels = SECTION(environment_texel, BLOB_ENVIRONMENT);
	struct environment_row *rows = SECTION(environment_row, BLOB_ENVIRONMENT_ROWS);
	(void)state;
	REFUSED(h->environment_width = 1);
	REFUSED(h->environment_width = 0, h->environment_height = 0);
	REFUSED(h->environment_width = 0x80000001u, h->environment_height = 2);
	REFUSED(h->environment_power = -1);
	REFUSED(h->environment_power = NAN);
	REFUSED(h->environment_contrast = -1);
	REFUSED(h->environment_contrast = INFINITY);
	REFUSED(h->sections[BLOB_ENVIRONMENT_ROWS].count = 1);
	REFUSED(h->sections[BLOB_ENVIRONMENT].count = 0, h->environment_width = 0);
	REFUSED(texels[1].radiance[2] = -1);
	REFUSED(texels[1].radiance[2] = NAN);
	REFUSED(texels[0].radiance[0] = 1e13f);
	REFUSED(texels[1].pdf = INFINITY);
	REFUSED(texels[1].pdf = -1);
	REFUSED(rows[0].keep = 1.5f);
	REFUSED(rows[0].keep = NAN);
	REFUSED(rows[1].alias = 2);
	REFUSED(h->facts &= ~(uint32_t)FACT_SURROUNDINGS);
}

static void elements(void **state)
{
	struct blob_header *h = small_header(&blob);
	struct imported_element *e = SECTION(imported_element, BLOB_PATCH_ELEMENTS);
	(void)state;
	REFUSED(h->sections[BLOB_PATCH_ELEMENTS].count = 3);
	REFUSED(h->sections[BLOB_PATCH_ELEMENTS].count = 2);
	REFUSED(h->sections[BLOB_PATCH_ELEMENTS].count = 0);
	REFUSED(h->sections[BLOB_PATCH_ELEMENTS].count = LIMIT_PATCH_ELEMENTS + 1);
	REFUSED(h->facts &= ~(uint32_t)FACT_PATCHES);
	REFUSED(e[1].patch = 2);
	REFUSED(e[2].patch = 1);
	REFUSED(e[2].side = 0);
	REFUSED(e[0].side = 2);
	REFUSED(e[0].corners = 2);
	REFUSED(e[0].corners = 5);
	REFUSED(e[1].corner[3][0] = 1);
	REFUSED(e[1].corner[3][2] = (double)NAN);
	REFUSED(e[0].corner[3][1] = (double)INFINITY);
	REFUSED(e[0].corner[2][1] = -1.1e12);
	REFUSED(e[0].material = LIMIT_MATERIALS);
	REFUSED(e[0].area = -1);
	REFUSED(e[0].area = INFINITY);
	REFUSED(e[3].b[2] = -1);
	REFUSED(e[3].m[0] = NAN);
	REFUSED(e[3].d[1] = 2e30f);
	REFUSED(e[3].h[1] = INFINITY);
	REFUSED(e[3].rho[1] = 1.5f);
	REFUSED(e[3].escaped = NAN);
	REFUSED(e[3].cut = 1.5f);
	REFUSED(e[3].reached = 0);
	REFUSED(e[3].reached = 2);
	REFUSED(e[0].straight = 2);
	REFUSED(e[1].straight = 1);
	REFUSED(e[1].reserved = 1);
}

static void rows(void **state)
{
	struct blob_header *h = small_header(&blob);
	struct imported_row *row = SECTION(imported_row, BLOB_FACTOR_ROWS);
	struct imported_factor *entry = SECTION(imported_factor, BLOB_FACTOR_ENTRIES);
	(void)state;
	REFUSED(h->sections[BLOB_FACTOR_ROWS].count = 0);
	REFUSED(h->sections[BLOB_FACTOR_ROWS].count = LIMIT_PATCH_ELEMENTS + 1);
	REFUSED(h->sections[BLOB_FACTOR_ENTRIES].count = 4);
	REFUSED(h->sections[BLOB_FACTOR_ENTRIES].count = LIMIT_PATCH_ENTRIES + 1ull);
	REFUSED(h->facts &= ~(uint32_t)FACT_FACTORS);
	REFUSED(row[1].first = 1);
	REFUSED(row[0].count = 3);
	REFUSED(row[3].count = 0);
	REFUSED(row[3].count = UINT32_MAX);
	REFUSED(entry[0].column = 3);
	REFUSED(entry[0].column = 4);
	REFUSED(entry[1].column = 1);
	REFUSED(entry[2].value = -1e-40f);
	REFUSED(entry[2].value = NAN);
	REFUSED(entry[2].value = INFINITY);
	REFUSED(entry[2].value = 1.001f * (1 + LIMIT_RADIOSITY_BOUNCES));
	small_make(&blob);
	entry[2].value = 1 + LIMIT_RADIOSITY_BOUNCES; // mirrors can do that
	assert_int_equal(check(), STATUS_OK);
}

static void nodes(void **state)
{
	(void)state;
	REFUSED(memset(SECTION(scene_node, BLOB_SCENE_NODES)[0].name, 'x', LIMIT_NAME + 1));
	REFUSED(SECTION(scene_node, BLOB_SCENE_NODES)[0].parent = 0);
	REFUSED(SECTION(scene_node, BLOB_SCENE_NODES)[0].parent = 1);
	REFUSED(SECTION(scene_node, BLOB_SCENE_NODES)[1].parent = 2);
	REFUSED(SECTION(scene_node, BLOB_SCENE_NODES)[1].first_triangle = 3);
	REFUSED(SECTION(scene_node, BLOB_SCENE_NODES)[1].first_triangle = UINT32_MAX);
	REFUSED(SECTION(scene_node, BLOB_SCENE_NODES)[1].triangle_count = UINT32_MAX);
	REFUSED(SECTION(scene_node, BLOB_SCENE_NODES)[1].light = 3);
	REFUSED(SECTION(scene_node, BLOB_SCENE_NODES)[0].camera = 1);
	REFUSED(SECTION(scene_node, BLOB_SCENE_NODES)[0].local.c[3][0] = NAN);
	REFUSED(SECTION(scene_node, BLOB_SCENE_NODES)[1].world.c[0][0] = INFINITY);
	REFUSED(SECTION(scene_node, BLOB_SCENE_NODES)[1].world.c[3][0] = 1);
	REFUSED(SECTION(scene_node, BLOB_SCENE_NODES)[1].parts.scale[2] = NAN);
	REFUSED(SECTION(scene_node, BLOB_SCENE_NODES)[1].parts.rotation[3] = 0);
}

static void animations(void **state)
{
	(void)state;
	REFUSED(memset(SECTION(scene_animation, BLOB_ANIMATIONS)[0].name, 'x', LIMIT_NAME + 1));
	REFUSED(SECTION(scene_animation, BLOB_ANIMATIONS)[0].channel_count = 3);
	REFUSED(SECTION(scene_animation, BLOB_ANIMATIONS)[0].first_channel = UINT32_MAX);
	REFUSED(SECTION(scene_animation, BLOB_ANIMATIONS)[0].duration_s = NAN);
	REFUSED(SECTION(scene_channel, BLOB_CHANNELS)[0].node = 2);
	REFUSED(SECTION(scene_channel, BLOB_CHANNELS)[0].path = 3);
	REFUSED(SECTION(scene_channel, BLOB_CHANNELS)[0].curve = 3);
	REFUSED(SECTION(scene_channel, BLOB_CHANNELS)[0].keys = 0);
	REFUSED(SECTION(scene_channel, BLOB_CHANNELS)[0].keys = UINT32_MAX);
	REFUSED(SECTION(scene_channel, BLOB_CHANNELS)[1].keys = 2);
	REFUSED(SECTION(scene_channel, BLOB_CHANNELS)[1].first = 15);
	REFUSED(SECTION(scene_channel, BLOB_CHANNELS)[1].first = UINT32_MAX);
	REFUSED(((float *)small_section(&blob, BLOB_CURVES))[1] = 0);
	REFUSED(((float *)small_section(&blob, BLOB_CURVES))[5] = NAN);
}

static void a_missing_child_is_fine_in_a_tiny_scene(void **state)
{
	struct blob_header *h = small_header(&blob);
	struct bvh_node *n = small_section(&blob, BLOB_NODES);
	(void)state;
	h->sections[BLOB_NODES].count = h->sections[BLOB_TRIANGLES].count = h->sections[BLOB_LEAF_TRIANGLES].count = 1;
	h->sections[BLOB_EMITTERS].count = h->sections[BLOB_SCENE_NODES].count = h->sections[BLOB_CHANNELS].count = 0;
	h->sections[BLOB_ANIMATIONS].count = 0;
	small_ranges(&blob);
	h->facts = facts_collect(h);
	h->bvh_depth = 1;
	n[0] = n[1];
	n[0].child1 = n[0].count1 = 0;
	for (int c = 0; c < 3; c++)
		n[0].min1[c] = n[0].max1[c] = INFINITY;
	assert_int_equal(check(), STATUS_OK);
	n[0].child1 = 1;
	assert_int_equal(check(), STATUS_SCENE_INVALID);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test_setup(a_sound_blob_passes, fresh),
	    cmocka_unit_test_setup(headers, fresh),
	    cmocka_unit_test_setup(sections, fresh),
	    cmocka_unit_test_setup(geometry, fresh),
	    cmocka_unit_test_setup(tree, fresh),
	    cmocka_unit_test_setup(a_leaf_has_fifteen_triangles_at_most, fresh),
	    cmocka_unit_test_setup(colours, fresh),
	    cmocka_unit_test_setup(a_deep_texture_takes_twice_the_texels, fresh),
	    cmocka_unit_test_setup(surfaces, fresh),
	    cmocka_unit_test_setup(parts_of_vertices, fresh),
	    cmocka_unit_test_setup(facts_are_those_of_the_contents, fresh),
	    cmocka_unit_test_setup(ranges_are_of_the_contents, fresh),
	    cmocka_unit_test_setup(lights_and_cameras, fresh),
	    cmocka_unit_test_setup(surroundings, fresh),
	    cmocka_unit_test_setup(elements, fresh),
	    cmocka_unit_test_setup(rows, fresh),
	    cmocka_unit_test_setup(nodes, fresh),
	    cmocka_unit_test_setup(animations, fresh),
	    cmocka_unit_test_setup(a_missing_child_is_fine_in_a_tiny_scene, fresh),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
