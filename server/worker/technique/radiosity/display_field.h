// What is known of elements, on OpenGL, where shaders look it up by a place on a triangle (shaders/radiosity/lookup.glsl).
// It knows no camera: it stays with a solution, and pictures share it. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_DISPLAY_FIELD_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_DISPLAY_FIELD_H

#include "server/worker/gl/texels.h"
#include "server/worker/technique/radiosity/elements.h"

// A field; zeroed: none. May be moved by copying the struct.
struct display_field {
	struct gl_texels faces, triangles, values;
	uint32_t patches;
};

// Floats of an element: its value has three; or each of its four corners has (corners.h), between which light is
// interpolated.
static inline uint32_t display_field_floats(bool corners)
{
	return corners ? 12 : 3;
}

// Upload. `values`: display_field_floats for each element. STATUS_MEMORY, STATUS_DEVICE; *field is zeroed then.
enum status display_field_init(struct display_field *field, struct gl_device *device, const struct elements *elements,
			       const float *values, bool corners, struct error *err);

// Free it. A zeroed one is fine.
void display_field_finish(struct display_field *field);

// Bind it for the program in use.
void display_field_bind(const struct display_field *field);

// Device memory of one, in bytes.
uint64_t display_field_bytes(uint32_t faces, uint32_t triangles, uint32_t patches, bool corners);

#endif
