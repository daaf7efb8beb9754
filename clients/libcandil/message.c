#include "clients/libcandil/message.h"

#include <math.h>
#include <pb_decode.h>
#include <string.h>

#include "clients/libcandil/error.h"
#include "protocol/header.h"
#include "protocol/names.h"
#include "protocol/text.h"

#define TEXT(to, from) text_copy((to), sizeof(to), (from))
#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

// ---- requests -------------------------------------------------------------------------------------------------------

static candil_status take_string(const char *what, const char *in, char *out, size_t capacity, struct candil_error *error)
{
	if (!in || !*in)
		return error_set(error, CANDIL_STATUS_BAD_ARGUMENT, "%s is missing", what);
	if (strlen(in) >= capacity)
		return error_set(error, CANDIL_STATUS_BAD_ARGUMENT, "%s is longer than %zu bytes", what, capacity - 1);
	strcpy(out, in);
	return CANDIL_STATUS_OK;
}

static candil_Vec3 vec3_write(const struct candil_vec3 *v)
{
	return (candil_Vec3){v->x, v->y, v->z};
}

candil_status message_write_name(const char *name, char *out, size_t capacity, struct candil_error *error)
{
	return take_string("the scene's name", name, out, capacity, error);
}

candil_status message_write_load(const struct candil_load_request *request, candil_Load *load, struct candil_error *error)
{
	if (!request->server_path == !request->file)
		return error_set(error, CANDIL_STATUS_BAD_ARGUMENT, "a load names either a path of the daemon's or a file");
	load->up = (candil_UpAxis)request->up;
	load->metres_per_unit = request->metres_per_unit;
	candil_status status = message_write_name(request->name, load->name, sizeof(load->name), error);
	if (status == CANDIL_STATUS_OK && request->server_path)
		status = take_string("the scene's path", request->server_path, load->path, sizeof(load->path), error);
	return status;
}

static candil_status write_camera(const struct candil_render_request *request, candil_Render *render,
				  struct candil_error *error)
{
	candil_Camera *camera = &render->camera;
	if (request->camera_name) {
		render->has_camera = true;
		return take_string("the camera's name", request->camera_name, camera->name, sizeof(camera->name), error);
	}
	if (request->has_camera) {
		render->has_camera = camera->has_eye = camera->has_target = camera->has_up = true;
		camera->eye = vec3_write(&request->eye);
		camera->target = vec3_write(&request->target);
		camera->up = vec3_write(&request->up);
		camera->vfov_degrees = request->vfov_degrees;
	}
	return CANDIL_STATUS_OK;
}

static candil_status write_options(const struct candil_render_request *request, candil_Render *render,
				   struct candil_error *error)
{
	if (request->option_count > COUNT(render->options))
		return error_set(error, CANDIL_STATUS_LIMIT, "a render takes at most %zu options", COUNT(render->options));
	candil_status status =
	    error_if_missing(request->options || request->option_count == 0, "the request's options", error);
	for (size_t i = 0; i < request->option_count && status == CANDIL_STATUS_OK; i++) {
		candil_Option *to = &render->options[render->options_count++];
		status = take_string("an option's name", request->options[i].name, to->name, sizeof(to->name), error);
		if (status == CANDIL_STATUS_OK)
			status =
			    take_string("an option's value", request->options[i].value, to->value, sizeof(to->value), error);
	}
	return status;
}

static candil_status write_light(const struct candil_light *from, candil_Light *to)
{
	*to = (candil_Light){.kind = (candil_LightKind)from->kind,
			     .has_position = true,
			     .has_direction = true,
			     .has_intensity = true,
			     .inner_degrees = from->inner_degrees,
			     .outer_degrees = from->outer_degrees,
			     .angle_degrees = from->angle_degrees,
			     .range = from->range};
	to->position = vec3_write(&from->position);
	to->direction = vec3_write(&from->direction);
	to->intensity = vec3_write(&from->intensity);
	return CANDIL_STATUS_OK;
}

