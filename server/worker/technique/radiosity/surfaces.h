// What every element of radiosity is made of, computed on the device from the scene's materials by the code that shades the
// path tracer's hits (shaders/common/surface.glsl): fills element_buffers.surfaces. Vulkan; device's thread only.
//
// Of each patch these are means over the part of its area that masks leave there, weighted by alpha where surfaces are
// blended: emitted radiance, diffuse albedo, and the reflectance of what is polished. Emission is the front's, and the
// back's only where the material emits on both sides; reflectance is that of both. They are means at one point where nothing
// varies over the patch, else at points of Hammersley's set (shaders/radiosity/patch_surface.comp.glsl), whose mean of a
// texture differs from the integral by some 10⁻³ of its contrast.
//
// Materials become Lambert's and the mirror's law:
// - a metal whose microfacets' α is at most PATCH_MIRROR_ALPHA is a mirror of its base colour, which is its reflectance at
//   normal incidence; what is only partly metallic is a mirror for that part, and diffuse for the rest;
// - other metals are diffuse, of their base colour, and so is everything where EFFECT_GLOSSY is not among the effects;
// - dielectrics are diffuse, of their base colour, and their specular lobe is left out; glass is opaque;
// - what is unlit is black, and does not emit: it only hides what is behind it.
//
// Of each patch it also finds, for surfaces_cover, what other bodies cover, as a block does of the floor that it stands on:
// of PATCH_COVER_SIDE² parts those from whose middle all of PATCH_COVER_RAYS rays meet backs. No light gets there. So what a
// front receives, from lights and by rows of rays, is a mean over the rest of it alone. It is kept in
// element_buffers.patches, which jobs share: it depends on places, and on materials through masks, and bits there are only
// ever added.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_SURFACES_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_SURFACES_H

#include "server/worker/technique/radiosity/patch_pass.h"
#include "server/worker/technique/radiosity/row_maker.h"

struct surfaces;

// Whether to look for what is covered, for rows that are made this way. Those of rays leave it out. Hemicubes and analytic
// factors are of whole patches, so that light must be, too. Rows of a file are taken for those of rays, as they are by
// default.
static inline bool surfaces_cover(enum row_way way)
{
	return way == ROWS_BY_HEMISPHERE || way == ROWS_IMPORTED;
}

// Begin. What `of` names must outlive it; `of` itself need not. `covered`: whether what is covered of these patches has been
// found, and set once it has; it must outlive the surfaces; NULL: it is not wanted. STATUS_MEMORY, STATUS_DEVICE, as all
// below; on failure nothing is left.
enum status surfaces_create(const struct patch_scene *of, bool *covered, struct device *device, struct surfaces **surfaces,
			    struct error *err);
void surfaces_destroy(struct surfaces *surfaces);

// Compile its code, unless that has been done. It takes seconds on a software device.
bool surfaces_compiled(const struct surfaces *surfaces);
enum status surfaces_compile(struct surfaces *surfaces, struct error *err);

// Work for about budget_us, at least one dispatch. What comes out does not depend on the budgets. STATUS_TRAVERSAL_CUT: the
// driver ended loops too early, and what is covered is not known.
enum status surfaces_step(struct surfaces *surfaces, uint32_t budget_us, struct error *err);

// Whether what they are made of is known, if not all that is covered.
bool surfaces_made(const struct surfaces *surfaces);

// Whether it is over, and the share of it that is done.
bool surfaces_finished(const struct surfaces *surfaces);
float surfaces_progress(const struct surfaces *surfaces); // 0…1

// Whether some of the scene may be a mirror, by factors of materials and ranges of their textures. Any thread.
bool surfaces_may_mirror(const struct blob_view *scene);

// Device memory of it, beside the scene's and the elements', for so many faces, in bytes.
uint64_t surfaces_bytes(uint32_t faces);

#endif
