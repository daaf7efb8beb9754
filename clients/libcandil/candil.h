// libcandil: the client side of candild, a headless render service. This header is the manual.
//
// A `candil_client` is one connection. Two ways to use it, which can follow each other on one connection:
//
//  - Blocking: candil_connect, candil_load_file, candil_render, candil_disconnect. Each call returns with its answer.
//  - Non-blocking, for a poll loop of your own: candil_submit_… queues a request and returns its id; when candil_fd is
//    readable (or writable, while candil_wants_write says so) call candil_process, then candil_next_event until it returns
//    false. Many requests, renders above all, share one connection that way; every event bears its request's id.
//
// Threads: a client belongs to one thread at a time; different clients are independent. The library has no global state,
// starts no thread, installs no signal handler and raises no SIGPIPE.
//
// Failure: a call that can fail returns a candil_status and, unless `error` is NULL, fills in a sentence that says what to
// do. After CANDIL_STATUS_IO or CANDIL_STATUS_CONNECT the connection is over: all that is left is candil_disconnect.
//
// Ownership: strings and arrays that go in stay the caller's and are copied before the call returns. What comes out is plain
// values without pointers, but for image bytes, whose owner is said where they appear.
//
// Units: metres, degrees, W/(m² sr), microseconds unless a name says otherwise. Colours are linear Rec.709.
#ifndef CANDIL_H
#define CANDIL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define CANDIL_API __attribute__((visibility("default")))
#else
#define CANDIL_API
#endif

// ---- status ---------------------------------------------------------------------------------------------------------

// The numbers of the wire. A server newer than this header may send others: treat those as a plain failure.
typedef enum candil_status {
	CANDIL_STATUS_OK = 0,
	// The stream itself is broken; the daemon closes the connection.
	CANDIL_STATUS_BAD_MAGIC = 1,
	CANDIL_STATUS_BAD_VERSION = 2,
	CANDIL_STATUS_BAD_FLAGS = 3,
	CANDIL_STATUS_MESSAGE_TOO_LONG = 4,
	CANDIL_STATUS_HELLO_FIRST = 5,
	CANDIL_STATUS_NOT_ALLOWED = 6,
	CANDIL_STATUS_TOO_MANY_CONNECTIONS = 7,
	// This request is wrong; the connection goes on.
	CANDIL_STATUS_UNKNOWN_TYPE = 20,
	CANDIL_STATUS_BAD_MESSAGE = 21,
	CANDIL_STATUS_BAD_ARGUMENT = 22,
	CANDIL_STATUS_LIMIT = 23,
	CANDIL_STATUS_DUPLICATE_REQUEST = 24,
	CANDIL_STATUS_TOO_MANY_JOBS = 25,
	CANDIL_STATUS_NO_SUCH_REQUEST = 26,
	CANDIL_STATUS_UNSUPPORTED = 27,
	// Scenes.
	CANDIL_STATUS_SCENE_NOT_FOUND = 40,
	CANDIL_STATUS_SCENE_FILE = 41,
	CANDIL_STATUS_SCENE_PATH = 42,
	CANDIL_STATUS_SCENE_INVALID = 43,
	CANDIL_STATUS_SCENE_UNSUPPORTED = 44,
	CANDIL_STATUS_SCENE_LIMIT = 45,
	CANDIL_STATUS_LOADER_LOST = 46,
	CANDIL_STATUS_TOO_MANY_SCENES = 47,
	// The job.
	CANDIL_STATUS_CANCELLED = 60,
	CANDIL_STATUS_DEADLINE = 61,
	CANDIL_STATUS_MEMORY = 62,
	CANDIL_STATUS_DEVICE = 63,
	CANDIL_STATUS_WORKER_LOST = 64,
	CANDIL_STATUS_TRAVERSAL_CUT = 65,
	CANDIL_STATUS_ENCODE = 66,
	// The daemon's own trouble, and this side's.
	CANDIL_STATUS_INTERNAL = 80,
	CANDIL_STATUS_SHUTTING_DOWN = 81,
	CANDIL_STATUS_CONNECT = 82, // no daemon answers, or it refused the handshake
	CANDIL_STATUS_IO = 83, // the connection broke
} candil_status;

