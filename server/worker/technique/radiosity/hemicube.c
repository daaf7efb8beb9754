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
#include "shaders/gl/hemicube_rays_comp.h"
#include "shaders/gl/hemicube_sum_comp.h"
#include "shaders/gl/hemicube_vert.h"

#define ROW_BYTES (64ull << 20) // of a batch's sums, lists and entries, at most, where one row does not take more
#define ROWS_MOST 256u // of a batch
#define CELL_BYTES (32ull << 20) // of a pass's pictures, at most, where one layer does not take more
#define SEEN_BYTES (16ull << 20) // of what cells tell about planes of mirrors, where one layer does not tell more

#define ALPHA (1u << candil_Effect_EFFECT_ALPHA_MASK | 1u << candil_Effect_EFFECT_ALPHA_BLEND)
#define ALPHA_FROM (1u << candil_Effect_EFFECT_TEXTURES | 1u << candil_Effect_EFFECT_VERTEX_COLORS)

static const struct gl_source draw_source = {
    .name = "hemicube", .vertex = source_hemicube_vert, .fragment = source_hemicube_frag};
static const struct gl_source sum_source = {.name = "hemicube_sum", .compute = source_hemicube_sum_comp};
static const struct gl_source rays_source = {.name = "hemicube_rays", .compute = source_hemicube_rays_comp};
static const struct gl_source pack_source = {.name = "hemicube_pack", .compute = source_hemicube_pack_comp};

// ---- sizes ------------------------------------------------------------------------------------------------------------

// By portals each level of mirrors has two words for each pixel, by rays there are two in all.
static uint64_t cell_bytes(const struct hemicube_options *o)
{
	const uint64_t portals = o->bounces > 0 ? o->bounces : 1;
	const uint64_t found = o->mirrors == HEMICUBE_MIRRORS_OFF      ? 0
			       : o->mirrors == HEMICUBE_MIRRORS_PORTAL ? portals * 2 * sizeof(uint32_t)
								       : 2 * sizeof(uint32_t);
	return (uint64_t)HEMICUBE_LAYERS * o->pixels * o->pixels * (sizeof(uint32_t) + sizeof(float) + found);
}

static uint32_t cells_of(const struct hemicube_options *o)
{
	const uint64_t fit = CELL_BYTES / cell_bytes(o);
	return fit < 1 ? 1 : fit > HEMICUBE_CELLS_MOST ? HEMICUBE_CELLS_MOST : (uint32_t)fit;
}

// Elements that a row has room for: as many as there are, or as pixels meet.
static uint32_t list_of(uint32_t side, const struct hemicube_options *o)
{
	const uint64_t paths = o->mirrors == HEMICUBE_MIRRORS_OFF ? 1 : o->bounces + 1;
	const uint64_t pixels = 3ull * o->pixels * o->pixels * o->origins * paths;
	return pixels < side ? (uint32_t)pixels : side;
}

static uint64_t row_bytes(uint32_t side, const struct hemicube_options *o)
{
	return (uint64_t)side * 2 * sizeof(uint32_t) +
	       (uint64_t)list_of(side, o) * (sizeof(uint32_t) + sizeof(struct hemicube_entry)) + sizeof(struct hemicube_row);
}

static uint32_t rows_of(uint32_t side, const struct hemicube_options *o)
{
	const uint64_t fit = ROW_BYTES / row_bytes(side, o);
	return fit < 1 ? 1 : fit > ROWS_MOST ? ROWS_MOST : (uint32_t)fit;
}

