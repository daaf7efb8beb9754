// The values that go into libcandil's calls and come out of them. candil.h includes this header; its head says what holds
// for all of them: threads, failure, ownership, units, versions, examples.
#ifndef CANDIL_TYPES_H
#define CANDIL_TYPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// enum candil_status, candil_technique, candil_effect, and CANDIL_EFFECT_COUNT. The statuses are in groups:
//
//	0         OK
//	1 to 7    the stream or the handshake is wrong; the daemon closes the connection
//	20 to 27  the request is wrong, or cannot be served now; the connection goes on
//	40 to 48  the scene
//	60 to 66  the job
//	80, 81    the daemon's own trouble
//	82, 83    this side: no daemon answers (CONNECT), or the connection broke (IO)
#include "candil_names.h"

// Why a call failed.
struct candil_error {
	candil_status code;
	char text[256]; // what is wrong and what to do, one sentence
};

// A point, a direction or a colour.
struct candil_vec3 {
	double x, y, z;
};

// ---- scenes ----------------------------------------------------------------------------------------------------------

// Which axis of an OBJ file points up. A glTF file says so itself, and this is ignored.
enum candil_up {
	CANDIL_UP_DEFAULT = 0, // +Y
	CANDIL_UP_Y = 1,
	CANDIL_UP_Z = 2,
};

// Which file to load, and how. The file is named by exactly one of server_path and file.
struct candil_load_request {
	const char *name; // the scene's name in the daemon: 1 to 63 bytes without '/' and control characters
	const char *server_path; // relative to the daemon's --scene-root, at most 1023 bytes; NULL: `file`
	const char *file; // a file of this machine; NULL: `server_path`. Its folder is opened here and goes along as a
			  // descriptor, and files that the scene names are read beneath that folder alone
	enum candil_up up; // OBJ only
	double metres_per_unit; // OBJ only: 1e-9 to 1e9; 0 means 1
};

// A camera of a scene.
struct candil_camera_info {
	char name[64];
	struct candil_vec3 eye, target, up; // metres, world space
	double vfov_degrees; // vertical; 0: orthographic
};

// An animation of a scene.
struct candil_animation_info {
	char name[64];
	double duration_s; // seconds, from 0 on
};

// What a scene holds. A list holds the first of its kind, as many as there is room for; a count that says "in the scene" may
// exceed that of the list. What a file leaves without a name is called "node 3" and so on.
struct candil_scene_info {
	char name[64]; // in the daemon
	char file[256]; // as the load named it, beneath its folder
	char hash[40]; // of what was loaded, hexadecimal
	uint64_t blob_bytes; // memory that the daemon keeps for it
	uint32_t triangles, materials, textures, emissive_triangles, punctual_lights; // in the scene
	uint32_t camera_count; // in the scene
	uint32_t camera_list_count;
	struct candil_camera_info cameras[32];
	struct candil_vec3 bounds_min, bounds_max; // metres, world space; not finite if there are none
	struct candil_vec3 origin; // metres, world space: where the daemon puts its own zero
	uint32_t bvh_nodes, bvh_depth; // of the tree that rays walk
	uint32_t dropped_degenerate, dropped_non_finite, dropped_out_of_range; // triangles that were left out
	uint32_t missing_textures; // that could not be read
	uint32_t warning_count;
	char warnings[32][256]; // a sentence each
	uint32_t warnings_more; // that did not fit
	uint32_t ignored_count;
	char ignored[32][64]; // features of the file that candil leaves out
	uint32_t fact_count;
	char facts[32][32]; // what decides which effects run: "textures", "emitters"…
	uint64_t load_us; // how long reading took, microseconds
	char light_units[128]; // how photometric values of the file were taken, a sentence; "" if it has none
	uint32_t node_count; // in the scene
	uint32_t node_list_count;
	char nodes[64][64]; // names, parents first
	uint32_t material_list_count; // of `materials`
	char material_names[64][64];
	uint32_t animation_count; // in the scene
	uint32_t animation_list_count;
	struct candil_animation_info animations[32];
	uint32_t environment_width, environment_height; // texels of a picture of surroundings; 0: the file is none
	uint32_t patch_elements; // of a file of patches; 0: the file is none
	uint32_t factor_rows, factor_entries; // of a file of form factors; 0: the file is none
};

// One line of candil_scenes.
struct candil_scene_entry {
	char name[64];
	uint32_t triangles; // 0 while it is being loaded
	uint64_t blob_bytes; // 0 while it is being loaded
	bool loading;
	uint32_t jobs; // that use it now
};

