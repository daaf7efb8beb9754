#include "tests/gpu/patch_model.h"

#include <stdlib.h>

#include "server/base/vec3.h"
#include "server/loader/bvh.h"
#include "server/worker/devices.h"

struct device *device;
const struct plan everything = {.effects = 0xFFFFFFFF, .width = 1, .height = 1};

bool model_test_begin(void)
{
	struct error err;
	if (device_create(&(struct device_options){0}, &device, &err) == STATUS_OK)
		return true;
	print_message("skipped: %s\n", err.text);
	return false;
}

int model_test_end(void)
{
	const int errors = device->validation_errors > 0;
	const int left = device->bytes != 0;
	devices_finish(&(struct devices){.vk = device});
	return errors + left;
}

void model_start(struct patch_model *m)
{
	memset(m, 0, sizeof *m);
	for (int i = 0; i < 8; i++) {
		struct material *a = &m->materials[i];
		a->albedo[0] = a->albedo[1] = a->albedo[2] = 1;
		a->albedo_texture = a->emission_texture = a->specular_texture = a->specular_weight_texture = NONE;
		a->surface_texture = a->normal_texture = a->transmission_texture = NONE;
		a->coat_texture = a->coat_roughness_texture = a->coat_normal_texture = NONE;
		a->roughness = 1;
		a->ior = 1.5f;
	}
}

void model_add(struct patch_model *m, const double a[3], const double b[3], const double c[3], const double uv[3][2],
	       uint32_t material)
{
	static const double plain[3][2] = {{0, 0}, {1, 0}, {0, 1}};
	const double *corners[3] = {a, b, c};
	const uint32_t t = m->count++;
	assert_true(t < MODEL_TRIANGLES);
	uv = uv ? uv : plain;
	m->triangles[t].material = material;
	for (uint32_t k = 0; k < 3; k++) {
		struct vertex *v = &m->vertices[3 * t + k];
		m->triangles[t].vertex[k] = 3 * t + k;
		for (int i = 0; i < 3; i++)
			v->position[i] = (float)corners[k][i];
		v->uv[0] = (float)uv[k][0];
		v->uv[1] = (float)uv[k][1];
		for (int i = 0; i < 4; i++)
			m->colors[3 * t + k].rgba[i] = 1;
	}
}

void model_add_quad(struct patch_model *m, const double at[3], const double u[3], const double v[3], uint32_t material)
{
	static const double uv[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{1, 1}, {0, 1}, {0, 0}}};
	double p[3][3];
	for (int i = 0; i < 3; i++) {
		p[0][i] = at[i] + u[i];
		p[1][i] = at[i] + u[i] + v[i];
		p[2][i] = at[i] + v[i];
	}
	model_add(m, at, p[0], p[1], uv[0], material);
	model_add(m, p[1], p[2], at, uv[1], material);
}

void model_add_corners(struct patch_model *m, const double c[4][3], uint32_t material)
{
	const double uv[2][3][2] = {{{c[0][0], c[0][1]}, {c[1][0], c[1][1]}, {c[2][0], c[2][1]}},
				    {{c[3][0], c[3][1]}, {c[0][0], c[0][1]}, {c[2][0], c[2][1]}}};
	model_add(m, c[0], c[1], c[2], uv[0], material);
	model_add(m, c[3], c[0], c[2], uv[1], material);
}

static void make_tree(struct patch_model *m)
{
	struct bvh tree;
	struct blob_view *v = &m->scene.view;
	assert_int_equal(bvh_build(m->vertices, m->triangles, m->count, &tree, NULL), STATUS_OK);
	for (uint32_t i = 0; i < m->count; i++) {
		const struct triangle *t = &m->triangles[tree.order[i]];
		struct leaf_triangle *leaf = &m->leaves[i];
		*leaf = (struct leaf_triangle){.id = tree.order[i], .material = t->material};
		memcpy(leaf->v0, m->vertices[t->vertex[0]].position, sizeof leaf->v0);
		memcpy(leaf->v1, m->vertices[t->vertex[1]].position, sizeof leaf->v1);
		memcpy(leaf->v2, m->vertices[t->vertex[2]].position, sizeof leaf->v2);
	}
	m->nodes = malloc(tree.node_count * sizeof *tree.nodes);
	assert_non_null(m->nodes);
	memcpy(m->nodes, tree.nodes, tree.node_count * sizeof *tree.nodes);
	m->header.bvh_depth = tree.depth;
	v->sections[BLOB_NODES] = m->nodes;
	v->counts[BLOB_NODES] = tree.node_count;
	v->sections[BLOB_LEAF_TRIANGLES] = m->leaves;
	v->counts[BLOB_LEAF_TRIANGLES] = m->count;
	bvh_finish(&tree);
}

