#include "server/worker/technique/pt/pt_sky.h"

#include <stdlib.h>

static const char kind; // its address is pt_sky's kind of struct derived

static void pt_sky_destroy(struct derived *derived)
{
	struct pt_sky *s = (struct pt_sky *)derived;
	buffer_finish(&s->texels, s->device);
	buffer_finish(&s->rows, s->device);
	free(s);
}

static uint64_t pt_sky_idle_bytes(const struct derived *derived)
{
	const struct pt_sky *s = (const struct pt_sky *)derived;
	return s->texels.allocated + s->rows.allocated;
}

static enum status pt_sky_upload(struct resident_scene *picture, enum blob_section section, struct device *device,
				 struct buffer *buffer, struct error *err)
{
	const uint64_t bytes = (uint64_t)scene_count(picture, section) * blob_stride(section);
	return buffer_init_with(buffer, device, scene_section(picture, section), bytes, err);
}

enum status pt_sky_get(struct resident_scene *picture, struct device *device, const struct pt_sky **sky, struct error *err)
{
	struct pt_sky *s = (struct pt_sky *)resident_derived(picture, &kind);
	*sky = s;
	if (s)
		return STATUS_OK;
	s = calloc(1, sizeof *s);
	if (!s)
		return error_set(err, STATUS_MEMORY, "out of memory");
	s->derived = (struct derived){.kind = &kind, .destroy = pt_sky_destroy, .bytes = pt_sky_idle_bytes};
	s->device = device;
	enum status status = pt_sky_upload(picture, BLOB_ENVIRONMENT, device, &s->texels, err);
	if (status == STATUS_OK)
		status = pt_sky_upload(picture, BLOB_ENVIRONMENT_ROWS, device, &s->rows, err);
	if (status != STATUS_OK) {
		pt_sky_destroy(&s->derived);
		return status;
	}
	resident_derive(picture, &s->derived);
	*sky = s;
	return STATUS_OK;
}
