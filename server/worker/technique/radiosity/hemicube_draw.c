// The passes of hemicubes.
#include <epoxy/gl.h>
#include <math.h>

#include "server/base/vec3.h"
#include "server/worker/gl/scene.h"
#include "server/worker/gl/settle.h"
#include "server/worker/technique/radiosity/hemicube_job.h"
#include "server/worker/trace/trace.h"

static void set_raster(const struct hemicube *h)
{
	const float n = (float)h->options.pixels;
	GLfloat ports[4 * HEMICUBE_FACES * HEMICUBE_ABREAST_MOST];
	const struct {
		float x, y, high;
	} faces[HEMICUBE_FACES] = {{0, 0, n}, {n, 0, n / 2}, {n, n / 2, n / 2}, {0, n, n / 2}, {n, n, n / 2}};
	for (uint32_t i = 0; i < h->abreast * HEMICUBE_FACES; i++) {
		ports[4 * i] = (float)(i / HEMICUBE_FACES) * 2 * n + faces[i % HEMICUBE_FACES].x;
		ports[4 * i + 1] = faces[i % HEMICUBE_FACES].y;
		ports[4 * i + 2] = n;
		ports[4 * i + 3] = faces[i % HEMICUBE_FACES].high;
	}
	glBindFramebuffer(GL_FRAMEBUFFER, h->target.framebuffer);
	glViewportArrayv(0, (GLsizei)(h->abreast * HEMICUBE_FACES), ports);
	glBindVertexArray(h->vertex_array);
}

static void set_sizes(const struct hemicube *h)
{
	glUniform4ui(HEMICUBE_SIZES, h->options.pixels, h->abreast, h->elements->count, h->list_most);
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
	if (level > 0)
		gl_texture_bind(&h->levels[level - 1].found, UNIT_HEMICUBE_PARENTS);
	const enum status s = ask(h, *program, err);
	if (s != STATUS_OK)
		return s;
	set_sizes(h);
	glUniform1f(HEMICUBE_NEAR, h->near);
	return s;
}

static enum status draw_clusters(const struct hemicube *h, uint32_t level, const struct hemicube_draw *draws, uint32_t count,
				 struct error *err)
{
	struct gl_program *program = NULL;
	for (uint32_t i = 0; i < count; i++) {
		const struct hemicube_draw *d = &draws[i];
		const struct hemicube_cluster *c = &h->clusters[d->cluster];
		const GLsizei corners = (GLsizei)(3 * (c->end - c->first));
		if (i == 0 || c->cut != h->clusters[draws[i - 1].cluster].cut) {
			const enum status s = use(h, level, c->cut, &program, err);
			if (s != STATUS_OK)
				return s;
		}
		glUniform2ui(HEMICUBE_DRAW, c->first, d->first);
		if (c->cut)
			glDrawArraysInstanced(GL_TRIANGLES, (GLint)(3 * c->first), corners, (GLsizei)d->count);
		else
			glDrawElementsInstanced(GL_TRIANGLES, corners, GL_UNSIGNED_INT,
						(const void *)(3 * sizeof(uint32_t) * (uintptr_t)c->first),
						(GLsizei)d->count);
		gl_program_has_run(h->device, program);
	}
	return STATUS_OK;
}

// Which faces of a cell a sphere may be seen by: bits. Each side plane of a face's pyramid is at 45 degrees, and the sphere
// is out of it where its middle is farther than its radius behind one. `slack` covers the rounding of what is drawn.
static uint32_t faces_of(const struct hemicube_view *v, const struct hemicube_cluster *c)
{
	double p[3], size = c->radius;
	for (int a = 0; a < 3; a++) {
		p[a] = c->at[a] - v->origin.at[a];
		size += fabs(p[a]) + fabs(c->at[a]);
	}
	const double x = vec3_dot(p, v->origin.x), y = vec3_dot(p, v->origin.y), z = vec3_dot(p, v->origin.z);
	const double slack = 1e-5 * size, reach = 1.4142135623730951 * (c->radius + slack), low = c->radius + slack;
	uint32_t faces = 0;
	if (z < -low)
		return 0;
	faces |= z + reach >= fabs(x) && z + reach >= fabs(y) ? 1u : 0u;
	faces |= x + reach >= fabs(y) && x + reach >= z ? 2u : 0u;
	faces |= reach - x >= fabs(y) && reach - x >= z ? 4u : 0u;
	faces |= y + reach >= fabs(x) && y + reach >= z ? 8u : 0u;
	faces |= reach - y >= fabs(x) && reach - y >= z ? 16u : 0u;
	return faces & v->faces;
}

// Draw what the faces of a level may see. Where they do not fit the buffer, it is drawn in parts.
static enum status draw_all(struct hemicube *h, uint32_t level, struct error *err)
{
	const struct hemicube_level *l = &h->levels[level];
	uint32_t draws = 0, used = 0;
	enum status s = STATUS_OK;
	for (uint32_t k = 0; s == STATUS_OK && k < h->cluster_count; k++) {
		struct hemicube_draw *d = &h->host_draws[draws];
		*d = (struct hemicube_draw){.cluster = k, .first = used};
		for (uint32_t i = 0; i < l->count; i++) {
			const uint32_t faces = faces_of(&l->views[i], &h->clusters[k]);
			for (uint32_t face = 0; faces >> face; face++)
				if (faces >> face & 1)
					h->host_faces[used++] = 8 * i + face;
		}
		d->count = used - d->first;
		draws += d->count > 0;
		// The next cluster may be seen by all faces.
		if (k + 1 < h->cluster_count && h->instances_most - used >= HEMICUBE_FACES * l->count)
			continue;
		if (draws > 0) {
			gl_buffer_write(&h->instances, 0, used * sizeof *h->host_faces, h->host_faces);
			s = draw_clusters(h, level, h->host_draws, draws, err);
		}
		draws = used = 0;
	}
	return s;
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
	gl_buffer_bind(&h->instances, BIND_HEMICUBE_INSTANCES);
	glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
	set_raster(h);
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

static void bind_texels(const struct hemicube *h, unsigned unit, unsigned texture, uint64_t texels)
{
	gl_shape(h->device, (uint64_t)unit << 1 | ((texels & (texels - 1)) == 0));
	glBindTextureUnit(unit, texture);
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
