#include "server/worker/technique/radiosity/display.h"

#include <epoxy/gl.h>
#include <stddef.h>
#include <string.h>

#include "server/worker/devices.h"
#include "server/worker/gl/scene.h"
#include "shaders/gl/radiosity_gather_comp.h"
#include "shaders/gl/radiosity_light_comp.h"
#include "shaders/gl/radiosity_show_comp.h"
#include "shaders/shared/radiosity_show.h"

_Static_assert(sizeof(struct triangle) == 16 && sizeof(struct vertex) == 32, "shaders fetch them as one texel and two");
_Static_assert(sizeof(struct material) == 16 * RADIOSITY_MATERIAL_TEXELS, "shaders fetch it as texels");
_Static_assert(sizeof(struct texture_info) == 4 * RADIOSITY_TEXTURE_WORDS, "shaders fetch it by words");
_Static_assert(offsetof(struct material, emission) == 16 && offsetof(struct material, metallic) == 56 &&
		   offsetof(struct material, surface_texture) == 64 && offsetof(struct material, flags) == 80 &&
		   offsetof(struct material, power_density) == 84,
	       "shaders/radiosity/place.glsl knows where they are");
_Static_assert(sizeof(struct environment_row) == 8, "shaders fetch it as two words");

static const struct gl_source show_source = {.name = "lookup", .compute = source_radiosity_show_comp};
static const struct gl_source light_source = {.name = "light", .compute = source_radiosity_light_comp};
static const struct gl_source gather_source = {.name = "gather", .compute = source_radiosity_gather_comp};

// The scene's buffers that shaders read as texels.
static const struct {
	uint32_t binding;
	GLenum format;
	unsigned unit;
} views[DISPLAY_VIEWS] = {
    {BIND_TRIANGLES, GL_RGBA32UI, RADIOSITY_CORNERS_UNIT},   {BIND_VERTICES, GL_RGBA32F, RADIOSITY_VERTICES_UNIT},
    {BIND_MATERIALS, GL_RGBA32UI, RADIOSITY_MATERIALS_UNIT}, {BIND_TEXTURES, GL_R32UI, RADIOSITY_TEXTURES_UNIT},
    {BIND_TEXELS, GL_R32UI, RADIOSITY_TEXELS_UNIT},          {BIND_SRGB_TABLE, GL_R32F, RADIOSITY_SRGB_UNIT}};

#define LEFT_OUT \
	(1u << candil_Effect_EFFECT_GLOSSY | 1u << candil_Effect_EFFECT_GLASS | 1u << candil_Effect_EFFECT_CLEARCOAT)

struct plan display_plan(const struct plan *plan)
{
	struct plan p = *plan;
	p.effects &= ~LEFT_OUT;
	return p;
}

bool display_traces(const struct display_options *o)
{
	return o->gather > 0 || (o->bounces > 0 && !o->plain);
}

// ---- the passes ---------------------------------------------------------------------------------------------------------

static void bind(const struct display *d)
{
	display_field_bind(d->field->values.texture ? d->field : &d->none);
	for (unsigned i = 0; i < DISPLAY_VIEWS; i++)
		gl_texels_bind(&d->views[i], views[i].unit);
	if (d->sky)
		sky_map_bind(d->sky);
	if (d->sky_table)
		gl_texels_bind(&d->sky_table->rows, RADIOSITY_SKY_UNIT);
}

static void bind_show(void *user, const struct deferred_area *area)
{
	(void)area;
	bind(user);
}

static void bind_gather(void *user, const struct deferred_area *area)
{
	const struct display_rays *rays = user;
	(void)area;
	bind(rays->display);
	glUniform3ui(RADIOSITY_RAYS, rays->first, rays->end, rays->display->options.gather);
}

static struct deferred_pass *add_pass(struct display *d, const struct gl_source *source)
{
	struct deferred_pass *pass = &d->passes[d->pass_count++];
	*pass = (struct deferred_pass){.source = source, .stage = source->name, .bind = bind_show, .user = d};
	gl_define(&pass->defines, "RADIOSITY_BOUNCES", "%u", d->options.plain ? 0 : d->options.bounces);
	gl_define(&pass->defines, "RADIOSITY_CORNERS", "%s", d->options.corners ? "true" : "false");
	gl_define(&pass->defines, "RADIOSITY_ONCE", "%s", d->options.once ? "true" : "false");
	gl_define(&pass->defines, "RADIOSITY_PLAIN", "%s", d->options.plain ? "true" : "false");
	gl_define(&pass->defines, "RADIOSITY_LIT_TEXTURES", "%s", d->lit_textures ? "true" : "false");
	if (d->sky && !d->options.plain)
		gl_define(&pass->defines, "RADIOSITY_SKY", "true");
	return pass;
}

// Points that neighbouring pixels share would all be wrong in the same way beside a lamp, where a gather's rays are good.
static struct lighting_wish light_of(const struct display_options *o)
{
	struct lighting_wish wish = o->light;
	wish.own = true;
	wish.rays = o->gather;
	return wish;
}

