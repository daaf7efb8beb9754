#include "server/worker/plan.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/limits.h"
#include "protocol/names.h"
#include "server/base/angle.h"
#include "server/base/vec3.h"
#include "server/worker/plan_options.h"
#include "shaders/shared/vct_show.h"

static bool called_for(candil_Effect effect, const candil_Render *r, const struct plan *p, uint32_t facts);

static bool allowed(candil_Effect effect, const candil_Render *r)
{
	return !(r->effects_off >> effect & 1u);
}

// Whether some light is there, and not switched off.
static bool shines(const candil_Render *r, const struct plan *p, uint32_t facts)
{
	static const candil_Effect lights[] = {candil_Effect_EFFECT_EMITTERS, candil_Effect_EFFECT_LIGHTS,
					       candil_Effect_EFFECT_ENVIRONMENT};
	for (size_t i = 0; i < sizeof lights / sizeof *lights; i++)
		if (called_for(lights[i], r, p, facts) && allowed(lights[i], r))
			return true;
	return false;
}

// Whether something shines that light paths are worth beginning at, and is not switched off.
static bool starts_light_paths(const candil_Render *r, const struct plan *p, uint32_t facts)
{
	const bool emitters = facts & FACT_EMITTERS && allowed(candil_Effect_EFFECT_EMITTERS, r);
	const bool lights = facts & (FACT_POINT_LIGHTS | FACT_SPOT_LIGHTS | FACT_DIRECTIONAL_LIGHTS) &&
			    allowed(candil_Effect_EFFECT_LIGHTS, r);
	const bool sky = p->environment.power > 0 && p->environment.contrast >= PLAN_SKY_CONTRAST &&
			 allowed(candil_Effect_EFFECT_ENVIRONMENT, r);
	return emitters || lights || sky;
}

// Whether the scene and the request's own values call for an effect.
static bool called_for(candil_Effect effect, const candil_Render *r, const struct plan *p, uint32_t facts)
{
	switch (effect) {
	case candil_Effect_EFFECT_TEXTURES:
		return facts & FACT_TEXTURES;
	case candil_Effect_EFFECT_EMITTERS:
		return facts & FACT_EMITTERS;
	case candil_Effect_EFFECT_LIGHTS:
		return facts & (FACT_POINT_LIGHTS | FACT_SPOT_LIGHTS | FACT_DIRECTIONAL_LIGHTS);
	case candil_Effect_EFFECT_ENVIRONMENT:
		return p->background[0] > 0 || p->background[1] > 0 || p->background[2] > 0 || p->environment.power > 0;
	case candil_Effect_EFFECT_BOUNCES:
		return p->depth > 1 && facts & (FACT_REFLECTS | FACT_GLOSSY) && shines(r, p, facts);
	case candil_Effect_EFFECT_GLOSSY:
		return facts & FACT_GLOSSY;
	case candil_Effect_EFFECT_NORMAL_MAPS:
		return facts & FACT_NORMAL_MAPS;
	case candil_Effect_EFFECT_ALPHA_MASK:
		return facts & FACT_ALPHA_MASK;
	case candil_Effect_EFFECT_VERTEX_COLORS:
		return facts & FACT_VERTEX_COLORS;
	case candil_Effect_EFFECT_UNLIT:
		return facts & FACT_UNLIT;
	case candil_Effect_EFFECT_GLASS:
		return facts & FACT_GLASS;
	case candil_Effect_EFFECT_ALPHA_BLEND:
		return facts & FACT_ALPHA_BLEND;
	case candil_Effect_EFFECT_CLEARCOAT:
		return facts & FACT_CLEARCOAT;
	case candil_Effect_EFFECT_ROUGH_DIFFUSE:
		return facts & FACT_ROUGH_DIFFUSE;
	case candil_Effect_EFFECT_CAUSTICS:
		return p->depth > 1 && facts & FACT_POLISHED && starts_light_paths(r, p, facts) &&
		       allowed(candil_Effect_EFFECT_BOUNCES, r);
	}
	return false;
}

// Why a technique cannot do an effect; NULL: it can.
static const char *cannot(const struct plan *p, candil_Effect effect)
{
	if (p->technique == candil_Technique_TECHNIQUE_DIRECT && effect == candil_Effect_EFFECT_BOUNCES)
		return "direct shows light that comes straight from its source: pt and vct follow it further";
	if (p->technique == candil_Technique_TECHNIQUE_DIRECT && effect == candil_Effect_EFFECT_GLASS)
		return "only pt and vct look through glass: clear surfaces are opaque with their base colour";
	if (p->technique != candil_Technique_TECHNIQUE_PT && effect == candil_Effect_EFFECT_ALPHA_BLEND)
		return "only pt blends by alpha: blended surfaces are whole";
	if (p->technique != candil_Technique_TECHNIQUE_PT && effect == candil_Effect_EFFECT_CLEARCOAT)
		return "only pt has clear coats: surfaces are without";
	if (p->technique != candil_Technique_TECHNIQUE_PT && effect == candil_Effect_EFFECT_ROUGH_DIFFUSE)
		return "only pt has rough diffuse surfaces: they are Lambert's";
	if (p->technique != candil_Technique_TECHNIQUE_PT && effect == candil_Effect_EFFECT_CAUSTICS)
		return "only pt follows light from lamps by way of polished surfaces";
	if (p->technique != candil_Technique_TECHNIQUE_VCT || p->vct_show == VCT_SHOW_NONE)
		return NULL;
	if (effect == candil_Effect_EFFECT_NORMAL_MAPS)
		return "voxels have the mesh's own normals";
	const bool light = p->vct_show == VCT_SHOW_RADIANCE || p->vct_show == VCT_SHOW_IRRADIANCE;
	if (!light && (effect == candil_Effect_EFFECT_LIGHTS || effect == candil_Effect_EFFECT_ENVIRONMENT ||
		       effect == candil_Effect_EFFECT_BOUNCES))
		return "what vct.show asks for needs no light";
	return NULL;
}

