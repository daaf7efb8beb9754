// The passes of hemicubes.
#include <epoxy/gl.h>
#include <math.h>
#include <string.h>

#include "server/base/vec3.h"
#include "server/worker/gl/scene.h"
#include "server/worker/gl/settle.h"
#include "server/worker/technique/radiosity/hemicube_job.h"
#include "server/worker/trace/trace.h"

// Faces are drawn part by part of their layers, each of which has a viewport: the top, the lower halves, the upper ones.
// Programs that choose a viewport themselves would draw all at once, but software drivers copy each corner of each triangle
// for them.
static uint32_t part_of(uint32_t face)
{
	return face == 0 ? 0 : 2 - face % 2;
}

static void set_part(const struct hemicube *h, uint32_t part)
{
	const GLint n = (GLint)h->options.pixels;
	glViewport(0, part == 2 ? n / 2 : 0, n, part == 0 ? n : n / 2);
}

static void set_sizes(const struct hemicube *h)
{
	glUniform3ui(HEMICUBE_SIZES, h->options.pixels, h->elements->count, h->list_most);
}

static void bind_texels(const struct hemicube *h, unsigned unit, unsigned texture, uint64_t texels)
{
	gl_shape(h->device, (uint64_t)unit << 1 | ((texels & (texels - 1)) == 0));
	glBindTextureUnit(unit, texture);
}

// Before a program in use runs with what is bound.
static enum status ask(const struct hemicube *h, const struct gl_program *program, struct error *err)
{
	bool warm;
	return gl_program_ask(h->device, program, &warm, err);
}

// Put the program of clusters with masks or without into use.
static enum status use(const struct hemicube *h, uint32_t level, bool cut, struct gl_program **program, struct error *err)
{
	*program = level > 0 ? h->draw_mirrored[cut] : h->draw[cut];
	gl_program_use(h->device, *program);
	bind_texels(h, UNIT_HEMICUBE_CELLS, h->cell_texels, (uint64_t)h->cells_most * HEMICUBE_CELL_TEXELS);
	if (level > 0)
		gl_texture_bind(&h->levels[level - 1].found, UNIT_HEMICUBE_PARENTS);
	const enum status s = ask(h, *program, err);
	if (s != STATUS_OK)
		return s;
	set_sizes(h);
	glUniform1f(HEMICUBE_NEAR, h->near);
	return s;
}

// Draw what is in the lists, and empty them.
static enum status draw_lists(struct hemicube *h, uint32_t level, struct error *err)
{
	enum status s = STATUS_OK;
	gl_buffer_write(&h->listed, 0, h->listed_count * sizeof *h->host_listed, h->host_listed);
	glBindBuffer(GL_DRAW_INDIRECT_BUFFER, h->draws.name);
	for (uint32_t i = 0; s == STATUS_OK && i < HEMICUBE_LISTS; i++) {
		struct hemicube_list *list = &h->lists_of_draws[i];
		const uint64_t first = i * sizeof list->draws;
		struct gl_program *program;
		if (list->count == 0)
			continue;
		s = use(h, level, i >= HEMICUBE_PARTS, &program, err);
		if (s != STATUS_OK)
			break;
		gl_buffer_write(&h->draws, first, list->count * sizeof *list->draws, list->draws);
		set_part(h, i % HEMICUBE_PARTS);
		glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, (const void *)(uintptr_t)first,
					    (GLsizei)list->count, 0);
		gl_program_has_run(h->device, program);
		list->count = 0;
	}
	h->listed_count = 0;
	glBindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
	return s;
}

// End a draw that began with index `first`.
static void list_draw(struct hemicube *h, uint32_t first, uint32_t instance, uint32_t list)
{
	struct hemicube_list *l = &h->lists_of_draws[list];
	if (h->listed_count > first)
		l->draws[l->count++] = (struct hemicube_draw){
		    .corners = h->listed_count - first, .instances = 1, .first = first, .first_instance = instance};
}

// List what a face of a cell sees of clusters with masks or without. Where it does not fit, the lists are drawn before.
static enum status list_face(struct hemicube *h, uint32_t level, uint32_t cell, uint32_t face, bool cut, uint32_t seen,
			     struct error *err)
{
	const uint32_t list = part_of(face) + (cut ? HEMICUBE_PARTS : 0);
	uint32_t first = h->listed_count;
	enum status s = STATUS_OK;
	for (uint32_t k = 0; s == STATUS_OK && k < seen; k++) {
		const struct hemicube_cluster *c = &h->clusters.list[h->host_seen[k].cluster];
		const uint32_t corners = 3 * (c->end - c->first);
		if (!(h->host_seen[k].faces >> face & 1) || c->cut != cut)
			continue;
		if (corners > h->listed_most - h->listed_count) {
			list_draw(h, first, 8 * cell + face, list);
			s = draw_lists(h, level, err);
			first = 0;
		}
		memcpy(h->host_listed + h->listed_count, h->host_indices + 3 * c->first, corners * sizeof *h->host_listed);
		h->listed_count += corners;
	}
	list_draw(h, first, 8 * cell + face, list);
	return s;
}

