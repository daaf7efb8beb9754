#include "server/front/quotes/key.h"

#include <pb_encode.h>
#include <stdlib.h>
#include <string.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "protocol/names.h"
#include "server/base/ipc.h"
#include "server/front/scenes.h"

static void add_text(XXH64_state_t *state, const char *text)
{
	XXH64_update(state, text ? text : "", text ? strlen(text) + 1 : 1);
}

static bool add_bytes(pb_ostream_t *stream, const pb_byte_t *bytes, size_t count)
{
	return XXH64_update(stream->state, bytes, count) == XXH_OK;
}

// All of a request that shows in the picture but its technique, its options, its size and its samples, with its camera or
// without.
static uint64_t hash_view(const candil_Render *render, bool camera)
{
	candil_Render r = *render;
	XXH64_state_t state;
	XXH64_reset(&state, 0);
	pb_ostream_t stream = {.callback = add_bytes, .state = &state, .max_size = SIZE_MAX};
	r.scene[0] = r.environment.scene[0] = r.imported[0] = 0;
	r.technique = candil_Technique_TECHNIQUE_AUTO;
	r.options_count = 0;
	r.whole = false;
	r.width = r.height = r.samples = r.first_sample = r.deadline_ms = r.progress_ms = r.aovs = 0;
	r.seed = 0;
	r.target_error = r.exposure_ev = 0;
	r.format = candil_Format_FORMAT_EXR_HALF;
	r.view = candil_View_VIEW_NONE;
	r.progressive = false;
	if (!camera) {
		r.has_camera = false;
		r.camera = (candil_Camera)candil_Camera_init_zero;
	}
	// A message that was decoded can be encoded.
	pb_encode(&stream, candil_Render_fields, &r);
	return XXH64_digest(&state);
}

static int compare_options(const void *a, const void *b)
{
	return strcmp(((const candil_Option *)a)->name, ((const candil_Option *)b)->name);
}

static uint64_t hash_look(const candil_Render *render, candil_Technique technique)
{
	candil_Option options[LIMIT_OPTIONS];
	size_t count = 0;
	XXH64_state_t state;
	XXH64_reset(&state, technique);
	// What it does not take, a reference is not drawn by.
	for (pb_size_t i = 0; i < render->options_count; i++)
		if (technique_takes(technique, render->options[i].name))
			options[count++] = render->options[i];
	qsort(options, count, sizeof *options, compare_options);
	for (size_t i = 0; i < count; i++) {
		add_text(&state, options[i].name);
		add_text(&state, options[i].value);
	}
	return XXH64_digest(&state);
}

static uint64_t hash_texts(const char *const *texts, size_t count)
{
	XXH64_state_t state;
	XXH64_reset(&state, 0);
	for (size_t i = 0; i < count; i++)
		add_text(&state, texts[i]);
	return XXH64_digest(&state);
}

struct quote_key quote_key_of(const candil_Render *render, candil_Technique technique, const struct subject_hashes *of,
			      const char *device)
{
	const char *const where[] = {device, ipc_build()};
	const char *parts[PARTS];
	for (unsigned i = 0; i < PARTS; i++)
		parts[i] = of->part[i];
	return (struct quote_key){.where = hash_texts(where, 2),
				  .scene = hash_texts(parts, PARTS),
				  .look = hash_look(render, technique),
				  .view = hash_view(render, true),
				  .light = hash_view(render, false)};
}

uint64_t quote_warmth_of(const struct quote_key *key, uint64_t of)
{
	return XXH64(&of, sizeof of, key->look ^ key->light);
}

uint64_t quote_facts_of(const struct subject *subject)
{
	const candil_SceneInfo *scene = &subject->part[PART_SCENE]->info;
	XXH64_state_t state;
	uint64_t parts = 0;
	for (unsigned i = 0; i < PARTS; i++)
		parts |= (uint64_t)(subject->part[i] != NULL) << i;
	XXH64_reset(&state, parts);
	for (pb_size_t i = 0; i < scene->facts_count; i++)
		add_text(&state, scene->facts[i]);
	return XXH64_digest(&state);
}

uint64_t quote_made_of(const struct subject *subject)
{
	uint64_t ids[PARTS];
	subject_ids(subject, ids);
	return XXH64(ids, sizeof ids, 0);
}