// Every scene of the daemon.
struct candil_scene_list {
	uint32_t count;
	struct candil_scene_entry scenes[64];
};

// ---- what a render is asked for --------------------------------------------------------------------------------------

// What became of an effect.
enum candil_effect_state {
	CANDIL_EFFECT_SIMULATED = 0,
	CANDIL_EFFECT_ABSENT = 1, // left out: the scene has nothing of it
	CANDIL_EFFECT_SWITCHED_OFF = 2, // left out: the request says off
	CANDIL_EFFECT_FORCED = 3, // simulated though the scene has nothing of it: the request says on
	CANDIL_EFFECT_UNSUPPORTED = 4, // left out: the technique cannot do it
};

// The file. EXR is linear radiance, W/(m² sr), PNG 8-bit sRGB. The last two are no pictures but what a technique that has
// patches computes with, which PROTOCOL.md describes.
enum candil_format {
	CANDIL_FORMAT_EXR_HALF = 0, // 16 bits a value
	CANDIL_FORMAT_EXR_FLOAT = 1, // 32 bits a value
	CANDIL_FORMAT_PNG = 2,
	CANDIL_FORMAT_PLY = 3, // patches with their radiosity, binary
	CANDIL_FORMAT_MTX = 4, // their form factors, Matrix Market coordinates
};

// How the radiance of a PNG, times 2 to the exposure, becomes a value from 0 to 1.
enum candil_view {
	CANDIL_VIEW_NONE = 0, // clipped
	CANDIL_VIEW_REINHARD = 1, // divided by one plus its luminance
	CANDIL_VIEW_FILMIC = 2, // John Hable's curve
};

// Extra channels beside the colour, EXR only: bits of `aovs`.
enum candil_aov {
	CANDIL_AOV_DEPTH = 1u << 0, // Z: metres along the view axis, infinity where nothing is hit
	CANDIL_AOV_NORMAL = 1u << 1, // N.X N.Y N.Z: the shading normal, world space
	CANDIL_AOV_ALBEDO = 1u << 2, // albedo.R albedo.G albedo.B
	CANDIL_AOV_ID = 1u << 3, // id: 1 plus the material's index, 0 where nothing is hit
};

// An option of a technique. candil's README lists them; one that the technique does not have is refused.
struct candil_option {
	const char *name; // "pt.depth": 1 to 31 bytes
	const char *value; // "8": 1 to 31 bytes
};

// One more light.
struct candil_light {
	enum candil_light_kind kind;
	struct candil_vec3 position; // metres, world space; not of a directional light
	struct candil_vec3 direction; // the way the light travels, any length above 0; not of a point light
	struct candil_vec3 intensity; // W/sr, of a directional light W/m²; components from 0 to 1e20
	double inner_degrees, outer_degrees; // of a spot, from its axis: 0 <= inner < outer <= 90
	double angle_degrees; // of a directional light: across the disc that it shines from, 0 to below 180; 0: one
			      // direction. Only path tracing shines from all of the disc
	double range; // of a point light or a spot: metres beyond which it sends no light, finite; 0: no bound
};

// Another look for a material. What has no `has_` set stays as the scene has it. Textures go on multiplying.
struct candil_material_edit {
	const char *name; // all materials of this name; or "#" and a number
	bool has_base_color, has_emission, has_specular, has_specular_weight, has_metallic, has_roughness;
	bool has_diffuse_roughness, has_coat, has_coat_roughness;
	struct candil_vec3 base_color; // 0 to 1
	struct candil_vec3 emission; // W/(m² sr), 0 to 1e12
	struct candil_vec3 specular; // reflectance at normal incidence of what is no metal, 0 to 1
	double specular_weight, metallic, roughness; // 0 to 1
	double diffuse_roughness; // Oren and Nayar's, 0 to 1; 0: Lambert's surface
	double coat, coat_roughness; // of a clear coat: how much of it there is, and how rough, 0 to 1
};

// Another place for a node, relative to its parent, as glTF has it. What is beneath the node goes along, lights and cameras
// too. What has no `has_` set stays as the scene, or the animation, has it.
struct candil_node_edit {
	const char *name; // the one node of this name; or "#" and a number
	bool has_translation, has_rotation, has_scale;
	struct candil_vec3 translation; // metres
	double rotation[4]; // quaternion x, y, z, w of any length above 0
	struct candil_vec3 scale; // each component 1e-9 to 1e9, or so below zero
};

