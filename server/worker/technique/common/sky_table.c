#include "server/worker/technique/common/sky_table.h"

#include <epoxy/gl.h>
#include <stdlib.h>

static const char kind; // its address is sky_table's kind of struct derived

static void sky_table_destroy(struct derived *derived)
{
	struct sky_table *s = (struct sky_table *)derived;
	gl_texels_finish(&s->rows);
	free(s);
}

static uint64_t sky_table_idle_bytes(const struct derived *derived)
{
	return ((const struct sky_table *)derived)->rows.buffer.bytes;
}

enum status sky_table_get(struct resident_scene *picture, struct gl_device *device, const struct sky_table **sky,
			  struct error *err)
{
	struct sky_table *s = (struct sky_table *)resident_derived(picture, &kind);
	*sky = s;
	if (s)
		return STATUS_OK;
	s = calloc(1, sizeof *s);
	if (!s)
		return error_set(err, STATUS_MEMORY, "out of memory");
	s->derived = (struct derived){.kind = &kind, .destroy = sky_table_destroy, .bytes = sky_table_idle_bytes};
	const uint64_t words = (uint64_t)scene_count(picture, BLOB_ENVIRONMENT_ROWS) * 2;
	const void *rows = scene_section(picture, BLOB_ENVIRONMENT_ROWS);
	const enum status status = gl_texels_init(&s->rows, device, GL_R32UI, words, rows, err);
	if (status != STATUS_OK) {
		free(s);
		return status;
	}
	resident_derive(picture, &s->derived);
	*sky = s;
	return STATUS_OK;
}
