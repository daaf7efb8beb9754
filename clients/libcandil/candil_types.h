// The values that go into libcandil's calls and come out of them. candil.h includes it; its head says what holds for all of
// them: threads, failure, ownership, units.
#ifndef CANDIL_TYPES_H
#define CANDIL_TYPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "candil_names.h" // enum candil_status, candil_technique, candil_effect; CANDIL_EFFECT_COUNT

// ---- status ----------------------------------------------------------------------------------------------------------

struct candil_error {
	candil_status code;
	char text[256]; // what is wrong and what to do, one sentence
};

// ---- scenes ----------------------------------------------------------------------------------------------------------

struct candil_vec3 {
	double x, y, z;
};

enum candil_up { CANDIL_UP_DEFAULT = 0, CANDIL_UP_Y = 1, CANDIL_UP_Z = 2 };

struct candil_load_request {
	const char *name; // 1…63 bytes: the scene's name in the daemon
	const char *server_path; // relative to the daemon's --scene-root; or NULL and
	const char *file; // a file of this machine: its folder is opened here and goes along as a descriptor. Files that
			  // the scene names are read beneath that folder only
	enum candil_up up; // OBJ only: which axis points up
	double metres_per_unit; // OBJ only: 0 means 1
};

struct candil_camera_info {
	char name[64];
	struct candil_vec3 eye, target, up; // metres, world space
	double vfov_degrees; // 0: orthographic
};

struct candil_animation_info {
	char name[64];
	double duration_s;
};

struct candil_scene_info {
	char name[64];
	char file[256];
	char hash[40];
	uint64_t blob_bytes;
	uint32_t triangles, materials, textures, emissive_triangles, punctual_lights;
	uint32_t camera_count; // in the scene; may exceed camera_list_count
	uint32_t camera_list_count;
	struct candil_camera_info cameras[32];
	struct candil_vec3 bounds_min, bounds_max, origin;
	uint32_t bvh_nodes, bvh_depth;
	uint32_t dropped_degenerate, dropped_non_finite, dropped_out_of_range, missing_textures;
	uint32_t warning_count;
	char warnings[32][256];
	uint32_t warnings_more; // that did not fit
	uint32_t ignored_count;
	char ignored[32][64]; // features of the file that the renderer leaves out
	uint32_t fact_count;
	char facts[16][32]; // what the plan goes by: "textures", "emitters"…
	uint64_t load_us;
	char light_units[128];
	// What edits may name. The counts are the scene's and may exceed those of the lists.
	uint32_t node_count, node_list_count;
	char nodes[64][64];
	uint32_t material_list_count; // of `materials`
	char material_names[64][64];
	uint32_t animation_count, animation_list_count;
	struct candil_animation_info animations[32];
	uint32_t environment_width, environment_height; // of a picture of surroundings, texels; 0: it is a scene
};

struct candil_scene_entry {
	char name[64];
	uint32_t triangles;
	uint64_t blob_bytes;
	bool loading;
	uint32_t jobs; // that use it now
};

struct candil_scene_list {
	uint32_t count;
	struct candil_scene_entry scenes[64];
};

// ---- what a render is asked for --------------------------------------------------------------------------------------

enum candil_effect_state {
	CANDIL_EFFECT_SIMULATED = 0,
	CANDIL_EFFECT_ABSENT = 1, // the scene has none
	CANDIL_EFFECT_SWITCHED_OFF = 2,
	CANDIL_EFFECT_FORCED = 3, // the scene has none, the request says on
	CANDIL_EFFECT_UNSUPPORTED = 4, // the technique cannot
};

enum candil_format { CANDIL_FORMAT_EXR_HALF = 0, CANDIL_FORMAT_EXR_FLOAT = 1, CANDIL_FORMAT_PNG = 2 };
enum candil_view { CANDIL_VIEW_NONE = 0, CANDIL_VIEW_REINHARD = 1, CANDIL_VIEW_FILMIC = 2 };

// Extra images beside the colour, EXR only; bits of `aovs`.
enum candil_aov {
	CANDIL_AOV_DEPTH = 1u << 0,
	CANDIL_AOV_NORMAL = 1u << 1,
	CANDIL_AOV_ALBEDO = 1u << 2,
	CANDIL_AOV_ID = 1u << 3,
};

struct candil_option {
	const char *name; // "pt.depth"
	const char *value;
};

