// Makes and frees hemicubes.
#include "server/worker/technique/radiosity/hemicube.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/common/scene_traits.h"
#include "server/worker/technique/radiosity/hemicube_job.h"
#include "shaders/gl/hemicube_frag.h"
#include "shaders/gl/hemicube_pack_comp.h"
#include "shaders/gl/hemicube_sum_comp.h"
#include "shaders/gl/hemicube_vert.h"

#define ROW_BYTES (64ull << 20) // of a batch's sums, lists and entries, at most, where one row does not take more
#define ROWS_MOST 256u // of a batch
#define CELL_BYTES (32ull << 20) // of a pass's pictures, at most, where one layer does not take more
#define CELLS_MOST 256u // of a pass
#define ABREAST_PIXELS 128u // of a face's side, up to which cells lie side by side
#define SUM_MOST 3.4e9 // of a row: a word holds it, and what products of middles have too much
#define NEAR 0x1p-50 // of the scene's largest coordinate
#define NEAR_LEAST 1e-36f // metres: a depth is still a normal float

#define ALPHA (1u << candil_Effect_EFFECT_ALPHA_MASK | 1u << candil_Effect_EFFECT_ALPHA_BLEND)
#define ALPHA_FROM (1u << candil_Effect_EFFECT_TEXTURES | 1u << candil_Effect_EFFECT_VERTEX_COLORS)

static const struct gl_source draw_source = {
    .name = "hemicube", .vertex = source_hemicube_vert, .fragment = source_hemicube_frag};
static const struct gl_source sum_source = {.name = "hemicube_sum", .compute = source_hemicube_sum_comp};
static const struct gl_source pack_source = {.name = "hemicube_pack", .compute = source_hemicube_pack_comp};

// ---- sizes ------------------------------------------------------------------------------------------------------------

// Cells that lie side by side.
static uint32_t abreast_of(const struct hemicube_options *o)
{
	return o->pixels <= ABREAST_PIXELS ? HEMICUBE_ABREAST_MOST : 1;
}

static uint64_t layer_bytes(const struct hemicube_options *o)
{
	return (uint64_t)abreast_of(o) * 3 * o->pixels * o->pixels * (sizeof(uint32_t) + sizeof(float));
}

static uint32_t cells_of(const struct hemicube_options *o)
{
	const uint64_t layers = CELL_BYTES / layer_bytes(o), fit = (layers < 1 ? 1 : layers) * abreast_of(o);
	return fit > CELLS_MOST ? CELLS_MOST / abreast_of(o) * abreast_of(o) : (uint32_t)fit;
}

// Elements that a row has room for: as many as there are, or pixels.
static uint32_t list_of(uint32_t side, const struct hemicube_options *o)
{
	const uint64_t pixels = 3ull * o->pixels * o->pixels * o->origins;
	return pixels < side ? (uint32_t)pixels : side;
}

static uint64_t row_bytes(uint32_t side, const struct hemicube_options *o)
{
	return (uint64_t)side * sizeof(uint32_t) +
	       (uint64_t)list_of(side, o) * (sizeof(uint32_t) + sizeof(struct hemicube_entry)) + sizeof(struct hemicube_row);
}

static uint32_t rows_of(uint32_t side, const struct hemicube_options *o)
{
	const uint64_t fit = ROW_BYTES / row_bytes(side, o);
	return fit < 1 ? 1 : fit > ROWS_MOST ? ROWS_MOST : (uint32_t)fit;
}

uint64_t hemicube_bytes(uint32_t triangles, uint32_t vertices, uint32_t patches, const struct hemicube_options *o)
{
	const uint64_t of_triangle =
	    3 * sizeof(uint32_t) + 3 * sizeof(struct hemicube_corner) + sizeof(struct radiosity_face);
	return triangles * of_triangle + vertices * 3ull * sizeof(float) +
	       rows_of(2 * patches, o) * row_bytes(2 * patches, o) + cells_of(o) * sizeof(struct hemicube_cell) +
	       cells_of(o) / abreast_of(o) * layer_bytes(o) + hemicube_table_entries(o->pixels) * sizeof(uint32_t) +
	       sizeof(struct scene_params);
}

// ---- the scene --------------------------------------------------------------------------------------------------------

// Of a plan's effects, those that change what is there.
static uint32_t effects_of(const struct plan *plan)
{
	return plan->effects & ALPHA ? plan->effects & (ALPHA | ALPHA_FROM) : 0;
}

static bool is_cut(const struct hemicube *h, uint32_t triangle)
{
	const struct triangle *triangles = scene_section(h->scene, BLOB_TRIANGLES);
	const struct material *materials = scene_section(h->scene, BLOB_MATERIALS);
	const uint32_t flags = (h->effects >> candil_Effect_EFFECT_ALPHA_MASK & 1 ? MATERIAL_ALPHA_MASK : 0u) |
			       (h->effects >> candil_Effect_EFFECT_ALPHA_BLEND & 1 ? MATERIAL_ALPHA_BLEND : 0u);
	return (materials[triangles[triangle].material].flags & flags) != 0;
}