// Clusters for a look that is only to run the programs: one without masks and one with, if there are such.
static uint32_t one_of_each(const struct hemicube *h)
{
	uint32_t count = 0;
	bool has[2] = {false, false};
	for (uint32_t i = 0; i < h->clusters.counts[0]; i++) {
		const bool cut = h->clusters.list[i].cut;
		if (!has[cut])
			h->host_seen[count++] = (struct hemicube_seen){.cluster = i, .faces = HEMICUBE_ALL_FACES};
		has[cut] = true;
	}
	return count;
}

// Draw what the faces of a level may see.
static enum status draw_all(struct hemicube *h, uint32_t level, struct error *err)
{
	const struct hemicube_level *l = &h->levels[level];
	enum status s = STATUS_OK;
	for (uint32_t i = 0; s == STATUS_OK && i < l->count; i++) {
		const struct hemicube_view *v = &l->views[i];
		const uint32_t seen =
		    h->compiled ? hemicube_clusters_find(&h->clusters, &v->origin, h->options.pixels, v->faces, h->host_seen)
				: one_of_each(h);
		for (uint32_t face = 0; s == STATUS_OK && face < HEMICUBE_FACES; face++)
			for (int cut = 0; s == STATUS_OK && cut < 2; cut++)
				if (h->draw[cut])
					s = list_face(h, level, i, face, cut, seen, err);
	}
	return s == STATUS_OK ? draw_lists(h, level, err) : s;
}

static enum status bind_scene(const struct hemicube *h, uint32_t bindings, struct error *err)
{
	struct gl_scene *scene;
	const enum status s = gl_scene_get(h->scene, h->device, bindings, &scene, err);
	if (s != STATUS_OK)
		return s;
	gl_scene_bind(scene, bindings);
	gl_buffer_bind(&h->job, BIND_JOB);
	return s;
}

static enum status draw(struct hemicube *h, uint32_t level, struct error *err)
{
	static const GLuint nothing[4] = {0};
	static const GLfloat far = 0;
	enum status s = h->draw[1] ? bind_scene(h, h->bindings, err) : STATUS_OK;
	if (s != STATUS_OK)
		return s;
	gl_buffer_bind(&h->cells, BIND_HEMICUBE_CELLS);
	glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
	glBindFramebuffer(GL_FRAMEBUFFER, h->target.framebuffer);
	glBindVertexArray(h->vertex_array);
	glClearBufferuiv(GL_COLOR, 0, nothing);
	glClearBufferfv(GL_DEPTH, 0, &far);
	s = draw_all(h, level, err);
	glBindFramebuffer(GL_FRAMEBUFFER, 0);
	glBindVertexArray(0);
	return s;
}

static uint32_t groups_of(uint32_t items)
{
	return (items + HEMICUBE_LANES - 1) / HEMICUBE_LANES;
}

// What passes over pixels read and write.
static void bind_pixels(const struct hemicube *h)
{
	gl_texture_bind(&h->target.ids, UNIT_HEMICUBE_IDS);
	bind_texels(h, UNIT_HEMICUBE_TRIANGLES, h->corner_texels, 3ull * h->triangle_count);
	gl_buffer_bind(&h->faces, BIND_RADIOSITY_FACES);
	gl_buffer_bind(&h->cells, BIND_HEMICUBE_CELLS);
	gl_buffer_bind(&h->dense, BIND_HEMICUBE_DENSE);
	gl_buffer_bind(&h->rows, BIND_HEMICUBE_ROWS);
	gl_buffer_bind(&h->lists, BIND_HEMICUBE_LISTS);
	if (h->planes.count > 0)
		gl_buffer_bind(&h->mirrors, BIND_HEMICUBE_MIRRORS);
}

// What portals add to that.
static void bind_portals(const struct hemicube *h, uint32_t level)
{
	const bool goes_on = level < h->options.bounces;
	const uint32_t before = level > 0 ? level - 1 : 0;
	glUniform1ui(HEMICUBE_PLANES, h->seen_words);
	gl_buffer_bind(&h->seen, BIND_HEMICUBE_SEEN);
	if (goes_on)
		gl_buffer_clear(&h->seen);
	// Without mirrors on the way nothing reads the texture, and behind the last nothing writes the image.
	gl_texture_bind(&h->levels[before].found, UNIT_HEMICUBE_PARENTS);
	gl_texture_bind_image(&h->levels[goes_on ? level : before].found, IMAGE_HEMICUBE_FOUND, 0, GL_WRITE_ONLY);
}

