#include "server/front/request.h"

#include <math.h>
#include <pb_decode.h>
#include <string.h>

#include "protocol/header.h"
#include "protocol/names.h"
#include "protocol/text.h"
#include "server/front/request_edits.h"

#define DEFAULT_SAMPLES 64u
#define OPEN_SAMPLES 65536u // where an error or a deadline is to end it
#define DEFAULT_PROGRESS_MS 100u
#define EFFECT_BITS ((1u << EFFECT_COUNT) - 1u)
#define METRES_PER_UNIT_MAX 1e9

enum status request_decode(const uint8_t *body, size_t bytes, const pb_msgdesc_t *fields, void *message, struct error *err)
{
	pb_istream_t stream = pb_istream_from_buffer(body, bytes);
	if (pb_decode(&stream, fields, message))
		return STATUS_OK;
	return error_set(err, STATUS_BAD_MESSAGE, "the body cannot be decoded (%s): see candil.proto",
			 PB_GET_ERROR(&stream));
}

// The same for a message with lists, one of which may be longer than its limit.
static enum status decode_lists(const uint8_t *body, size_t bytes, const pb_msgdesc_t *fields, void *message,
				struct error *err)
{
	pb_istream_t stream = pb_istream_from_buffer(body, bytes);
	if (pb_decode(&stream, fields, message))
		return STATUS_OK;
	if (!strcmp(PB_GET_ERROR(&stream), "array overflow"))
		return error_set(
		    err, STATUS_LIMIT,
		    "a request has at most %u options and %u edits of a kind, a sweep %u cameras or times: send "
		    "several requests",
		    LIMIT_OPTIONS, LIMIT_EDIT_NODES, LIMIT_SWEEP_CAMERAS);
	return error_set(err, STATUS_BAD_MESSAGE, "the body cannot be decoded (%s): see candil.proto",
			 PB_GET_ERROR(&stream));
}

static enum status check_name(const char *name, const char *what, struct error *err)
{
	if (text_is_name(name))
		return STATUS_OK;
	return error_set(err, STATUS_BAD_ARGUMENT,
			 "a %s's name has 1 to %u bytes of UTF-8 without '/' and control characters", what, LIMIT_NAME);
}

enum status request_hello(const uint8_t *body, size_t bytes, candil_Hello *hello, struct error *err)
{
	enum status status = request_decode(body, bytes, candil_Hello_fields, hello, err);
	if (status != STATUS_OK)
		return status;
	text_clean(hello->client, sizeof hello->client);
	if (hello->version_min > hello->version_max)
		return error_set(err, STATUS_BAD_MESSAGE, "version_min %u is above version_max %u", hello->version_min,
				 hello->version_max);
	return STATUS_OK;
}

enum status request_load(const uint8_t *body, size_t bytes, candil_Load *load, struct error *err)
{
	enum status status = request_decode(body, bytes, candil_Load_fields, load, err);
	if (status == STATUS_OK)
		status = check_name(load->name, "scene", err);
	if (status != STATUS_OK)
		return status;
	if (!text_is_plain_path(load->path))
		return error_set(err, STATUS_SCENE_PATH,
				 "the path must be relative, of plain components: no leading '/', no '.', no '..'");
	if ((unsigned)load->up > candil_UpAxis_UP_Z)
		return error_set(err, STATUS_BAD_ARGUMENT, "up is 0 (default), 1 (Y) or 2 (Z)");
	if (load->metres_per_unit == 0)
		load->metres_per_unit = 1;
	if (!isfinite(load->metres_per_unit) || load->metres_per_unit < 1 / METRES_PER_UNIT_MAX ||
	    load->metres_per_unit > METRES_PER_UNIT_MAX)
		return error_set(err, STATUS_BAD_ARGUMENT, "a unit is between 1e-9 and 1e9 metres, or 0 for 1");
	return STATUS_OK;
}

enum status request_unload(const uint8_t *body, size_t bytes, candil_Unload *unload, struct error *err)
{
	enum status status = request_decode(body, bytes, candil_Unload_fields, unload, err);
	return status == STATUS_OK ? check_name(unload->name, "scene", err) : status;
}