// Whether the surroundings shine, and their light may scatter twice.
static bool sky_shines(const candil_Render *r, const struct plan *p, uint32_t facts)
{
	return p->depth > 1 && called_for(candil_Effect_EFFECT_ENVIRONMENT, r, p, facts) &&
	       allowed(candil_Effect_EFFECT_ENVIRONMENT, r);
}

// What becomes of an effect, and the reason to tell.
static candil_EffectState decide(candil_Effect effect, const candil_Render *r, uint32_t facts, const struct plan *p,
				 const char **why)
{
	const struct effect_words *words = effect_words(effect);
	const uint32_t bit = 1u << effect;
	*why = cannot(p, effect);
	if (*why)
		return candil_EffectState_EFFECT_STATE_UNSUPPORTED;
	*why = words->substitute;
	if (r->effects_off & bit)
		return candil_EffectState_EFFECT_STATE_SWITCHED_OFF;
	*why = words->simulated;
	if (effect == candil_Effect_EFFECT_ENVIRONMENT && p->technique == candil_Technique_TECHNIQUE_DIRECT)
		*why = "the background is not black: it is seen, and only pt and vct take light from it";
	if (called_for(effect, r, p, facts))
		return candil_EffectState_EFFECT_STATE_SIMULATED;
	*why = words->absent;
	if (effect == candil_Effect_EFFECT_CAUSTICS && facts & FACT_POLISHED && sky_shines(r, p, facts))
		*why = "only the background shines, and evenly enough that chance finds its caustics as well";
	return r->effects_on & bit ? candil_EffectState_EFFECT_STATE_FORCED : candil_EffectState_EFFECT_STATE_ABSENT;
}

static void plan_effects(const candil_Render *r, uint32_t facts, struct plan *p)
{
	for (unsigned i = 0; i < EFFECT_COUNT; i++) {
		candil_EffectReport *report = &p->reports[p->report_count++];
		const char *why;
		*report = (candil_EffectReport)candil_EffectReport_init_zero;
		report->effect = (candil_Effect)i;
		report->state = decide((candil_Effect)i, r, facts, p, &why);
		snprintf(report->why, sizeof report->why, "%s", why);
		if (report->state == candil_EffectState_EFFECT_STATE_SIMULATED ||
		    report->state == candil_EffectState_EFFECT_STATE_FORCED)
			p->effects |= 1u << report->effect;
	}
}

// ---- camera -----------------------------------------------------------------------------------------------------------

// Image plane from a view direction and any vector that is not along it.
static enum status aim(struct plan *p, const double up[3], double half_height, struct error *err)
{
	struct plan_camera *c = &p->camera;
	double right[3], straight_up[3];
	if (!vec3_normalize(c->forward))
		return error_set(err, STATUS_BAD_ARGUMENT, "the camera's eye and target are the same point: move one");
	vec3_cross(c->forward, up, right);
	if (!vec3_normalize(right))
		return error_set(err, STATUS_BAD_ARGUMENT, "the camera's up direction is along its view: choose another");
	vec3_cross(right, c->forward, straight_up);
	// A panorama's image has no plane: the frame is enough.
	const double half_width = c->panorama ? 1 : half_height * p->width / p->height;
	for (int i = 0; i < 3; i++) {
		c->right[i] = right[i] * half_width;
		c->up[i] = straight_up[i] * half_height;
	}
	return STATUS_OK;
}

// What the request says of the lens, over what the camera has. `half_height` is the camera's own image plane's.
static double plan_lens(const candil_Lens *lens, struct plan_camera *c, double half_height)
{
	c->lens_radius = lens->radius;
	c->focus = lens->focus;
	c->panorama = lens->projection == candil_Projection_PROJECTION_PANORAMA;
	if (lens->projection == candil_Projection_PROJECTION_CAMERA)
		return half_height;
	c->orthographic = !c->panorama;
	return c->orthographic ? lens->height / 2 : 1;
}