uint64_t hemicube_bytes(uint32_t triangles, uint32_t patches, const struct hemicube_options *o)
{
	const uint64_t of_triangle = 3 * sizeof(struct hemicube_corner) + sizeof(struct radiosity_face);
	const uint64_t seen = (uint64_t)cells_of(o) * (triangles + sizeof(uint32_t));
	const uint64_t of_mirrors = o->mirrors == HEMICUBE_MIRRORS_OFF
					? 0
					: 2ull * patches * sizeof(struct hemicube_mirror) +
					      (seen < SEEN_BYTES ? seen : SEEN_BYTES + (uint64_t)triangles);
	return of_mirrors + triangles * of_triangle + HEMICUBE_LISTS * sizeof(struct hemicube_list) +
	       rows_of(2 * patches, o) * row_bytes(2 * patches, o) + cells_of(o) * sizeof(struct hemicube_cell) +
	       (HEMICUBE_LISTED_MOST + 8 * cells_of(o)) * sizeof(uint32_t) + cells_of(o) * cell_bytes(o) +
	       hemicube_table_entries(o->pixels) * sizeof(uint32_t) + sizeof(struct scene_params) +
	       sizeof(struct hemicube_pixels);
}

// ---- making it --------------------------------------------------------------------------------------------------------

// Of a plan's effects, those that change what is there.
static uint32_t effects_of(const struct plan *plan)
{
	return plan->effects & ALPHA ? plan->effects & (ALPHA | ALPHA_FROM) : 0;
}

static enum status make_rows(struct hemicube *h, struct error *err)
{
	const uint64_t rows = h->rows_most, list = rows * h->list_most;
	h->host_rows = calloc(rows, sizeof *h->host_rows);
	h->host_cells = calloc(h->cells_most, sizeof *h->host_cells);
	h->levels[0].views = calloc(h->cells_most, sizeof *h->levels[0].views);
	if (!h->host_rows || !h->host_cells || !h->levels[0].views)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status s = gl_buffer_init(&h->dense, h->device, rows * h->elements->count * 2 * sizeof(uint32_t), NULL, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->rows, h->device, rows * sizeof *h->host_rows, NULL, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->lists, h->device, list * sizeof(uint32_t), NULL, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->entries, h->device, list * sizeof(struct hemicube_entry), NULL, err);
	if (s == STATUS_OK)
		s = gl_buffer_init(&h->cells, h->device, h->cells_most * sizeof *h->host_cells, NULL, err);
	if (s == STATUS_OK)
		s = hemicube_texels(h, &h->cells, GL_RGBA32F, sizeof *h->host_cells / HEMICUBE_CELL_TEXELS, &h->cell_texels,
				    err);
	return s;
}

static struct gl_texture_desc cells_desc(const struct hemicube *h, GLenum format)
{
	return (struct gl_texture_desc){.target = GL_TEXTURE_2D_ARRAY,
					.format = format,
					.width = h->options.pixels,
					.height = h->options.pixels,
					.depth = h->cells_most * HEMICUBE_LAYERS,
					.levels = 1};
}

