#include "server/worker/technique/common/sky_map.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"

static const float pi = (float)PI;
#define CELLS ((uint32_t)SKY_CONES_WIDTH * SKY_CONES_HEIGHT)

static const char kind; // its address is sky_map's kind of struct derived

// A cell of a coarse version of the picture: a direction with its solid angle and mean radiance.
struct cell {
	float direction[3];
	float solid; // sr
	float radiance[3];
};

static void sky_map_destroy(struct derived *derived)
{
	struct sky_map *m = (struct sky_map *)derived;
	gl_texture_finish(&m->picture, m->device);
	gl_texture_finish(&m->cones, m->device);
	free(m);
}

static uint64_t sky_map_idle_bytes(const struct derived *derived)
{
	const struct sky_map *m = (const struct sky_map *)derived;
	return m->picture.bytes + m->cones.bytes;
}

static void place_cell(struct cell *c, uint32_t x, uint32_t y)
{
	const float longitude = ((float)x + 0.5f) / SKY_CONES_WIDTH * 2 * pi - pi;
	const float polar = ((float)y + 0.5f) / SKY_CONES_HEIGHT * pi;
	c->direction[0] = sinf(polar) * sinf(longitude);
	c->direction[1] = cosf(polar);
	c->direction[2] = -sinf(polar) * cosf(longitude);
	c->solid = 2 * pi / SKY_CONES_WIDTH * 2 * sinf(polar) * sinf(0.5f * pi / SKY_CONES_HEIGHT);
}

static uint32_t at_most(float value, uint32_t most)
{
	return value <= 0 ? 0 : value >= (float)most ? most : (uint32_t)value;
}

// For a picture coarser than the cells: look it up bilinearly in the middle of each cell.
static void look_up(const struct environment_texel *t, uint32_t w, uint32_t h, uint32_t x, uint32_t y, float out[3])
{
	const float u = ((float)x + 0.5f) / SKY_CONES_WIDTH * (float)w - 0.5f;
	const float v = ((float)y + 0.5f) / SKY_CONES_HEIGHT * (float)h - 0.5f;
	const float part_u = u - floorf(u), part_v = v - floorf(v);
	const uint32_t x0 = u < 0 ? w - 1 : at_most(u, w - 1), x1 = x0 + 1 < w ? x0 + 1 : 0;
	const uint32_t y0 = at_most(v, h - 1), y1 = at_most(floorf(v) + 1, h - 1);
	for (int c = 0; c < 3; c++) {
		const float above =
		    t[(size_t)y0 * w + x0].radiance[c] * (1 - part_u) + t[(size_t)y0 * w + x1].radiance[c] * part_u;
		const float below =
		    t[(size_t)y1 * w + x0].radiance[c] * (1 - part_u) + t[(size_t)y1 * w + x1].radiance[c] * part_u;
		out[c] = above * (1 - part_v) + below * part_v;
	}
}

// For a finer one: each cell is the mean, by solid angle, of the texels whose middles are in it. So no small sun is lost.
static void add_up(const struct environment_texel *t, uint32_t w, uint32_t h, struct cell *cells)
{
	double(*sums)[4] = calloc(CELLS, sizeof *sums);
	if (!sums)
		return;
	for (uint32_t y = 0; y < h; y++) {
		const double weight = sin((y + 0.5) * (double)pi / h);
		double(*row)[4] = sums + (size_t)((uint64_t)y * SKY_CONES_HEIGHT / h) * SKY_CONES_WIDTH;
		for (uint32_t x = 0; x < w; x++) {
			double *sum = row[(uint64_t)x * SKY_CONES_WIDTH / w];
			for (int c = 0; c < 3; c++)
				sum[c] += weight * (double)t[(size_t)y * w + x].radiance[c];
			sum[3] += weight;
		}
	}
	for (uint32_t i = 0; i < CELLS; i++)
		for (int c = 0; c < 3; c++)
			cells[i].radiance[c] = (float)(sums[i][c] / sums[i][3]);
	free(sums);
}

static void fill_cells(const struct resident_scene *picture, struct cell *cells)
{
	const struct environment_texel *t = scene_section(picture, BLOB_ENVIRONMENT);
	const uint32_t w = picture->blob->environment_width, h = picture->blob->environment_height;
	const bool fine = w >= SKY_CONES_WIDTH && h >= SKY_CONES_HEIGHT;
	for (uint32_t y = 0; y < SKY_CONES_HEIGHT; y++)
		for (uint32_t x = 0; x < SKY_CONES_WIDTH; x++) {
			struct cell *c = &cells[y * SKY_CONES_WIDTH + x];
			place_cell(c, x, y);
			if (!fine)
				look_up(t, w, h, x, y, c->radiance);
		}
	if (fine)
		add_up(t, w, h, cells);
}