struct candil_error {
	candil_status code;
	char text[256]; // what is wrong and what to do, one sentence
};

// "scene-not-found": the stable name of a status; "unknown" for a number that is none. Static.
CANDIL_API const char *candil_status_name(candil_status status);

// "0.1.0", of the library. Static.
CANDIL_API const char *candil_library_version(void);

// ---- connection -----------------------------------------------------------------------------------------------------

typedef struct candil_client candil_client;

// What the daemon said in its hello.
struct candil_server {
	uint32_t version; // of the protocol
	char name[64];
	uint64_t max_message_bytes;
	uint64_t max_pixels;
	uint64_t max_samples_times_pixels;
	uint32_t max_jobs_per_connection;
};

// The path that NULL stands for in candil_connect: $XDG_RUNTIME_DIR/candil.sock. false if that variable is not set or the
// path does not fit in `capacity` bytes.
CANDIL_API bool candil_default_address(char *path, size_t capacity);

// Connect to the socket at `address` ("PATH" or "unix:PATH"; NULL: the default) and shake hands; waits at most 10 s.
// On success *client is the caller's, to be ended with candil_disconnect; else it is NULL.
// Fails with CONNECT (nobody there), BAD_VERSION, NOT_ALLOWED, TOO_MANY_CONNECTIONS, BAD_ARGUMENT (the path is too long).
CANDIL_API candil_status candil_connect(const char *address, candil_client **client, struct candil_error *error);

// The same on a stream socket that is connected already. The descriptor is the client's from now on, even on failure.
CANDIL_API candil_status candil_connect_fd(int fd, candil_client **client, struct candil_error *error);

// Close and free. Requests under way are dropped; the daemon frees their device time. NULL is allowed.
CANDIL_API void candil_disconnect(candil_client *client);

// Valid as long as the client.
CANDIL_API const struct candil_server *candil_server(const candil_client *client);

// How long a blocking call waits with no byte from the daemon before it fails with IO; the connection is over then.
// 0, the default: for ever. The first render with a new set of effects compiles shaders in silence: allow seconds.
CANDIL_API void candil_set_timeout(candil_client *client, uint32_t milliseconds);

// ---- scenes ---------------------------------------------------------------------------------------------------------

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

// ---- render ---------------------------------------------------------------------------------------------------------

enum candil_technique {
	CANDIL_TECHNIQUE_AUTO = 0,
	CANDIL_TECHNIQUE_PT = 1,
	CANDIL_TECHNIQUE_VCT = 2,
	CANDIL_TECHNIQUE_RADIOSITY = 3,
	CANDIL_TECHNIQUE_DIRECT = 4,
};

// An effect's bit in effects_on and effects_off is 1u << effect.
enum candil_effect {
	CANDIL_EFFECT_TEXTURES = 0,
	CANDIL_EFFECT_EMITTERS = 1,
	CANDIL_EFFECT_LIGHTS = 2,
	CANDIL_EFFECT_ENVIRONMENT = 3,
	CANDIL_EFFECT_BOUNCES = 4,
	CANDIL_EFFECT_GLOSSY = 5,
	CANDIL_EFFECT_NORMAL_MAPS = 6,
	CANDIL_EFFECT_ALPHA_MASK = 7,
	CANDIL_EFFECT_VERTEX_COLORS = 8,
	CANDIL_EFFECT_UNLIT = 9,
	CANDIL_EFFECT_GLASS = 10,
	CANDIL_EFFECT_ALPHA_BLEND = 11,
	CANDIL_EFFECT_CLEARCOAT = 12,
	CANDIL_EFFECT_ROUGH_DIFFUSE = 13,
	CANDIL_EFFECT_CAUSTICS = 14,
};
#define CANDIL_EFFECT_COUNT 15u

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