static enum status camera_of_scene(const struct blob_camera *from, const candil_Lens *lens, struct plan *p,
				   struct error *err)
{
	memcpy(p->camera.eye, from->eye, sizeof p->camera.eye);
	memcpy(p->camera.forward, from->forward, sizeof p->camera.forward);
	p->camera.orthographic = from->vfov_degrees == 0;
	double half = p->camera.orthographic ? from->half_height : tan(from->vfov_degrees * PI / 360);
	half = plan_lens(lens, &p->camera, half);
	return aim(p, from->up, half, err);
}

static enum status plan_camera(const candil_Render *r, const struct blob_view *scene, struct plan *p, struct error *err)
{
	const struct blob_camera *cameras = scene->sections[BLOB_CAMERAS];
	const uint32_t count = scene->counts[BLOB_CAMERAS];
	const candil_Camera *c = &r->camera;
	if (r->has_camera && c->name[0]) {
		for (uint32_t i = 0; i < count; i++)
			if (!strcmp(cameras[i].name, c->name))
				return camera_of_scene(&cameras[i], &r->lens, p, err);
		return error_set(err, STATUS_BAD_ARGUMENT, "the scene has no camera '%s': `candil describe` lists them",
				 c->name);
	}
	if (!r->has_camera || !c->has_eye) {
		if (count == 0)
			return error_set(err, STATUS_BAD_ARGUMENT, "the scene has no camera: give one with the request");
		return camera_of_scene(&cameras[0], &r->lens, p, err);
	}
	const double eye[3] = {c->eye.x, c->eye.y, c->eye.z};
	const double target[3] = {c->target.x, c->target.y, c->target.z};
	const double y_up[3] = {0, 1, 0};
	const double up[3] = {c->up.x, c->up.y, c->up.z};
	const bool needs_angle = r->lens.projection == candil_Projection_PROJECTION_CAMERA;
	if (needs_angle && !(c->vfov_degrees > 0 && c->vfov_degrees < 180))
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "the camera's vertical field of view must be between 0 and 180 degrees");
	for (int i = 0; i < 3; i++) {
		p->camera.eye[i] = eye[i];
		p->camera.forward[i] = target[i] - eye[i];
	}
	const double half = plan_lens(&r->lens, &p->camera, tan(c->vfov_degrees * PI / 360));
	return aim(p, c->has_up ? up : y_up, half, err);
}

static enum status plan_environment(const candil_Render *r, const struct blob_header *picture, struct plan_environment *e,
				    struct error *err)
{
	if (!picture)
		return STATUS_OK;
	if (picture->environment_width == 0)
		return error_set(err, STATUS_BAD_ARGUMENT, "'%s' is a scene, no picture of surroundings",
				 r->environment.scene);
	e->width = picture->environment_width;
	e->height = picture->environment_height;
	e->turn = r->environment.rotation_degrees / 360;
	e->turn -= floor(e->turn);
	e->scale = r->environment.scale;
	e->power = (double)picture->environment_power * e->scale;
	e->contrast = (double)picture->environment_contrast;
	return STATUS_OK;
}

enum status plan_make(const candil_Render *r, const struct blob_view *scene, const struct blob_header *environment,
		      struct plan *p, struct error *err)
{
	memset(p, 0, sizeof *p);
	if (scene->blob->environment_width > 0)
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "'%s' is a picture of surroundings, no scene: name a scene, and this as its background",
				 r->scene);
	p->technique = r->technique == candil_Technique_TECHNIQUE_AUTO ? candil_Technique_TECHNIQUE_PT : r->technique;
	p->width = r->width;
	p->height = r->height;
	p->samples = r->samples ? r->samples : PLAN_SAMPLES_DEFAULT;
	p->first_sample = r->first_sample;
	p->seed = r->seed;
	p->target_error = r->target_error;
	p->deadline = r->deadline_ms > 0;
	plan_options_default(p);
	p->aovs = r->aovs;
	p->filter = r->filter;
	p->format = r->format;
	p->view = r->view;
	p->exposure_ev = r->exposure_ev;
	if (r->has_background) {
		p->background[0] = (float)r->background.x;
		p->background[1] = (float)r->background.y;
		p->background[2] = (float)r->background.z;
	}
	for (pb_size_t i = 0; i < r->options_count; i++) {
		enum status s = plan_option(&r->options[i], p, err);
		if (s != STATUS_OK)
			return s;
	}
	enum status s = plan_options_check(p, err);
	if (s == STATUS_OK)
		s = plan_environment(r, environment, &p->environment, err);
	if (s != STATUS_OK)
		return s;
	if (p->technique == candil_Technique_TECHNIQUE_DIRECT)
		p->depth = 1;
	if (p->technique == candil_Technique_TECHNIQUE_VCT)
		p->depth = p->vct_bounces + 1;
	s = plan_camera(r, scene, p, err);
	if (s != STATUS_OK)
		return s;
	plan_effects(r, scene->facts, p);
	// What clear surfaces reflect is made by what makes glossy ones, which changes no other surface where none is.
	if (p->technique == candil_Technique_TECHNIQUE_VCT && plan_has(p, candil_Effect_EFFECT_GLASS) &&
	    allowed(candil_Effect_EFFECT_GLOSSY, r))
		p->effects |= 1u << candil_Effect_EFFECT_GLOSSY;
	return STATUS_OK;
}
