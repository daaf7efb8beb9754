#include "server/worker/technique/common/sky_texels.h"

#include <stdlib.h>

static const char kind; // its address is sky_texels' kind of struct derived

static void sky_texels_destroy(struct derived *derived)
{
	struct sky_texels *s = (struct sky_texels *)derived;
	buffer_finish(&s->texels, s->device);
	buffer_finish(&s->rows, s->device);
	free(s);
}

static uint64_t sky_texels_idle_bytes(const struct derived *derived)
{
	const struct sky_texels *s = (const struct sky_texels *)derived;
	return s->texels.allocated + s->rows.allocated;
}

static enum status sky_texels_upload(struct resident_scene *picture, enum blob_section section, struct device *device,
				     struct buffer *buffer, struct error *err)
{
	const uint64_t bytes = (uint64_t)scene_count(picture, section) * blob_stride(section);
	return buffer_init_with(buffer, device, scene_section(picture, section), bytes, err);
}

enum status sky_texels_get(struct resident_scene *picture, struct device *device, const struct sky_texels **sky,
			   struct error *err)
{
	struct sky_texels *s = (struct sky_texels *)resident_derived(picture, &kind);
	*sky = s;
	if (s)
		return STATUS_OK;
	s = calloc(1, sizeof *s);
	if (!s)
		return error_set(err, STATUS_MEMORY, "out of memory");
	s->derived = (struct derived){.kind = &kind, .destroy = sky_texels_destroy, .bytes = sky_texels_idle_bytes};
	s->device = device;
	enum status status = sky_texels_upload(picture, BLOB_ENVIRONMENT, device, &s->texels, err);
	if (status == STATUS_OK)
		status = sky_texels_upload(picture, BLOB_ENVIRONMENT_ROWS, device, &s->rows, err);
	if (status != STATUS_OK) {
		sky_texels_destroy(&s->derived);
		return status;
	}
	resident_derive(picture, &s->derived);
	*sky = s;
	return STATUS_OK;
}