static candil_status write_material(const struct candil_material_edit *from, candil_MaterialEdit *to,
				    struct candil_error *error)
{
	*to = (candil_MaterialEdit){
	    .has_base_color = from->has_base_color, .has_emission = from->has_emission, .has_specular = from->has_specular};
	to->base_color = vec3_write(&from->base_color);
	to->emission = vec3_write(&from->emission);
	to->specular = vec3_write(&from->specular);
#define WRITE_SHARE(field, ...) \
	to->has_##field = from->has_##field; \
	to->field = from->field;
	CANDIL_MATERIAL_SHARES(WRITE_SHARE)
	return take_string("a material's name", from->name, to->name, sizeof(to->name), error);
}

static candil_status write_node(const struct candil_node_edit *from, candil_NodeEdit *to, struct candil_error *error)
{
	*to = (candil_NodeEdit){
	    .has_translation = from->has_translation, .has_rotation = from->has_rotation, .has_scale = from->has_scale};
	to->translation = vec3_write(&from->translation);
	to->rotation = (candil_Quaternion){from->rotation[0], from->rotation[1], from->rotation[2], from->rotation[3]};
	to->scale = vec3_write(&from->scale);
	return take_string("a node's name", from->name, to->name, sizeof(to->name), error);
}

static candil_status write_edits(const struct candil_edits *from, candil_Edits *to, struct candil_error *error)
{
	candil_status status = CANDIL_STATUS_OK;
	if (from->light_count > COUNT(to->lights) || from->material_count > COUNT(to->materials) ||
	    from->node_count > COUNT(to->nodes))
		return error_set(error, CANDIL_STATUS_LIMIT, "a request edits at most %zu lights, materials and nodes each",
				 COUNT(to->lights));
	status =
	    error_if_missing((from->lights || from->light_count == 0) && (from->materials || from->material_count == 0) &&
				 (from->nodes || from->node_count == 0),
			     "a list of the request's edits", error);
	if (status != CANDIL_STATUS_OK)
		return status;
	to->replace_lights = from->replace_lights;
	to->time_s = from->time_s;
	for (size_t i = 0; i < from->light_count; i++)
		status = write_light(&from->lights[i], &to->lights[to->lights_count++]);
	for (size_t i = 0; i < from->material_count && status == CANDIL_STATUS_OK; i++)
		status = write_material(&from->materials[i], &to->materials[to->materials_count++], error);
	for (size_t i = 0; i < from->node_count && status == CANDIL_STATUS_OK; i++)
		status = write_node(&from->nodes[i], &to->nodes[to->nodes_count++], error);
	if (status == CANDIL_STATUS_OK && from->animation)
		status = take_string("the animation's name", from->animation, to->animation, sizeof(to->animation), error);
	return status;
}

static candil_status write_sweep_camera(const struct candil_camera *from, candil_Camera *to, struct candil_error *error)
{
	*to = (candil_Camera)candil_Camera_init_zero;
	if (from->name)
		return take_string("a camera's name", from->name, to->name, sizeof(to->name), error);
	if (!(from->vfov_degrees < 0) && !(from->vfov_degrees > 0)) // 0: the scene's first camera
		return CANDIL_STATUS_OK;
	to->has_eye = to->has_target = to->has_up = true;
	to->eye = vec3_write(&from->eye);
	to->target = vec3_write(&from->target);
	to->up = vec3_write(&from->up);
	to->vfov_degrees = from->vfov_degrees;
	return CANDIL_STATUS_OK;
}

