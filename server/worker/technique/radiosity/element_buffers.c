#include "server/worker/technique/radiosity/element_buffers.h"

#include <stdlib.h>

enum status element_buffers_init(struct element_buffers *b, const struct elements *e, bool surfaces, struct device *device,
				 struct error *err)
{
	*b = (struct element_buffers){0};
	enum status s = buffer_init_with(&b->faces, device, e->faces, e->patches.faces.count * sizeof *e->faces, err);
	if (s == STATUS_OK)
		s = buffer_init_with(&b->triangles, device, e->triangles, e->triangle_count * sizeof *e->triangles, err);
	if (s == STATUS_OK && e->count > 0)
		s = buffer_init(&b->patches, device, e->patches.count * sizeof *e->shapes, BUFFER_DEVICE, err);
	if (s == STATUS_OK && e->count > 0)
		s = element_buffers_send(b, e, 0, device, err);
	if (s == STATUS_OK && surfaces && e->count > 0)
		s = buffer_init(&b->surfaces, device, e->count * sizeof(struct radiosity_surface), BUFFER_DEVICE, err);
	if (s != STATUS_OK)
		element_buffers_finish(b, device);
	return s;
}

enum status element_buffers_send(struct element_buffers *b, const struct elements *e, uint32_t first, struct device *device,
				 struct error *err)
{
	const uint64_t stride = sizeof *e->shapes;
	return e->made > first
		   ? buffer_write(&b->patches, device, first * stride, (e->made - first) * stride, e->shapes + first, err)
		   : STATUS_OK;
}

// What is left by the parts that count as covered: covers_part of cover.glsl.
static float open_share(uint32_t covered)
{
	const uint32_t inside = covered & PATCH_COVER_ALL, doubtful = covered >> PATCH_COVER_PARTS & ~inside;
	uint32_t parts = 0;
	for (uint32_t part = 0; part < PATCH_COVER_PARTS; part++)
		parts += inside >> part & 1u;
	return parts == PATCH_COVER_PARTS || doubtful ? 1 : 1 - (float)parts / (float)PATCH_COVER_PARTS;
}

enum status element_buffers_areas(const struct element_buffers *b, const struct elements *e, struct device *device,
				  float **areas, struct error *err)
{
	const uint32_t count = e->patches.count;
	struct radiosity_patch *patches = malloc((count + 1ull) * sizeof *patches);
	float *area = malloc((e->count + 1ull) * sizeof *area);
	*areas = NULL;
	enum status s = patches && area ? STATUS_OK : error_set(err, STATUS_MEMORY, "out of memory");
	if (s == STATUS_OK && e->count > 0)
		s = buffer_read(&b->patches, device, 0, count * sizeof *patches, patches, err);
	for (uint32_t i = 0; s == STATUS_OK && i < e->count; i++)
		area[i] = i < count ? patches[i].area * open_share(patches[i].covered) : patches[i - count].area;
	if (s == STATUS_OK)
		*areas = area;
	else
		free(area);
	free(patches);
	return s;
}

void element_buffers_finish(struct element_buffers *b, struct device *device)
{
	buffer_finish(&b->faces, device);
	buffer_finish(&b->triangles, device);
	buffer_finish(&b->patches, device);
	buffer_finish(&b->surfaces, device);
}

void element_buffers_fill(const struct element_buffers *b, const struct buffer **of)
{
	of[BIND_RADIOSITY_FACES] = &b->faces;
	of[BIND_RADIOSITY_TRIANGLES] = &b->triangles;
	of[BIND_RADIOSITY_PATCHES] = &b->patches;
	of[BIND_RADIOSITY_SURFACES] = &b->surfaces;
}

uint64_t element_buffers_bytes(uint32_t faces, uint32_t triangles, uint32_t patches)
{
	return (uint64_t)faces * sizeof(struct radiosity_face) + (uint64_t)triangles * sizeof(uint32_t) +
	       (uint64_t)patches * (sizeof(struct radiosity_patch) + 2 * sizeof(struct radiosity_surface));
}
