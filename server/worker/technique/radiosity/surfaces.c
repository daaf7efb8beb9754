#include "server/worker/technique/radiosity/surfaces.h"

#include <stdlib.h>

#include "server/base/clock.h"
#include "server/scene/ranges.h"
#include "server/worker/technique/common/scene_traits.h"
#include "server/worker/trace/trace.h"
#include "shaders/patch_cover_comp.h"
#include "shaders/patch_surface_comp.h"

_Static_assert(PATCH_COVER_SIDE *PATCH_COVER_SIDE == PATCH_COVER_PARTS && 2 * PATCH_COVER_PARTS <= 32 &&
		   PATCH_COVER_ALL == (1ull << PATCH_COVER_PARTS) - 1,
	       "a part has two bits");

static const struct shader surface_shader = {.name = "patch_surface",
					     .code = shader_patch_surface_comp,
					     .bytes = sizeof shader_patch_surface_comp,
					     .bindings = BIND_RADIOSITY_COUNT,
					     .push_bytes = sizeof(struct patch_push)};

static const struct shader cover_shader = {.name = "patch_cover",
					   .code = shader_patch_cover_comp,
					   .bytes = sizeof shader_patch_cover_comp,
					   .bindings = BIND_RADIOSITY_COUNT,
					   .texels = TRACE_TEXELS,
					   .push_bytes = sizeof(struct patch_push)};

#define TURNS (1 + PATCH_COVER_PARTS)

struct surfaces {
	struct patch_pass pass;
	struct patch_pass cover; // without a device if it is not wanted
	bool *covered; // NULL: not wanted
	uint32_t turn; // 0: what they are made of; from 1 on a part's cover
	uint32_t next; // patch
};

// Those of the plan's effects that the pass can know: others would only make more variants of its code.
static uint32_t effects_of(const struct plan *plan)
{
	return plan->effects & (1u << candil_Effect_EFFECT_TEXTURES | 1u << candil_Effect_EFFECT_EMITTERS |
				1u << candil_Effect_EFFECT_GLOSSY | 1u << candil_Effect_EFFECT_ALPHA_MASK |
				1u << candil_Effect_EFFECT_ALPHA_BLEND | 1u << candil_Effect_EFFECT_VERTEX_COLORS |
				1u << candil_Effect_EFFECT_UNLIT);
}

static enum status make_pass(struct patch_pass *pass, const struct patch_scene *of, struct device *device, struct error *err)
{
	const uint32_t effects = effects_of(of->plan);
	const struct buffer *const own[3] = {NULL};
	struct constants c = {0};
	pass->device = device;
	scene_set_constants(&c, of->scene, effects);
	constants_set(&c, SPEC_PATCH_COUNT, of->elements->patches.count);
	enum status s = patch_pass_init(pass, of, effects, false, err);
	return s == STATUS_OK ? patch_pass_bind(pass, of, &surface_shader, &c, own, err) : s;
}

// Of the plan's effects, those that change what a ray meets.
static uint32_t effects_of_rays(const struct plan *plan)
{
	const uint32_t alpha = 1u << candil_Effect_EFFECT_ALPHA_MASK | 1u << candil_Effect_EFFECT_ALPHA_BLEND;
	const uint32_t from = 1u << candil_Effect_EFFECT_TEXTURES | 1u << candil_Effect_EFFECT_VERTEX_COLORS;
	return plan->effects & alpha ? plan->effects & (alpha | from) : 0;
}

static enum status make_cover(struct patch_pass *pass, const struct patch_scene *of, struct device *device,
			      struct error *err)
{
	const uint32_t effects = effects_of_rays(of->plan);
	const struct buffer *const own[3] = {NULL};
	struct constants c = {0};
	pass->device = device;
	enum status s = resident_upload(of->scene, device, TRACE_BINDINGS, err);
	if (s == STATUS_OK)
		s = patch_pass_init(pass, of, effects, false, err);
	if (s != STATUS_OK)
		return s;
	const struct trace trace = trace_choose(device, of->scene, TRACE_AUTO);
	scene_set_constants(&c, of->scene, effects);
	trace_set_constants(&trace, &c);
	constants_set(&c, SPEC_PATCH_COUNT, of->elements->patches.count);
	return patch_pass_bind(pass, of, &cover_shader, &c, own, err);
}