candil_status message_write_sweep(const struct candil_render_request *request, const struct candil_camera *cameras,
				  size_t count, candil_Sweep *sweep, struct candil_error *error)
{
	_Static_assert(COUNT(sweep->cameras) == CANDIL_SWEEP_CAMERAS, "candil_types.h and candil.options differ");
	if (count < 1 || count > CANDIL_SWEEP_CAMERAS)
		return error_set(error, CANDIL_STATUS_LIMIT, "a sweep takes 1 to %u cameras", CANDIL_SWEEP_CAMERAS);
	sweep->has_render = true;
	candil_status status = message_write_render(request, &sweep->render, error);
	sweep->render.has_camera = false;
	for (size_t i = 0; i < count && status == CANDIL_STATUS_OK; i++)
		status = write_sweep_camera(&cameras[i], &sweep->cameras[sweep->cameras_count++], error);
	for (size_t i = 0; i < count && request->edits && request->edits->animation; i++)
		sweep->times[sweep->times_count++] = cameras[i].time_s;
	return status;
}

candil_status message_write_render(const struct candil_render_request *request, candil_Render *render,
				   struct candil_error *error)
{
	render->technique = (candil_Technique)request->technique;
	render->width = request->width;
	render->height = request->height;
	render->samples = request->samples;
	render->first_sample = request->first_sample;
	render->seed = request->seed;
	render->effects_on = request->effects_on;
	render->effects_off = request->effects_off;
	render->aovs = request->aovs;
	render->format = (candil_Format)request->format;
	render->exposure_ev = request->exposure_ev;
	render->view = (candil_View)request->view;
	render->progressive = request->progressive;
	render->default_light = request->default_light;
	render->has_background = request->has_background;
	if (request->has_background)
		render->background = vec3_write(&request->background);
	render->progress_ms = request->progress_ms;
	render->has_lens = true;
	render->lens = (candil_Lens){.projection = (candil_Projection)request->lens.projection,
				     .height = request->lens.height,
				     .radius = request->lens.radius,
				     .focus = request->lens.focus};
	render->filter = (candil_Filter)request->filter;
	render->target_error = request->target_error;
	render->deadline_ms = request->deadline_ms;
	render->whole = request->whole;
	candil_status status = message_write_name(request->scene, render->scene, sizeof(render->scene), error);
	render->has_environment = request->environment != NULL;
	render->environment.rotation_degrees = request->environment_turn_degrees;
	render->environment.scale = request->environment_scale;
	if (status == CANDIL_STATUS_OK && request->environment)
		status = message_write_name(request->environment, render->environment.scene,
					    sizeof(render->environment.scene), error);
	if (status == CANDIL_STATUS_OK && request->imported)
		status = message_write_name(request->imported, render->imported, sizeof(render->imported), error);
	if (status == CANDIL_STATUS_OK)
		status = write_camera(request, render, error);
	if (status == CANDIL_STATUS_OK)
		status = write_options(request, render, error);
	render->has_edits = request->edits != NULL;
	if (status == CANDIL_STATUS_OK && request->edits)
		status = write_edits(request->edits, &render->edits, error);
	return status;
}

// ---- replies --------------------------------------------------------------------------------------------------------

static struct candil_vec3 vec3_read(bool has, const candil_Vec3 *v)
{
	return has ? (struct candil_vec3){v->x, v->y, v->z} : (struct candil_vec3){0, 0, 0};
}

static void read_camera(const candil_CameraInfo *from, struct candil_camera_info *to)
{
	TEXT(to->name, from->name);
	to->eye = vec3_read(from->has_eye, &from->eye);
	to->target = vec3_read(from->has_target, &from->target);
	to->up = vec3_read(from->has_up, &from->up);
	to->vfov_degrees = from->vfov_degrees;
}

static void read_scene_lists(const candil_SceneInfo *from, struct candil_scene_info *to)
{
	_Static_assert(COUNT(to->cameras) == COUNT(from->cameras) && COUNT(to->warnings) == COUNT(from->warnings) &&
			   COUNT(to->ignored) == COUNT(from->ignored) && COUNT(to->facts) == COUNT(from->facts),
		       "candil_types.h and candil.options differ");
	to->camera_count = from->camera_count;
	to->camera_list_count = from->cameras_count;
	for (size_t i = 0; i < from->cameras_count; i++)
		read_camera(&from->cameras[i], &to->cameras[i]);
	to->warning_count = from->warnings_count;
	for (size_t i = 0; i < from->warnings_count; i++)
		TEXT(to->warnings[i], from->warnings[i]);
	to->warnings_more = from->warnings_more;
	to->ignored_count = from->ignored_count;
	for (size_t i = 0; i < from->ignored_count; i++)
		TEXT(to->ignored[i], from->ignored[i]);
	to->fact_count = from->facts_count;
	for (size_t i = 0; i < from->facts_count; i++)
		TEXT(to->facts[i], from->facts[i]);
}