enum status request_describe(const uint8_t *body, size_t bytes, candil_Describe *describe, struct error *err)
{
	enum status status = request_decode(body, bytes, candil_Describe_fields, describe, err);
	return status == STATUS_OK ? check_name(describe->name, "scene", err) : status;
}

// ---- a render --------------------------------------------------------------------------------------------------------

static bool can(candil_Technique technique, unsigned trait)
{
	return technique_traits(technique) & trait;
}

// A technique that cannot do what is asked for: "a lens needs pt: …"
static enum status refuse_trait(const char *what, unsigned trait, const char *why, struct error *err)
{
	char known[64];
	technique_list(trait, "or", known, sizeof known);
	return error_set(err, STATUS_UNSUPPORTED, "%s needs %s: %s", what, known, why);
}

static uint32_t default_samples(const candil_Render *r)
{
	// More samples of a picture without noise only smooth its edges.
	if (!can(r->technique, TECHNIQUE_NOISE))
		return 1;
	if (!(r->target_error > 0) && r->deadline_ms == 0)
		return DEFAULT_SAMPLES;
	const uint32_t left = r->first_sample < LIMIT_SAMPLES ? LIMIT_SAMPLES - r->first_sample : 1;
	return left < OPEN_SAMPLES ? left : OPEN_SAMPLES;
}

static enum status check_size(candil_Render *r, struct error *err)
{
	if (r->width == 0 || r->height == 0)
		return error_set(err, STATUS_BAD_ARGUMENT, "width and height are at least 1 pixel");
	if (r->width > LIMIT_SIDE || r->height > LIMIT_SIDE)
		return error_set(err, STATUS_LIMIT, "width and height are at most %u pixels", LIMIT_SIDE);
	uint64_t pixels = (uint64_t)r->width * r->height;
	if (pixels > LIMIT_PIXELS)
		return error_set(err, STATUS_LIMIT, "an image has at most %u pixels: ask for a smaller one", LIMIT_PIXELS);
	if (r->samples == 0)
		r->samples = default_samples(r);
	if ((uint64_t)r->first_sample + r->samples > LIMIT_SAMPLES)
		return error_set(err, STATUS_LIMIT, "the first sample's number and the samples are at most %u together",
				 LIMIT_SAMPLES);
	if (r->samples * pixels > LIMIT_SAMPLES_TIMES_PIXELS)
		return error_set(err, STATUS_LIMIT, "samples times pixels is at most %llu: split the samples over requests",
				 LIMIT_SAMPLES_TIMES_PIXELS);
	return STATUS_OK;
}

static enum status check_technique(const candil_Render *r, struct error *err)
{
	char known[64];
	if ((unsigned)r->technique >= TECHNIQUE_COUNT)
		return error_set(err, STATUS_BAD_ARGUMENT, "technique %u is none of candil.proto", (unsigned)r->technique);
	if (technique_traits(r->technique) & TECHNIQUE_RENDERS)
		return STATUS_OK;
	technique_list(TECHNIQUE_RENDERS, "or", known, sizeof known);
	return error_set(err, STATUS_UNSUPPORTED, "this daemon has no technique %s: ask for %s",
			 technique_name(r->technique), known);
}

static bool within(const candil_Vec3 *v, double least, double most)
{
	return v->x >= least && v->x <= most && v->y >= least && v->y <= most && v->z >= least && v->z <= most;
}

static double length(double x, double y, double z)
{
	return sqrt(x * x + y * y + z * z);
}

static enum status check_directions(const candil_Camera *c, struct error *err)
{
	double fx = c->target.x - c->eye.x, fy = c->target.y - c->eye.y, fz = c->target.z - c->eye.z;
	double forward = length(fx, fy, fz), up = length(c->up.x, c->up.y, c->up.z);
	if (!(forward > 0))
		return error_set(err, STATUS_BAD_ARGUMENT, "the camera's target must differ from its eye");
	if (!(up > 0))
		return error_set(err, STATUS_BAD_ARGUMENT, "the camera's up vector must not be zero");
	fx /= forward, fy /= forward, fz /= forward;
	double ux = c->up.x / up, uy = c->up.y / up, uz = c->up.z / up;
	if (!(length(fy * uz - fz * uy, fz * ux - fx * uz, fx * uy - fy * ux) > 1e-6))
		return error_set(err, STATUS_BAD_ARGUMENT, "the camera's up vector must not point along its view");
	return STATUS_OK;
}

