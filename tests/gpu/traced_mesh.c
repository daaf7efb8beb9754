#include "tests/gpu/traced_mesh.h"

#include <stdlib.h>

#include "server/scene/facts.h"

static void make_leaves(struct traced_mesh *t, const struct mesh *m)
{
	t->leaves = calloc(m->count, sizeof *t->leaves);
	assert_non_null(t->leaves);
	for (uint32_t i = 0; i < m->count; i++) {
		struct leaf_triangle *l = &t->leaves[i];
		l->id = t->bvh.order[i];
		l->material = m->triangles[l->id].material;
		const uint32_t *v = m->triangles[l->id].vertex;
		memcpy(l->v0, m->vertices[v[0]].position, sizeof l->v0);
		memcpy(l->v1, m->vertices[v[1]].position, sizeof l->v1);
		memcpy(l->v2, m->vertices[v[2]].position, sizeof l->v2);
	}
}

static void make_view(struct traced_mesh *t, const struct mesh *m)
{
	struct blob_view *v = &t->scene.view;
	for (uint32_t i = 0; i < TRACED_MATERIALS; i++)
		t->materials[i] = (struct material){.albedo = {.5f, .5f, .5f},
						    .albedo_texture = NONE,
						    .emission_texture = NONE,
						    .specular_texture = NONE,
						    .specular_weight_texture = NONE,
						    .surface_texture = NONE,
						    .normal_texture = NONE,
						    .transmission_texture = NONE,
						    .coat_texture = NONE,
						    .coat_roughness_texture = NONE,
						    .coat_normal_texture = NONE,
						    .roughness = 1,
						    .alpha = 1,
						    .ior = 1.5f};
	*v = m->view;
	v->blob = &t->header;
	v->sections[BLOB_NODES] = t->bvh.nodes;
	v->counts[BLOB_NODES] = t->bvh.node_count;
	v->sections[BLOB_LEAF_TRIANGLES] = t->leaves;
	v->counts[BLOB_LEAF_TRIANGLES] = m->count;
	for (int c = 0; c < 3; c++) {
		v->bounds_min[c] = INFINITY;
		v->bounds_max[c] = -INFINITY;
		for (uint32_t i = 0; i < v->counts[BLOB_VERTICES]; i++) {
			v->bounds_min[c] = fminf(v->bounds_min[c], m->vertices[i].position[c]);
			v->bounds_max[c] = fmaxf(v->bounds_max[c], m->vertices[i].position[c]);
		}
	}
	v->facts = facts_of_view(v); // of its lengths alone: materials are still none
	v->sections[BLOB_MATERIALS] = t->materials;
	v->counts[BLOB_MATERIALS] = TRACED_MATERIALS;
}

void traced_mesh_init(struct traced_mesh *t, struct device *device, const struct mesh *m, double edge)
{
	struct error err;
	memset(t, 0, sizeof *t);
	t->device = device;
	assert_int_equal(bvh_build(m->vertices, m->triangles, m->count, &t->bvh, &err), STATUS_OK);
	make_leaves(t, m);
	make_view(t, m);
	const struct patch_options options = {.edge = edge};
	assert_int_equal(elements_init(&t->elements, &t->scene.view, &options, &err), STATUS_OK);
	assert_int_equal(element_buffers_init(&t->buffers, &t->elements, true, device, &err), STATUS_OK);
	assert_int_equal(buffer_clear(&t->buffers.surfaces, device, &err), STATUS_OK);
}

void traced_mesh_finish(struct traced_mesh *t)
{
	for (uint32_t i = 0; i < BIND_SCENE_COUNT; i++)
		buffer_finish(&t->scene.buffers[i], t->device);
	element_buffers_finish(&t->buffers, t->device);
	elements_finish(&t->elements);
	bvh_finish(&t->bvh);
	free(t->leaves);
}

void traced_mesh_polish(struct traced_mesh *t, uint32_t material, float mirror)
{
	const uint32_t count = t->elements.count, patches = t->elements.patches.count;
	struct radiosity_surface *of = calloc(count, sizeof *of);
	struct error err;
	assert_non_null(of);
	for (uint32_t i = 0; i < count; i++) {
		struct patch p;
		patches_get(&t->elements.patches, i % patches, &p);
		for (int c = 0; c < 3; c++)
			of[i].mirror[c] = p.material == material ? mirror : 0;
	}
	buffer_finish(&t->buffers.surfaces, t->device);
	assert_int_equal(buffer_init_with(&t->buffers.surfaces, t->device, of, count * sizeof *of, &err), STATUS_OK);
	free(of);
}

void mesh_place(struct mesh *m, const double axis[3], double angle, double scale, double shift)
{
	for (uint32_t i = 0; i < 3 * m->count; i++) {
		struct form_polygon one = {.corners = 1};
		for (int c = 0; c < 3; c++)
			one.at[0][c] = (double)m->vertices[i].position[c];
		one = placed(&one, axis, angle, scale, shift);
		for (int c = 0; c < 3; c++)
			m->vertices[i].position[c] = (float)one.at[0][c];
	}
}
