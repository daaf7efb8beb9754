// Brings to the device what hemicubes need of a scene.
#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/worker/technique/radiosity/hemicube_job.h"

#define CLUSTER 32u // triangles, at most
#define NEAR 0x1p-50 // of the scene's largest coordinate
#define NEAR_LEAST 1e-36f // metres: a depth is still a normal float

static bool is_cut(const struct hemicube *h, uint32_t triangle)
{
	const struct triangle *triangles = scene_section(h->scene, BLOB_TRIANGLES);
	const struct material *materials = scene_section(h->scene, BLOB_MATERIALS);
	const uint32_t flags = (h->effects >> candil_Effect_EFFECT_ALPHA_MASK & 1 ? MATERIAL_ALPHA_MASK : 0u) |
			       (h->effects >> candil_Effect_EFFECT_ALPHA_BLEND & 1 ? MATERIAL_ALPHA_BLEND : 0u);
	return (materials[triangles[triangle].material].flags & flags) != 0;
}

// The sphere about the middle of the box about a cluster.
static void bound(const struct hemicube *h, struct hemicube_cluster *c)
{
	const struct vertex *vertices = scene_section(h->scene, BLOB_VERTICES);
	const struct triangle *triangles = scene_section(h->scene, BLOB_TRIANGLES);
	double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
	for (uint32_t i = c->first; i < c->end; i++)
		for (int k = 0; k < 3; k++)
			for (int a = 0; a < 3; a++) {
				const double at = (double)vertices[triangles[i].vertex[k]].position[a];
				low[a] = fmin(low[a], at);
				high[a] = fmax(high[a], at);
			}
	c->radius = 0;
	for (int a = 0; a < 3; a++) {
		c->at[a] = 0.5 * low[a] + 0.5 * high[a];
		c->radius += (0.5 * high[a] - 0.5 * low[a]) * (0.5 * high[a] - 0.5 * low[a]);
	}
	c->radius = sqrt(c->radius);
}

static bool begins_cluster(const struct hemicube *h, uint32_t i, uint32_t length)
{
	return i == 0 || length == CLUSTER || is_cut(h, i) != is_cut(h, i - 1);
}

static enum status make_clusters(struct hemicube *h, struct error *err)
{
	uint32_t count = 0, length = 0;
	for (uint32_t i = 0; i < h->triangle_count; i++, length++)
		if (begins_cluster(h, i, length)) {
			count++;
			length = 0;
		}
	h->clusters = calloc(count, sizeof *h->clusters);
	if (!h->clusters)
		return error_set(err, STATUS_MEMORY, "out of memory");
	length = 0;
	for (uint32_t i = 0; i < h->triangle_count; i++, length++) {
		if (begins_cluster(h, i, length)) {
			h->clusters[h->cluster_count++] = (struct hemicube_cluster){.first = i, .cut = is_cut(h, i)};
			length = 0;
		}
		h->clusters[h->cluster_count - 1].end = i + 1;
	}
	for (uint32_t i = 0; i < h->cluster_count; i++)
		bound(h, &h->clusters[i]);
	return STATUS_OK;
}

static enum status upload_positions(struct hemicube *h, struct error *err)
{
	const struct vertex *vertices = scene_section(h->scene, BLOB_VERTICES);
	const uint32_t count = scene_count(h->scene, BLOB_VERTICES);
	float(*at)[3] = malloc(count * sizeof *at), most = 0;
	if (!at)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < count; i++)
		for (int c = 0; c < 3; c++) {
			at[i][c] = vertices[i].position[c];
			most = fmaxf(most, fabsf(at[i][c]));
		}
	h->near = fmaxf((float)(NEAR * (double)most), NEAR_LEAST);
	const enum status s = gl_buffer_init(&h->positions, h->device, count * sizeof *at, at, err);
	free(at);
	return s;
}

static enum status upload_triangles(struct hemicube *h, struct error *err)
{
	const struct vertex *vertices = scene_section(h->scene, BLOB_VERTICES);
	const struct triangle *triangles = scene_section(h->scene, BLOB_TRIANGLES);
	const uint32_t count = h->triangle_count;
	uint32_t(*indices)[3] = malloc(count * sizeof *indices);
	struct hemicube_corner(*corners)[3] = malloc(count * sizeof *corners);
	enum status s = indices && corners ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; s == STATUS_OK && i < count; i++)
		for (int k = 0; k < 3; k++) {
			indices[i][k] = triangles[i].vertex[k];
			memcpy(corners[i][k].at, vertices[indices[i][k]].position, sizeof corners[i][k].at);
			corners[i][k].word = h->elements->triangles[i];
		}
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->indices, h->device, count * sizeof *indices, indices, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->corners, h->device, count * sizeof *corners, corners, err);
	free(indices);
	free(corners);
	return s;
}

static enum status upload_table(struct hemicube *h, struct error *err)
{
	const uint32_t count = hemicube_table_entries(h->options.pixels);
	double *table;
	uint32_t *words = malloc(count * sizeof *words);
	if (!words)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status s = hemicube_table_make(h->options.pixels, h->options.middles, &table, err);
	if (s == STATUS_OK) {
		hemicube_table_round(h->options.pixels, table, HEMICUBE_UNIT, words);
		s = gl_buffer_init(&h->table, h->device, count * sizeof *words, words, err);
		free(table);
	}
	free(words);
	return s;
}

static enum status texels_of(struct hemicube *h, const struct gl_buffer *buffer, GLenum format, uint32_t texel_bytes,
			     unsigned *texture, struct error *err)
{
	GLint most = 0;
	glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
	if (buffer->bytes / texel_bytes > (uint64_t)most)
		return error_set(err, STATUS_MEMORY, "the scene has more corners than the OpenGL device's %d texels", most);
	glCreateTextures(GL_TEXTURE_BUFFER, 1, texture);
	glTextureBuffer(*texture, format, buffer->name);
	return gl_check(h->device, "viewing a buffer as texels", err);
}

enum status hemicube_upload(struct hemicube *h, struct error *err)
{
	enum status s = make_clusters(h, err);
	if (s == STATUS_OK)
		s = upload_positions(h, err);
	if (s == STATUS_OK)
		s = upload_triangles(h, err);
	if (s == STATUS_OK)
		s = upload_table(h, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->faces, h->device, h->elements->patches.faces.count * sizeof *h->elements->faces,
				   h->elements->faces, err);
	if (s == STATUS_OK)
		s = texels_of(h, &h->corners, GL_RGBA32UI, sizeof(struct hemicube_corner), &h->corner_texels, err);
	if (s == STATUS_OK)
		s = texels_of(h, &h->table, GL_R32UI, sizeof(uint32_t), &h->table_texels, err);
	return s;
}