static void make_view(struct patch_model *m)
{
	struct blob_view *v = &m->scene.view;
	m->scene.blob = v->blob = &m->header;
	const struct {
		enum blob_section section;
		const void *data;
		uint32_t count;
	} all[] = {{BLOB_VERTICES, m->vertices, 3 * m->count}, {BLOB_TRIANGLES, m->triangles, m->count},
		   {BLOB_MATERIALS, m->materials, 8},          {BLOB_TEXTURES, m->textures, m->texture_count},
		   {BLOB_TEXELS, m->texels, m->texel_count},   {BLOB_COLORS, m->colors, m->has_colors ? 3 * m->count : 0},
		   {BLOB_LIGHTS, m->lights, m->light_count}};
	for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
		v->sections[all[i].section] = all[i].data;
		v->counts[all[i].section] = all[i].count;
	}
	for (int c = 0; c < 3; c++) {
		v->bounds_min[c] = INFINITY;
		v->bounds_max[c] = -INFINITY;
		for (uint32_t i = 0; i < 3 * m->count; i++) {
			v->bounds_min[c] = fminf(v->bounds_min[c], m->vertices[i].position[c]);
			v->bounds_max[c] = fmaxf(v->bounds_max[c], m->vertices[i].position[c]);
		}
	}
}

void model_close(struct patch_model *m, double edge)
{
	make_view(m);
	make_tree(m);
	assert_int_equal(elements_init(&m->elements, &m->scene.view, &(struct patch_options){.edge = edge}, NULL),
			 STATUS_OK);
	assert_int_equal(element_buffers_init(&m->buffers, &m->elements, true, device, NULL), STATUS_OK);
}

void model_finish(struct patch_model *m)
{
	while (m->scene.derived) {
		struct derived *d = m->scene.derived;
		m->scene.derived = d->next;
		d->destroy(d);
	}
	for (uint32_t i = 0; i < BIND_SCENE_COUNT; i++)
		buffer_finish(&m->scene.buffers[i], device);
	element_buffers_finish(&m->buffers, device);
	elements_finish(&m->elements);
	free(m->nodes);
	m->nodes = NULL;
}

void model_surfaces(const struct patch_model *m, struct radiosity_surface *out)
{
	const uint64_t bytes = m->elements.count * sizeof *out;
	assert_int_equal(buffer_read(&m->buffers.surfaces, device, 0, bytes, out, NULL), STATUS_OK);
}

// Of a triangle: the middles of n² like it.
static double mean_of_triangle(const double *a, const double *b, const double *c, uint32_t n, model_field *field,
			       const void *data, double mean[3])
{
	double u[3], v[3], across[3], sum[3] = {0};
	for (int i = 0; i < 3; i++) {
		u[i] = b[i] - a[i];
		v[i] = c[i] - a[i];
	}
	vec3_cross(u, v, across);
	for (uint32_t y = 0; y < n; y++)
		for (uint32_t x = 0; x < 2 * (n - y) - 1; x++) {
			const double third = x % 2 ? 2.0 / 3 : 1.0 / 3, s = (x / 2 + third) / n, t = (y + third) / n;
			double at[3], value[3];
			for (int i = 0; i < 3; i++)
				at[i] = a[i] + s * u[i] + t * v[i];
			field(at, data, value);
			for (int i = 0; i < 3; i++)
				sum[i] += value[i];
		}
	for (int i = 0; i < 3; i++)
		mean[i] = sum[i] / ((double)n * n);
	return 0.5 * sqrt(vec3_dot(across, across));
}

void model_mean(const struct patch_model *m, uint32_t patch, uint32_t n, model_field *field, const void *data,
		double mean[3])
{
	struct patch p;
	double area = 0;
	patches_get(&m->elements.patches, patch, &p);
	mean[0] = mean[1] = mean[2] = 0;
	for (uint32_t k = 2; k < p.shape.corners; k++) {
		double part[3];
		const double share = mean_of_triangle(p.shape.at[0], p.shape.at[k - 1], p.shape.at[k], n, field, data, part);
		area += share;
		for (int i = 0; i < 3; i++)
			mean[i] += share * part[i];
	}
	for (int i = 0; i < 3; i++)
		mean[i] /= area;
}
