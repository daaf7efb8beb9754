// The deferred renderer that image techniques on OpenGL share. It rasterises which triangle each pixel sees, runs the
// technique's shading passes over the pixels, sums their radiance over samples, makes the AOVs, and does all this in slices.
//
// One sample is the visibility pass, which draws every triangle and keeps its id; then the technique's passes, each over all
// pixels; then a pass that adds their radiance to the picture's sums. All passes of a sample see one ray a pixel, jittered,
// or through the pixel's middle if the picture has one sample. A picture of more pixels than the device can bind is made in
// bands of rows. Each band works on TILE_SIDE more rows on either side, because passes read neighbouring pixels; so the
// picture's bits do not depend on where bands end. A technique's struct technique_job holds a struct deferred and passes its
// calls on. Device's thread only.
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

// Effects of what the camera sees and of light straight from its source: for struct technique's `effects`.
#define DEFERRED_EFFECTS \
	(1u << candil_Effect_EFFECT_TEXTURES | 1u << candil_Effect_EFFECT_EMITTERS | 1u << candil_Effect_EFFECT_LIGHTS | \
	 1u << candil_Effect_EFFECT_ENVIRONMENT | 1u << candil_Effect_EFFECT_GLOSSY | \
	 1u << candil_Effect_EFFECT_NORMAL_MAPS | 1u << candil_Effect_EFFECT_ALPHA_MASK | \
	 1u << candil_Effect_EFFECT_VERTEX_COLORS | 1u << candil_Effect_EFFECT_UNLIT)

// The rows of the image that a pass works on.
struct deferred_area {
	uint32_t width; // pixels
	uint32_t first_row, rows;
	uint32_t sample; // the sample's number in the job, from 0
};

// A shading pass: a compute shader over tiles, as shaders/deferred/pixel.glsl describes.
struct deferred_pass {
	const struct gl_source *source;
	struct gl_defines defines; // its macros, to which those of the effects are added
	const char *stage; // the name under which its time is told: a literal
	bool halved; // its tiles are those of every second pixel of every second row of the area, counted on their own
	// Bind what the shader needs beside the scene, the job and the bindings of shared/deferred.h. Called before every
	// dispatch, with the program in use, because other jobs bind what they need in between. NULL: nothing to bind.
	void (*bind)(void *user, const struct deferred_area *area);
	void *user;
};

struct deferred;

// Device memory of a job of this plan, in bytes, without its scene and the technique's own. `rows` of pixels are worked on
// at once; 0: as many as the device can bind.
uint64_t deferred_bytes(const struct devices *devices, const struct plan *plan, uint32_t rows);

// Make everything that a job needs on the device: upload the scene (`bindings` beside those that shading by the plan reads),
// make textures, compile all programs and run each once over nothing. `passes` are copied; what their `user` points to must
// outlive *deferred. On failure nothing is left: STATUS_MEMORY, STATUS_DEVICE, STATUS_INTERNAL.
enum status deferred_create(struct devices *devices, struct resident_scene *scene, const struct plan *plan, uint32_t rows,
			    uint32_t bindings, const struct deferred_pass *passes, uint32_t pass_count,
			    struct deferred **deferred, struct error *err);

// Free it. NULL is allowed.
void deferred_destroy(struct deferred *deferred);

// struct technique's `step`. STATUS_TRAVERSAL_CUT if the driver ended the loops of a pixel's rays early.
enum status deferred_step(struct deferred *deferred, uint32_t budget_us, struct step_result *result, struct error *err);

// struct technique's `read`.
enum status deferred_read(struct deferred *deferred, struct frame **frame, struct error *err);

// The most rows of pixels that a pass works on at once, as the height of a technique's own textures of one texel a pixel.
uint32_t deferred_band_rows(const struct gl_device *device, const struct plan *plan, uint32_t rows);

// struct technique's `notes`: these techniques have no lens but a pinhole, and directional lights without a width.
void deferred_notes(const struct resident_scene *scene, const struct plan *plan, candil_Accepted *accepted);

// The job's timer, for a technique's own work before the first sample. deferred_read tells its stages. It stays the job's.
struct gl_timer *deferred_timer(struct deferred *deferred);

// Add host time of work before the first sample to the stages "upload" and "compile".
void deferred_add_setup(struct deferred *deferred, uint64_t upload_us, uint64_t compile_us);

#endif