// A camera whose lens says how wide it sees needs no angle.
static enum status check_camera(candil_Camera *c, const candil_Lens *lens, struct error *err)
{
	if (!text_is_clean(c->name))
		return error_set(err, STATUS_BAD_ARGUMENT, "a camera's name is UTF-8 without control characters");
	if (c->name[0] || (!c->has_eye && !c->has_target && !c->has_up && c->vfov_degrees == 0))
		return STATUS_OK;
	if (!c->has_eye || !c->has_target)
		return error_set(err, STATUS_BAD_ARGUMENT, "a camera without a name needs eye and target");
	if (!c->has_up) {
		c->has_up = true;
		c->up = (candil_Vec3){.y = 1};
	}
	if (!within(&c->eye, -LIMIT_COORDINATE, LIMIT_COORDINATE) ||
	    !within(&c->target, -LIMIT_COORDINATE, LIMIT_COORDINATE) || !within(&c->up, -LIMIT_COORDINATE, LIMIT_COORDINATE))
		return error_set(err, STATUS_BAD_ARGUMENT, "a camera's coordinates are finite and at most %g",
				 LIMIT_COORDINATE);
	const bool needs_angle = lens->projection == candil_Projection_PROJECTION_CAMERA;
	if (needs_angle && !(c->vfov_degrees > 0 && c->vfov_degrees < 180))
		return error_set(err, STATUS_BAD_ARGUMENT, "a camera's angle of view is above 0 and below 180 degrees");
	return check_directions(c, err);
}

static bool is_length(double metres)
{
	return metres > 0 && metres <= LIMIT_COORDINATE;
}

static enum status check_lens(const candil_Lens *l, candil_Technique technique, struct error *err)
{
	const bool orthographic = l->projection == candil_Projection_PROJECTION_ORTHOGRAPHIC;
	const bool panorama = l->projection == candil_Projection_PROJECTION_PANORAMA;
	if ((unsigned)l->projection > candil_Projection_PROJECTION_PANORAMA)
		return error_set(err, STATUS_BAD_ARGUMENT, "projection %u is none of candil.proto", (unsigned)l->projection);
	if (orthographic && !is_length(l->height))
		return error_set(err, STATUS_BAD_ARGUMENT, "an orthographic camera needs the height of its image in metres");
	if (!(l->radius >= 0 && l->radius <= LIMIT_COORDINATE))
		return error_set(err, STATUS_BAD_ARGUMENT, "a lens's radius is 0, for a pinhole, or a length in metres");
	if (l->radius > 0 && !is_length(l->focus))
		return error_set(err, STATUS_BAD_ARGUMENT, "a lens needs the distance in metres at which it is sharp");
	if (l->radius > 0 && panorama)
		return error_set(err, STATUS_BAD_ARGUMENT, "a panorama has no lens: leave its radius out");
	if ((panorama || l->radius > 0) && !can(technique, TECHNIQUE_LENS))
		return refuse_trait(panorama ? "a panorama" : "a lens with a radius", TECHNIQUE_LENS,
				    "other techniques see through a pinhole alone", err);
	return STATUS_OK;
}

static enum status check_filter(const candil_Render *r, struct error *err)
{
	if ((unsigned)r->filter > candil_Filter_FILTER_BLACKMAN_HARRIS)
		return error_set(err, STATUS_BAD_ARGUMENT, "filter %u is none of candil.proto", (unsigned)r->filter);
	if (r->filter != candil_Filter_FILTER_BOX && !can(r->technique, TECHNIQUE_LENS))
		return refuse_trait("a pixel filter", TECHNIQUE_LENS, "other techniques take light through a box", err);
	return STATUS_OK;
}