// Direct light's own passes. Where mirrors are, what they reflect is no part of it.
static enum status add_light(struct display *d, struct devices *devices, struct resident_scene *scene,
			     const struct plan *plan, struct error *err)
{
	const struct plan shown = display_plan(plan);
	const struct lighting_wish wish = light_of(&d->options);
	const enum status s = lighting_init(&d->lighting, devices, scene, &shown, &wish, err);
	if (s != STATUS_OK)
		return s;
	d->pass_count = d->lighting.pass_count;
	memcpy(d->passes, d->lighting.passes, d->pass_count * sizeof *d->passes);
	if (d->options.bounces == 0)
		return STATUS_OK;
	d->passes[0].source = &light_source;
	gl_define(&d->passes[0].defines, "RADIOSITY_BOUNCES", "%u", d->options.bounces);
	return STATUS_OK;
}

static void add_gathers(struct display *d, const struct plan *plan, const struct resident_scene *scene)
{
	const struct plan shown = display_plan(plan);
	const struct lighting_wish wish = light_of(&d->options);
	const uint32_t rivals = lighting_rivals(&shown, scene, &wish);
	const uint32_t rays = d->options.gather, wanted = (rays - 1) / DISPLAY_GATHER_RAYS + 1;
	const uint32_t count = wanted < DISPLAY_GATHER_PASSES ? wanted : DISPLAY_GATHER_PASSES;
	for (uint32_t i = 0; i < count; i++) {
		d->rays[i] = (struct display_rays){.display = d,
						   .first = (uint32_t)((uint64_t)rays * i / count),
						   .end = (uint32_t)((uint64_t)rays * (i + 1) / count)};
		struct deferred_pass *pass = add_pass(d, &gather_source);
		pass->bind = bind_gather;
		pass->user = &d->rays[i];
		gl_define(&pass->defines, "RADIOSITY_RIVALS", "%u.0", rivals);
	}
}

// Whether some material has a texture of its emission.
static bool has_lit_textures(const struct resident_scene *scene)
{
	const struct material *m = scene_section(scene, BLOB_MATERIALS);
	for (uint32_t i = 0; i < scene_count(scene, BLOB_MATERIALS); i++)
		if (m[i].emission_texture != NONE)
			return true;
	return false;
}

static enum status view_scene(struct display *d, struct gl_device *device, struct resident_scene *scene, struct error *err)
{
	uint32_t bindings = 0;
	struct gl_scene *of;
	for (unsigned i = 0; i < DISPLAY_VIEWS; i++)
		bindings |= 1u << views[i].binding;
	enum status s = gl_scene_get(scene, device, bindings, &of, err);
	for (unsigned i = 0; s == STATUS_OK && i < DISPLAY_VIEWS; i++)
		s = gl_texels_view(&d->views[i], device, views[i].format, gl_scene_buffer(of, views[i].binding), err);
	return s;
}

enum status display_init(struct display *d, struct devices *devices, struct resident_scene *scene, const struct plan *plan,
			 const struct display_options *options, const struct display_field *field, struct error *err)
{
	static const struct elements no_elements;
	struct gl_device *device;
	*d = (struct display){.options = *options, .field = field, .lit_textures = has_lit_textures(scene)};
	enum status s = devices_gl(devices, &device, err);
	if (s == STATUS_OK)
		s = display_field_init(&d->none, device, &no_elements, NULL, options->corners, err);
	if (s == STATUS_OK)
		s = view_scene(d, device, scene, err);
	if (s == STATUS_OK && plan_has_sky(plan))
		s = sky_map_get(plan->environment.scene, device, &d->sky, err);
	if (s == STATUS_OK && plan_has_sky(plan) && options->gather > 0)
		s = sky_table_get(plan->environment.scene, device, &d->sky_table, err);
	if (s == STATUS_OK && options->gather > 0)
		s = add_light(d, devices, scene, plan, err);
	if (s != STATUS_OK) {
		display_finish(d);
		return s;
	}
	if (options->gather > 0)
		add_gathers(d, plan, scene);
	else
		add_pass(d, &show_source);
	return STATUS_OK;
}

void display_finish(struct display *d)
{
	lighting_finish(&d->lighting);
	display_field_finish(&d->none);
	for (unsigned i = 0; i < DISPLAY_VIEWS; i++)
		gl_texels_finish(&d->views[i]);
	*d = (struct display){0};
}

// ---- before them --------------------------------------------------------------------------------------------------------

enum status display_step(struct display *d, struct gl_timer *timer, uint32_t budget_us, struct error *err)
{
	return lighting_step(&d->lighting, timer, budget_us, err);
}

bool display_ready(const struct display *d)
{
	return lighting_ready(&d->lighting);
}

uint64_t display_compile_us(const struct display *d)
{
	return d->lighting.compile_us;
}

uint64_t display_bytes(const struct devices *devices, const struct resident_scene *scene, const struct plan *plan,
		       const struct display_options *o)
{
	const struct plan shown = display_plan(plan);
	const struct lighting_wish wish = light_of(o);
	return display_field_bytes(0, 0, 0, o->corners) +
	       (o->gather > 0 ? lighting_bytes(devices, scene, &shown, &wish) : 0);
}
