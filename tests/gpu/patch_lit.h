// What the tests of light on patches share: surfaces, then light, for a model.
#ifndef CANDIL_TESTS_PATCH_LIT_H
#define CANDIL_TESTS_PATCH_LIT_H

#include "tests/gpu/patch_model.h"

#include <stdlib.h>

#include "server/base/vec3.h"
#include "server/worker/technique/radiosity/light.h"
#include "server/worker/technique/radiosity/surfaces.h"

static struct patch_model model;
static const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1};

static inline void compute(struct patch_model *m, const struct plan *plan, struct light_options options, uint32_t slice_us,
			   float (*out)[3])
{
	const struct patch_scene of = {plan, &m->scene, &m->elements, &m->buffers};
	bool covered = false;
	struct surfaces *s;
	struct light *l;
	assert_int_equal(surfaces_create(&of, &covered, device, &s, NULL), STATUS_OK);
	while (!surfaces_finished(s))
		assert_int_equal(surfaces_step(s, slice_us, NULL), STATUS_OK);
	surfaces_destroy(s);
	assert_true(light_wanted(plan, &m->scene, options.lamps));
	assert_int_equal(light_create(&of, &options, device, &l, NULL), STATUS_OK);
	assert_int_equal(light_compile(l, NULL), STATUS_OK);
	while (!light_finished(l))
		assert_int_equal(light_step(l, slice_us, NULL), STATUS_OK);
	assert_true(light_progress(l) == 1);
	assert_int_equal(light_read(l, out[0], NULL), STATUS_OK);
	light_destroy(l);
}

static inline float (*computed(struct patch_model *m, const struct plan *plan, struct light_options options))[3]
{
	float(*out)[3] = calloc(m->elements.count, sizeof *out);
	assert_non_null(out);
	compute(m, plan, options, 100000, out);
	return out;
}

static inline struct punctual_light *add_light(struct patch_model *m, uint32_t kind, const double at[3],
					       const double towards[3])
{
	struct punctual_light *l = &m->lights[m->light_count++];
	double length = sqrt(vec3_dot(towards, towards));
	*l = (struct punctual_light){.kind = kind, .intensity = {2, 3, 5}, .outer = 1, .pmf = 1, .keep = 1};
	for (int c = 0; c < 3; c++) {
		l->position[c] = (float)at[c];
		l->direction[c] = (float)(length > 0 ? towards[c] / length : 0);
	}
	return l;
}

#endif
