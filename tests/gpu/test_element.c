// Shaders find the element of a place, and where in its patch it is, as elements_at does.
#include "shaders/element_comp.h"
#include "tests/gpu/run_shader.h"
#include "tests/unit/element_samples.h"

#include <stdio.h>

#define PLACES 65536u
#define NEAR \
	2e-3 // of a patch: how near to a side a place may be. Floats round barycentrics to 6e-8, and that of a cut in 70 to
	     // 4e-6

static const struct shader shader = {
    .name = "element", .code = shader_element_comp, .bytes = sizeof shader_element_comp, .bindings = 2, .push_bytes = 8};

// As the shader has it.
static struct {
	struct radiosity_face faces[64];
	uint32_t triangles[128];
	struct {
		uint32_t triangle;
		float uv[2];
		uint32_t front;
	} places[PLACES];
} asked;
static struct {
	uint32_t element;
	float inside[2];
} answers[PLACES];
static struct element_sample samples[PLACES];

// Ask for places of all patches of a mesh; counts the wrong answers.
static enum status check(uint32_t kind, double edge, uint32_t *wrong, double *far, struct error *err)
{
	static struct mesh m;
	struct elements e;
	struct shader_run run;
	element_mesh(&m, kind);
	enum status s = elements_init(&e, &m.view, &(struct patch_options){.edge = edge}, err);
	if (s != STATUS_OK)
		return s;
	assert_true(e.patches.faces.count <= 64 && e.triangle_count <= 128);
	memcpy(asked.faces, e.faces, e.patches.faces.count * sizeof *e.faces);
	memcpy(asked.triangles, e.triangles, e.triangle_count * sizeof *e.triangles);
	for (uint32_t i = 0; i < PLACES; i++) {
		samples[i] = element_sample(&m, &e.patches, i % e.patches.count, NEAR);
		asked.places[i].triangle = samples[i].triangle;
		for (int k = 0; k < 2; k++)
			asked.places[i].uv[k] = (float)samples[i].uv[k];
		asked.places[i].front = i % 3 != 0;
	}
	const uint32_t push[2] = {PLACES, e.patches.count};
	if ((s = shader_run_init(&run, &shader, &asked, sizeof asked, sizeof answers, err)) == STATUS_OK) {
		s = shader_run_dispatch(&run, push, sizeof push, PLACES / 64, err);
		if (s == STATUS_OK)
			s = buffer_read(&run.out, run.device, 0, sizeof answers, answers, err);
		shader_run_finish(&run);
	}
	for (uint32_t i = 0; i < PLACES && s == STATUS_OK; i++) {
		*wrong += answers[i].element != samples[i].patch + (asked.places[i].front ? 0 : e.patches.count);
		for (int k = 0; k < 2; k++)
			*far = fmax(*far, fabs((double)answers[i].inside[k] - samples[i].inside[k]));
	}
	printf("mesh %u, %u patches: %u wrong so far, at most %.2g of a patch off\n", kind, e.patches.count, *wrong, *far);
	elements_finish(&e);
	return s;
}

int main(void)
{
	static const double edges[] = {INFINITY, 0.2, 0.02};
	struct error err;
	uint32_t wrong = 0;
	double far = 0;
	enum status s = STATUS_OK;
	for (uint32_t kind = 0; kind < ELEMENT_MESHES && s == STATUS_OK; kind++)
		for (size_t k = 0; k < sizeof edges / sizeof *edges && s == STATUS_OK; k++)
			s = check(kind, edges[k], &wrong, &far, &err);
	if (s != STATUS_OK) {
		printf("%s: %s\n", s == STATUS_DEVICE ? "skipped" : "FAIL", err.text);
		return s == STATUS_DEVICE ? 77 : 1;
	}
	return wrong == 0 && far < NEAR ? 0 : 1;
}
