// The passes of hemicubes.
#include <epoxy/gl.h>

#include "server/worker/gl/scene.h"
#include "server/worker/technique/radiosity/hemicube_job.h"

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
	glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
	glDisable(GL_SCISSOR_TEST);
	glDisable(GL_CULL_FACE);
	glDisable(GL_STENCIL_TEST);
	glDisable(GL_RASTERIZER_DISCARD);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_GREATER);
	glDepthMask(GL_TRUE);
	glBindVertexArray(h->vertex_array);
}

// Back to the state that all other passes expect.
static void reset_raster(void)
{
	glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
	glBindFramebuffer(GL_FRAMEBUFFER, 0);
	glBindVertexArray(0);
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

static enum status draw_run(const struct hemicube *h, const struct hemicube_run *run, uint32_t count, struct error *err)
{
	const GLsizei corners = (GLsizei)(3 * (run->end - run->first));
	struct gl_program *program = h->draw[run->cut];
	gl_program_use(h->device, program);
	const enum status s = ask(h, program, err);
	if (s != STATUS_OK)
		return s;
	set_sizes(h);
	glUniform4ui(HEMICUBE_RANGE, 0, count, 0, 0);
	glUniform1f(HEMICUBE_NEAR, h->near);
	glUniform1ui(HEMICUBE_TRIANGLE, run->first);
	if (run->cut)
		glDrawArraysInstanced(GL_TRIANGLES, (GLint)(3 * run->first), corners, (GLsizei)(HEMICUBE_FACES * count));
	else
		glDrawElementsInstanced(GL_TRIANGLES, corners, GL_UNSIGNED_INT,
					(const char *)NULL + 3 * sizeof(uint32_t) * (size_t)run->first,
					(GLsizei)(HEMICUBE_FACES * count));
	gl_program_has_run(h->device, program);
	return STATUS_OK;
}

static enum status draw(const struct hemicube *h, uint32_t count, struct error *err)
{
	static const GLuint nothing[4] = {0};
	static const GLfloat far = 0;
	enum status s = STATUS_OK;
	if (h->draw[1]) {
		struct gl_scene *scene;
		s = gl_scene_get(h->scene, h->device, h->bindings, &scene, err);
		if (s != STATUS_OK)
			return s;
		gl_scene_bind(scene);
		gl_buffer_bind(&h->job, BIND_JOB);
	}
	gl_buffer_bind(&h->cells, BIND_HEMICUBE_CELLS);
	set_raster(h);
	glClearBufferuiv(GL_COLOR, 0, nothing);
	glClearBufferfv(GL_DEPTH, 0, &far);
	for (uint32_t i = 0; s == STATUS_OK && i < h->run_count; i++)
		s = draw_run(h, &h->runs[i], count, err);
	reset_raster();
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

static enum status sum(const struct hemicube *h, uint32_t count, struct error *err)
{
	const uint32_t n = h->options.pixels;
	gl_program_use(h->device, h->sum);
	gl_texture_bind(&h->target.ids, UNIT_HEMICUBE_IDS);
	bind_texels(h, UNIT_HEMICUBE_TABLE, h->table_texels, hemicube_table_entries(n));
	bind_texels(h, UNIT_HEMICUBE_TRIANGLES, h->corner_texels, 3ull * h->triangle_count);
	const enum status s = ask(h, h->sum, err);
	if (s != STATUS_OK)
		return s;
	set_sizes(h);
	glUniform4ui(HEMICUBE_RANGE, 0, count, 0, 0);
	gl_buffer_bind(&h->faces, BIND_RADIOSITY_FACES);
	gl_buffer_bind(&h->cells, BIND_HEMICUBE_CELLS);
	gl_buffer_bind(&h->dense, BIND_HEMICUBE_DENSE);
	gl_buffer_bind(&h->rows, BIND_HEMICUBE_ROWS);
	gl_buffer_bind(&h->lists, BIND_HEMICUBE_LISTS);
	glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
	glDispatchCompute(groups_of(3 * n * n), count, 1);
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
	gl_program_has_run(h->device, h->sum);
	return STATUS_OK;
}

enum status hemicube_pass(struct hemicube *h, uint32_t count, struct error *err)
{
	gl_buffer_write(&h->cells, 0, count * sizeof *h->host_cells, h->host_cells);
	const enum status s = draw(h, count, err);
	return s == STATUS_OK ? sum(h, count, err) : s;
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