// What one request changes of its scene. Nothing is loaded again, and others see the scene as it is. A name is one that
// candil_describe lists, or "#" and its number in that list, from 0.
//
// Example:
//	const struct candil_light lamp = {
//		.kind = CANDIL_LIGHT_SPOT,
//		.position = {0, 1.9, 0.5},
//		.direction = {0, -1, 0},
//		.intensity = {5, 5, 5},
//		.inner_degrees = 20,
//		.outer_degrees = 30,
//	};
//	const struct candil_material_edit red = {
//		.name = "lime wash",
//		.has_base_color = true,
//		.base_color = {0.8, 0.2, 0.1},
//	};
//	const struct candil_edits edits = {.lights = &lamp, .light_count = 1, .materials = &red, .material_count = 1};
//	struct candil_render_request request;
//	struct candil_render_result result;
//	candil_render_request_init(&request);
//	request.scene = "room";
//	request.width = request.height = 32;
//	request.samples = 1;
//	request.edits = &edits;
//	if (candil_render(client, &request, NULL, &result, &error) != CANDIL_STATUS_OK)
//		die(error.text);
//	candil_free(result.image.data);
struct candil_edits {
	const struct candil_light *lights;
	size_t light_count; // 0 to 32
	bool replace_lights; // they take the place of the scene's point, spot and directional lights
	const struct candil_material_edit *materials;
	size_t material_count; // 0 to 32
	const struct candil_node_edit *nodes; // on top of the animation
	size_t node_count; // 0 to 32
	const char *animation; // of the scene: a name, or "#" and a number; NULL: none
	double time_s; // of the animation, -1e9 to 1e9 seconds. Of a sweep, each camera has its own instead
};

// How rays go through the camera.
enum candil_projection {
	CANDIL_PROJECTION_CAMERA = 0, // as the camera has it
	CANDIL_PROJECTION_ORTHOGRAPHIC = 1, // parallel
	CANDIL_PROJECTION_PANORAMA = 2, // from all directions: longitude across, latitude down, the target in the middle
};

// The lens of the camera, whichever camera it is. All zero: as the camera has it. The technique that path traces alone takes
// a panorama and a radius; others refuse them with UNSUPPORTED.
struct candil_lens {
	enum candil_projection projection;
	double height; // orthographic: of the image, metres, above 0
	double radius; // of a thin lens, metres, above 0; 0: a pinhole
	double focus; // distance along the view axis of what is sharp, metres, above 0; read if there is a radius
};

// How much of the light near a pixel's middle the pixel takes. The technique that path traces alone takes other filters than
// the box.
enum candil_filter {
	CANDIL_FILTER_BOX = 0, // its own square, evenly
	CANDIL_FILTER_GAUSSIAN = 1, // standard deviation half a pixel, to a distance of 2 pixels
	CANDIL_FILTER_BLACKMAN_HARRIS = 2, // the window, 4 pixels wide
};

// A picture that is asked for. Begin with candil_render_request_init. The same request without a deadline gives the same
// pixels, bit for bit, on the same device.
struct candil_render_request {
	const char *scene; // name of a loaded scene, or of one that is being loaded: the job then waits
	enum candil_technique technique;
	uint32_t width, height; // pixels, 1 to 16384 each, at most 67108864 together
	uint32_t samples; // per pixel; 0: as many as the technique needs for a picture to look at
	uint32_t first_sample; // index of the first: renders of disjoint ranges can be merged. The last is below 16777216
	uint64_t seed; // another seed, another noise
	const char *camera_name; // of the scene; NULL: the next fields
	bool has_camera; // the four fields below are the camera; false without a name: the scene's first
	struct candil_vec3 eye, target; // metres, world space; not the same place
	struct candil_vec3 up; // any length above 0; not along the view
	double vfov_degrees; // vertical, above 0 and below 180
	uint32_t effects_on; // bits 1u << effect: simulated whatever the scene holds
	uint32_t effects_off; // bits: left out. What is in neither is as the scene calls for; nothing may be in both
	uint32_t aovs; // bits of enum candil_aov; EXR only
	enum candil_format format;
	double exposure_ev; // PNG only: stops, -64 to 64
	enum candil_view view; // PNG only
	bool progressive; // send intermediate images before the final one
	const struct candil_option *options;
	size_t option_count; // 0 to 16
	bool has_background; // `background` counts; not beside `environment`
	struct candil_vec3 background; // W/(m² sr), what rays meet that leave the scene, 0 to 1e12; absent: black
	// A picture of all directions around the scene, which lights it too: the name under which it was loaded; NULL: none.
	// Longitude grows from left to right, latitude falls from top to bottom. Unturned, its middle is seen along -Z.
	const char *environment;
	double environment_turn_degrees; // about +Y, counter-clockwise seen from above, -1e6 to 1e6
	double environment_scale; // W/(m² sr) of one unit of the file, 1e-9 to 1e9; 0 means 1
	// A file of form factors, or of a solution, that radiosity takes in place of making its own: the name under which it
	// was loaded; NULL: none.
	const char *imported;
	bool default_light; // a scene that nothing gives light to gets a neutral sky, which candil_accepted tells; false: it
			    // stays black
	uint32_t progress_ms; // least time between two progress events, at most 3600000; 0 means 100
	const struct candil_edits *edits; // NULL: none
	struct candil_lens lens;
	enum candil_filter filter;
	// A render may end before it has all its samples; candil_done.reason says why it ended. Both may be 0: never.
	double target_error; // once relmse_high is at most this, always at the same sample; only a technique that
			     // has noise takes it
	uint32_t deadline_ms; // from the request's arrival to the encoded image, at most 86400000
	bool whole; // by the deadline every pixel has a sample, or there is no picture: CANDIL_DEADLINE; false: one of fewer
		    // pixels, scaled up, will do
};

