// Irradiance of every element straight from lights that are no elements, computed on the device by rays: D of solver.h,
// W/m². Where the caller wants it emissive surfaces count as such, whose exitance form factors then do not carry. Point,
// spot and directional lights, with their ranges and discs, are those of the path tracer, by its code
// (shaders/common/light.glsl), and so is an environment's picture, of which a constant background is none: that one is
// π · radiance · the share that escapes (factors.h), and is the caller's. Vulkan; device's thread only.
//
// A value is the mean over the part of the patch that masks leave there, at `points` points that are scrambled for each
// patch (shaders/common/sampling.glsl), each with one shadow ray to each light. Cosines are those of the flat patch,
// whatever its shading normals. Of the picture a point has a ray by the cosine on each side, and where the picture is uneven
// one by its table besides, the two weighted by the power heuristic (Veach 1997, 9.2.4).
//
// Of emissive surfaces a point has two rays on each side likewise, one by the cosine and one to a point on them, chosen by
// power. Form factors have an error of √((1 - F) / (F rays)) of a lamp that has the share F of what a patch sees: a
// lamp that is small beside the room is found far better from here.
//
// By way of mirrors (surfaces.h, which must have been filled in before) the picture and emissive surfaces are seen, by
// `bounces` of them at most; what more would bring is left out. The other lights are not: no ray from a patch finds them
// there.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_LIGHT_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_LIGHT_H

#include "server/worker/technique/radiosity/patch_pass.h"

#define LIGHT_POINTS_MOST 4096u

// How light is looked for.
struct light_options {
	uint32_t points; // of a patch, for each light: a power of two, 1 … LIGHT_POINTS_MOST
	uint32_t sky_points; // of each side of a patch, for the picture and for emissive surfaces: likewise
	uint32_t bounces; // at mirrors
	bool lamps; // emissive surfaces are among the lights
};

struct light;

// Whether there is anything to compute: the plan simulates lights and the scene has some, or its environment is a picture.
// Where there is nothing, D is 0, and no light need be made.
bool light_wanted(const struct plan *plan, const struct resident_scene *scene, bool lamps);

// Begin. What `of` names must outlive it; `of` itself need not. STATUS_BAD_ARGUMENT: a number of points that is none;
// STATUS_MEMORY, STATUS_DEVICE, as all below. On failure nothing is left.
enum status light_create(const struct patch_scene *of, const struct light_options *options, struct device *device,
			 struct light **light, struct error *err);
void light_destroy(struct light *light);

// Compile its code, unless that has been done. It takes seconds on a software device.
bool light_compiled(const struct light *light);
enum status light_compile(struct light *light, struct error *err);

// Work for about budget_us, at least one dispatch. What comes out does not depend on the budgets. STATUS_TRAVERSAL_CUT: the
// driver ended loops too early, and nothing of it is right.
enum status light_step(struct light *light, uint32_t budget_us, struct error *err);

// Whether it is over, and how far it is.
bool light_finished(const struct light *light);
float light_progress(const struct light *light); // 0…1
uint64_t light_rays(const struct light *light); // that were asked for so far, at most

// How many that will be in all, for so many patches. No device is touched.
double light_rays_wanted(const struct plan *plan, const struct resident_scene *scene, const struct light_options *options,
			 uint32_t patches);

// Copy D to host memory, 3 floats for each element.
enum status light_read(const struct light *light, float *irradiance, struct error *err);

// Device memory of it, beside the scene's and the elements', in bytes.
uint64_t light_bytes(const struct plan *plan, uint32_t faces, uint32_t patches);

#endif