static enum status make_runs(struct hemicube *h, struct error *err)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < h->triangle_count; i++)
		count += i == 0 || is_cut(h, i) != is_cut(h, i - 1);
	h->runs = calloc(count, sizeof *h->runs);
	if (!h->runs)
		return error_set(err, STATUS_MEMORY, "out of memory");
	for (uint32_t i = 0; i < h->triangle_count; i++) {
		if (i == 0 || is_cut(h, i) != is_cut(h, i - 1))
			h->runs[h->run_count++] = (struct hemicube_run){.first = i, .cut = is_cut(h, i)};
		h->runs[h->run_count - 1].end = i + 1;
	}
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
		hemicube_table_round(h->options.pixels, table, h->unit, words);
		s = gl_buffer_init(&h->table, h->device, count * sizeof *words, words, err);
		free(table);
	}
	free(words);
	return s;
}

// ---- making it --------------------------------------------------------------------------------------------------------

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

static enum status make_rows(struct hemicube *h, struct error *err)
{
	const uint64_t rows = h->rows_most, list = rows * h->list_most;
	h->host_rows = calloc(rows, sizeof *h->host_rows);
	h->host_cells = calloc(h->cells_most, sizeof *h->host_cells);
	if (!h->host_rows || !h->host_cells)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status s = gl_buffer_init(&h->dense, h->device, rows * h->elements->count * sizeof(uint32_t), NULL, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->rows, h->device, rows * sizeof *h->host_rows, NULL, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->lists, h->device, list * sizeof(uint32_t), NULL, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->entries, h->device, list * sizeof(struct hemicube_entry), NULL, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->cells, h->device, h->cells_most * sizeof *h->host_cells, NULL, err);
	return s;
}

