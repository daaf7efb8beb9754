#include "protocol/asked.h"

#include <pb_encode.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "protocol/header.h"
#include "protocol/limits.h"
#include "protocol/names.h"

// Numbers by 17 digits: all that tell two doubles apart.
#define NUMBER "%.17g"
#define THREE NUMBER "," NUMBER "," NUMBER

_Static_assert(LIMIT_OPTIONS *(LIMIT_OPTION_NAME + 1 + LIMIT_OPTION_VALUE + 1) < ASKED_TEXT_BYTES, "all options fit");

static void append(char text[ASKED_TEXT_BYTES], const char *format, ...) __attribute__((format(printf, 2, 3)));

static void append(char text[ASKED_TEXT_BYTES], const char *format, ...)
{
	const size_t used = strlen(text);
	va_list args;
	va_start(args, format);
	vsnprintf(text + used, ASKED_TEXT_BYTES - used, format, args);
	va_end(args);
}

static const char *comma(const char *text)
{
	return text[0] ? "," : "";
}

static void camera_words(const candil_Render *r, char text[ASKED_TEXT_BYTES])
{
	const candil_Camera *c = &r->camera;
	if (!r->has_camera || (!c->name[0] && !c->has_eye))
		append(text, "first");
	else if (c->name[0])
		append(text, "name %s", c->name);
	else
		append(text, THREE "," THREE "," THREE "," NUMBER, c->eye.x, c->eye.y, c->eye.z, c->target.x, c->target.y,
		       c->target.z, c->up.x, c->up.y, c->up.z, c->vfov_degrees);
}

static void lens_words(const candil_Lens *lens, char text[ASKED_TEXT_BYTES])
{
	if (lens->projection == candil_Projection_PROJECTION_ORTHOGRAPHIC)
		append(text, "orthographic " NUMBER, lens->height);
	else if (lens->projection == candil_Projection_PROJECTION_PANORAMA)
		append(text, "panorama");
	else
		append(text, "camera");
	if (lens->radius > 0)
		append(text, ",radius " NUMBER ",focus " NUMBER, lens->radius, lens->focus);
}

static void effects_words(const candil_Render *r, char text[ASKED_TEXT_BYTES])
{
	for (unsigned i = 0; i < EFFECT_COUNT; i++)
		if ((r->effects_on | r->effects_off) >> i & 1u)
			append(text, "%s%c%s", comma(text), r->effects_on >> i & 1u ? '+' : '-', effect_name(i));
	if (!text[0])
		append(text, "auto");
}

static void aovs_words(uint32_t aovs, char text[ASKED_TEXT_BYTES])
{
	static const struct {
		uint32_t bit;
		const char *name;
	} known[] = {{AOV_DEPTH, "depth"}, {AOV_NORMAL, "normal"}, {AOV_ALBEDO, "albedo"}, {AOV_ID, "id"}};
	for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
		if (aovs & known[i].bit)
			append(text, "%s%s", comma(text), known[i].name);
	if (!text[0])
		append(text, "none");
}

static void background_words(const candil_Render *r, char text[ASKED_TEXT_BYTES])
{
	const candil_Environment *e = &r->environment;
	if (r->has_environment)
		append(text, "picture,turn " NUMBER ",scale " NUMBER, e->rotation_degrees, e->scale > 0 ? e->scale : 1);
	else if (r->has_background)
		append(text, THREE, r->background.x, r->background.y, r->background.z);
	else
		append(text, "black");
}

static void options_words(const candil_Render *r, char text[ASKED_TEXT_BYTES])
{
	for (pb_size_t i = 0; i < r->options_count; i++)
		append(text, "%s%s=%s", comma(text), r->options[i].name, r->options[i].value);
	if (!text[0])
		append(text, "none");
}

// FNV-1a, 64 bits.
static bool hash_bytes(pb_ostream_t *stream, const pb_byte_t *bytes, size_t count)
{
	uint64_t *hash = stream->state;
	for (size_t i = 0; i < count; i++)
		*hash = (*hash ^ bytes[i]) * 0x100000001b3u;
	return true;
}

static void edits_words(const candil_Render *r, char text[ASKED_TEXT_BYTES])
{
	uint64_t hash = 0xcbf29ce484222325u;
	pb_ostream_t stream = {.callback = hash_bytes, .state = &hash, .max_size = SIZE_MAX};
	if (!r->has_edits || !pb_encode(&stream, candil_Edits_fields, &r->edits) || stream.bytes_written == 0)
		append(text, "none");
	else
		append(text, "%016llx", (unsigned long long)hash);
}

static void end_words(const candil_Render *r, char text[ASKED_TEXT_BYTES])
{
	if (r->target_error > 0)
		append(text, "error " NUMBER, r->target_error);
	if (r->deadline_ms > 0)
		append(text, "%stime %u%s", comma(text), r->deadline_ms, r->whole ? " whole" : "");
	if (!text[0])
		append(text, "samples");
}

static void view_words(const candil_Render *r, char text[ASKED_TEXT_BYTES])
{
	static const char *const views[] = {"none", "reinhard", "filmic"};
	const unsigned view = (unsigned)r->view;
	append(text, "%s,exposure " NUMBER, view < sizeof views / sizeof views[0] ? views[view] : "unknown", r->exposure_ev);
}

void asked_words(const candil_Render *render, asked_take *take, void *user)
{
	static const char *const filters[] = {"box", "gauss", "bh"};
	const unsigned filter = (unsigned)render->filter;
	const unsigned technique = (unsigned)render->technique;
	char text[ASKED_TEXT_BYTES];
#define TAKE(key, words) (text[0] = '\0', (words), take(user, (key), text))
	TAKE("technique", append(text, "%s", technique_name(technique ? technique : TECHNIQUE_OF_AUTO)));
	TAKE("camera", camera_words(render, text));
	TAKE("lens", lens_words(&render->lens, text));
	TAKE("samples", append(text, "%u", render->samples));
	TAKE("first_sample", append(text, "%u", render->first_sample));
	TAKE("seed", append(text, "%llu", (unsigned long long)render->seed));
	TAKE("end", end_words(render, text));
	TAKE("options", options_words(render, text));
	TAKE("effects", effects_words(render, text));
	TAKE("edits", edits_words(render, text));
	TAKE("background", background_words(render, text));
	TAKE("default_light", append(text, "%s", render->default_light ? "on" : "off"));
	TAKE("filter", append(text, "%s", filter < sizeof filters / sizeof filters[0] ? filters[filter] : "unknown"));
	TAKE("aovs", aovs_words(render->aovs, text));
	TAKE("format", append(text, "%s", format_name((unsigned)render->format)));
	if (render->format == candil_Format_FORMAT_PNG)
		TAKE("view", view_words(render, text));
#undef TAKE
}
