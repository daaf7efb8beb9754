#include "tests/bench/factor_subject.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct error err;

void factor_must(enum status s, const struct error *why)
{
	if (s == STATUS_OK)
		return;
	printf("FAIL: %s\n", why->text);
	exit(1);
}

void factor_subject_change(struct factor_subject *s, const struct rays_options *options)
{
	const struct plan plan = {0};
	rays_destroy(s->rays);
	s->per_row = options->rays;
	factor_must(rays_create(s->device, &s->scene, &plan, &s->elements, &s->buffers, options, &s->rays, &err), &err);
}

void factor_subject_init(struct factor_subject *s, struct device *device, const char *loader, const char *file, double edge,
			 const struct rays_options *options)
{
	memset(s, 0, sizeof *s);
	s->device = device;
	factor_must(load_scene(loader, file, &s->loaded, &err), &err);
	s->scene = (struct resident_scene){.blob = s->loaded.blob, .bytes = s->loaded.bytes, .fd = s->loaded.fd};
	blob_view_init(&s->scene.view, s->loaded.blob);
	factor_must(elements_init(&s->elements, &s->scene.view, &(struct patch_options){.edge = edge}, &err), &err);
	factor_must(element_buffers_init(&s->buffers, &s->elements, device, &err), &err);
	for (uint32_t i = 0; i < FACTOR_ROWS; i++)
		s->list[i] = (uint32_t)((i + 0.5) * s->elements.patches.count / FACTOR_ROWS);
	factor_subject_change(s, options);
}

void factor_subject_finish(struct factor_subject *s)
{
	rays_destroy(s->rays);
	element_buffers_finish(&s->buffers, s->device);
	elements_finish(&s->elements);
	for (unsigned i = 0; i < BIND_SCENE_COUNT; i++)
		buffer_finish(&s->scene.buffers[i], s->device);
	loaded_scene_finish(&s->loaded);
}