// `asked`: it is only asked about its error, which any technique may be, also one that cannot end by it.
static enum status check_end(const candil_Render *r, bool asked, struct error *err)
{
	if (!(r->target_error >= 0 && isfinite(r->target_error)))
		return error_set(err, STATUS_BAD_ARGUMENT, "a target error is a relative MSE above 0, or 0 for none");
	if (r->target_error > 0 && !asked && !can(r->technique, TECHNIQUE_NOISE))
		return refuse_trait("a target error", TECHNIQUE_NOISE,
				    "other techniques do not know their error while they render", err);
	if (r->deadline_ms > LIMIT_DEADLINE_MS)
		return error_set(err, STATUS_LIMIT, "a deadline is at most %u ms away", LIMIT_DEADLINE_MS);
	return STATUS_OK;
}

static enum status check_effects(const candil_Render *r, struct error *err)
{
	if ((r->effects_on | r->effects_off) & ~EFFECT_BITS)
		return error_set(err, STATUS_UNSUPPORTED, "an effect's bit is unknown to this daemon");
	if (r->effects_on & r->effects_off)
		return error_set(err, STATUS_BAD_ARGUMENT, "an effect is switched on and off at once");
	return STATUS_OK;
}

static enum status check_environment(candil_Render *r, struct error *err)
{
	candil_Environment *e = &r->environment;
	if (!r->has_environment)
		return STATUS_OK;
	if (r->has_background)
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "a background is a colour or a picture: leave `background` or `environment` out");
	if (check_name(e->scene, "picture", err) != STATUS_OK)
		return err->code;
	if (!(fabs(e->rotation_degrees) <= LIMIT_TURN_DEGREES))
		return error_set(err, STATUS_BAD_ARGUMENT, "a picture of surroundings is turned by -%g to %g degrees",
				 LIMIT_TURN_DEGREES, LIMIT_TURN_DEGREES);
	if (e->scale == 0)
		e->scale = 1;
	if (!(e->scale >= 1 / LIMIT_ENVIRONMENT_SCALE && e->scale <= LIMIT_ENVIRONMENT_SCALE))
		return error_set(err, STATUS_BAD_ARGUMENT, "a picture's scale is between %g and %g, or 0 for 1",
				 1 / LIMIT_ENVIRONMENT_SCALE, LIMIT_ENVIRONMENT_SCALE);
	return STATUS_OK;
}

static enum status check_imported(const candil_Render *r, struct error *err)
{
	if (!r->imported[0])
		return STATUS_OK;
	if (!can(r->technique, TECHNIQUE_PATCHES))
		return refuse_trait("an imported file", TECHNIQUE_PATCHES, "other techniques have no patches", err);
	return check_name(r->imported, "file", err);
}

// A file that is no picture.
static enum status check_file(const candil_Render *r, struct error *err)
{
	if (!can(r->technique, TECHNIQUE_PATCHES))
		return refuse_trait("a file of patches", TECHNIQUE_PATCHES, "other techniques have none", err);
	if (r->progressive || r->deadline_ms > 0)
		return error_set(
		    err, STATUS_BAD_ARGUMENT,
		    "a file of patches comes whole, when it is ready: leave intermediate images and the deadline out");
	return STATUS_OK;
}

