#include "server/worker/plan/make.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "protocol/names.h"
#include "server/worker/plan/camera.h"
#include "server/worker/plan/effects.h"
#include "server/worker/technique/technique.h"

#define PLAN_SAMPLES_DEFAULT 64u

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

static enum status plan_imported(const candil_Render *r, const struct blob_header *file, struct plan_imported *imported,
				 struct error *err)
{
	if (!file)
		return STATUS_OK;
	const uint32_t elements = blob_count(file, BLOB_PATCH_ELEMENTS), rows = blob_count(file, BLOB_FACTOR_ROWS);
	if (elements == 0 && rows == 0)
		return error_set(err, STATUS_BAD_ARGUMENT, "'%s' is no file of patches or of form factors", r->imported);
	imported->factors = rows > 0;
	imported->elements = rows > 0 ? rows : elements;
	imported->entries = blob_count(file, BLOB_FACTOR_ENTRIES);
	memcpy(imported->hash, file->hash, sizeof imported->hash);
	return STATUS_OK;
}

// ---- options ------------------------------------------------------------------------------------------------------------

// The techniques that take an option, as a list in a sentence: "pt", "direct or vct".
static void list_takers(const char *option, char *out, size_t capacity)
{
	const char *names[TECHNIQUE_COUNT];
	size_t count = 0;
	for (uint32_t i = 0; i < technique_count(); i++)
		if (option_known(technique_at(i)->options, option))
			names[count++] = technique_name(technique_at(i)->number);
	names_list(names, count, "or", out, capacity);
}

// Refuse an option that no technique has. The sentence names the options of the technique that it begins with; the names of
// all would not fit.
static enum status no_such_option(const char *name, struct error *err)
{
	const char *dot = strchr(name, '.');
	const size_t prefix = dot ? (size_t)(dot - name) + 1 : 0;
	char known[LIMIT_TEXT + 1] = "", begin[64] = "";
	const int number = prefix ? technique_number(name, prefix - 1) : -1;
	const struct technique *of = number >= 0 ? technique_find((candil_Technique)number) : NULL;
	if (of)
		option_list(of->options, name, prefix, known, sizeof known);
	if (known[0])
		return error_set(err, STATUS_BAD_ARGUMENT, "there is no option '%s': known are %.*s%s", name, (int)prefix,
				 name, known);
	technique_list(TECHNIQUE_RENDERS, "or", begin, sizeof begin);
	return error_set(err, STATUS_BAD_ARGUMENT,
			 "there is no option '%s': they begin with %s and a dot, and with a wrong name behind that the rest "
			 "is told",
			 name, begin);
}

static enum status plan_option(const candil_Option *o, const struct technique *technique, struct plan *p, struct error *err)
{
	char takers[64];
	if (option_known(technique->options, o->name))
		return option_set(technique->options, o, &p->settings, err);
	list_takers(o->name, takers, sizeof takers);
	if (!takers[0])
		return no_such_option(o->name, err);
	return error_set(err, STATUS_BAD_ARGUMENT,
			 "option %s does nothing in %s, only with technique %s: ask for that, or leave the option out",
			 o->name, technique_name(technique->number), takers);
}

static enum status plan_options(const candil_Render *r, const struct technique *technique, struct plan *p, struct error *err)
{
	enum status s = STATUS_OK;
	technique->defaults(&p->settings);
	for (pb_size_t i = 0; s == STATUS_OK && i < r->options_count; i++)
		s = plan_option(&r->options[i], technique, p, err);
	return s == STATUS_OK && technique->check ? technique->check(p, err) : s;
}

// ---- all of it ----------------------------------------------------------------------------------------------------------

static void copy_request(const candil_Render *r, struct plan *p)
{
	p->width = r->width;
	p->height = r->height;
	p->samples = r->samples ? r->samples : PLAN_SAMPLES_DEFAULT;
	p->first_sample = r->first_sample;
	p->seed = r->seed;
	p->target_error = r->target_error;
	p->deadline = r->deadline_ms > 0;
	p->whole = r->whole;
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
}

enum status plan_make(const candil_Render *r, const struct blob_view *scene, const struct blob_header *environment,
		      const struct blob_header *imported, struct plan *p, struct error *err)
{
	memset(p, 0, sizeof *p);
	if (scene->blob->environment_width > 0)
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "'%s' is a picture of surroundings, no scene: name a scene, and this as its background",
				 r->scene);
	if (blob_count(scene->blob, BLOB_PATCH_ELEMENTS) > 0 || blob_count(scene->blob, BLOB_FACTOR_ROWS) > 0)
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "'%s' is a file of patches or of form factors, no scene: name the scene that it is of, and "
				 "this by " TECHNIQUE_OPTION_IMPORT,
				 r->scene);
	const struct technique *technique = technique_find(r->technique);
	if (!technique)
		return error_set(err, STATUS_UNSUPPORTED, "this worker has no such technique");
	if (!format_is_picture(r->format) && !(technique->files >> r->format & 1u))
		return error_set(err, STATUS_UNSUPPORTED, "%s makes no file of format %s", technique_name(technique->number),
				 format_name(r->format));
	p->technique = technique->number;
	copy_request(r, p);
	enum status s = plan_imported(r, imported, &p->imported, err);
	if (s == STATUS_OK)
		s = plan_options(r, technique, p, err);
	if (s == STATUS_OK)
		s = plan_environment(r, environment, &p->environment, err);
	if (s == STATUS_OK)
		s = plan_camera(r, scene, p, err);
	if (s != STATUS_OK)
		return s;
	p->depth = technique->depth(p);
	plan_effects(r, scene, technique, p);
	return STATUS_OK;
}