static enum status make_target(struct hemicube *h, struct hemicube_target *t, struct error *err)
{
	struct gl_texture_desc desc = cells_desc(h, GL_R32UI);
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

static enum status make_portals(struct hemicube *h, struct error *err)
{
	const struct gl_texture_desc desc = cells_desc(h, GL_RG32UI);
	enum status s =
	    gl_buffer_init(&h->seen, h->device, (uint64_t)h->cells_most * h->seen_words * sizeof(uint32_t), NULL, err);
	for (uint32_t i = 0; s == STATUS_OK && i <= h->options.bounces; i++) {
		struct hemicube_level *l = &h->levels[i];
		if (i > 0)
			l->views = calloc(h->cells_most, sizeof *l->views);
		l->seen = calloc((size_t)h->cells_most * h->seen_words, sizeof *l->seen);
		if (!l->views || !l->seen)
			return error_set(err, STATUS_MEMORY, "out of memory");
		if (i < h->options.bounces || i == 0)
			s = gl_texture_init(&l->found, h->device, &desc, err);
	}
	return s;
}

static enum status make_mirrors(struct hemicube *h, struct error *err)
{
	enum status s =
	    gl_buffer_init(&h->mirrors, h->device, h->elements->count * sizeof *h->planes.mirrors, h->planes.mirrors, err);
	if (s == STATUS_OK && hemicube_has_rays(h)) {
		const uint64_t cells = h->cells_most, pixels = cells * 3 * h->options.pixels * h->options.pixels;
		s = gl_buffer_init(&h->pixels, h->device, sizeof(struct hemicube_pixels) + pixels * 2 * sizeof(uint32_t),
				   NULL, err);
	}
	return s == STATUS_OK && hemicube_has_portals(h) ? make_portals(h, err) : s;
}

static void make_vertex_array(struct hemicube *h)
{
	glCreateVertexArrays(1, &h->vertex_array);
	glVertexArrayVertexBuffer(h->vertex_array, 0, h->corners.name, 0, sizeof(struct hemicube_corner));
	glVertexArrayVertexBuffer(h->vertex_array, 1, h->instances.name, 0, sizeof(uint32_t));
	glVertexArrayBindingDivisor(h->vertex_array, 1, 1);
	glVertexArrayElementBuffer(h->vertex_array, h->listed.name);
	glEnableVertexArrayAttrib(h->vertex_array, 0);
	glVertexArrayAttribFormat(h->vertex_array, 0, 3, GL_FLOAT, GL_FALSE, 0);
	glVertexArrayAttribBinding(h->vertex_array, 0, 0);
	glEnableVertexArrayAttrib(h->vertex_array, 1);
	glVertexArrayAttribIFormat(h->vertex_array, 1, 1, GL_UNSIGNED_INT, 0);
	glVertexArrayAttribBinding(h->vertex_array, 1, 1);
}

static enum status make_buffers(struct hemicube *h, const struct plan *plan, struct error *err)
{
	struct scene_params job;
	scene_params_fill(plan, &h->scene->view, false, &job);
	enum status s = hemicube_upload(h, err);
	if (s == STATUS_OK)
		s = make_rows(h, err);
	if (s == STATUS_OK)
		s = make_target(h, &h->target, err);
	if (s == STATUS_OK && (h->effects || h->options.mirrors == HEMICUBE_MIRRORS_HYBRID))
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

// Whether some triangles have masks (`cut`), or have none.
static bool has_triangles(const struct hemicube *h, bool cut)
{
	bool some = false;
	for (uint32_t i = 0; i < h->clusters.counts[0]; i++)
		some |= h->clusters.list[i].cut == cut;
	return some;
}

// Programs that draw, within mirrors or not: first of triangles without masks, then with.
static enum status make_draws(struct hemicube *h, bool mirrored, struct gl_program *draw[2], struct error *err)
{
	enum status s = STATUS_OK;
	for (int cut = 0; s == STATUS_OK && cut < 2; cut++) {
		struct gl_defines defines = {0};
		if (cut) {
			gl_define(&defines, "HEMICUBE_CUT", "1");
			scene_define(&defines, h->scene, h->effects);
		}
		if (mirrored)
			gl_define(&defines, "HEMICUBE_MIRRORED", "1");
		if (has_triangles(h, cut))
			s = make_program(h, &draw_source, &defines, &draw[cut], err);
	}
	return s;
}

static enum status make_programs(struct hemicube *h, struct error *err)
{
	const struct gl_defines none = {0};
	enum status s = make_draws(h, false, h->draw, err);
	if (s == STATUS_OK)
		s = make_program(h, &sum_source, &none, &h->sum, err);
	return s == STATUS_OK ? make_program(h, &pack_source, &none, &h->pack, err) : s;
}

static enum status make_mirror_programs(struct hemicube *h, struct error *err)
{
	struct gl_defines sums = {0}, scene = {0};
	gl_program_release(h->sum);
	gl_define(&sums, hemicube_has_portals(h) ? "HEMICUBE_PORTAL" : "HEMICUBE_HYBRID", "1");
	scene_define(&scene, h->scene, h->effects);
	enum status s = make_program(h, &sum_source, &sums, &h->sum, err);
	if (s == STATUS_OK && hemicube_has_portals(h))
		s = make_draws(h, true, h->draw_mirrored, err);
	return s == STATUS_OK && hemicube_has_rays(h) ? make_program(h, &rays_source, &scene, &h->rays, err) : s;
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
	const uint32_t most = o->mirrors == HEMICUBE_MIRRORS_PORTAL ? HEMICUBE_PORTALS_MOST : HEMICUBE_BOUNCES_MOST;
	if (o->bounces > most)
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "hemicubes follow light at mirrors at most %u times, not %u times", most, o->bounces);
	if (e->count == 0)
		return error_set(err, STATUS_BAD_ARGUMENT, "the scene has no patches");
	if (o->pixels > d->image_side_max)
		return error_set(err, STATUS_MEMORY, "this OpenGL device has no pictures of %u pixels a side", o->pixels);
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
	struct plan own = *plan;
	own.effects = h->effects;
	h->bindings = scene_bindings_shade(&own);
	h->triangle_count = scene_count(scene, BLOB_TRIANGLES);
	h->cells_most = cells_of(options);
	h->rows_most = rows_of(elements->count, options);
	h->list_most = list_of(elements->count, options);
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

static void finish_levels(struct hemicube *h, uint32_t first)
{
	for (uint32_t i = first; i <= HEMICUBE_PORTALS_MOST; i++) {
		gl_texture_finish(&h->levels[i].found, h->device);
		free(h->levels[i].views);
		free(h->levels[i].seen);
		h->levels[i].views = NULL;
		h->levels[i].seen = NULL;
	}
}

enum status hemicube_reflect(struct hemicube *h, const struct radiosity_surface *surfaces, struct error *err)
{
	if (h->options.mirrors == HEMICUBE_MIRRORS_OFF)
		return STATUS_OK;
	// What an attempt without enough memory has left.
	hemicube_planes_finish(&h->planes);
	gl_buffer_finish(&h->mirrors, h->device);
	gl_buffer_finish(&h->pixels, h->device);
	gl_buffer_finish(&h->seen, h->device);
	finish_levels(h, 1);
	enum status s = hemicube_planes_init(&h->planes, h->elements, surfaces, err);
	if (s != STATUS_OK)
		return s;
	if (h->planes.count == 0) {
		h->options.mirrors = HEMICUBE_MIRRORS_OFF;
		return STATUS_OK;
	}
	h->seen_words = (h->planes.count * 8 + 31) / 32;
	while (h->cells_most > 1 && (uint64_t)h->cells_most * h->seen_words * sizeof(uint32_t) > SEEN_BYTES)
		h->cells_most--;
	h->compiled = false;
	s = make_mirrors(h, err);
	return s == STATUS_OK ? make_mirror_programs(h, err) : s;
}

void hemicube_destroy(struct hemicube *h)
{
	if (!h)
		return;
	struct gl_program *programs[] = {h->draw[0], h->draw[1], h->draw_mirrored[0], h->draw_mirrored[1], h->sum,
					 h->rays,    h->pack};
	struct gl_buffer *buffers[] = {&h->instances, &h->mirrors, &h->seen,  &h->pixels,  &h->draws,
				       &h->listed,    &h->corners, &h->table, &h->faces,   &h->cells,
				       &h->dense,     &h->rows,    &h->lists, &h->entries, &h->job};
	for (size_t i = 0; i < sizeof programs / sizeof *programs; i++)
		gl_program_release(programs[i]);
	if (h->vertex_array)
		glDeleteVertexArrays(1, &h->vertex_array);
	glDeleteTextures(1, &h->corner_texels);
	glDeleteTextures(1, &h->table_texels);
	glDeleteTextures(1, &h->cell_texels);
	finish_target(h, &h->target);
	for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++)
		gl_buffer_finish(buffers[i], h->device);
	finish_levels(h, 0);
	hemicube_planes_finish(&h->planes);
	hemicube_clusters_finish(&h->clusters);
	free(h->lists_of_draws);
	free(h->host_seen);
	free(h->host_listed);
	free(h->host_indices);
	free(h->host_cells);
	free(h->host_rows);
	free(h);
}