// The camera of one image of a sweep: one of the scene's by name; or, without a name, the four fields below; or, with
// vfov_degrees 0 too, the scene's first.
struct candil_camera {
	const char *name; // NULL: none
	struct candil_vec3 eye, target, up; // as those of a candil_render_request
	double vfov_degrees; // above 0 and below 180
	double time_s; // of the animation that the request's edits name; without one it is not read
};

// The cameras that one sweep takes at most. Cameras × samples × pixels is bound too: max_samples_times_pixels of
// candil_server.
#define CANDIL_SWEEP_CAMERAS 256u

// ---- what comes back -------------------------------------------------------------------------------------------------

// What becomes of one effect in a job.
struct candil_effect_report {
	enum candil_effect effect;
	enum candil_effect_state state;
	char why[96]; // a few words
	bool timed; // the rest is known, which takes an option of the technique
	int64_t cost_us; // of the whole job; of an effect that is left out: what it would add. It is a difference of two
			 // times, and may be below zero
	double share; // of the job's time, 1: all of it
};

// A way to render, and what to expect of it. Nine times of ten what comes out lies between low and high.
struct candil_choice {
	enum candil_technique technique; // never CANDIL_TECHNIQUE_AUTO
	uint32_t samples; // per pixel
	double time_ms, time_ms_low, time_ms_high; // from the request's arrival to the image, on an idle device whose
						   // programs are compiled
	double relmse, relmse_low, relmse_high; // against the picture that path tracing tends to; negative: unknown
};

// The answer to a quote.
struct candil_quote {
	struct candil_choice choice;
	bool met; // what was asked for, as far as can be foreseen; true if nothing was
	char why[256]; // a sentence
	bool has_cheaper, has_better;
	struct candil_choice cheaper, better; // the next of those that nothing beats in both time and error
	char from[16]; // "pilot": the scene was looked at for this answer; "model": what was known already
	double cold_ms; // beside time_ms: programs that are to be compiled first; 0: none
	double queue_ms; // beside time_ms: what the jobs under way add, as far as can be foreseen
	uint32_t jobs; // under way
	uint32_t records; // frames and pilots of this scene that the answer stands on
	uint32_t note_count;
	char notes[4][192]; // sentences on what may surprise
};

// The device has the job: what will be done. It comes once.
struct candil_accepted {
	enum candil_technique technique; // never CANDIL_TECHNIQUE_AUTO
	uint32_t plan_count;
	struct candil_effect_report plan[32]; // one for each effect
	char device[128];
	uint64_t job_bytes; // device memory that the job takes
	uint32_t samples; // per pixel, at most
	uint32_t depth; // scattering events at most
	bool default_light; // nothing gave light, and a neutral sky does, as the request asked
	uint32_t note_count;
	char notes[4][192]; // sentences on what may surprise
	uint32_t warning_count;
	char warnings[32][256]; // sentences on what of the scene's files was mended or left out, and shows in the picture
	uint32_t warnings_more; // that did not fit
	bool has_quote; // the technique was chosen, by `quote`: CANDIL_TECHNIQUE_AUTO with a target error or a deadline
	struct candil_quote quote;
};

// How the numbers on a picture's error are known.
enum candil_error_kind {
	CANDIL_ERROR_KIND_UNKNOWN = 0, // not at all: all three are negative
	CANDIL_ERROR_KIND_MEASURED = 1, // from the picture's own samples
	CANDIL_ERROR_KIND_PREDICTED = 2, // from what other pictures of the scene had
};