static enum status sum(const struct hemicube *h, uint32_t level, struct error *err)
{
	static const struct hemicube_pixels nothing = {.groups = {0, 1, 1}};
	const uint32_t n = h->options.pixels, count = h->levels[level].count;
	gl_settle(h->device);
	gl_program_use(h->device, h->sum);
	bind_pixels(h);
	bind_texels(h, UNIT_HEMICUBE_TABLE, h->table_texels, hemicube_table_entries(n));
	if (hemicube_has_portals(h))
		bind_portals(h, level);
	if (hemicube_has_rays(h)) {
		gl_buffer_write(&h->pixels, 0, sizeof nothing, &nothing);
		gl_buffer_bind(&h->pixels, BIND_HEMICUBE_PIXELS);
	}
	const enum status s = ask(h, h->sum, err);
	if (s != STATUS_OK)
		return s;
	set_sizes(h);
	if (h->planes.count > 0)
		glUniform2ui(HEMICUBE_BOUNCES, level, h->options.bounces);
	glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
	glDispatchCompute(groups_of((3 * n * n + HEMICUBE_RUN - 1) / HEMICUBE_RUN), count, 1);
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
	gl_program_has_run(h->device, h->sum);
	return STATUS_OK;
}

// Follow the rays that the sum has left.
static enum status follow(const struct hemicube *h, struct error *err)
{
	gl_settle(h->device);
	gl_program_use(h->device, h->rays);
	enum status s = bind_scene(h, h->bindings | TRACE_BINDINGS, err);
	if (s != STATUS_OK)
		return s;
	bind_pixels(h);
	gl_buffer_bind(&h->pixels, BIND_HEMICUBE_PIXELS);
	s = ask(h, h->rays, err);
	if (s != STATUS_OK)
		return s;
	set_sizes(h);
	glUniform2ui(HEMICUBE_BOUNCES, 0, h->options.bounces);
	glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, h->pixels.name);
	glMemoryBarrier(GL_COMMAND_BARRIER_BIT);
	glDispatchComputeIndirect(0);
	glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, 0);
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
	gl_program_has_run(h->device, h->rays);
	return STATUS_OK;
}

// A cell as shaders see it. What is behind its mirror's plane, or in it but for rounding, is not drawn.
static void fill_cell(const struct hemicube *h, const struct hemicube_view *v, struct hemicube_cell *cell)
{
	*cell = (struct hemicube_cell){.row = v->row, .parent = v->parent, .plane = v->plane};
	for (int c = 0; c < 3; c++) {
		cell->eye[c] = (float)v->origin.at[c];
		cell->x[c] = (float)v->origin.x[c];
		cell->y[c] = (float)v->origin.y[c];
		cell->z[c] = (float)v->origin.z[c];
	}
	if (v->plane == 0)
		return;
	const struct hemicube_plane *p = &h->planes.list[v->plane - 1];
	const double high = vec3_dot(p->normal, v->origin.at) - p->offset, side = high > 0 ? -1 : 1;
	double away = 0;
	for (int c = 0; c < 3; c++) {
		cell->clip[c] = (float)(side * p->normal[c]);
		away += (p->at[c] - v->origin.at[c]) * (p->at[c] - v->origin.at[c]);
	}
	cell->clip[3] = (float)(-fabs(high) - p->error - HEMICUBE_TILT_ERROR * (p->radius + sqrt(away)));
}

enum status hemicube_pass(struct hemicube *h, uint32_t level, struct error *err)
{
	const struct hemicube_level *l = &h->levels[level];
	for (uint32_t i = 0; i < l->count; i++)
		fill_cell(h, &l->views[i], &h->host_cells[i]);
	gl_buffer_write(&h->cells, 0, l->count * sizeof *h->host_cells, h->host_cells);
	enum status s = draw(h, level, err);
	if (s == STATUS_OK)
		s = sum(h, level, err);
	return s == STATUS_OK && hemicube_has_rays(h) ? follow(h, err) : s;
}

enum status hemicube_pack(const struct hemicube *h, uint32_t count, struct error *err)
{
	gl_program_use(h->device, h->pack);
	const enum status s = ask(h, h->pack, err);
	if (s != STATUS_OK)
		return s;
	set_sizes(h);
	gl_buffer_bind(&h->dense, BIND_HEMICUBE_DENSE);
	gl_buffer_bind(&h->rows, BIND_HEMICUBE_ROWS);
	gl_buffer_bind(&h->lists, BIND_HEMICUBE_LISTS);
	gl_buffer_bind(&h->entries, BIND_HEMICUBE_ENTRIES);
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
	glDispatchCompute(count, 1, 1);
	gl_program_has_run(h->device, h->pack);
	return STATUS_OK;
}