// Edits change the scene for one request; nothing is loaded again, and others see the scene as it is. A name is one that
// candil_describe lists, or "#" and its number there. PROTOCOL.md says more.
enum candil_light_kind { CANDIL_LIGHT_POINT = 0, CANDIL_LIGHT_SPOT = 1, CANDIL_LIGHT_DIRECTIONAL = 2 };

struct candil_light {
	enum candil_light_kind kind;
	struct candil_vec3 position; // metres, world space; not of a directional one
	struct candil_vec3 direction; // the way the light travels, any length above 0; not of a point light
	struct candil_vec3 intensity; // W/sr; of a directional one W/m²
	double inner_degrees, outer_degrees; // of a spot: 0 ≤ inner < outer ≤ 90
	double angle_degrees; // of a directional one: across the disc that it shines from, below 180; 0: one direction
};

// What has no `has_` set stays as the scene has it. Textures go on multiplying.
struct candil_material_edit {
	const char *name; // all materials of this name
	bool has_base_color, has_emission, has_specular, has_specular_weight, has_metallic, has_roughness;
	bool has_diffuse_roughness, has_coat, has_coat_roughness;
	struct candil_vec3 base_color; // 0…1
	struct candil_vec3 emission; // W/(m² sr)
	struct candil_vec3 specular; // reflectance at normal incidence of what is no metal, 0…1
	double specular_weight, metallic, roughness; // 0…1
	double diffuse_roughness; // Oren and Nayar's, 0…1; 0: Lambert
	double coat, coat_roughness; // of a clear coat: how much of it there is, and how rough, 0…1
};

// Relative to the node's parent, as glTF has it. What is beneath the node goes along.
struct candil_node_edit {
	const char *name;
	bool has_translation, has_rotation, has_scale;
	struct candil_vec3 translation; // metres
	double rotation[4]; // quaternion x, y, z, w of any length above 0
	struct candil_vec3 scale; // no component 0
};

struct candil_edits {
	const struct candil_light *lights;
	size_t light_count; // 0…32
	bool replace_lights; // they take the place of the scene's point, spot and directional lights
	const struct candil_material_edit *materials;
	size_t material_count; // 0…32
	const struct candil_node_edit *nodes;
	size_t node_count; // 0…32; on top of the animation
	const char *animation; // NULL: none
	double time_s; // of the animation; a sweep's cameras say it instead
};

enum candil_projection {
	CANDIL_PROJECTION_CAMERA = 0, // as the camera has it
	CANDIL_PROJECTION_ORTHOGRAPHIC = 1, // parallel rays
	CANDIL_PROJECTION_PANORAMA = 2, // all directions: longitude across, latitude down, the target in the middle
};

// How rays go through the camera, whichever it is. All zero: as the camera has it.
struct candil_lens {
	enum candil_projection projection;
	double height; // orthographic: of the image, metres
	double radius; // of a thin lens, metres; 0: a pinhole
	double focus; // distance along the view axis of what is sharp, metres; read if there is a radius
};

// How much of the light near a pixel's middle it takes.
enum candil_filter {
	CANDIL_FILTER_BOX = 0, // its own square, evenly
	CANDIL_FILTER_GAUSSIAN = 1, // standard deviation 0.5 pixels, to a distance of 2
	CANDIL_FILTER_BLACKMAN_HARRIS = 2, // the window, 4 pixels wide
};

struct candil_render_request {
	const char *scene; // name of a loaded scene
	enum candil_technique technique;
	uint32_t width, height; // pixels
	uint32_t samples; // per pixel
	uint32_t first_sample; // renders of disjoint ranges can be merged
	uint64_t seed;
	const char *camera_name; // a camera of the scene; or NULL and
	bool has_camera; //   the four fields below (metres, world space); neither: the scene's first camera
	struct candil_vec3 eye, target, up;
	double vfov_degrees;
	uint32_t effects_on; // bits: on whatever the scene holds
	uint32_t effects_off; // bits: off. In neither: as the scene calls for
	uint32_t aovs; // CANDIL_AOV_… bits
	enum candil_format format;
	double exposure_ev; // PNG only
	enum candil_view view; // PNG only
	bool progressive; // intermediate images before the final one
	const struct candil_option *options;
	size_t option_count; // 0…16
	bool has_background;
	struct candil_vec3 background; // W/(m² sr), what rays meet that leave the scene; absent: black
	// Or, instead, a picture of all directions, which lights the scene too: the name under which it was loaded; NULL:
	// none. Longitude grows from left to right, latitude falls from top to bottom; unturned, its middle is seen along
	// -Z.
	const char *environment;
	double environment_turn_degrees; // about +Y, counter-clockwise seen from above
	double environment_scale; // W/(m² sr) of one unit of the file; 0: 1
	uint32_t progress_ms; // least time between two progress events; 0: 100
	const struct candil_edits *edits; // NULL: none
	struct candil_lens lens;
	enum candil_filter filter;
	// What ends a render before its samples do; candil_done.reason says which it was. 0: nothing.
	double target_error; // an estimated relMSE, pt alone; the same request ends at the same sample
	uint32_t deadline_ms; // from the request's arrival to its encoded image
};