static enum status make_target(struct hemicube *h, struct hemicube_target *t, struct error *err)
{
	struct gl_texture_desc desc = {.target = GL_TEXTURE_2D_ARRAY,
				       .format = GL_R32UI,
				       .width = h->abreast * 2 * h->options.pixels,
				       .height = h->options.pixels + h->options.pixels / 2,
				       .depth = h->cells_most / h->abreast,
				       .levels = 1};
	enum status s = gl_texture_init(&t->ids, h->device, &desc, err);
	desc.format = GL_DEPTH_COMPONENT32F;
	if (s == STATUS_OK)
		s = gl_texture_init(&t->depths, h->device, &desc, err);
	if (s != STATUS_OK)
		return s;
	glCreateFramebuffers(1, &t->framebuffer);
	glNamedFramebufferTexture(t->framebuffer, GL_COLOR_ATTACHMENT0, t->ids.name, 0);
	glNamedFramebufferTexture(t->framebuffer, GL_DEPTH_ATTACHMENT, t->depths.name, 0);
	if (glCheckNamedFramebufferStatus(t->framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
		return error_set(err, STATUS_DEVICE, "this OpenGL device cannot draw layers of 32-bit numbers and depths");
	return gl_check(h->device, "making a framebuffer", err);
}

static void finish_target(struct hemicube *h, struct hemicube_target *t)
{
	if (t->framebuffer)
		glDeleteFramebuffers(1, &t->framebuffer);
	gl_texture_finish(&t->ids, h->device);
	gl_texture_finish(&t->depths, h->device);
}

static void make_vertex_array(struct hemicube *h)
{
	glCreateVertexArrays(1, &h->vertex_array);
	glVertexArrayVertexBuffer(h->vertex_array, 0, h->positions.name, 0, 3 * sizeof(float));
	glVertexArrayElementBuffer(h->vertex_array, h->indices.name);
	glEnableVertexArrayAttrib(h->vertex_array, 0);
	glVertexArrayAttribFormat(h->vertex_array, 0, 3, GL_FLOAT, GL_FALSE, 0);
	glVertexArrayAttribBinding(h->vertex_array, 0, 0);
}

static enum status make_buffers(struct hemicube *h, const struct plan *plan, struct error *err)
{
	struct scene_params job;
	scene_params_fill(plan, &h->scene->view, false, &job);
	enum status s = upload_positions(h, err);
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
	if (s == STATUS_OK)
		s = make_rows(h, err);
	if (s == STATUS_OK)
		s = make_target(h, &h->target, err);
	if (s == STATUS_OK && effects_of(plan))
		s = gl_buffer_init(&h->job, h->device, sizeof job, &job, err);
	if (s == STATUS_OK)
		make_vertex_array(h);
	return s;
}

static enum status make_program(struct hemicube *h, const struct gl_source *source, const struct gl_defines *defines,
				struct gl_program **program, struct error *err)
{
	enum status s = gl_program_get(h->device, source, defines, program, err);
	if (s == STATUS_OK)
		gl_program_hold(*program);
	else
		*program = NULL;
	return s;
}

static enum status make_programs(struct hemicube *h, struct error *err)
{
	struct gl_defines none = {0}, cut = {0};
	bool whole = false, masked = false;
	enum status s = STATUS_OK;
	for (uint32_t i = 0; i < h->run_count; i++) {
		masked |= h->runs[i].cut;
		whole |= !h->runs[i].cut;
	}
	gl_define(&cut, "HEMICUBE_CUT", "1");
	scene_define(&cut, h->scene, h->effects);
	if (whole)
		s = make_program(h, &draw_source, &none, &h->draw[0], err);
	if (s == STATUS_OK && masked)
		s = make_program(h, &draw_source, &cut, &h->draw[1], err);
	if (s == STATUS_OK)
		s = make_program(h, &sum_source, &none, &h->sum, err);
	if (s == STATUS_OK)
		s = make_program(h, &pack_source, &none, &h->pack, err);
	return s;
}

static enum status check(const struct hemicube_options *o, const struct elements *e, const struct gl_device *d,
			 struct error *err)
{
	if (o->pixels < HEMICUBE_PIXELS_LEAST || o->pixels > HEMICUBE_PIXELS_MOST || o->pixels % 2)
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "hemicubes of %u pixels a side are asked for: even numbers of %u to %u can be", o->pixels,
				 HEMICUBE_PIXELS_LEAST, HEMICUBE_PIXELS_MOST);
	if (o->origins < 1 || o->origins > HEMICUBE_ORIGINS_MOST)
		return error_set(err, STATUS_BAD_ARGUMENT, "%u hemicubes a patch are asked for: 1 to %u can be", o->origins,
				 HEMICUBE_ORIGINS_MOST);
	if (o->bounces > HEMICUBE_BOUNCES_MOST)
		return error_set(err, STATUS_BAD_ARGUMENT, "%u bounces at mirrors are asked for: at most %u can be",
				 o->bounces, HEMICUBE_BOUNCES_MOST);
	if (e->count == 0)
		return error_set(err, STATUS_BAD_ARGUMENT, "the scene has no patches");
	if (2 * o->pixels * abreast_of(o) > d->image_side_max)
		return error_set(err, STATUS_MEMORY, "this OpenGL device has no pictures of %u pixels a side",
				 2 * o->pixels * abreast_of(o));
	if (!epoxy_has_gl_extension("GL_ARB_shader_viewport_layer_array"))
		return error_set(err, STATUS_DEVICE, "this OpenGL device lacks GL_ARB_shader_viewport_layer_array");
	return STATUS_OK;
}

enum status hemicube_create(struct gl_device *device, struct resident_scene *scene, const struct plan *plan,
			    const struct elements *elements, const struct hemicube_options *options,
			    struct hemicube **hemicube, struct error *err)
{
	*hemicube = NULL;
	enum status s = check(options, elements, device, err);
	if (s != STATUS_OK)
		return s;
	struct hemicube *h = calloc(1, sizeof *h);
	if (!h)
		return error_set(err, STATUS_MEMORY, "out of memory");
	h->device = device;
	h->scene = scene;
	h->elements = elements;
	h->options = *options;
	h->effects = effects_of(plan);
	h->bindings = scene_bindings_shade(plan);
	h->triangle_count = scene_count(scene, BLOB_TRIANGLES);
	h->abreast = abreast_of(options);
	h->cells_most = cells_of(options);
	h->rows_most = rows_of(elements->count, options);
	h->list_most = list_of(elements->count, options);
	h->unit = 8 * (uint32_t)(SUM_MOST / (8.0 * (options->bounces + 1) * options->origins));
	s = make_runs(h, err);
	if (s == STATUS_OK)
		s = make_buffers(h, plan, err);
	if (s == STATUS_OK)
		s = make_programs(h, err);
	if (s != STATUS_OK) {
		hemicube_destroy(h);
		return s;
	}
	*hemicube = h;
	return STATUS_OK;
}

void hemicube_destroy(struct hemicube *h)
{
	if (!h)
		return;
	struct gl_program *programs[] = {h->draw[0], h->draw[1], h->sum, h->pack};
	struct gl_buffer *buffers[] = {&h->positions, &h->indices, &h->corners, &h->table,   &h->faces, &h->cells,
				       &h->dense,     &h->rows,    &h->lists,   &h->entries, &h->job};
	for (size_t i = 0; i < sizeof programs / sizeof *programs; i++)
		gl_program_release(programs[i]);
	if (h->vertex_array)
		glDeleteVertexArrays(1, &h->vertex_array);
	glDeleteTextures(1, &h->corner_texels);
	glDeleteTextures(1, &h->table_texels);
	finish_target(h, &h->target);
	for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++)
		gl_buffer_finish(buffers[i], h->device);
	free(h->runs);
	free(h->host_cells);
	free(h->host_rows);
	free(h);
}
