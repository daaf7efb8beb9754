// Pictures of a solution of radiosity: the passes of a deferred renderer (deferred.h) on OpenGL. A new camera costs one draw
// of the scene and these. Device's thread only.
//
// A picture looks up the irradiance H of what each pixel sees (display_field.h), by element or between the values of its
// corners, and shows L = ρ/π H + emission, with ρ and the emission of the very place, textures and all. Or it gathers
// (radiosity_gather.comp.glsl): direct light comes from direct's own passes, and only what surfaces reflect is looked up, by
// rays from each pixel's place. Polished metals are mirrors, whose rays are followed; everything else is diffuse. Or it
// shows a value of each element as it is.
//
//   display_init, display_step until display_ready, the passes, display_finish
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_DISPLAY_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_DISPLAY_H

#include "server/worker/technique/common/sky_table.h"
#include "server/worker/technique/direct/lighting.h"
#include "server/worker/technique/radiosity/display_field.h"

#define DISPLAY_VIEWS 6u
#define DISPLAY_GATHER_PASSES 4u // a gather's, at most: some drivers end the loops of a pixel that has too many rays at once
#define DISPLAY_GATHER_RAYS 32u // of a pass; more only where there would be too many passes

_Static_assert(DISPLAY_GATHER_PASSES + LIGHTING_PASSES_MAX <= DEFERRED_PASSES_MAX, "a picture has room for them");

// What a picture is.
struct display_options {
	bool plain; // the field's values are shown as they are, on black
	bool corners; // the field has values of corners
	uint32_t gather; // rays of a sample of a pixel; 0: no gather
	uint32_t bounces; // at mirrors, that a ray follows at most; 0: there are none
	bool once; // light scatters once: what surfaces reflect is not gathered
	struct lighting_wish light; // with a gather
};

// A share of a gather's rays.
struct display_rays {
	struct display *display;
	uint32_t first, end;
};

// The passes of one job.
struct display {
	struct display_options options;
	const struct display_field *field;
	bool lit_textures; // some material has a texture of its emission
	struct gl_texels views[DISPLAY_VIEWS]; // the scene's buffers as texels
	struct display_field none; // bound while the field is empty, so that programs are compiled for what comes
	const struct sky_map *sky; // NULL: there is no environment
	const struct sky_table *sky_table; // with a gather; NULL likewise
	struct lighting lighting; // with a gather
	struct display_rays rays[DISPLAY_GATHER_PASSES];
	struct deferred_pass passes[DEFERRED_PASSES_MAX];
	uint32_t pass_count;
};

// The plan as deferred_create gets it for these passes: without what they do not do, so that no code of it is compiled.
struct plan display_plan(const struct plan *plan);

// Make the passes. They need TRACE_BINDINGS of the scene where display_traces. *field must outlive the display, and may be
// zeroed until the first sample; *display must not move while its passes are in use. On failure nothing is left:
// STATUS_MEMORY, STATUS_DEVICE, STATUS_INTERNAL.
enum status display_init(struct display *display, struct devices *devices, struct resident_scene *scene,
			 const struct plan *plan, const struct display_options *options, const struct display_field *field,
			 struct error *err);

// Free it. A zeroed one is fine.
void display_finish(struct display *display);

// Whether passes by these options trace rays.
bool display_traces(const struct display_options *options);

// Work for about budget_us on what must be done before the first pass, and whether that is done: as lighting_step and
// lighting_ready.
enum status display_step(struct display *display, struct gl_timer *timer, uint32_t budget_us, struct error *err);
bool display_ready(const struct display *display);

// Host time that compiling took beside the passes, for deferred_add_setup.
uint64_t display_compile_us(const struct display *display);

// Device memory of a job's display, in bytes, without its scene and its field.
uint64_t display_bytes(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan,
		       const struct display_options *options);

#endif
