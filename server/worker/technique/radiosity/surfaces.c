#include "server/worker/technique/radiosity/surfaces.h"

#include <stdlib.h>

#include "server/base/clock.h"
#include "server/scene/ranges.h"
#include "server/worker/technique/common/scene_traits.h"
#include "shaders/patch_surface_comp.h"

static const struct shader surface_shader = {.name = "patch_surface",
					     .code = shader_patch_surface_comp,
					     .bytes = sizeof shader_patch_surface_comp,
					     .bindings = BIND_RADIOSITY_COUNT,
					     .push_bytes = sizeof(struct patch_push)};

struct surfaces {
	struct patch_pass pass;
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

enum status surfaces_create(const struct patch_scene *of, struct device *device, struct surfaces **out, struct error *err)
{
	struct surfaces *s = calloc(1, sizeof *s);
	const uint32_t effects = effects_of(of->plan);
	const struct buffer *const own[3] = {NULL};
	struct constants c = {0};
	*out = NULL;
	if (!s)
		return error_set(err, STATUS_MEMORY, "out of memory");
	s->pass.device = device;
	scene_set_constants(&c, of->scene, effects);
	constants_set(&c, SPEC_PATCH_COUNT, of->elements->patches.count);
	enum status status = patch_pass_init(&s->pass, of, effects, false, err);
	if (status == STATUS_OK)
		status = patch_pass_bind(&s->pass, of, &surface_shader, &c, own, err);
	if (status != STATUS_OK) {
		surfaces_destroy(s);
		return status;
	}
	*out = s;
	return STATUS_OK;
}

void surfaces_destroy(struct surfaces *s)
{
	if (s)
		patch_pass_finish(&s->pass);
	free(s);
}

bool surfaces_compiled(const struct surfaces *s)
{
	return patch_pass_compiled(&s->pass);
}

enum status surfaces_compile(struct surfaces *s, struct error *err)
{
	return patch_pass_compile(&s->pass, err);
}

enum status surfaces_step(struct surfaces *s, uint32_t budget_us, struct error *err)
{
	const uint64_t start = clock_us();
	enum status status = STATUS_OK;
	do {
		const uint64_t spent = clock_us() - start;
		const uint32_t left = spent < budget_us ? budget_us - (uint32_t)spent : 0;
		const struct patch_push push = {.first = s->next,
						.count = patch_pass_fit(&s->pass, s->pass.patches - s->next, left)};
		if (push.count > 0)
			status = patch_pass_run(&s->pass, &push, err);
		s->next += push.count;
	} while (status == STATUS_OK && !surfaces_finished(s) && clock_us() - start < budget_us);
	return status;
}

bool surfaces_finished(const struct surfaces *s)
{
	return s->next >= s->pass.patches;
}

float surfaces_progress(const struct surfaces *s)
{
	return s->pass.patches ? (float)s->next / (float)s->pass.patches : 1.0f;
}

uint64_t surfaces_bytes(uint32_t faces)
{
	return sizeof(struct scene_params) + sizeof(struct pass_counters) + (uint64_t)faces * 2 * sizeof(uint32_t);
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