// The names that people type: "pt", "textures", "switched-off", "exr-half", "reinhard"; "unknown" for other values. Static.
CANDIL_API const char *candil_technique_name(enum candil_technique technique);
CANDIL_API const char *candil_effect_name(enum candil_effect effect);
CANDIL_API const char *candil_effect_state_name(enum candil_effect_state state);
CANDIL_API const char *candil_format_name(enum candil_format format);
CANDIL_API const char *candil_view_name(enum candil_view view);

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

// 512x512, 64 samples, float EXR, technique and effects automatic, the scene's first camera. `scene` is left NULL.
CANDIL_API void candil_render_request_init(struct candil_render_request *request);

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
	struct candil_effect_report plan[16];
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
	struct candil_stage stages[16];
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

// ---- blocking calls -------------------------------------------------------------------------------------------------
// Refused with BAD_ARGUMENT while requests made by candil_submit_… are open: their events would have nowhere to go.

// A round trip. *microseconds (may be NULL) is how long it took.
CANDIL_API candil_status candil_ping(candil_client *client, uint64_t *microseconds, struct candil_error *error);

// Load a scene and keep it in the daemon until it is unloaded. `info` may be NULL.
CANDIL_API candil_status candil_load(candil_client *client, const struct candil_load_request *request,
				     struct candil_scene_info *info, struct candil_error *error);

// candil_load of a local file with everything else at its default.
CANDIL_API candil_status candil_load_file(candil_client *client, const char *name, const char *file,
					  struct candil_scene_info *info, struct candil_error *error);

CANDIL_API candil_status candil_unload(candil_client *client, const char *name, struct candil_error *error);
CANDIL_API candil_status candil_scenes(candil_client *client, struct candil_scene_list *list, struct candil_error *error);
CANDIL_API candil_status candil_describe(candil_client *client, const char *name, struct candil_scene_info *info,
					 struct candil_error *error);
CANDIL_API candil_status candil_stats(candil_client *client, struct candil_stats *stats, struct candil_error *error);

// What candil_render calls while it waits. Any may be NULL. A result other than 0 cancels the render, which then returns
// CANCELLED. Image bytes are valid during the call only. The client must not be used inside.
struct candil_callbacks {
	int (*accepted)(void *user, const struct candil_accepted *accepted);
	int (*progress)(void *user, const struct candil_progress *progress);
	int (*image)(void *user, const struct candil_image *image); // intermediate images, of a progressive render; of a
								    // sweep, the final ones as well
	void *user;
};

struct candil_render_result {
	struct candil_image image; // the final one; `data` is the caller's, to be freed with candil_free
	struct candil_accepted accepted;
	struct candil_done done;
};

// Render and return the final image. `callbacks` may be NULL. On failure result->image.data is NULL.
CANDIL_API candil_status candil_render(candil_client *client, const struct candil_render_request *request,
				       const struct candil_callbacks *callbacks, struct candil_render_result *result,
				       struct candil_error *error);

struct candil_sweep_result {
	struct candil_accepted accepted; // of the first image
	struct candil_done done; // sums over all images, but for samples (of each) and estimated_relmse (the mean)
};

// The same picture from `count` cameras, 1 to CANDIL_SWEEP_CAMERAS, or at as many times of an animation. The request's own
// camera is not used. Each image comes through callbacks->image as soon as it is finished, in the order of the cameras,
// image->index saying which; if that takes long, the daemon goes on with one more image and then waits. A failure ends the
// whole sweep; images that have come are good.
CANDIL_API candil_status candil_sweep(candil_client *client, const struct candil_render_request *request,
				      const struct candil_camera *cameras, size_t count,
				      const struct candil_callbacks *callbacks, struct candil_sweep_result *result,
				      struct candil_error *error);

// Free image bytes that the library handed over. NULL is allowed.
CANDIL_API void candil_free(const void *data);

// ---- non-blocking calls ---------------------------------------------------------------------------------------------

// The descriptor to poll. Do nothing else with it.
CANDIL_API int candil_fd(const candil_client *client);