static void read_scene_names(const candil_SceneInfo *from, struct candil_scene_info *to)
{
	_Static_assert(COUNT(to->nodes) == COUNT(from->nodes) && COUNT(to->material_names) == COUNT(from->material_names) &&
			   COUNT(to->animations) == COUNT(from->animations),
		       "candil_types.h and candil.options differ");
	to->node_count = from->node_count;
	to->node_list_count = from->nodes_count;
	for (size_t i = 0; i < from->nodes_count; i++)
		TEXT(to->nodes[i], from->nodes[i]);
	to->material_list_count = from->material_names_count;
	for (size_t i = 0; i < from->material_names_count; i++)
		TEXT(to->material_names[i], from->material_names[i]);
	to->environment_width = from->environment_width;
	to->environment_height = from->environment_height;
	to->patch_elements = from->patch_elements;
	to->factor_rows = from->factor_rows;
	to->factor_entries = from->factor_entries;
	to->animation_count = from->animation_count;
	to->animation_list_count = from->animations_count;
	for (size_t i = 0; i < from->animations_count; i++) {
		TEXT(to->animations[i].name, from->animations[i].name);
		to->animations[i].duration_s = isfinite(from->animations[i].duration_s) ? from->animations[i].duration_s : 0;
	}
}

static void read_scene(const candil_SceneInfo *from, struct candil_scene_info *to)
{
	TEXT(to->name, from->name);
	TEXT(to->file, from->file);
	TEXT(to->hash, from->hash);
	TEXT(to->light_units, from->light_units);
	read_scene_names(from, to);
	to->blob_bytes = from->blob_bytes;
	to->triangles = from->triangles;
	to->materials = from->materials;
	to->textures = from->textures;
	to->emissive_triangles = from->emissive_triangles;
	to->punctual_lights = from->punctual_lights;
	to->bounds_min = vec3_read(from->has_bounds_min, &from->bounds_min);
	to->bounds_max = vec3_read(from->has_bounds_max, &from->bounds_max);
	to->origin = vec3_read(from->has_origin, &from->origin);
	to->bvh_nodes = from->bvh_nodes;
	to->bvh_depth = from->bvh_depth;
	to->dropped_degenerate = from->dropped_degenerate;
	to->dropped_non_finite = from->dropped_non_finite;
	to->dropped_out_of_range = from->dropped_out_of_range;
	to->missing_textures = from->missing_textures;
	to->load_us = from->load_us;
	read_scene_lists(from, to);
}

static void read_list(const candil_SceneList *from, struct candil_scene_list *to)
{
	_Static_assert(COUNT(to->scenes) == COUNT(from->scenes), "candil_types.h and candil.options differ");
	to->count = from->scenes_count;
	for (size_t i = 0; i < from->scenes_count; i++) {
		TEXT(to->scenes[i].name, from->scenes[i].name);
		to->scenes[i].triangles = from->scenes[i].triangles;
		to->scenes[i].blob_bytes = from->scenes[i].blob_bytes;
		to->scenes[i].loading = from->scenes[i].loading;
		to->scenes[i].jobs = from->scenes[i].jobs;
	}
}

// A number that is negative where it is not known, as are those that cannot be: not finite, below `least` or above `most`.
static double known(double x, double least, double most)
{
	return isfinite(x) && x >= least && x <= most ? x : -1.0;
}

