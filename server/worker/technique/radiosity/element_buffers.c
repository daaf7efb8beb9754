#include "server/worker/technique/radiosity/element_buffers.h"

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