// One image of a sweep. Its camera is one of the scene's by name, or (name NULL) the four fields below, in metres and world
// space, or (vfov_degrees 0 too) the scene's first.
struct candil_camera {
	const char *name;
	struct candil_vec3 eye, target, up;
	double vfov_degrees; // above 0, below 180
	double time_s; // of the animation that the request's edits name; else not read
};

// Cameras that one sweep takes at most. Cameras × samples × pixels is bound too, by max_samples_times_pixels.
#define CANDIL_SWEEP_CAMERAS 256u

// ---- what comes back -------------------------------------------------------------------------------------------------

struct candil_effect_report {
	enum candil_effect effect;
	enum candil_effect_state state;
	char why[96];
	bool timed; // the rest is known: with the option pt.effect_times alone
	int64_t cost_us; // of the whole job; what it would add, if it is left out. Measured by difference: may be below zero
	double share; // of the job's time
};

// The daemon took the job: what it will do.
struct candil_accepted {
	enum candil_technique technique;
	uint32_t plan_count;
	struct candil_effect_report plan[32];
	char device[128];
	uint64_t job_bytes; // device memory the job takes
	uint32_t samples, depth;
	uint32_t note_count;
	char notes[4][192]; // sentences on what may surprise
};

struct candil_progress {
	uint32_t samples_done, samples; // per pixel
	double fraction; // 0…1
	uint64_t device_us, elapsed_us;
	double estimated_relmse; // at the last look; negative: unknown
};

struct candil_stage {
	char name[24];
	uint64_t us;
};

// What the technique counted or measured; PROTOCOL.md lists the names.
struct candil_figure {
	char name[24];
	double value; // finite
	char unit[16];
};

struct candil_done {
	uint32_t samples;
	uint32_t stage_count;
	struct candil_stage stages[24];
	uint64_t elapsed_us; // in the daemon
	double estimated_relmse; // negative: unknown
	uint64_t non_finite_samples; // found on the device, taken as zero
	uint64_t rays;
	uint32_t slices, retries;
	char device[128];
	char reason[64]; // why it ended: "samples", "error" or "time"
	uint32_t figure_count;
	struct candil_figure figures[32];
	uint32_t note_count;
	char notes[2][192]; // sentences on what may surprise and came out in the work alone
};

// An encoded image file, whole: EXR or PNG bytes, to be written to a file as they are.
struct candil_image {
	const uint8_t *data; // the owner is said where the image comes from
	size_t bytes; // at most 64 a pixel and 4 MiB
	enum candil_format format;
	uint32_t width, height, samples;
	bool final; // false: an intermediate one
	uint32_t index; // of the camera in a sweep, else 0
};

// ---- the daemon ------------------------------------------------------------------------------------------------------

// What the daemon said in its hello.
struct candil_server {
	uint32_t version; // of the protocol
	char name[64];
	uint64_t max_message_bytes;
	uint64_t max_pixels;
	uint64_t max_samples_times_pixels;
	uint32_t max_jobs_per_connection;
};

struct candil_stats {
	uint64_t uptime_us;
	uint32_t connections, jobs;
	uint64_t jobs_done, jobs_failed, jobs_cancelled, slices;
	uint32_t worker_starts, loader_starts;
	uint64_t loader_failures;
	uint32_t scenes;
	uint64_t scene_bytes, buffered_bytes;
	uint64_t image_bytes; // of encoded images that are being made or wait to be read
	uint32_t worker_pid, loader_pid;
	char device[128]; // "" while the worker starts
	uint64_t device_bytes, validation_errors;
	uint32_t slice_ms;
	char device_error[256]; // why there is no usable device; "" if there is one
};

#endif