static enum status check_output(candil_Render *r, struct error *err)
{
	if ((unsigned)r->format >= _candil_Format_ARRAYSIZE)
		return error_set(err, STATUS_BAD_ARGUMENT, "format %u is none of candil.proto", (unsigned)r->format);
	if (!format_is_picture(r->format) && check_file(r, err) != STATUS_OK)
		return err->code;
	if ((unsigned)r->view > candil_View_VIEW_FILMIC)
		return error_set(err, STATUS_BAD_ARGUMENT, "view %u is none of candil.proto", (unsigned)r->view);
	if (r->aovs & ~(uint32_t)AOV_ALL)
		return error_set(err, STATUS_UNSUPPORTED, "an AOV's bit is unknown to this daemon");
	if (r->aovs && r->format != candil_Format_FORMAT_EXR_HALF && r->format != candil_Format_FORMAT_EXR_FLOAT)
		return error_set(err, STATUS_BAD_ARGUMENT, "AOVs need an EXR: other files have no place for them");
	if (!(fabs(r->exposure_ev) <= LIMIT_EXPOSURE_EV))
		return error_set(err, STATUS_BAD_ARGUMENT, "an exposure is between -%g and %g stops", LIMIT_EXPOSURE_EV,
				 LIMIT_EXPOSURE_EV);
	if (r->has_background && !within(&r->background, 0, LIMIT_RADIANCE))
		return error_set(err, STATUS_BAD_ARGUMENT, "a background's components are between 0 and %g", LIMIT_RADIANCE);
	if (r->progress_ms == 0)
		r->progress_ms = DEFAULT_PROGRESS_MS;
	if (r->progress_ms > LIMIT_PROGRESS_MS)
		return error_set(err, STATUS_LIMIT, "progress is told every %u ms at least", LIMIT_PROGRESS_MS);
	return STATUS_OK;
}

// technique.option, lower case, digits, '_'
static bool is_option_name(const char *name)
{
	static const char letters[] = "abcdefghijklmnopqrstuvwxyz0123456789_";
	size_t technique = strspn(name, letters);
	if (technique == 0 || name[technique] != '.')
		return false;
	size_t option = strspn(name + technique + 1, letters);
	return option > 0 && name[technique + 1 + option] == 0;
}

static bool is_option_value(const char *value)
{
	static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.+-:,";
	return *value && value[strspn(value, letters)] == 0;
}

static enum status check_options(const candil_Render *r, struct error *err)
{
	for (pb_size_t i = 0; i < r->options_count; i++) {
		const candil_Option *o = &r->options[i];
		if (!is_option_name(o->name) || !is_option_value(o->value))
			return error_set(err, STATUS_BAD_ARGUMENT,
					 "an option is technique.name in small letters and a value without spaces");
		for (pb_size_t j = 0; j < i; j++)
			if (!strcmp(o->name, r->options[j].name))
				return error_set(err, STATUS_BAD_ARGUMENT, "option %s is given twice", o->name);
	}
	return STATUS_OK;
}

static enum status check_render(candil_Render *render, bool asked, struct error *err)
{
	enum status status = check_name(render->scene, "scene", err);
	if (status == STATUS_OK)
		status = check_size(render, err);
	if (status == STATUS_OK)
		status = check_technique(render, err);
	if (status == STATUS_OK)
		status = check_lens(&render->lens, render->technique, err);
	if (status == STATUS_OK && render->has_camera)
		status = check_camera(&render->camera, &render->lens, err);
	if (status == STATUS_OK)
		status = check_filter(render, err);
	if (status == STATUS_OK)
		status = check_end(render, asked, err);
	if (status == STATUS_OK)
		status = check_effects(render, err);
	if (status == STATUS_OK)
		status = check_output(render, err);
	if (status == STATUS_OK)
		status = check_environment(render, err);
	if (status == STATUS_OK)
		status = check_imported(render, err);
	if (status == STATUS_OK)
		status = check_options(render, err);
	if (status == STATUS_OK && render->has_edits)
		status = request_check_edits(&render->edits, err);
	return status;
}

enum status request_check_render(candil_Render *render, struct error *err)
{
	return check_render(render, false, err);
}

enum status request_render(const uint8_t *body, size_t bytes, candil_Render *render, struct error *err)
{
	enum status status = decode_lists(body, bytes, candil_Render_fields, render, err);
	return status == STATUS_OK ? request_check_render(render, err) : status;
}

// ---- a quote ---------------------------------------------------------------------------------------------------------

bool request_is_open(const candil_Render *r)
{
	return r->technique == candil_Technique_TECHNIQUE_AUTO && (r->target_error > 0 || r->deadline_ms > 0);
}

