#include "server/worker/technique/vct/vct_picture.h"

#include <epoxy/gl.h>

#include "server/worker/technique/vct/vct_options.h"
#include "shaders/gl/vct_coarse_comp.h"
#include "shaders/gl/vct_cones_comp.h"
#include "shaders/gl/vct_fine_comp.h"
#include "shaders/gl/vct_rays_comp.h"
#include "shaders/gl/vct_share_comp.h"

static const struct gl_source coarse_source = {.name = "vct_coarse", .compute = source_vct_coarse_comp};
static const struct gl_source fine_source = {.name = "vct_fine", .compute = source_vct_fine_comp};
static const struct gl_source cones_source = {.name = "vct_cones", .compute = source_vct_cones_comp};
static const struct gl_source rays_source = {.name = "vct_rays", .compute = source_vct_rays_comp};
static const struct gl_source share_source = {.name = "vct_share", .compute = source_vct_share_comp};

// ---- textures -----------------------------------------------------------------------------------------------------------

static bool is_half(const struct plan *plan)
{
	return vct_settings(plan)->detail == VCT_DETAIL_HALF;
}

static bool has_rays(const struct plan *plan)
{
	return vct_settings(plan)->gather == VCT_GATHER_BY_RAYS;
}

static struct gl_texture_desc desc_of(const struct gl_device *gl, const struct plan *plan, GLenum format)
{
	const uint32_t every = is_half(plan) ? 2 : 1;
	const uint32_t rows = deferred_band_rows(gl, plan, vct_settings(plan)->direct.rows);
	return (struct gl_texture_desc){.target = GL_TEXTURE_2D,
					.format = format,
					.width = (plan->width + every - 1) / every,
					.height = (rows + every - 1) / every,
					.depth = 1,
					.levels = 1};
}

// The formats of irradiance and facets, then of what rays need beside them.
static const GLenum formats[] = {GL_RGBA32F, GL_RGBA32UI, GL_RGBA32F, GL_R32F};

// How many of the textures a picture has.
static unsigned textures_of(const struct plan *plan)
{
	return has_rays(plan) ? 4 : is_half(plan) ? 2 : 0;
}

uint64_t vct_picture_bytes(const struct gl_device *gl, const struct plan *plan)
{
	uint64_t bytes = 0;
	for (unsigned i = 0; i < textures_of(plan); i++) {
		const struct gl_texture_desc desc = desc_of(gl, plan, formats[i]);
		bytes += gl_texture_bytes(&desc);
	}
	return bytes;
}

enum status vct_picture_init(struct vct_picture *p, struct gl_device *device, const struct plan *plan,
			     const struct vct_volume *volume, struct error *err)
{
	struct gl_texture *textures[] = {&p->irradiance, &p->facets, &p->shared, &p->nearness};
	enum status s = STATUS_OK;
	p->device = device;
	p->volume = volume;
	for (unsigned i = 0; s == STATUS_OK && i < textures_of(plan); i++) {
		const struct gl_texture_desc desc = desc_of(device, plan, formats[i]);
		s = gl_texture_init(textures[i], device, &desc, err);
	}
	return s;
}

void vct_picture_finish(struct vct_picture *p)
{
	gl_texture_finish(&p->irradiance, p->device);
	gl_texture_finish(&p->facets, p->device);
	gl_texture_finish(&p->shared, p->device);
	gl_texture_finish(&p->nearness, p->device);
	*p = (struct vct_picture){0};
}

// ---- passes -------------------------------------------------------------------------------------------------------------

static void bind_part(void *user, const struct deferred_area *area)
{
	const struct vct_picture_part *part = user;
	const struct vct_picture *p = part->picture;
	(void)area;
	vct_volume_bind(p->volume);
	if (part->from) {
		gl_texture_bind(part->from, VCT_IRRADIANCE_UNIT);
		gl_texture_bind(&p->facets, VCT_FACETS_UNIT);
	}
	if (part->to) {
		gl_texture_bind_image(part->to, VCT_IRRADIANCE_IMAGE, 0, GL_READ_WRITE);
		gl_texture_bind_image(&p->facets, VCT_FACETS_IMAGE, 0, GL_WRITE_ONLY);
	}
	if (p->nearness.name) {
		gl_texture_bind(&p->nearness, VCT_NEARNESS_UNIT);
		gl_texture_bind_image(&p->nearness, VCT_NEARNESS_IMAGE, 0, GL_READ_WRITE);
	}
	if (part->rays[2] > 0)
		glUniform3uiv(VCT_PIXEL_RAYS, 1, part->rays);
}

// The passes in the making.
struct pass_list {
	struct vct_picture *picture;
	const struct plan *plan;
	struct deferred_pass *passes;
	uint32_t first, count;
};

static struct vct_picture_part *add_part(struct pass_list *l, const struct gl_source *source, const char *stage, bool halved)
{
	struct vct_picture_part *part = &l->picture->parts[l->count - l->first];
	struct deferred_pass *pass = &l->passes[l->count++];
	*part = (struct vct_picture_part){.picture = l->picture};
	*pass = (struct deferred_pass){
	    .source = source, .stage = stage, .halved = halved && is_half(l->plan), .bind = bind_part, .user = part};
	vct_define(&pass->defines, &l->picture->volume->options);
	gl_define(&pass->defines, "VCT_EVERY", "%s", is_half(l->plan) ? "2u" : "1u");
	if (has_rays(l->plan))
		gl_define(&pass->defines, "VCT_RAYS", "true");
	return part;
}

static void add_rays(struct pass_list *l)
{
	struct vct_picture *p = l->picture;
	const uint32_t all = vct_settings(l->plan)->rays, wanted = (all - 1) / VCT_PICTURE_RAYS + 1;
	const uint32_t count = wanted < VCT_PICTURE_RAY_PASSES ? wanted : VCT_PICTURE_RAY_PASSES;
	for (uint32_t i = 0; i < count; i++) {
		struct vct_picture_part *part = add_part(l, &rays_source, "rays", true);
		part->to = &p->irradiance;
		part->rays[0] = all * i / count;
		part->rays[1] = all * (i + 1) / count;
		part->rays[2] = all;
	}
	struct vct_picture_part *share = add_part(l, &share_source, "share", true);
	share->from = &p->irradiance;
	share->to = &p->shared;
	struct vct_picture_part *fine = add_part(l, &fine_source, "blend", false);
	fine->from = &p->shared;
	fine->rays[2] = all;
}

uint32_t vct_picture_passes(struct vct_picture *p, const struct plan *plan, struct deferred_pass *passes, uint32_t count)
{
	struct pass_list l = {.picture = p, .plan = plan, .passes = passes, .first = count, .count = count};
	if (has_rays(plan)) {
		add_rays(&l);
	} else if (is_half(plan)) {
		add_part(&l, &coarse_source, "cones", true)->to = &p->irradiance;
		add_part(&l, &fine_source, "cones", false)->from = &p->irradiance;
	} else {
		add_part(&l, &cones_source, "cones", false);
	}
	return l.count;
}
