// What the passes over patches share (shaders/shared/patch_pass.h): the buffers that a shader of the scene needs beside its
// own, its pipeline, its bindings, and how many patches fit a slice. Used by surfaces.c and light.c. Vulkan; device's thread
// only. Times are microseconds.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_PATCH_PASS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_PATCH_PASS_H

#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/radiosity/element_buffers.h"
#include "server/worker/vk/pipeline.h"
#include "shaders/shared/patch_pass.h"
#include "shaders/shared/scene_params.h"

// A pass. Its owner sets `device` first; all else begins as zero.
struct patch_pass {
	struct device *device;
	struct pipeline *pipeline;
	struct binding_set set;
	struct buffer job; // struct scene_params
	struct buffer counters; // struct pass_counters
	struct buffer face_triangles; // BIND_PATCH_TRIANGLES
	uint32_t patches;
	double item_us; // measured time of a patch in a dispatch; 0: not yet
};

// What a pass is made of. All must outlive it.
struct patch_scene {
	const struct plan *plan; // of it the effects, the environment and the seed
	struct resident_scene *scene;
	const struct elements *elements;
	const struct element_buffers *buffers;
};

// Make the buffers of a pass, and upload those of the scene that shading by these effects (bits 1 << candil_Effect) reads.
// `sky_is_lamp`: as scene_params_fill. STATUS_MEMORY, STATUS_DEVICE; patch_pass_finish frees what was made by then.
enum status patch_pass_init(struct patch_pass *pass, const struct patch_scene *of, uint32_t effects, bool sky_is_lamp,
			    struct error *err);

// Make its pipeline, by constants to which those of the scene were added, and bind the buffers: own[k] at
// BIND_PATCH_LIGHT + k, of three places. Fails likewise.
enum status patch_pass_bind(struct patch_pass *pass, const struct patch_scene *of, const struct shader *shader,
			    const struct constants *constants, const struct buffer *const own[3], struct error *err);

// Free what it has. A pass of which all but `device` is zero is fine.
void patch_pass_finish(struct patch_pass *pass);

// Whether the driver has compiled its code. If not, the first dispatch takes long.
bool patch_pass_compiled(const struct patch_pass *pass);

// Run it over nothing, so that the driver compiles it now. Does nothing where it has. STATUS_MEMORY, STATUS_DEVICE.
enum status patch_pass_compile(struct patch_pass *pass, struct error *err);

// Run one dispatch over push->count patches, and measure it. Fails likewise.
enum status patch_pass_run(struct patch_pass *pass, const struct patch_push *push, struct error *err);

// Whether all rays so far came to their ends. STATUS_TRAVERSAL_CUT: the driver ended loops too early.
enum status patch_pass_check(const struct patch_pass *pass, struct error *err);

// How many of the patches that are left a dispatch of budget_us takes: at least one workgroup.
uint32_t patch_pass_fit(const struct patch_pass *pass, uint32_t left, uint32_t budget_us);

#endif
