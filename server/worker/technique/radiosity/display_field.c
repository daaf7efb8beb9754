#include "server/worker/technique/radiosity/display_field.h"

#include <epoxy/gl.h>

#include "shaders/shared/radiosity_show.h"

_Static_assert(sizeof(struct radiosity_face) == RADIOSITY_FACE_WORDS * sizeof(uint32_t), "shaders fetch it by words");

enum status display_field_init(struct display_field *f, struct gl_device *device, const struct elements *e,
			       const float *values, bool corners, struct error *err)
{
	*f = (struct display_field){.patches = e->patches.count};
	const uint64_t faces = (uint64_t)e->patches.faces.count * RADIOSITY_FACE_WORDS;
	const uint64_t floats = (uint64_t)e->count * display_field_floats(corners);
	enum status s = gl_texels_init(&f->faces, device, GL_R32UI, faces, e->faces, err);
	if (s == STATUS_OK)
		s = gl_texels_init(&f->triangles, device, GL_R32UI, e->triangle_count, e->triangles, err);
	if (s == STATUS_OK)
		s = gl_texels_init(&f->values, device, corners ? GL_RGBA32F : GL_R32F, floats, values, err);
	if (s != STATUS_OK)
		display_field_finish(f);
	return s;
}

void display_field_finish(struct display_field *f)
{
	gl_texels_finish(&f->faces);
	gl_texels_finish(&f->triangles);
	gl_texels_finish(&f->values);
	*f = (struct display_field){0};
}

void display_field_bind(const struct display_field *f)
{
	gl_texels_bind(&f->faces, RADIOSITY_FACES_UNIT);
	gl_texels_bind(&f->triangles, RADIOSITY_TRIANGLES_UNIT);
	gl_texels_bind(&f->values, RADIOSITY_VALUES_UNIT);
	glUniform1ui(RADIOSITY_PATCHES, f->patches);
}

uint64_t display_field_bytes(uint32_t faces, uint32_t triangles, uint32_t patches, bool corners)
{
	return gl_texels_bytes(GL_R32UI, (uint64_t)faces * RADIOSITY_FACE_WORDS) + gl_texels_bytes(GL_R32UI, triangles) +
	       gl_texels_bytes(corners ? GL_RGBA32F : GL_R32F, 2 * (uint64_t)patches * display_field_floats(corners));
}