// How far a job is. It begins anew if the worker process was lost.
struct candil_progress {
	uint32_t samples_done, samples; // of every pixel; of a sweep: of all images together
	double fraction; // of the work, 0 to 1
	uint64_t device_us, elapsed_us; // that the device worked, that passed since the request arrived
	double estimated_relmse; // at the last look; negative: unknown
	double relmse_low,
	    relmse_high; // nine times of ten the true one lies between; negative: unknown. relmse_high is also
			 // where there is no upper end, because light may be there that no sample has found
	enum candil_error_kind error_kind; // of these three
	char stage[24]; // what is done now: "compile", "begin", "render"; more may come; "": not told
};

// A part of a job and the time that it took. PROTOCOL.md lists the names; more may come.
struct candil_stage {
	char name[24];
	uint64_t us;
};

// What a technique counted or measured. PROTOCOL.md lists the names; more may come.
struct candil_figure {
	char name[24];
	double value; // finite
	char unit[16]; // "" if there is none
};

// What of a picture's file is likely to disappoint: shares of its pixels, 0 to 1. A pixel may be counted in several.
struct candil_verdict {
	double black; // every channel of the file is 0
	double clipped; // some channel is 1 or more behind a PNG's exposure and view, or above 65504 in an EXR of 16 bits
	double missed; // no sample of the pixel met a surface
};

// The account of a finished job.
struct candil_done {
	uint32_t samples; // per pixel
	uint32_t stage_count;
	struct candil_stage stages[24];
	uint64_t elapsed_us; // from the request's arrival to the image's last byte
	uint64_t cold_us; // of these: opening the device and compiling programs that it did not have yet; 0: it was warm
	double estimated_relmse; // negative: unknown
	double relmse_low, relmse_high; // as of candil_progress
	enum candil_error_kind error_kind; // likewise
	uint64_t non_finite_samples; // that were taken as zero
	uint64_t rays;
	uint32_t slices; // pieces that the job was worked on in
	uint32_t retries; // times that it was begun again because the worker process was lost
	char device[128];
	char reason[64]; // why it ended: "samples", "error" or "time"
	uint32_t figure_count;
	struct candil_figure figures[48];
	uint32_t note_count;
	char notes[4][192]; // sentences on what may surprise and came out in the work alone
	struct candil_verdict verdict; // on the picture; of a sweep, the mean; zero of a file that is none
};

// An encoded image file, whole: EXR or PNG bytes, to be written to a file as they are.
struct candil_image {
	const uint8_t *data; // the owner is said where the image comes from
	size_t bytes; // at most 64 a pixel and 4 MiB
	enum candil_format format;
	uint32_t width, height; // pixels
	uint32_t made_width, made_height; // pixels that were rendered: the same, or fewer, scaled up, where a deadline left
					  // no time for more
	uint32_t samples; // that are in it, per pixel
	bool final; // false: an intermediate one
	uint32_t index; // of the camera in a sweep, from 0; else 0
	struct candil_verdict verdict; // of a final one that is a picture
};

// ---- the daemon ------------------------------------------------------------------------------------------------------

// What the daemon said of itself in the handshake.
struct candil_server {
	uint32_t version; // of the protocol: 1
	char name[64]; // "candild" and its version
	uint64_t max_message_bytes; // of one message
	uint64_t max_pixels; // of one image
	uint64_t max_samples_times_pixels; // of a render, or of all images of a sweep
	uint32_t max_jobs_per_connection; // renders and loads at once
};

// The daemon's counters, since it started unless "now" is said.
struct candil_stats {
	uint64_t uptime_us;
	uint32_t connections, jobs; // now
	uint64_t jobs_done, jobs_failed, jobs_cancelled, slices;
	uint32_t worker_starts, loader_starts;
	uint64_t loader_failures;
	uint32_t scenes; // now
	uint64_t scene_bytes; // of all of them, now
	uint64_t buffered_bytes; // that wait for clients to read them, now
	uint64_t image_bytes; // of encoded images that are being made or wait to be read, now
	uint32_t worker_pid, loader_pid; // process ids now; 0: there is none
	char device[128]; // "" while the worker starts
	uint64_t device_bytes; // device memory in use, now
	uint64_t validation_errors; // of Vulkan's validation layers, where they are on
	uint32_t slice_ms; // how long a job is worked on before another one has its turn
	char device_error[256]; // why there is no usable device; "" if there is one
	uint32_t max_connections, max_scenes; // that the daemon's descriptors are enough for
	uint32_t device_losses; // of the device, as far as can be told
	char device_note[256]; // a device was lost too often, or compiled code cannot be kept any more; "": neither
};

#endif