static void read_choice(const candil_Choice *from, struct candil_choice *to)
{
	to->technique = (enum candil_technique)from->technique;
	to->samples = from->samples;
	to->time_ms = known(from->time_ms, 0, INFINITY);
	to->time_ms_low = known(from->time_ms_low, 0, INFINITY);
	to->time_ms_high = known(from->time_ms_high, 0, INFINITY);
	to->relmse = known(from->relmse, 0, INFINITY);
	to->relmse_low = known(from->relmse_low, 0, INFINITY);
	to->relmse_high = known(from->relmse_high, 0, INFINITY);
}

static void read_quote(const candil_QuoteReply *from, struct candil_quote *to)
{
	_Static_assert(COUNT(to->notes) == COUNT(from->notes), "candil_types.h and candil.options differ");
	read_choice(&from->choice, &to->choice);
	to->met = from->met;
	TEXT(to->why, from->why);
	to->has_cheaper = from->has_cheaper;
	to->has_better = from->has_better;
	read_choice(&from->cheaper, &to->cheaper);
	read_choice(&from->better, &to->better);
	TEXT(to->from, from->from);
	to->cold_ms = known(from->cold_ms, 0, INFINITY);
	to->queue_ms = known(from->queue_ms, 0, INFINITY);
	to->jobs = from->jobs;
	to->records = from->records;
	to->note_count = from->notes_count;
	for (size_t i = 0; i < from->notes_count; i++)
		TEXT(to->notes[i], from->notes[i]);
}

static void read_accepted(const candil_Accepted *from, struct candil_accepted *to)
{
	_Static_assert(COUNT(to->plan) == COUNT(from->plan), "candil_types.h and candil.options differ");
	to->technique = (enum candil_technique)from->technique;
	to->plan_count = from->plan_count;
	for (size_t i = 0; i < from->plan_count; i++) {
		to->plan[i].effect = (enum candil_effect)from->plan[i].effect;
		to->plan[i].state = (enum candil_effect_state)from->plan[i].state;
		TEXT(to->plan[i].why, from->plan[i].why);
		to->plan[i].timed = from->plan[i].has_cost_us;
		to->plan[i].cost_us = from->plan[i].cost_us;
		to->plan[i].share = from->plan[i].has_share && isfinite(from->plan[i].share) ? from->plan[i].share : 0;
	}
	TEXT(to->device, from->device);
	to->job_bytes = from->job_bytes;
	to->samples = from->samples;
	to->depth = from->depth;
	to->default_light = from->default_light;
	_Static_assert(COUNT(to->notes) == COUNT(from->notes), "candil_types.h and candil.options differ");
	to->note_count = from->notes_count;
	for (size_t i = 0; i < from->notes_count; i++)
		TEXT(to->notes[i], from->notes[i]);
	_Static_assert(COUNT(to->warnings) == COUNT(from->warnings), "candil_types.h and candil.options differ");
	to->warning_count = from->warnings_count;
	for (size_t i = 0; i < from->warnings_count; i++)
		TEXT(to->warnings[i], from->warnings[i]);
	to->warnings_more = from->warnings_more;
	to->has_quote = from->has_quote;
	read_quote(&from->quote, &to->quote);
}

// Whether a picture's error is told: a number that is absent is 0 on the wire, and no error of 0.
static bool is_told(candil_ErrorKind kind, double relmse)
{
	const bool named = kind == candil_ErrorKind_ERROR_KIND_MEASURED || kind == candil_ErrorKind_ERROR_KIND_PREDICTED;
	return named && isfinite(relmse) && relmse >= 0;
}

// fmin and fmax return the other number for a NaN.
static double read_share(double share)
{
	return fmin(fmax(share, 0.0), 1.0);
}