enum status request_quote(const uint8_t *body, size_t bytes, candil_Quote *quote, struct error *err)
{
	enum status status = decode_lists(body, bytes, candil_Quote_fields, quote, err);
	if (status == STATUS_OK && !quote->has_render)
		status = error_set(err, STATUS_BAD_ARGUMENT, "a quote is about a render: fill in `render`");
	if (status == STATUS_OK && !format_is_picture(quote->render.format))
		status = error_set(err, STATUS_BAD_ARGUMENT, "a quote is about a picture: ask for the format of one");
	if (status == STATUS_OK && quote->pilot_ms > LIMIT_PILOT_MS)
		status = error_set(err, STATUS_LIMIT, "a pilot takes at most %u ms", LIMIT_PILOT_MS);
	return status == STATUS_OK ? check_render(&quote->render, true, err) : status;
}

// ---- a sweep ---------------------------------------------------------------------------------------------------------

_Static_assert(candil_Sweep_size <= LIMIT_MESSAGE_BYTES, "the longest sweep fits a message");
_Static_assert(sizeof((candil_Sweep *)0)->cameras / sizeof(candil_Camera) == LIMIT_SWEEP_CAMERAS, "candil.options agrees");
_Static_assert(sizeof((candil_Sweep *)0)->times / sizeof(double) == LIMIT_SWEEP_CAMERAS, "candil.options agrees");
_Static_assert(sizeof((candil_Edits *)0)->lights / sizeof(candil_Light) == LIMIT_EDIT_LIGHTS &&
		   sizeof((candil_Edits *)0)->materials / sizeof(candil_MaterialEdit) == LIMIT_EDIT_MATERIALS &&
		   sizeof((candil_Edits *)0)->nodes / sizeof(candil_NodeEdit) == LIMIT_EDIT_NODES,
	       "candil.options agrees");

// One camera an image, or one for all times.
static enum status check_times(const candil_Sweep *sweep, struct error *err)
{
	enum status status = STATUS_OK;
	if (sweep->times_count == 0)
		return STATUS_OK;
	if (!sweep->render.edits.animation[0])
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "a sweep over times needs an animation: name one in render.edits");
	if (sweep->cameras_count != 1 && sweep->cameras_count != sweep->times_count)
		return error_set(err, STATUS_BAD_ARGUMENT, "a sweep over %u times takes as many cameras, or one for all",
				 (unsigned)sweep->times_count);
	for (pb_size_t i = 0; i < sweep->times_count && status == STATUS_OK; i++)
		status = request_check_time(sweep->times[i], err);
	return status;
}

enum status request_sweep(const uint8_t *body, size_t bytes, candil_Sweep *sweep, struct error *err)
{
	candil_Render *render = &sweep->render;
	enum status status = decode_lists(body, bytes, candil_Sweep_fields, sweep, err);
	if (status == STATUS_OK && sweep->cameras_count == 0)
		status = error_set(err, STATUS_BAD_ARGUMENT, "a sweep needs at least one camera");
	if (status == STATUS_OK && render->has_camera)
		status = error_set(err, STATUS_BAD_ARGUMENT, "a sweep's cameras are in `cameras`: leave render.camera out");
	if (status == STATUS_OK && !format_is_picture(render->format))
		status =
		    error_set(err, STATUS_BAD_ARGUMENT, "a sweep is of pictures: ask for a file of patches by a render");
	if (status == STATUS_OK)
		status = request_check_render(render, err);
	for (pb_size_t i = 0; i < sweep->cameras_count && status == STATUS_OK; i++)
		status = check_camera(&sweep->cameras[i], &render->lens, err);
	if (status == STATUS_OK)
		status = check_times(sweep, err);
	const uint64_t images = sweep->times_count > 0 ? sweep->times_count : sweep->cameras_count;
	// No product of these passes 2^64: each was held to its own limit.
	uint64_t samples = (uint64_t)render->samples * render->width * render->height;
	if (status == STATUS_OK && samples * images > LIMIT_SAMPLES_TIMES_PIXELS)
		status = error_set(err, STATUS_LIMIT,
				   "images times samples times pixels is at most %llu: split them over requests",
				   LIMIT_SAMPLES_TIMES_PIXELS);
	return status;
}
