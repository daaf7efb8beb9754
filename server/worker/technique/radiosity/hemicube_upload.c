// Brings to the device what hemicubes need of a scene.
#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/worker/technique/radiosity/hemicube_job.h"

#define CLUSTER 2u // triangles, at most, on a software device, for which each costs more than to find it
#define CLUSTER_HARDWARE 32u
#define SHARED 32u // triangles, at most, that share corners
#define NEAR 0x1p-50 // of the scene's largest coordinate
#define NEAR_LEAST 1e-36f // metres: a depth is still a normal float

static enum status make_clusters(struct hemicube *h, struct error *err)
{
	const uint32_t flags = (h->effects >> candil_Effect_EFFECT_ALPHA_MASK & 1 ? MATERIAL_ALPHA_MASK : 0u) |
			       (h->effects >> candil_Effect_EFFECT_ALPHA_BLEND & 1 ? MATERIAL_ALPHA_BLEND : 0u);
	return hemicube_clusters_init(&h->clusters, h->scene, h->device->software ? CLUSTER : CLUSTER_HARDWARE, flags, err);
}

static void set_near(struct hemicube *h)
{
	const struct vertex *vertices = scene_section(h->scene, BLOB_VERTICES);
	float most = 0;
	for (uint32_t i = 0; i < scene_count(h->scene, BLOB_VERTICES); i++)
		for (int c = 0; c < 3; c++)
			most = fmaxf(most, fabsf(vertices[i].position[c]));
	h->near = fmaxf((float)(NEAR * (double)most), NEAR_LEAST);
}

// The corners of a run of triangles by their vertices.
struct corner_list {
	uint32_t vertex[3 * SHARED], corner[3 * SHARED];
	uint32_t count;
};

// The corner at a vertex; NONE: there is none so far.
static uint32_t find_corner(const struct corner_list *l, uint32_t vertex)
{
	for (uint32_t i = 0; i < l->count; i++)
		if (l->vertex[i] == vertex)
			return l->corner[i];
	return NONE;
}

// A pixel is told its triangle by the triangle's last corner, which so is one of its own; the other two are those that
// triangles before have at the same vertices, where there are some, because each corner is projected once.
static void share_corners(const struct triangle *triangles, uint32_t first, uint32_t end, uint32_t *indices)
{
	struct corner_list known = {.count = 0};
	for (uint32_t i = first; i < end; i++) {
		const uint32_t *vertex = triangles[i].vertex;
		uint32_t last = 2;
		for (uint32_t k = 0; k < 3; k++)
			if (find_corner(&known, vertex[k]) == NONE)
				last = k;
		for (uint32_t k = 0; k < 3; k++) {
			const uint32_t corner = (last + 1 + k) % 3, other = find_corner(&known, vertex[corner]);
			indices[3 * i + k] = k == 2 || other == NONE ? 3 * i + corner : other;
			if (other != NONE)
				continue;
			known.vertex[known.count] = vertex[corner];
			known.corner[known.count++] = 3 * i + corner;
		}
	}
}

// Triangles with masks share none: which corner is whose tells the place on the triangle.
static enum status make_indices(struct hemicube *h, struct error *err)
{
	const struct triangle *triangles = scene_section(h->scene, BLOB_TRIANGLES);
	h->host_indices = malloc(3ull * h->triangle_count * sizeof *h->host_indices);
	if (!h->host_indices)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < 3 * h->triangle_count; i++)
		h->host_indices[i] = i;
	for (uint32_t k = 0, end; k < h->clusters.counts[0]; k = end) {
		const struct hemicube_cluster *c = &h->clusters.list[k];
		for (end = k + 1; end < h->clusters.counts[0] && h->clusters.list[end].cut == c->cut &&
				  h->clusters.list[end].end - c->first <= SHARED;)
			end++;
		if (!c->cut)
			share_corners(triangles, c->first, h->clusters.list[end - 1].end, h->host_indices);
	}
	return STATUS_OK;
}

// What draws are listed in.
static enum status make_lists(struct hemicube *h, struct error *err)
{
	const uint64_t all = 3ull * h->triangle_count * HEMICUBE_FACES * h->cells_most;
	const uint32_t instances = 8 * h->cells_most;
	h->listed_most = all < HEMICUBE_LISTED_MOST ? (uint32_t)all : HEMICUBE_LISTED_MOST;
	h->host_seen = calloc(h->clusters.counts[0], sizeof *h->host_seen);
	h->host_listed = calloc(h->listed_most, sizeof *h->host_listed);
	h->lists_of_draws = calloc(HEMICUBE_LISTS, sizeof *h->lists_of_draws);
	uint32_t *numbers = malloc(instances * sizeof *numbers);
	enum status s = STATUS_OK;
	if (!h->host_seen || !h->host_listed || !h->lists_of_draws || !numbers)
		s = error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; s == STATUS_OK && i < instances; i++)
		numbers[i] = i;
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->instances, h->device, instances * sizeof *numbers, numbers, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->listed, h->device, h->listed_most * sizeof *h->host_listed, NULL, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->draws, h->device, HEMICUBE_LISTS * sizeof h->lists_of_draws->draws, NULL, err);
	free(numbers);
	return s;
}

static enum status upload_corners(struct hemicube *h, struct error *err)
{
	const struct vertex *vertices = scene_section(h->scene, BLOB_VERTICES);
	const struct triangle *triangles = scene_section(h->scene, BLOB_TRIANGLES);
	const uint32_t count = h->triangle_count;
	struct hemicube_corner(*corners)[3] = malloc(count * sizeof *corners);
	if (!corners)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++) {
			memcpy(corners[i][k].at, vertices[triangles[i].vertex[k]].position, sizeof corners[i][k].at);
			corners[i][k].word = h->elements->triangles[i];
		}
	const enum status s = gl_buffer_init(&h->corners, h->device, count * sizeof *corners, corners, err);
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

enum status hemicube_texels(struct hemicube *h, const struct gl_buffer *buffer, unsigned format, uint32_t texel_bytes,
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
	set_near(h);
	enum status s = make_clusters(h, err);
	if (s == STATUS_OK)
		s = make_indices(h, err);
	if (s == STATUS_OK)
		s = make_lists(h, err);
	if (s == STATUS_OK)
		s = upload_corners(h, err);
	if (s == STATUS_OK)
		s = upload_table(h, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->faces, h->device, h->elements->patches.faces.count * sizeof *h->elements->faces,
				   h->elements->faces, err);
	if (s == STATUS_OK)
		s = hemicube_texels(h, &h->corners, GL_RGBA32UI, sizeof(struct hemicube_corner), &h->corner_texels, err);
	if (s == STATUS_OK)
		s = hemicube_texels(h, &h->table, GL_R32UI, sizeof(uint32_t), &h->table_texels, err);
	return s;
}
