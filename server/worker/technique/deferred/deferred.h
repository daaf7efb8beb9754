// What the image techniques on OpenGL share: which triangle each pixel sees, by raster; shading passes over the pixels,
// given by the technique; sums over samples; the AOVs; slices.
//
// A sample is: the visibility pass (every triangle drawn, its ids kept), the technique's passes one after the other, each
// over all pixels, and their sum added to the picture's. The passes of one sample see one jittered ray a pixel: through the
// pixel's middle if the picture has one sample. Pictures of more pixels than the device binds are made in bands of rows,
// each with TILE_SIDE rows more on either side for what passes read of pixels near by, so that where a band ends shows in no
// bit. A technique's struct technique_job holds a struct deferred and hands its calls on. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_DEFERRED_H
#define CANDIL_WORKER_TECHNIQUE_DEFERRED_H

#include "server/worker/devices.h"
#include "server/worker/gl/program.h"
#include "server/worker/gl/texture.h"
#include "server/worker/gl/timer.h"
#include "server/worker/image/frame.h"
#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/technique.h"

#define DEFERRED_PASSES_MAX 8u

// Rows of the image that are worked on at once.
struct deferred_area {
	uint32_t width; // pixels
	uint32_t first_row, rows;
	uint32_t sample; // its number in the job, from 0
};

// A shading pass: a compute shader over tiles, as deferred/pixel.glsl describes.
struct deferred_pass {
	const struct gl_source *source;
	struct gl_defines defines; // the effects are added to them
	const char *stage; // under which its time is told; a literal
	// Bind what the shader needs beside the scene, the job and shared/deferred.h's. Called before every dispatch, with
	// the program in use; other jobs may have bound anything in between. NULL: nothing.
	void (*bind)(void *user, const struct deferred_area *area);
	void *user;
};

struct deferred;

// Device memory of a job of this plan, in bytes, without its scene. `rows` of pixels are worked on at once; 0: as many as
// the device binds.
uint64_t deferred_bytes(const struct devices *devices, const struct plan *plan, uint32_t rows);

// Everything a job needs on the device: scene upload (what `bindings` name beside what shading by the plan needs), textures,
// programs compiled and run once over nothing. Passes are copied. On failure nothing is left.
enum status deferred_create(struct devices *devices, struct resident_scene *scene, const struct plan *plan, uint32_t rows,
			    uint32_t bindings, const struct deferred_pass *passes, uint32_t pass_count,
			    struct deferred **deferred, struct error *err);
void deferred_destroy(struct deferred *deferred); // NULL is allowed

// As struct technique's.
enum status deferred_step(struct deferred *deferred, uint32_t budget_us, struct step_result *result, struct error *err);
enum status deferred_read(struct deferred *deferred, struct frame **frame, struct error *err);

// The most rows that a pass works on at once: for a technique's own textures of a value a pixel.
uint32_t deferred_band_rows(const struct gl_device *device, const struct plan *plan, uint32_t rows);

// struct technique's: a pinhole and one direction a light are all that these techniques have.
void deferred_notes(const struct resident_scene *scene, const struct plan *plan, candil_Accepted *accepted);

// For a technique's own passes before the first sample; told by deferred_read with the rest.
struct gl_timer *deferred_timer(struct deferred *deferred);

// Host time of work before the first sample to tell as "upload" and "compile".
void deferred_add_setup(struct deferred *deferred, uint64_t upload_us, uint64_t compile_us);

#endif