enum status surfaces_create(const struct patch_scene *of, bool *covered, struct device *device, struct surfaces **out,
			    struct error *err)
{
	struct surfaces *s = calloc(1, sizeof *s);
	*out = NULL;
	if (!s)
		return error_set(err, STATUS_MEMORY, "out of memory");
	s->covered = covered && !*covered ? covered : NULL;
	enum status status = make_pass(&s->pass, of, device, err);
	if (status == STATUS_OK && s->covered)
		status = make_cover(&s->cover, of, device, err);
	if (status != STATUS_OK) {
		surfaces_destroy(s);
		return status;
	}
	*out = s;
	return STATUS_OK;
}

void surfaces_destroy(struct surfaces *s)
{
	if (!s)
		return;
	patch_pass_finish(&s->pass);
	if (s->cover.device)
		patch_pass_finish(&s->cover);
	free(s);
}

bool surfaces_compiled(const struct surfaces *s)
{
	return patch_pass_compiled(&s->pass) && (!s->covered || patch_pass_compiled(&s->cover));
}

enum status surfaces_compile(struct surfaces *s, struct error *err)
{
	const enum status status = patch_pass_compile(&s->pass, err);
	return status == STATUS_OK && s->covered ? patch_pass_compile(&s->cover, err) : status;
}

enum status surfaces_step(struct surfaces *s, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	enum status status = STATUS_OK;
	while (status == STATUS_OK && !surfaces_finished(s)) {
		struct patch_pass *pass = s->turn == 0 ? &s->pass : &s->cover;
		const uint64_t spent = clock_us() - start;
		const uint32_t left = spent < budget_us ? budget_us - (uint32_t)spent : 0;
		const struct patch_push push = {.first = s->next,
						.count = patch_pass_fit(pass, pass->patches - s->next, left),
						.point = s->turn == 0 ? 0 : s->turn - 1};
		status = patch_pass_run(pass, &push, err);
		s->next += push.count;
		s->turn += s->next == pass->patches;
		s->next = s->next == pass->patches ? 0 : s->next;
		if (clock_us() - start >= budget_us)
			break;
	}
	if (status == STATUS_OK && s->covered)
		status = patch_pass_check(&s->cover, err);
	if (status == STATUS_OK && s->covered && s->turn == TURNS)
		*s->covered = true;
	return status;
}

// What is covered another job may have found meanwhile.
bool surfaces_finished(const struct surfaces *s)
{
	return s->pass.patches == 0 || s->turn == TURNS || (s->turn > 0 && (!s->covered || *s->covered));
}

bool surfaces_made(const struct surfaces *s)
{
	return s->pass.patches == 0 || s->turn > 0;
}

float surfaces_progress(const struct surfaces *s)
{
	return surfaces_finished(s) ? 1 : ((float)s->turn + (float)s->next / (float)s->pass.patches) / TURNS;
}

uint64_t surfaces_bytes(uint32_t faces)
{
	return 2 * (sizeof(struct scene_params) + sizeof(struct pass_counters) + (uint64_t)faces * 2 * sizeof(uint32_t));
}

bool surfaces_may_mirror(const struct blob_view *scene)
{
	const struct material *m = scene->sections[BLOB_MATERIALS];
	const struct material_use *uses = scene->sections[BLOB_MATERIAL_USES];
	bool found = false;
	for (uint32_t i = 0; i < scene->counts[BLOB_MATERIALS] && !found; i++) {
		const float least = m[i].roughness * range_of_texture(scene, m[i].surface_texture, 1).low;
		const float metal = m[i].metallic * range_of_texture(scene, m[i].surface_texture, 2).high;
		found = uses[i].triangles > 0 && !(m[i].flags & MATERIAL_UNLIT) && metal > 0 &&
			(double)(least * least) <= PATCH_MIRROR_ALPHA;
	}
	return found;
}