static void read_progress(const candil_Progress *from, struct candil_progress *to)
{
	to->samples_done = from->samples_done;
	to->samples = from->samples;
	to->fraction = read_share(from->fraction);
	to->device_us = from->device_us;
	to->elapsed_us = from->elapsed_us;
	TEXT(to->stage, from->stage);
	const bool told = is_told(from->error_kind, from->estimated_relmse);
	to->error_kind = told ? (enum candil_error_kind)from->error_kind : CANDIL_ERROR_KIND_UNKNOWN;
	to->estimated_relmse = told ? from->estimated_relmse : -1;
	to->relmse_low = told ? known(from->relmse_low, 0, from->estimated_relmse) : -1;
	to->relmse_high = told ? known(from->relmse_high, from->estimated_relmse, INFINITY) : -1;
}

struct candil_verdict message_read_verdict(const candil_Verdict *from)
{
	return (struct candil_verdict){
	    .black = read_share(from->black), .clipped = read_share(from->clipped), .missed = read_share(from->missed)};
}

static void read_figures(const candil_Done *from, struct candil_done *to)
{
	_Static_assert(COUNT(to->figures) == COUNT(from->figures), "candil_types.h and candil.options differ");
	to->figure_count = 0;
	for (size_t i = 0; i < from->figures_count; i++) {
		struct candil_figure *figure = &to->figures[to->figure_count];
		if (!isfinite(from->figures[i].value))
			continue;
		TEXT(figure->name, from->figures[i].name);
		TEXT(figure->unit, from->figures[i].unit);
		figure->value = from->figures[i].value;
		to->figure_count++;
	}
}

static void read_done(const candil_Done *from, struct candil_done *to)
{
	_Static_assert(COUNT(to->stages) == COUNT(from->stages), "candil_types.h and candil.options differ");
	to->samples = from->samples;
	to->stage_count = from->stages_count;
	for (size_t i = 0; i < from->stages_count; i++) {
		TEXT(to->stages[i].name, from->stages[i].name);
		to->stages[i].us = from->stages[i].us;
	}
	to->elapsed_us = from->elapsed_us;
	to->cold_us = from->cold_us < from->elapsed_us ? from->cold_us : from->elapsed_us;
	const bool told = is_told(from->error_kind, from->estimated_relmse);
	to->error_kind = told ? (enum candil_error_kind)from->error_kind : CANDIL_ERROR_KIND_UNKNOWN;
	to->estimated_relmse = told ? from->estimated_relmse : -1;
	to->relmse_low = told ? known(from->relmse_low, 0, from->estimated_relmse) : -1;
	to->relmse_high = told ? known(from->relmse_high, from->estimated_relmse, INFINITY) : -1;
	to->non_finite_samples = from->non_finite_samples;
	to->rays = from->rays;
	to->slices = from->slices;
	to->retries = from->retries;
	TEXT(to->device, from->device);
	TEXT(to->reason, from->reason);
	_Static_assert(COUNT(to->notes) == COUNT(from->notes), "candil_types.h and candil.options differ");
	to->note_count = from->notes_count;
	for (size_t i = 0; i < from->notes_count; i++)
		TEXT(to->notes[i], from->notes[i]);
	to->verdict = message_read_verdict(&from->verdict);
	read_figures(from, to);
}

static void read_stats(const candil_StatsReply *from, struct candil_stats *to)
{
	to->uptime_us = from->uptime_us;
	to->connections = from->connections;
	to->jobs = from->jobs;
	to->jobs_done = from->jobs_done;
	to->jobs_failed = from->jobs_failed;
	to->jobs_cancelled = from->jobs_cancelled;
	to->slices = from->slices;
	to->worker_starts = from->worker_starts;
	to->loader_starts = from->loader_starts;
	to->loader_failures = from->loader_failures;
	to->scenes = from->scenes;
	to->scene_bytes = from->scene_bytes;
	to->buffered_bytes = from->buffered_bytes;
	to->image_bytes = from->image_bytes;
	to->worker_pid = from->worker_pid;
	to->loader_pid = from->loader_pid;
	TEXT(to->device, from->device);
	to->device_bytes = from->device_bytes;
	to->validation_errors = from->validation_errors;
	to->slice_ms = from->slice_ms;
	TEXT(to->device_error, from->device_error);
	to->max_connections = from->max_connections;
	to->max_scenes = from->max_scenes;
	to->device_losses = from->device_losses;
	TEXT(to->device_note, from->device_note);
}