// The mean radiance over the cone about `middle`. The cone's edge is as soft as a cell is wide, so that cells do not show.
static void see(const struct cell *cells, const float middle[3], float half, float out[4])
{
	const float soft = 0.5f * pi / SKY_CONES_HEIGHT;
	const float outer = cosf(half + soft), inner = cosf(fmaxf(half - soft, 0));
	float sum[3] = {0, 0, 0}, solid = 0;
	for (uint32_t i = 0; i < CELLS; i++) {
		const struct cell *c = &cells[i];
		const float cosine = c->direction[0] * middle[0] + c->direction[1] * middle[1] + c->direction[2] * middle[2];
		if (cosine <= outer)
			continue;
		const float weight = c->solid * fminf((cosine - outer) / (inner - outer), 1);
		for (int k = 0; k < 3; k++)
			sum[k] += weight * c->radiance[k];
		solid += weight;
	}
	for (int k = 0; k < 3; k++)
		out[k] = sum[k] / solid;
	out[3] = 1;
}

static float *make_cones(const struct resident_scene *picture, float *most)
{
	struct cell *cells = calloc(CELLS, sizeof *cells);
	float(*out)[4] = calloc((size_t)CELLS * SKY_CONES_LAYERS, sizeof *out);
	*most = 0;
	if (cells && out)
		fill_cells(picture, cells);
	for (uint32_t layer = 0; cells && out && layer < SKY_CONES_LAYERS; layer++)
		for (uint32_t i = 0; i < CELLS; i++) {
			float *seen = out[layer * CELLS + i];
			see(cells, cells[i].direction, atanf(SKY_TANGENT_LEAST * (float)(1u << layer)), seen);
			*most = fmaxf(*most, fmaxf(seen[0], fmaxf(seen[1], seen[2])));
		}
	if (!cells) {
		free(out);
		out = NULL;
	}
	free(cells);
	return out ? &out[0][0] : NULL;
}

static void wrap(const struct gl_texture *t)
{
	gl_texture_linear(t, false);
	glTextureParameteri(t->name, GL_TEXTURE_WRAP_S, GL_REPEAT);
}

static enum status sky_map_upload(struct sky_map *m, const struct resident_scene *picture, const float *cones,
				  struct error *err)
{
	const struct gl_texture_desc whole = {.target = GL_TEXTURE_2D,
					      .format = GL_RGBA32F,
					      .width = picture->blob->environment_width,
					      .height = picture->blob->environment_height,
					      .depth = 1,
					      .levels = 1};
	const struct gl_texture_desc seen = {.target = GL_TEXTURE_2D_ARRAY,
					     .format = GL_RGBA32F,
					     .width = SKY_CONES_WIDTH,
					     .height = SKY_CONES_HEIGHT,
					     .depth = SKY_CONES_LAYERS,
					     .levels = 1};
	enum status s = gl_texture_init(&m->picture, m->device, &whole, err);
	if (s == STATUS_OK)
		s = gl_texture_init(&m->cones, m->device, &seen, err);
	if (s != STATUS_OK)
		return s;
	wrap(&m->picture);
	wrap(&m->cones);
	glTextureSubImage2D(m->picture.name, 0, 0, 0, (GLsizei)whole.width, (GLsizei)whole.height, GL_RGBA, GL_FLOAT,
			    scene_section(picture, BLOB_ENVIRONMENT));
	glTextureSubImage3D(m->cones.name, 0, 0, 0, 0, SKY_CONES_WIDTH, SKY_CONES_HEIGHT, SKY_CONES_LAYERS, GL_RGBA,
			    GL_FLOAT, cones);
	return gl_check(m->device, "uploading a picture of the surroundings", err);
}

enum status sky_map_get(struct resident_scene *picture, struct gl_device *device, const struct sky_map **map,
			struct error *err)
{
	struct sky_map *m = (struct sky_map *)resident_derived(picture, &kind);
	*map = m;
	if (m)
		return STATUS_OK;
	m = calloc(1, sizeof *m);
	float *cones = m ? make_cones(picture, &m->most) : NULL;
	if (!cones) {
		free(m);
		return error_set(err, STATUS_MEMORY, "out of memory");
	}
	m->derived = (struct derived){.kind = &kind, .destroy = sky_map_destroy, .bytes = sky_map_idle_bytes};
	m->device = device;
	enum status s = sky_map_upload(m, picture, cones, err);
	free(cones);
	if (s != STATUS_OK) {
		sky_map_destroy(&m->derived);
		return s;
	}
	resident_derive(picture, &m->derived);
	*map = m;
	return STATUS_OK;
}

void sky_map_bind(const struct sky_map *m)
{
	gl_texture_bind(&m->picture, SKY_PICTURE_UNIT);
	gl_texture_bind(&m->cones, SKY_CONES_UNIT);
}