// Whether to poll for POLLOUT besides POLLIN: bytes are waiting to be sent.
CANDIL_API bool candil_wants_write(const candil_client *client);

// Send and receive what can be without waiting. Harmless when there is nothing to do. Fails with IO once the connection is
// over and every event has been taken; the open requests each get an ERROR event first.
CANDIL_API candil_status candil_process(candil_client *client, struct candil_error *error);

// Queue a request and write its id to *id. Nothing is sent before candil_process. Fails with BAD_ARGUMENT (a string is too
// long or missing), TOO_MANY_JOBS (64 requests are open), SCENE_FILE (a local file cannot be opened), MEMORY, IO.
CANDIL_API candil_status candil_submit_ping(candil_client *client, const void *payload, size_t bytes, uint32_t *id,
					    struct candil_error *error); // payload: at most 256 bytes, comes back
CANDIL_API candil_status candil_submit_load(candil_client *client, const struct candil_load_request *request, uint32_t *id,
					    struct candil_error *error);
CANDIL_API candil_status candil_submit_unload(candil_client *client, const char *name, uint32_t *id,
					      struct candil_error *error);
CANDIL_API candil_status candil_submit_scenes(candil_client *client, uint32_t *id, struct candil_error *error);
CANDIL_API candil_status candil_submit_describe(candil_client *client, const char *name, uint32_t *id,
						struct candil_error *error);
CANDIL_API candil_status candil_submit_render(candil_client *client, const struct candil_render_request *request,
					      uint32_t *id, struct candil_error *error);
CANDIL_API candil_status candil_submit_sweep(candil_client *client, const struct candil_render_request *request,
					     const struct candil_camera *cameras, size_t count, uint32_t *id,
					     struct candil_error *error); // see candil_sweep
CANDIL_API candil_status candil_submit_stats(candil_client *client, uint32_t *id, struct candil_error *error);

// Ask the daemon to cancel render or sweep `id`. Has no event of its own: the render ends with ERROR cancelled, or with DONE
// where it was quicker. Fails with NO_SUCH_REQUEST if no such request of that id is open.
CANDIL_API candil_status candil_cancel(candil_client *client, uint32_t id, struct candil_error *error);

enum candil_event_kind {
	CANDIL_EVENT_PONG = 1, // pong             ends a ping
	CANDIL_EVENT_SCENE, // scene            ends a load or a describe
	CANDIL_EVENT_OK, //                  ends an unload
	CANDIL_EVENT_SCENES, // scenes           ends a list
	CANDIL_EVENT_ACCEPTED, // accepted         of a render: once
	CANDIL_EVENT_PROGRESS, // progress         of a render: any number
	CANDIL_EVENT_IMAGE, // image            of a render: intermediate ones, then one that is final;
			    //                  of a sweep: so for each camera in turn
	CANDIL_EVENT_DONE, // done             ends a render or a sweep; the final images came before it
	CANDIL_EVENT_STATS, // stats            ends a stats request
	CANDIL_EVENT_ERROR, // error            ends any request
};

struct candil_event {
	enum candil_event_kind kind;
	uint32_t id; // the request's
	bool ends_request; // no event with this id will follow
	union {
		struct {
			size_t bytes;
			uint8_t payload[256];
		} pong;
		struct candil_scene_info scene;
		struct candil_scene_list scenes;
		struct candil_accepted accepted;
		struct candil_progress progress;
		struct candil_image image; // data: the client's, valid until the next candil_next_event or candil_disconnect
		struct candil_done done;
		struct candil_stats stats;
		struct candil_error error;
	} u;
};

// Take the next event that has arrived. false: none now; go back to poll. Does not touch the socket.
CANDIL_API bool candil_next_event(candil_client *client, struct candil_event *event);

// After an IMAGE event: the caller owns image->data from now on and frees it with candil_free.
CANDIL_API void candil_keep_image(candil_client *client, const struct candil_image *image);

#ifdef __cplusplus
}
#endif

#endif