static void read_error(const candil_Error *from, struct candil_error *to)
{
	// A daemon that sends the code 0 must not make a failure look like a success.
	to->code = from->code != 0 && from->code <= INT32_MAX ? (candil_status)from->code : CANDIL_STATUS_INTERNAL;
	TEXT(to->text, from->message[0] ? from->message : "the daemon gave no reason");
}

static bool decode_message(const uint8_t *body, size_t bytes, const pb_msgdesc_t *fields, void *message)
{
	pb_istream_t stream = pb_istream_from_buffer(body, bytes);
	return pb_decode(&stream, fields, message);
}

bool message_read_image(const uint8_t *body, size_t bytes, candil_ImageFrame *frame)
{
	return decode_message(body, bytes, candil_ImageFrame_fields, frame);
}

bool message_read_server(const uint8_t *body, size_t bytes, struct candil_server *server)
{
	candil_HelloReply reply = candil_HelloReply_init_zero;
	if (!decode_message(body, bytes, candil_HelloReply_fields, &reply))
		return false;
	server->version = reply.version;
	TEXT(server->name, reply.server);
	server->max_message_bytes = reply.max_message_bytes;
	server->max_pixels = reply.max_pixels;
	server->max_samples_times_pixels = reply.max_samples_times_pixels;
	server->max_jobs_per_connection = reply.max_jobs_per_connection;
	return true;
}

// One line for each type of reply that is a whole event.
bool message_read_event(uint8_t type, const uint8_t *body, size_t bytes, struct candil_event *event)
{
	union {
		candil_Ping ping;
		candil_SceneInfo scene;
		candil_SceneList list;
		candil_Accepted accepted;
		candil_Progress progress;
		candil_Done done;
		candil_StatsReply stats;
		candil_QuoteReply quote;
		candil_Error error;
	} m;
	memset(&m, 0, sizeof(m));
	event->ends_request = type != MESSAGE_ACCEPTED && type != MESSAGE_PROGRESS;
#define READ(upper, kind_name, member, fields, convert) \
	case MESSAGE_##upper: \
		event->kind = CANDIL_EVENT_##kind_name; \
		if (!decode_message(body, bytes, fields, &m.member)) \
			return false; \
		convert; \
		return true;
	switch (type) {
		READ(SCENE_INFO, SCENE, scene, candil_SceneInfo_fields, read_scene(&m.scene, &event->u.scene))
		READ(SCENE_LIST, SCENES, list, candil_SceneList_fields, read_list(&m.list, &event->u.scenes))
		READ(ACCEPTED, ACCEPTED, accepted, candil_Accepted_fields, read_accepted(&m.accepted, &event->u.accepted))
		READ(PROGRESS, PROGRESS, progress, candil_Progress_fields, read_progress(&m.progress, &event->u.progress))
		READ(DONE, DONE, done, candil_Done_fields, read_done(&m.done, &event->u.done))
		READ(STATS_REPLY, STATS, stats, candil_StatsReply_fields, read_stats(&m.stats, &event->u.stats))
		READ(QUOTE_REPLY, QUOTE, quote, candil_QuoteReply_fields, read_quote(&m.quote, &event->u.quote))
		READ(ERROR, ERROR, error, candil_Error_fields, read_error(&m.error, &event->u.error))
	case MESSAGE_OK:
		event->kind = CANDIL_EVENT_OK;
		return true;
	case MESSAGE_PONG:
		event->kind = CANDIL_EVENT_PONG;
		if (!decode_message(body, bytes, candil_Ping_fields, &m.ping))
			return false;
		event->u.pong.bytes = m.ping.payload.size;
		memcpy(event->u.pong.payload, m.ping.payload.bytes, m.ping.payload.size);
		return true;
	default:
		return false;
	}
#undef READ
}
